//! The C API: one file per object, a thin layer over the engine's Rust types.
//!
//! `include/lahar/lahar.h` is generated from the files of this folder, in the order listed in
//! `xtask/src/headers.rs`. A wrapper checks pointers, counts, strides and struct sizes; the engine
//! checks physics. Every body runs inside [`entry::entry`]; the objects behind the handles are in
//! [`cells`].
#![allow(non_camel_case_types)] // the names are those of the C header
#![allow(clippy::missing_safety_doc)] // the conventions at the top of lahar.h are the contract of every function

pub mod answers;
mod arguments;
mod cells;
mod entry;
mod layout;

pub mod body;
pub mod context;
pub mod error;
pub mod field;
pub mod grid;
pub mod material;
pub mod model;
pub mod output;
pub mod prescribed_velocity;
pub mod progress;
pub mod statics;
pub mod status;
pub mod table;
pub mod traction;
pub mod version;
pub mod view;
pub mod wall;
pub mod world;

/// All public structs, for the assertions of `layout`.
mod public {
    pub(super) use super::body::{lahar_array, lahar_fill, lahar_particles};
    pub(super) use super::context::lahar_plugin_info;
    pub(super) use super::error::lahar_error_info;
    pub(super) use super::field::lahar_field_info;
    pub(super) use super::grid::lahar_grid_statistics;
    pub(super) use super::model::{lahar_model_info, lahar_parameter_info, lahar_state_info};
    pub(super) use super::output::lahar_totals;
    pub(super) use super::prescribed_velocity::lahar_prescribed_velocity;
    pub(super) use super::statics::{
        lahar_equilibrium, lahar_settle_criteria, lahar_settle_result,
    };
    pub(super) use super::table::lahar_table;
    pub(super) use super::traction::lahar_traction;
    pub(super) use super::view::lahar_view_info;
    pub(super) use super::wall::lahar_wall;
    pub(super) use super::world::lahar_world_options;
}
