//! Conditions on the nodes of the grid and on the particles of surfaces.

pub mod law;
pub mod prescribed_velocity;
pub mod region;
pub mod registry;
pub mod table;
pub mod traction;
pub mod wall;

pub use prescribed_velocity::{Prescribed, PrescribedVelocity};
pub use region::BoxRegion;
pub use registry::{Condition, Conditions, Entry, Holding, List, Listed};
pub use table::Table;
pub use traction::{Loaded, Surface, Traction};
pub use wall::{Reaching, Wall, WallKind};
