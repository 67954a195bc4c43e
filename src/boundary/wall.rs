//! Planar walls normal to an axis.
//!
//! A wall acts on every node whose signed distance to it (positive on the side of the material) is at most its reach: the
//! radius of the shape function's support less one cell, 0 for linear and h/2 for quadratic shapes. With the wall on a node plane
//! (linear) or a half-cell plane (quadratic) no free node's function then reaches the wall; elsewhere the wall acts up
//! to one cell late. All nodes behind it are held too; several walls act in the order in which they were added.

use crate::error::{Error, Result};

/// What a wall does to a node's velocity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum WallKind {
    /// The material sticks: v = 0.
    Sticky = 0,
    /// The material slides without friction and cannot leave: v·n = 0.
    Slip = 1,
    /// The material slides without friction and may leave: v·n ≥ 0.
    Separating = 2,
    /// As separating, with Coulomb friction: the tangential velocity changes by at most μ times the normal one.
    Friction = 3,
}

impl WallKind {
    /// The kind with this number.
    pub fn from_i32(value: i32) -> Result<Self> {
        match value {
            0 => Ok(Self::Sticky),
            1 => Ok(Self::Slip),
            2 => Ok(Self::Separating),
            3 => Ok(Self::Friction),
            _ => Err(Error::invalid(format!(
                "a wall's kind must be 0 (sticky), 1 (slip), 2 (separating) or 3 (friction), got {value}"
            ))),
        }
    }
}

/// A wall through the whole world, normal to an axis.
#[derive(Clone, Copy, Debug)]
pub struct Wall {
    /// Axis of the normal: 0, 1 or 2.
    pub axis: usize,
    /// +1: the material is at larger coordinates; −1: at smaller ones.
    pub side: i32,
    /// Coordinate of the wall along the axis [m].
    pub position: f64,
    /// What it does.
    pub kind: WallKind,
    /// Friction coefficient μ [–]; used by [`WallKind::Friction`].
    pub friction: f64,
}

impl Wall {
    /// Whether the wall makes sense in a world of `dimension` axes.
    pub fn check(&self, dimension: usize) -> Result<()> {
        if self.axis >= dimension {
            return Err(Error::invalid(format!(
                "a wall's axis must be 0 to {} in {dimension} dimensions, got {}",
                dimension - 1,
                self.axis
            )));
        }
        if self.side != 1 && self.side != -1 {
            return Err(Error::invalid(format!(
                "a wall's side must be 1 (material at larger coordinates) or -1, got {}",
                self.side
            )));
        }
        if !self.position.is_finite() {
            return Err(Error::invalid(format!(
                "a wall's position must be finite, got {}",
                self.position
            )));
        }
        if !(self.friction >= 0.0 && self.friction.is_finite()) {
            return Err(Error::invalid(format!(
                "a wall's friction must be finite and not negative, got {}",
                self.friction
            )));
        }
        Ok(())
    }

    /// Velocity that the wall leaves a node with velocity `v`.
    #[inline(always)]
    pub fn constrain<const D: usize>(&self, v: [f64; D]) -> [f64; D] {
        let side = f64::from(self.side);
        let mut out = v;
        match self.kind {
            WallKind::Sticky => return [0.0; D],
            WallKind::Slip => out[self.axis] = 0.0, // [BND-1]
            WallKind::Separating | WallKind::Friction => {
                let approach = -side * v[self.axis];
                if approach <= 0.0 {
                    return v;
                }
                out[self.axis] = 0.0;
                if self.kind == WallKind::Friction {
                    let tangential = out.iter().map(|c| c * c).sum::<f64>().sqrt();
                    let left = (tangential - self.friction * approach).max(0.0); // [BND-2]
                    if tangential > 0.0 {
                        out = out.map(|c| c * (left / tangential));
                    }
                }
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn floor(kind: WallKind) -> Wall {
        Wall { axis: 1, side: 1, position: 0.0, kind, friction: 0.5 }
    }

    #[test]
    fn each_kind_leaves_the_velocity_it_should() {
        let v = [3.0, -2.0];
        assert_eq!(floor(WallKind::Sticky).constrain(v), [0.0, 0.0]);
        assert_eq!(floor(WallKind::Slip).constrain(v), [3.0, 0.0]);
        assert_eq!(floor(WallKind::Separating).constrain(v), [3.0, 0.0]);
        assert_eq!(floor(WallKind::Friction).constrain(v), [2.0, 0.0]);
        assert_eq!(floor(WallKind::Friction).constrain([0.5, -2.0]), [0.0, 0.0]);
        for kind in [WallKind::Separating, WallKind::Friction] {
            assert_eq!(floor(kind).constrain([3.0, 2.0]), [3.0, 2.0]);
        }
        assert_eq!(floor(WallKind::Slip).constrain([3.0, 2.0]), [3.0, 0.0]);
    }
}
