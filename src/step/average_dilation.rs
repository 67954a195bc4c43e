//! Stage 5b, F-bar: the rate at which particles of a body grow is averaged over patches of the grid, so that nearly incompressible and plastic
//! material does not lock. Bodies without F-bar pass.
//!
//! A patch is a cell between nodes, whatever the shape function. Patches between the half-cell planes of quadratic splines would be the cells of
//! their polynomials, but the growth of such a cell is (v₊₁ − v₋₁) / 2: the pressure of every other one would be free of its neighbours. L̄ = L + (⟨tr L⟩ − tr L) I / n with the mean
//! weighted by volume, n = 2 in plane strain, else 3; strain increment, volume and F take L̄. In rates it is the F̄ = (⟨J⟩ / J)^(1/n) F of
//! E. A. de Souza Neto, D. Perić, M. Dutko, D. R. J. Owen, Int. J. Solids Struct. 33 (1996) 3277–3296, doi:10.1016/0020-7683(95)00259-6; for
//! particles: W. M. Coombs, T. J. Charlton, M. Cortis, C. E. Augarde, Comput. Methods Appl. Mech. Engrg. 333 (2018) 1–21, doi:10.1016/j.cma.2018.01.010.

use rayon::prelude::*;

use crate::background::{EDGE, Grid, Key, Run};
use crate::particles::Dilations;
use crate::world::state::{Body, Piece, Space, State};

use super::grid_to_particles::{Gather, grid_to_particles};
use super::update_stress::Outcome;

/// Patches that the particles of a block reach along each axis: their lowest nodes are in the block, or behind it by one.
const REACH: usize = EDGE + 1;

/// Sums over patches, kept from step to step.
#[derive(Debug, Default)]
pub struct Patches {
    /// For each run of a body and each patch that it reaches: Σ V tr L and Σ V of the run's own particles.
    sums: Vec<[f64; 2]>,
    /// The run of each slot of the grid.
    runs: Vec<u32>,
}

/// No run.
const NONE: u32 = u32::MAX;

/// Leaves with every particle of the bodies with F-bar the mean rate of its patch, of the gradient that `gather` takes.
pub fn average_dilation<const D: usize>(world: &mut State<D>, gather: Gather) {
    if !world.bodies.iter().any(Body::has_f_bar) {
        return;
    }
    world.for_each_chunk(|piece| {
        if piece.chunk.layout.has_dilation() {
            grid_to_particles(piece, gather, 0.0);
            keep_rates(piece);
        }
        Outcome::default()
    });
    let (space, parallel) = (world.space(), world.parallel);
    let State { bodies, grid, patches, .. } = world;
    for body in bodies.iter_mut().filter(|body| body.has_f_bar()) {
        let Body { particles, runs, .. } = body;
        let mut particles = particles.dilations::<D>();
        patches.collect(&space, grid.keys(), &mut particles, runs, parallel);
        let whole = Whole { space: &space, grid, patches, parallel };
        whole.share(particles, runs, 0);
    }
}

/// Turns the velocity gradients of a chunk into those of F-bar.
pub fn share_dilation<const D: usize>(piece: &mut Piece<'_, '_, D>) {
    let Piece { chunk, scratch, axisymmetric, .. } = piece;
    if !chunk.layout.has_dilation() {
        return;
    }
    let axes = if *axisymmetric { 3 } else { D };
    let (stride, l) = (scratch.stride, &mut *scratch.velocity_gradient);
    for (k, mean) in chunk.column(chunk.layout.dilation).iter().enumerate() {
        let trace = l[k] + l[4 * stride + k] + l[8 * stride + k];
        for a in 0..axes {
            l[4 * a * stride + k] += (mean - trace) / axes as f64; // [STR-16]
        }
    }
}

/// Keeps the trace of the velocity gradient of every particle of a chunk.
fn keep_rates<const D: usize>(piece: &mut Piece<'_, '_, D>) {
    let Piece { chunk, scratch, .. } = piece;
    let (stride, l) = (scratch.stride, &*scratch.velocity_gradient);
    for (k, rate) in chunk.column_mut(chunk.layout.dilation).iter_mut().enumerate() {
        *rate = l[k] + l[4 * stride + k] + l[8 * stride + k];
    }
}

