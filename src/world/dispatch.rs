//! The one table that turns options into kernels.

use crate::grid::Grid;
use crate::shape::ShapeKind;
use crate::shape::linear::Linear;
use crate::shape::quadratic_bspline::QuadraticBspline;
use crate::shape::stencil::ShapeFunction;
use crate::step::grid_to_particles::{GatherKernel, for_stencil_nodes, gather_chunk};
use crate::step::particles_to_grid::{Scatter, scatter_tiles};

/// Calls the visitor with number and weight of every node of the stencil at ξ; false if a node's block is not active.
pub type NodesAt<const D: usize> = fn(&Grid<D>, [f64; D], &mut dyn FnMut(usize, f64)) -> bool;

/// The kernels of a world, called once per run of particles.
#[derive(Clone, Copy, Debug)]
pub struct Kernels<const D: usize> {
    /// m, mv and f to a tile.
    pub scatter: Scatter<D>,
    /// The grid to particles.
    pub gather: GatherKernel<D>,
    /// The nodes around a point.
    pub nodes_at: NodesAt<D>,
    /// Σ w (x_i − x_p)² along one axis at ξ, in units of h².
    pub moment: fn(f64) -> f64,
}

impl<const D: usize> Kernels<D> {
    /// The kernels of a shape function.
    pub fn new(shape: ShapeKind) -> Self {
        match shape {
            ShapeKind::Linear => Self::of::<Linear, 2>(),
            ShapeKind::QuadraticBspline => Self::of::<QuadraticBspline, 3>(),
        }
    }

    fn of<S: ShapeFunction<N>, const N: usize>() -> Self {
        Self {
            scatter: scatter_tiles::<S, N, D>,
            gather: gather_chunk::<S, N, D>,
            nodes_at: for_stencil_nodes::<S, N, D>,
            moment: |xi| {
                let axis = S::axis::<f64>(xi);
                (0..N).map(|n| axis.w[n] * (n as f64 - axis.fraction).powi(2)).sum()
            },
        }
    }
}
