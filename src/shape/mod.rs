//! Shape functions: how a particle is spread over nodes.
//!
//! A shape function is one function of one axis; the tensor product is written once, in
//! [`weights`].

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
        /// Next to walls shape functions are as everywhere; all nodes in reach of a wall feel it.
        /// With B-splines a layer of up to a cell moves with the wall: fluids drain into it.
        Plain = 0, "plain", LAHAR_WALLS_PLAIN;
        /// Next to walls shape functions are modified: linear fields are reproduced up to the wall,
        /// which acts where it stands, on a node plane or not (default). Of several walls on a side
        /// of an axis the innermost counts; facing ones must be half a cell apart.
        Modified = 1, "modified", LAHAR_WALLS_MODIFIED, "modified shape functions";
    }
}

/// Properties of a shape function, whatever its type.
struct Facts {
    nodes: usize,
    first_offset: f64,
    moment: Option<f64>,
    is_sized: bool,
}

const fn facts<S: ShapeFunction<N>, const N: usize>() -> Facts {
    Facts { nodes: N, first_offset: S::FIRST_OFFSET, moment: S::MOMENT, is_sized: S::SIZED }
}

impl ShapeKind {
    const fn facts(self) -> Facts {
        match self {
            Self::Linear => facts::<linear::Linear, 2>(),
            Self::QuadraticBspline => facts::<quadratic_bspline::QuadraticBspline, 3>(),
            Self::CubicBspline => facts::<cubic_bspline::CubicBspline, 4>(),
            Self::UniformGimp | Self::ContiguousGimp => facts::<gimp::Gimp, 3>(),
        }
    }

    /// Nodes of a stencil along one axis.
    pub const fn nodes(self) -> usize {
        self.facts().nodes
    }

    /// The lowest node of the stencil at ξ is floor(ξ − offset); ξ in units of the spacing.
    pub const fn first_offset(self) -> f64 {
        self.facts().first_offset
    }

    /// Σ w (x_i − x_p)² along one axis, in units of h², if it is the same everywhere.
    pub const fn moment(self) -> Option<f64> {
        self.facts().moment
    }

    /// Whether particles need a size.
    pub const fn is_sized(self) -> bool {
        self.facts().is_sized
    }

    /// How far from a wall, in units of the spacing, nodes still feel it: radius of the
    /// support − 1. (A particle of GIMP that touches a wall on a node plane gives nothing to the
    /// nodes behind.)
    pub const fn wall_reach(self) -> f64 {
        if self.is_sized() { 0.0 } else { 0.5 * self.nodes() as f64 - 1.0 }
    }
}
