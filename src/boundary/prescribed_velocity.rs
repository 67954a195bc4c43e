//! Velocities prescribed on a region of the grid.

use super::{BoxRegion, Table};
use crate::error::{Error, Result};

/// The component along x in [`PrescribedVelocity::components`].
pub const X: i32 = 1;
/// The component along y.
pub const Y: i32 = 2;
/// The component along z.
pub const Z: i32 = 4;

/// The nodes in a box move as told, whatever pulls at them.
#[derive(Clone, Debug)]
pub struct PrescribedVelocity {
    /// Where: the nodes in this box, to 1e-9 of the spacing.
    pub region: BoxRegion,
    /// Which components: the sum of [`X`], [`Y`] and [`Z`]; the others stay free.
    pub components: i32,
    /// The velocity [m/s].
    pub velocity: Table,
}

impl PrescribedVelocity {
    /// Whether the condition makes sense in a world of `dimension` axes.
    pub fn check(&self, dimension: usize) -> Result<()> {
        self.region.check("a prescribed velocity", dimension)?;
        let all = if dimension == 3 { X | Y | Z } else { X | Y };
        if !(1..=all).contains(&self.components) {
            return Err(Error::invalid(format!(
                "components must be the sum of 1 (x), 2 (y){} for the components that are prescribed, got {}",
                if dimension == 3 { " and 4 (z)" } else { ", in two dimensions without z," },
                self.components
            )));
        }
        Ok(())
    }

    /// Whether the velocity along an axis is prescribed.
    pub fn holds(&self, axis: usize) -> bool {
        self.components >> axis & 1 == 1
    }
}