/// Which of the patches that a block reaches a place belongs to.
fn patch_of<const D: usize>(space: &Space<D>, key: Key<D>, x: [f64; D]) -> usize {
    let xi = space.between_walls(x);
    (0..D).fold(0, |patch, d| {
        let place = xi[d].floor() - f64::from(key[d]) * EDGE as f64;
        patch * REACH + place.clamp(0.0, EDGE as f64) as usize
    })
}

impl Patches {
    /// Sums up what the particles of each run of a body bring to the patches.
    fn collect<const D: usize>(
        &mut self,
        space: &Space<D>,
        keys: &[Key<D>],
        particles: &mut Dilations<'_, D>,
        runs: &[Run],
        parallel: bool,
    ) {
        let reached = REACH.pow(D as u32);
        self.sums.clear();
        self.sums.resize(runs.len() * reached, [0.0; 2]);
        self.runs.clear();
        self.runs.resize(keys.len(), NONE);
        for (n, run) in runs.iter().enumerate() {
            self.runs[run.block as usize] = n as u32;
        }
        let particles = &*particles;
        let sum_up = |(run, sums): (&Run, &mut [[f64; 2]])| {
            let key = keys[run.block as usize];
            for k in run.first as usize..run.end as usize {
                let sum = &mut sums[patch_of(space, key, particles.position(k))];
                sum[0] += particles.volume[k] * particles.rate(k);
                sum[1] += particles.volume[k];
            }
        };
        if parallel {
            runs.par_iter().zip(self.sums.par_chunks_mut(reached)).for_each(sum_up);
        } else {
            runs.iter().zip(self.sums.chunks_mut(reached)).for_each(sum_up);
        }
    }
}

/// What the runs of a body share.
struct Whole<'a, const D: usize> {
    space: &'a Space<D>,
    grid: &'a Grid<D>,
    patches: &'a Patches,
    parallel: bool,
}

impl<const D: usize> Whole<'_, D> {
    /// Replaces the rates of the particles of some runs, the first of them run `from` of the body, by the means of their patches.
    fn share(&self, mut particles: Dilations<'_, D>, runs: &[Run], from: usize) {
        const FEW: usize = 8;
        if !self.parallel || runs.len() <= FEW {
            for (n, run) in runs.iter().enumerate() {
                self.share_run(&mut particles, run, from + n);
            }
            return;
        }
        let half = runs.len() / 2;
        let (left, right) = runs.split_at(half);
        let (of_left, of_right) = particles.split(right[0].first as usize);
        rayon::join(
            || self.share(of_left, left, from),
            || self.share(of_right, right, from + half),
        );
    }

    fn share_run(&self, particles: &mut Dilations<'_, D>, run: &Run, n: usize) {
        let key = self.grid.keys()[run.block as usize];
        let mut means = [0.0; REACH * REACH * REACH];
        let reached = REACH.pow(D as u32);
        for patch in 0..reached {
            if self.patches.sums[n * reached + patch][1] > 0.0 {
                let [rate, volume] = self.total(run.block, key, patch);
                means[patch] = rate / volume;
            }
        }
        for k in run.first as usize..run.end as usize {
            *particles.rate_mut(k) = means[patch_of(self.space, key, particles.position(k))];
        }
    }

    /// The sums of a patch over all runs that reach it, from lower blocks to higher ones, so that all of them get the same.
    fn total(&self, slot: u32, key: Key<D>, patch: usize) -> [f64; 2] {
        let place: [usize; D] =
            std::array::from_fn(|d| patch / REACH.pow((D - 1 - d) as u32) % REACH);
        let mut total = [0.0; 2];
        for choice in 0..1 << D {
            // along an axis, the first patch of a block is the last of the block below
            let mut other = key;
            let mut theirs = 0;
            let mut exists = true;
            for d in 0..D {
                let upper = choice >> d & 1 == 1;
                let (step, at) = match (place[d], upper) {
                    (0, false) => (-1, EDGE),
                    (EDGE, true) => (1, 0),
                    (0, true) => (0, 0),
                    (at, false) => (0, at),
                    _ => {
                        exists = false;
                        break;
                    }
                };
                other[d] += step;
                theirs = theirs * REACH + at;
            }
            let found = if exists { self.grid.find_near(slot, &other) } else { None };
            let run = found.map_or(NONE, |slot| self.patches.runs[slot as usize]);
            if run != NONE {
                let sum = self.patches.sums[run as usize * REACH.pow(D as u32) + theirs];
                total = [total[0] + sum[0], total[1] + sum[1]];
            }
        }
        total
    }
}
