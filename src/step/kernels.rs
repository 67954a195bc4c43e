//! The one table that turns options into kernels.

use super::grid_to_particles::for_stencil_nodes;
use super::options::Options;
use super::particles_to_grid::{Scattered, scatter};
use super::parts::Method;
use super::pass::{Pass, pass};
use super::update_stress::Outcome;
use crate::background::{Background, Blocks};
use crate::parallel::Team;
use crate::particles::Body;
use crate::shape::cubic_bspline::CubicBspline;
use crate::shape::gimp::Gimp;
use crate::shape::linear::Linear;
use crate::shape::mls::Mls;
use crate::shape::modified::Modified;
use crate::shape::quadratic_bspline::QuadraticBspline;
use crate::shape::stencil::{At, ShapeFunction};
use crate::shape::{ShapeKind, WallTreatment};
use crate::transfer::TransferKind;

/// Calls the visitor with number and weight of every node of the stencil of a point in a layer;
/// false if a node's block is not active.
pub type NodesAt<const D: usize> =
    fn(&Blocks<D>, u32, [At<f64>; D], &mut dyn FnMut(usize, f64)) -> bool;

/// The kernels of a world: those of the stages that depend on the shape function, each a whole
/// stage.
#[derive(Clone, Copy)]
pub struct Kernels<const D: usize> {
    /// Particles to tiles.
    pub scatter: fn(&mut Background<D>, &[Body], &Method<D>, &Team, Scattered),
    /// The grid to particles, and what follows chunk by chunk.
    pub pass: fn(&mut [Body], &Background<D>, &Method<D>, &Team, &Pass) -> Outcome,
    /// The nodes around a point.
    pub nodes_at: NodesAt<D>,
    /// Σ w (x_i − x_p)² along one axis, in units of h².
    pub moment: fn(At<f64>) -> f64,
}

impl<const D: usize> Kernels<D> {
    /// The kernels of checked options, in a world with or without walls.
    pub fn new(options: &Options, walls: bool) -> Self {
        let modified = walls && options.wall_treatment == WallTreatment::Modified;
        let mls = options.transfer == TransferKind::Mls;
        match options.shape {
            ShapeKind::Linear => Self::walled::<Linear, 2>(modified),
            ShapeKind::QuadraticBspline => Self::of_spline::<QuadraticBspline, 3>(mls, modified),
            ShapeKind::CubicBspline => Self::of_spline::<CubicBspline, 4>(mls, modified),
            ShapeKind::UniformGimp | ShapeKind::ContiguousGimp => Self::walled::<Gimp, 3>(modified),
        }
    }

    fn of_spline<S: ShapeFunction<N>, const N: usize>(mls: bool, modified: bool) -> Self {
        match (mls, modified) {
            (true, false) => Self::of::<Mls<S>, N>(),
            (true, true) => Self::of::<Mls<Modified<S>>, N>(),
            _ => Self::walled::<S, N>(modified),
        }
    }

    fn walled<S: ShapeFunction<N>, const N: usize>(modified: bool) -> Self {
        if modified { Self::of::<Modified<S>, N>() } else { Self::of::<S, N>() }
    }

    fn of<S: ShapeFunction<N>, const N: usize>() -> Self {
        Self {
            scatter: scatter::<S, N, D>,
            pass: pass::<S, N, D>,
            nodes_at: for_stencil_nodes::<S, N, D>,
            moment: |at| {
                let axis = S::axis::<f64>(at);
                (0..N).map(|n| axis.w[n] * axis.r[n].powi(2)).sum()
            },
        }
    }
}
