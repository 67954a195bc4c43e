//! Shape functions: how a particle is spread over nodes.
//!
//! A shape function is one function of one axis; the tensor product is written once, in [`weights`].

pub mod linear;
pub mod quadratic_bspline;
pub mod stencil;
pub mod weights;

use crate::error::{Error, Result};

/// The shape functions that a world can use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum ShapeKind {
    /// Piecewise linear: 2 nodes an axis.
    Linear = 0,
    /// Quadratic B-spline: 3 nodes an axis.
    QuadraticBspline = 1,
}

impl ShapeKind {
    /// The kind with this number.
    pub fn from_i32(value: i32) -> Result<Self> {
        match value {
            0 => Ok(Self::Linear),
            1 => Ok(Self::QuadraticBspline),
            _ => Err(Error::invalid(format!(
                "shape must be 0 (linear) or 1 (quadratic B-spline), got {value}"
            ))),
        }
    }

    /// Nodes of a stencil along one axis.
    pub const fn nodes(self) -> usize {
        match self {
            Self::Linear => 2,
            Self::QuadraticBspline => 3,
        }
    }

    /// The lowest node of the stencil at ξ is floor(ξ − offset); ξ in units of the spacing.
    pub const fn first_offset(self) -> f64 {
        match self {
            Self::Linear => linear::Linear::FIRST_OFFSET,
            Self::QuadraticBspline => quadratic_bspline::QuadraticBspline::FIRST_OFFSET,
        }
    }

    /// How far from a wall, in units of the spacing, nodes still feel it: radius of the support − 1.
    pub const fn wall_reach(self) -> f64 {
        0.5 * self.nodes() as f64 - 1.0
    }
}

use stencil::ShapeFunction;
