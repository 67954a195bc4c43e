//! Stage 5, grid to particles: v_p from the transfer scheme, x_p += dt Σ w v, ∇v_p = Σ v ⊗ ∇w.
//!
//! The mirror image of the scatter: a node has eight lanes, two of its records, and with the weights w_n and the pairs c_n of an axis (see
//! [`particles_to_grid`](mod@super::particles_to_grid)) one pass over rows, planes and stencil gives Σ w R of both and, along each axis,
//! Σ n w or Σ ∂w of each. Which record stands where is told by [`GatherJob::second`] and [`GatherJob::gradient_lane`].
//! Cost per particle, quadratic in 3D: 93 fused products of eight lanes, 27 nodes read, 3 doubles read and 24 written.

use std::marker::PhantomData;

use crate::grid::key::EDGE;
use crate::grid::tiles::{TileNode, load_tile};
use crate::grid::{Grid, Key, Lanes};
use crate::particles::ChunkMut;
use crate::shape::stencil::{ShapeFunction, Stencil};
use crate::simd::{Isa, Kernel, LANES, Vector, each, prefetch};
use crate::step::particles_to_grid::{Weights, corners, span};
use crate::transfer::{Received, TransferKind, apic, pic_flip};
use crate::world::state::{ChunkStage, Piece, Space};

/// What a gather updates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gather {
    /// Velocity, position and gradient, all from R0.
    Everything,
    /// The velocity alone, from R0 and its increment R1 (first gather of MUSL).
    Velocity,
    /// Position from R0, gradient from the second velocities in R1 (last gather of MUSL).
    PositionAndGradient,
}

/// Everything a gather needs beside the chunk and the tile.
#[derive(Clone, Copy, Debug)]
pub struct GatherJob<const D: usize> {
    /// The instruction set.
    pub isa: Isa,
    /// Origin and spacing.
    pub space: Space<D>,
    /// The block of the run.
    pub key: Key<D>,
    /// First and one past the last particle, counted in the chunk.
    pub range: (usize, usize),
    /// What to update.
    pub what: Gather,
    /// The transfer scheme.
    pub transfer: TransferKind,
    /// Share of PIC in this step [–].
    pub pic_share: f64,
    /// The step [s].
    pub dt: f64,
    /// Distance between components of the gradient.
    pub stride: usize,
}

impl<const D: usize> GatherJob<D> {
    /// The record in the last four lanes of a node: affine transfers take moment and gradient of R0 at once, the others need R1
    /// (FLIP its increment, MUSL its second velocity).
    fn second<'g>(&self, grid: &'g Grid<D>) -> &'g [Lanes] {
        if self.transfer.is_affine() && self.what != Gather::PositionAndGradient {
            &grid.velocity
        } else {
            &grid.increment
        }
    }

    /// The first lane of the slopes that hold the velocity gradient.
    #[inline(always)]
    fn gradient_lane(&self) -> usize {
        if self.transfer.is_affine() || self.what == Gather::PositionAndGradient { 5 } else { 1 }
    }
}

