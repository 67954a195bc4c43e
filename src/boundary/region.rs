//! Boxes in space that choose nodes or particles.

use crate::error::{Error, Result};

/// A box; its sides may be infinitely far away. In two dimensions its third axis is ignored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxRegion {
    /// Lower corner [m].
    pub min: [f64; 3],
    /// Upper corner [m].
    pub max: [f64; 3],
}

impl BoxRegion {
    /// Whether the corners make sense in `dimension` axes; `what` names the box in errors.
    pub fn check(&self, what: &str, dimension: usize) -> Result<()> {
        for d in 0..dimension {
            if self.min[d].is_nan() && self.max[d].is_nan() {
                return Err(Error::invalid(format!(
                    "the box of {what} was not set along {}: give its corners box_min and box_max [m]",
                    ["x", "y", "z"][d]
                )));
            }
            if !(self.min[d] <= self.max[d]) {
                return Err(Error::invalid(format!(
                    "the box of {what} needs min <= max, neither being NaN [m]; along {} they are {} and {}",
                    ["x", "y", "z"][d],
                    self.min[d],
                    self.max[d]
                )));
            }
        }
        Ok(())
    }

    /// Whether a position lies in the box, which is larger by `margin` [m] on every side.
    pub fn holds<const D: usize>(&self, x: &[f64; D], margin: f64) -> bool {
        (0..D).all(|d| self.min[d] - margin <= x[d] && x[d] <= self.max[d] + margin)
    }
}
