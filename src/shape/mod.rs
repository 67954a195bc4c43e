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

use crate::choice::choices;
use stencil::ShapeFunction;

choices! {
    /// The shape functions that a world can use: [`linear`], [`quadratic_bspline`],
    /// [`cubic_bspline`], [`gimp`].
    pub enum ShapeKind: "shape" {
        /// Shape functions: linear. Use them with FLIP and LAHAR_ORDER_MUSL, see LAHAR_ORDER_USL.
        Linear = 0, "linear", LAHAR_SHAPE_LINEAR;
        /// Shape functions: quadratic B-splines (default).
        QuadraticBspline = 1, "quadratic_bspline", LAHAR_SHAPE_QUADRATIC_BSPLINE,
            "quadratic B-spline";
        /// Shape functions: cubic B-splines.
        CubicBspline = 2, "cubic_bspline", LAHAR_SHAPE_CUBIC_BSPLINE, "cubic B-spline";
        /// Shape functions: uniform GIMP, linear functions averaged over the particle's domain,
        /// which keeps its size. Bodies from arrays must give the sizes of their particles.
        UniformGimp = 3, "uniform_gimp", LAHAR_SHAPE_UNIFORM_GIMP, "uniform GIMP";
        /// Shape functions: contiguous-particle GIMP. The domain's edges follow the stretch U of
        /// the particle (F = R U), at most to the spacing.
        ContiguousGimp = 4, "contiguous_gimp", LAHAR_SHAPE_CONTIGUOUS_GIMP,
            "contiguous-particle GIMP";
    }
}

choices! {
    /// What shape functions do next to walls, see [`modified`].
    pub enum WallTreatment: "wall_treatment" {
        /// Next to walls shape functions are as everywhere; all nodes in reach of a wall feel it
        /// (default).
        Plain = 0, "plain", LAHAR_WALLS_PLAIN;
        /// Next to walls shape functions are modified: linear fields are reproduced up to the wall,
        /// where the node on it alone counts. Walls must stand on node planes, at most one on each
        /// side of an axis, and particles between them.
        Modified = 1, "modified", LAHAR_WALLS_MODIFIED, "modified shape functions";
    }
}

impl ShapeKind {
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
