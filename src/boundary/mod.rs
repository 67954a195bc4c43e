//! Conditions on the nodes of the grid and on the particles of surfaces.

pub mod prescribed_velocity;
pub mod region;
pub mod table;
pub mod traction;
pub mod wall;

pub use prescribed_velocity::PrescribedVelocity;
pub use region::BoxRegion;
pub use table::Table;
pub use traction::{Surface, Traction};
pub use wall::{Wall, WallKind};