/// The gather of one run of particles: job, tile, chunk, velocity gradients (9 components).
pub type GatherKernel<const D: usize> =
    fn(&GatherJob<D>, &[TileNode], &mut ChunkMut<'_>, &mut [f64]);

/// Updates the particles of a chunk from the grid and leaves their velocity gradients in the chunk's scratch.
pub fn grid_to_particles<const D: usize>(piece: &mut Piece<'_, '_, D>, what: Gather, dt: f64) {
    let Piece { chunk, scratch, tile, grid, runs, .. } = piece;
    let (first, end) = (chunk.first, chunk.first + chunk.len);
    if D == 2 {
        scratch.velocity_gradient.fill(0.0);
    }
    let start = runs.partition_point(|run| run.end as usize <= first);
    for run in runs[start..].iter().take_while(|run| (run.first as usize) < end) {
        let job = GatherJob {
            isa: piece.isa,
            space: piece.space,
            key: grid.keys()[run.block as usize],
            range: (first.max(run.first as usize) - first, end.min(run.end as usize) - first),
            what,
            transfer: piece.transfer,
            pic_share: pic_flip::pic_share(piece.pic_rate, dt),
            dt,
            stride: scratch.stride,
        };
        if piece.loaded.replace(run.block) != Some(run.block) {
            load_tile::<D>(job.isa, (grid, job.second(grid)), run.block, piece.edge, tile);
        }
        (piece.gather)(&job, tile, chunk, scratch.velocity_gradient);
    }
    piece.lap(ChunkStage::Gathered);
}

/// Kernel of a run.
pub fn gather_run<S: ShapeFunction<N>, const N: usize, const D: usize>(
    job: &GatherJob<D>,
    tile: &[TileNode],
    chunk: &mut ChunkMut<'_>,
    gradient: &mut [f64],
) {
    job.isa.dispatch(GatherRun::<S, N, D>(job, tile, chunk, gradient, PhantomData));
}

struct GatherRun<'a, 'c, S, const N: usize, const D: usize>(
    &'a GatherJob<D>,
    &'a [TileNode],
    &'a mut ChunkMut<'c>,
    &'a mut [f64],
    PhantomData<S>,
);

impl<S: ShapeFunction<N>, const N: usize, const D: usize> Kernel for GatherRun<'_, '_, S, N, D> {
    type Output = ();
    #[inline(always)]
    fn run<V: Vector>(self) {
        let Self(job, tile, chunk, gradient, _) = self;
        let (first, last) = job.range;
        for k in (first..last).step_by(LANES) {
            let end = last.min(k + LANES);
            for c in 0..chunk.layout.components() {
                prefetch(chunk.column(c), k + AHEAD);
            }
            let x: [V; D] =
                each!(d in D => V::load(&chunk.column(chunk.layout.position + d)[k..end]));
            let stencil = Stencil::<V, N, D>::new::<S>(job.space.to_units(x));
            let received = receive(job, &stencil, tile, end - k);
            if end == k + LANES {
                keep::<V, S, N, D>(job, &received, x, chunk, gradient, (k, k + LANES)); // of known length
            } else {
                keep::<V, S, N, D>(job, &received, x, chunk, gradient, (k, end));
            }
        }
    }
}

/// How many particles before its use a line of a column is asked for, here and in the stages that follow.
const AHEAD: usize = 64;

/// Updates the particles k to `end` from what they took.
#[inline(always)]
fn keep<V: Vector, S: ShapeFunction<N>, const N: usize, const D: usize>(
    job: &GatherJob<D>,
    received: &Received<V, D>,
    x: [V; D],
    chunk: &mut ChunkMut<'_>,
    gradient: &mut [f64],
    (k, end): (usize, usize),
) {
    let layout = chunk.layout;
    if job.what != Gather::PositionAndGradient {
        let mut v = received.velocity;
        if job.transfer.is_affine() {
            let c = apic::affine(received, S::MOMENT, job.space.spacing);
            for a in 0..D {
                for b in 0..D {
                    c[a][b].store(&mut chunk.column_mut(layout.affine + a * D + b)[k..end]);
                }
            }
        } else {
            let old = each!(a in D => V::load(&chunk.column(layout.velocity + a)[k..end]));
            v = pic_flip::velocity(old, received, job.pic_share);
        }
        for a in 0..D {
            v[a].store(&mut chunk.column_mut(layout.velocity + a)[k..end]);
        }
    }
    if job.what != Gather::Velocity {
        let new = each!(a in D => V::splat(job.dt).mul_add(received.velocity[a], x[a]));
        chunk.mark_moved(k, outside(job, new, end - k));
        for a in 0..D {
            new[a].store(&mut chunk.column_mut(layout.position + a)[k..end]);
            for b in 0..D {
                let at = (3 * a + b) * job.stride;
                received.gradient[a][b].store(&mut gradient[at + k..at + end]);
            }
        }
    }
}

/// Bit l is set if particle l of `count` is not in the block of its run any more.
#[inline(always)]
fn outside<V: Vector, const D: usize>(job: &GatherJob<D>, x: [V; D], count: usize) -> u8 {
    let xi = job.space.to_units(x);
    let mut inside = u8::MAX;
    for d in 0..D {
        let place = xi[d] - V::splat(job.space.first_offset);
        let lowest = f64::from(job.key[d]) * EDGE as f64;
        let (low, high) = (V::splat(lowest), V::splat(lowest + EDGE as f64));
        inside &= !place.less_than(low) & place.less_than(high);
    }
    !inside & (u8::MAX >> (LANES - count))
}

/// What `count` particles take from the nodes of their stencils.
#[inline(always)]
fn receive<V: Vector, const N: usize, const D: usize>(
    job: &GatherJob<D>,
    stencil: &Stencil<V, N, D>,
    tile: &[TileNode],
    count: usize,
) -> Received<V, D> {
    let weights = Weights::new(stencil, job.transfer.is_affine());
    let corners = corners(stencil, job.key);
    let mut sums = [V::splat(0.0); LANES];
    let mut slopes = [[V::splat(0.0); LANES]; D];
    for l in 0..count {
        let nodes = &tile[corners[l] as usize..][..span(N, D)];
        let (sum, slope) = collect(nodes, &weights, l);
        sums[l] = sum;
        for d in 0..D {
            slopes[d][l] = slope[d];
        }
    }
    let sums = V::transpose(sums);
    for d in 0..D {
        slopes[d] = V::transpose(slopes[d]);
    }
    let (h, inverse) = (V::splat(job.space.spacing), V::splat(job.space.inverse));
    let first = job.gradient_lane();
    Received {
        velocity: each!(a in D => sums[1 + a]),
        increment: each!(a in D => sums[5 + a]),
        moment: each!(a in D, b in D => {
            (slopes[b][1 + a] - stencil.axes[b].fraction * sums[1 + a]) * h
        }),
        gradient: each!(a in D, b in D => slopes[b][first + a] * inverse),
    }
}

/// Σ w R and, for each axis d, Σ c_d R of particle l, in units of the spacing and from the lowest node.
#[inline(always)]
fn collect<V: Vector, const N: usize, const D: usize>(
    nodes: &[TileNode],
    weights: &Weights<N, D>,
    l: usize,
) -> (V, [V; D]) {
    let edge = EDGE + N - 1;
    let zero = V::splat(0.0);
    let last = weights.axis::<V>(D - 1, l);
    let (mut sum, mut slopes) = (zero, [zero; D]);
    for i in 0..N {
        let (wx, cx) = weights.node::<V>(0, i, l);
        if D == 2 {
            let (of_row, slope) = sum_of_row(&nodes[i * edge..][..N], &last);
            sum = wx.mul_add(of_row, sum);
            slopes[0] = cx.mul_add(of_row, slopes[0]);
            slopes[1] = wx.mul_add(slope, slopes[1]);
        } else {
            let (mut plane, mut along_y, mut along_z) = (zero, zero, zero);
            for j in 0..N {
                let (wy, cy) = weights.node::<V>(1, j, l);
                let (of_row, slope) = sum_of_row(&nodes[(i * edge + j) * edge..][..N], &last);
                plane = wy.mul_add(of_row, plane);
                along_y = cy.mul_add(of_row, along_y);
                along_z = wy.mul_add(slope, along_z);
            }
            sum = wx.mul_add(plane, sum);
            slopes[0] = cx.mul_add(plane, slopes[0]);
            slopes[1] = wx.mul_add(along_y, slopes[1]);
            slopes[D - 1] = wx.mul_add(along_z, slopes[D - 1]);
        }
    }
    (sum, slopes)
}

#[inline(always)]
fn sum_of_row<V: Vector, const N: usize>(nodes: &[TileNode], last: &[(V, V); N]) -> (V, V) {
    let (mut sum, mut slope) = (V::splat(0.0), V::splat(0.0));
    for (n, node) in nodes.iter().enumerate() {
        let node = V::load_node(node);
        sum = last[n].0.mul_add(node, sum);
        slope = last[n].1.mul_add(node, slope);
    }
    (sum, slope)
}

/// Nodes of a stencil that a host's point sees: calls `visit` with node number and weight; false if a node is missing.
pub fn for_stencil_nodes<S: ShapeFunction<N>, const N: usize, const D: usize>(
    grid: &Grid<D>,
    xi: [f64; D],
    visit: &mut dyn FnMut(usize, f64),
) -> bool {
    let mut complete = true;
    Stencil::<f64, N, D>::new::<S>(xi).nodes(|index, w, _| match grid.find_node(index) {
        Some(node) => visit(node, w),
        None => complete = false,
    });
    complete
}
