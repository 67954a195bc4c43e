//! Writers.

pub mod vtk;
