//! Safe Rust for authors of constitutive models.
//!
//! A model is a type that implements [`Model`]: its constants describe it, `new` makes an instance from parameter
//! values and `update` advances a [`Batch`] of points. [`ModelTable::of`] turns the type into the
//! static table of the plugin ABI, a static [`Plugin`], which [`plugin!`] writes, lists the tables,
//! and [`export_plugin!`], in a thin `cdylib` of its own, writes the one symbol that the engine looks
//! for. A model needs no `unsafe`.
//!
//! Conventions of all arrays: SI or any other consistent units; tension positive; symmetric tensors are the tensor
//! components xx, yy, zz, xy, yz, zx; general tensors are row-major; both are three-dimensional in plane strain too.
//!
//! A model whose formulas are those of one point is written as a [`PointLaw`]: [`Batch::for_each_point`] runs it over a
//! batch with the widest vector instructions of the processor ([`simd`]).
//!
//! What models share stands in modules: [`elastic`], with [`elastic_model!`] for models of constant
//! moduli, [`plastic`], [`radial`], [`isotropic`], [`gap`], [`tensor`], [`math`] and [`root`].
//!
//! A panic in a model does not leave the plugin: the function that was running returns `LAHAR_PLUGIN_ERROR` with the
//! text of the panic. [`Driver`] runs a model through its table without an engine: element tests are written with
//! it and with [`testing`].

mod batch;
mod drive;
pub mod elastic;
pub mod gap;
pub mod isotropic;
pub mod math;
mod model;
mod path;
pub mod plastic;
mod point;
mod principal;
pub mod radial;
pub mod root;
pub mod simd;
mod table;
pub mod tensor;
pub mod testing;
mod wall;

pub use batch::{Batch, Columns, MAX_INPUTS, PointStatus};
pub use drive::Driver;
pub use lahar_plugin_abi as abi;
pub use model::Model;
pub use nalgebra;
pub use path::Control;
pub use point::{Point, PointLaw, Updated};
pub use principal::principal;
pub use table::{
    Input, Kinematics, ModelTable, Output, Parameter, Plugin, State, Transfer, c_text,
};
pub use wall::{enter, log, should_stop};

/// Writes the static `PLUGIN` with the listed models, and the function `plugin`, its entry for
/// programs that link it statically.
///
/// Version, author and licence are those of the package in which the macro stands.
///
/// ```text
/// lahar_plugin::plugin!(c"org.lahar.newtonian", [Newtonian, TaitWater]);
/// ```
#[macro_export]
macro_rules! plugin {
    ($id:expr, [$($model:ty),+ $(,)?]) => {
        /// The plugin with the models of this crate.
        pub static PLUGIN: $crate::Plugin = $crate::Plugin::new(
            $id,
            $crate::c_text(concat!(env!("CARGO_PKG_VERSION"), "\0")),
            &[$($crate::ModelTable::of::<$model>()),+],
        )
        .author($crate::c_text(concat!(env!("CARGO_PKG_AUTHORS"), "\0")))
        .licence($crate::c_text(concat!(env!("CARGO_PKG_LICENSE"), "\0")));

        /// The entry of the plugin, for programs that link its models statically.
        pub fn plugin(
            host: &'static $crate::abi::lahar_host_api,
        ) -> $crate::abi::LinkedPlugin {
            PLUGIN.entered(host)
        }
    };
}

/// Writes `lahar_plugin_entry_v1`, which returns the given `&'static Plugin`.
///
/// Use it once, in a `cdylib` that contains nothing else: two entry symbols in one binary collide.
///
/// ```text
/// lahar_plugin::export_plugin!(lahar_model_linear_elastic::PLUGIN);
/// ```
#[macro_export]
macro_rules! export_plugin {
    ($plugin:path) => {
        /// Entry of the plugin: returns its tables.
        ///
        /// # Safety
        ///
        /// `host` is NULL or points to a host table that stays valid for the life of the process.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn lahar_plugin_entry_v1(
            host: *const $crate::abi::lahar_host_api,
        ) -> *const $crate::abi::lahar_plugin_desc {
            // SAFETY: the engine passes its host table, which stays valid for the life of the process.
            unsafe { $crate::enter(host, &$plugin) }
        }
    };
}
