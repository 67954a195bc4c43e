//! Conditions on the nodes of the grid.

pub mod wall;

pub use wall::{Wall, WallKind};
