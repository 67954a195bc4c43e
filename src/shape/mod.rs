//! Shape functions: how a particle is spread over nodes.
//!
//! A shape function is one function of one axis; the tensor product is written once, in [`weights`].

pub mod cubic_bspline;
pub mod gimp;
pub mod linear;
pub mod mls;
pub mod modified;
pub mod quadratic_bspline;
pub mod stencil;
#[cfg(test)]
mod tests;
pub mod textbook;
pub mod weights;

use crate::error::{Error, Result};
use stencil::ShapeFunction;

/// The shape functions that a world can use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum ShapeKind {
    /// Piecewise linear: 2 nodes an axis.
    Linear = 0,
    /// Quadratic B-spline: 3 nodes an axis.
    QuadraticBspline = 1,
    /// Cubic B-spline: 4 nodes an axis.
    CubicBspline = 2,
    /// Uniform GIMP: linear, averaged over a particle of constant size; 3 nodes an axis.
    UniformGimp = 3,
    /// Contiguous-particle GIMP: the size follows the stretch of the particle.
    ContiguousGimp = 4,
}

impl ShapeKind {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Linear,
        Self::QuadraticBspline,
        Self::CubicBspline,
        Self::UniformGimp,
        Self::ContiguousGimp,
    ];

    /// The kind with this number.
    pub fn from_i32(value: i32) -> Result<Self> {
        Self::ALL.into_iter().find(|kind| *kind as i32 == value).ok_or_else(|| {
            Error::invalid(format!(
                "shape must be 0 (linear), 1 (quadratic B-spline), 2 (cubic B-spline), 3 (uniform GIMP) or 4 \
                 (contiguous-particle GIMP), got {value}"
            ))
        })
    }

    /// Its name in messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::QuadraticBspline => "quadratic B-spline",
            Self::CubicBspline => "cubic B-spline",
            Self::UniformGimp => "uniform GIMP",
            Self::ContiguousGimp => "contiguous-particle GIMP",
        }
    }

    /// Nodes of a stencil along one axis.
    pub const fn nodes(self) -> usize {
        match self {
            Self::Linear => 2,
            Self::QuadraticBspline | Self::UniformGimp | Self::ContiguousGimp => 3,
            Self::CubicBspline => 4,
        }
    }

    /// The lowest node of the stencil at ξ is floor(ξ − offset); ξ in units of the spacing.
    pub const fn first_offset(self) -> f64 {
        match self {
            Self::Linear => linear::Linear::FIRST_OFFSET,
            Self::QuadraticBspline => quadratic_bspline::QuadraticBspline::FIRST_OFFSET,
            Self::CubicBspline => cubic_bspline::CubicBspline::FIRST_OFFSET,
            Self::UniformGimp | Self::ContiguousGimp => gimp::Gimp::FIRST_OFFSET,
        }
    }

    /// Whether particles need a size.
    pub const fn is_sized(self) -> bool {
        matches!(self, Self::UniformGimp | Self::ContiguousGimp)
    }

    /// How far from a wall, in units of the spacing, nodes still feel it: radius of the support − 1. (A particle of GIMP that touches a wall on a
    /// node plane gives nothing to the nodes behind.)
    pub const fn wall_reach(self) -> f64 {
        if self.is_sized() { 0.0 } else { 0.5 * self.nodes() as f64 - 1.0 }
    }
}

/// What shape functions do next to walls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum WallTreatment {
    /// Nothing: all nodes in reach of a wall feel it.
    Plain = 0,
    /// Functions of nodes behind a wall are given to those in front, see [`modified`]; walls stand on node planes.
    Modified = 1,
}

impl WallTreatment {
    /// The treatment with this number.
    pub fn from_i32(value: i32) -> Result<Self> {
        match value {
            0 => Ok(Self::Plain),
            1 => Ok(Self::Modified),
            _ => Err(Error::invalid(format!(
                "wall_treatment must be 0 (plain) or 1 (modified shape functions), got {value}"
            ))),
        }
    }
}
