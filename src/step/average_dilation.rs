//! Stage 5b, F-bar: the rate at which particles of a body grow is averaged over patches of the grid, so that nearly incompressible and plastic
//! material does not lock. Bodies without F-bar pass.
//!
//! A patch is one cell of polynomials of the shape function: the particles with the same lowest node. L̄ = L + (⟨tr L⟩ − tr L) I / n with the mean
//! weighted by volume, n = 2 in plane strain, else 3; strain increment, volume and F take L̄. In rates it is the F̄ = (⟨J⟩ / J)^(1/n) F of
//! E. A. de Souza Neto, D. Perić, M. Dutko, D. R. J. Owen, Int. J. Solids Struct. 33 (1996) 3277–3296, doi:10.1016/0020-7683(95)00259-6; for
//! particles: W. M. Coombs, T. J. Charlton, M. Cortis, C. E. Augarde, Comput. Methods Appl. Mech. Engrg. 333 (2018) 1–21, doi:10.1016/j.cma.2018.01.010.

use crate::grid::{EDGE, Key, Run};
use crate::particles::Dilations;
use crate::world::state::{Body, Piece, Space, State};

use super::grid_to_particles::{Gather, grid_to_particles};
use super::update_stress::Outcome;

/// Most patches of a block.
const PATCHES: usize = EDGE * EDGE * EDGE;

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
    let State { bodies, grid, .. } = world;
    for body in bodies.iter_mut().filter(|body| body.has_f_bar()) {
        let Body { particles, runs, .. } = body;
        average(&space, grid.keys(), particles.dilations::<D>(), runs, parallel);
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

/// Replaces the rates of the particles of some runs by the means of their patches.
fn average<const D: usize>(
    space: &Space<D>,
    keys: &[Key<D>],
    mut particles: Dilations<'_, D>,
    runs: &[Run],
    parallel: bool,
) {
    const FEW: usize = 8;
    if !parallel || runs.len() <= FEW {
        for run in runs {
            average_run(space, keys[run.block as usize], &mut particles, run);
        }
        return;
    }
    let (left, right) = runs.split_at(runs.len() / 2);
    let (of_left, of_right) = particles.split(right[0].first as usize);
    rayon::join(
        || average(space, keys, of_left, left, true),
        || average(space, keys, of_right, right, true),
    );
}

fn average_run<const D: usize>(
    space: &Space<D>,
    key: Key<D>,
    particles: &mut Dilations<'_, D>,
    run: &Run,
) {
    let lowest = key.map(|k| f64::from(k) * EDGE as f64);
    let mut sums = [[0.0; 2]; PATCHES];
    let patch = |x: [f64; D]| {
        let xi = space.between_walls(x);
        (0..D).fold(0, |patch, d| {
            let place = (xi[d] - space.first_offset).floor() - lowest[d];
            patch * EDGE + place.clamp(0.0, (EDGE - 1) as f64) as usize
        })
    };
    for k in run.first as usize..run.end as usize {
        let sum = &mut sums[patch(particles.position(k))];
        let volume = particles.volume[k];
        sum[0] += volume * *particles.rate(k);
        sum[1] += volume;
    }
    for k in run.first as usize..run.end as usize {
        let [rate, volume] = sums[patch(particles.position(k))];
        *particles.rate(k) = rate / volume;
    }
}
