//! Stage 2, particles to grid: m_i = Σ w m, (mv)_i = Σ w m (v + C r), f_i = −Σ V σ ∇w with r = x_i − x_p.
//!
//! The particles of a block add into the block's tile; then every block pulls from the tiles that reach it, in a fixed order.
//!
//! Mass, momentum and force go in one pass over nodes of eight lanes, [m, mv; –, f]. With the weights w_n, their slopes w'_n and
//! the pairs c_n = [n w_n; w'_n] of an axis, a particle gives the node n of an axis w_n B + c_n G: the value B = [m, m v_0; 0]
//! at the lowest node of the stencil, and the column G = [0, m h C_d; –, −V σ_d / h] of affine matrix and stress. The axes
//! nest, so that a node of a row costs two products and sums. Eight particles share the arithmetic before the nodes.
//! Cost per particle, quadratic in 3D: 93 fused products of eight lanes, 27 nodes read and written, 23 doubles read.

use std::marker::PhantomData;

use rayon::prelude::*;

use crate::grid::blocks::Neighbours;
use crate::grid::key::block_nodes;
use crate::grid::tiles::{TileNode, Tiles, shared_rows};
use crate::grid::{EDGE, Key, Lanes, Run};
use crate::particles::Particles;
use crate::shape::stencil::{ShapeFunction, Stencil};
use crate::simd::{Isa, Kernel, LANES, Vector, each, prefetch};
use crate::tensor::SYMMETRIC_INDEX;
use crate::world::state::{Space, State};

/// What a scatter of one run of particles needs beside the tile.
#[derive(Clone, Copy)]
pub struct ScatterJob<'a, const D: usize> {
    /// The instruction set.
    pub isa: Isa,
    /// The particles of the body.
    pub particles: &'a Particles,
    /// Origin and spacing.
    pub space: &'a Space<D>,
    /// The block of the run.
    pub key: Key<D>,
    /// The run.
    pub run: Run,
    /// Whether the stresses give forces.
    pub forces: bool,
}

/// The scatter of one run of particles into a tile of its block.
pub type Scatter<const D: usize> = fn(&ScatterJob<'_, D>, &mut [TileNode]);

/// Maps mass, momentum and the forces of the stresses to the grid.
pub fn particles_to_grid<const D: usize>(world: &mut State<D>) {
    scatter(world, true);
    let State { grid, tiles, parallel, context, .. } = world;
    let (isa, all, nodes) = (context.isa(), &grid.backward[..], block_nodes(D));
    let pull = |(block, (r0, f)): (usize, (&mut [Lanes], &mut [Lanes]))| {
        isa.dispatch(Pull::<D> { tiles, all, block, low: r0, high: Some(f) });
    };
    if *parallel {
        let records = grid.velocity.par_chunks_mut(nodes).zip(grid.force.par_chunks_mut(nodes));
        records.enumerate().for_each(pull);
    } else {
        let records = grid.velocity.chunks_mut(nodes).zip(grid.force.chunks_mut(nodes));
        records.enumerate().for_each(pull);
    }
}

/// Maps the new momentum of the particles into R1 (second scatter of MUSL).
pub fn velocities_to_grid<const D: usize>(world: &mut State<D>) {
    scatter(world, false);
    let State { grid, tiles, parallel, context, .. } = world;
    let (isa, all, nodes) = (context.isa(), &grid.backward[..], block_nodes(D));
    let pull = |(block, r1): (usize, &mut [Lanes])| {
        isa.dispatch(Pull::<D> { tiles, all, block, low: r1, high: None });
    };
    if *parallel {
        grid.increment.par_chunks_mut(nodes).enumerate().for_each(pull);
    } else {
        grid.increment.chunks_mut(nodes).enumerate().for_each(pull);
    }
}

/// Fills the tiles.
fn scatter<const D: usize>(world: &mut State<D>, forces: bool) {
    let (space, kernel) = (world.space(), world.kernels.scatter);
    let State { bodies, grid, tiles, context, .. } = world;
    let nodes = tiles.tile_nodes(D);
    let fill = |tile: &mut [TileNode], t: usize| {
        tile.fill(TileNode::default());
        let (first, end) = tiles.tiles[t];
        for run in &tiles.runs[first as usize..end as usize] {
            let job = ScatterJob {
                isa: context.isa(),
                particles: &bodies[run.body as usize].particles,
                space: &space,
                key: grid.keys()[run.block as usize],
                run: *run,
                forces,
            };
            kernel(&job, tile);
        }
    };
    let all = &mut tiles.nodes[..nodes * tiles.tiles.len()];
    if world.parallel {
        let work = |tile: &mut [TileNode], t: usize| {
            context.mark_worker();
            fill(tile, t);
        };
        for_each_tile(all, (nodes, 0), &tiles.start, &work);
    } else {
        all.chunks_mut(nodes).enumerate().for_each(|(t, tile)| fill(tile, t));
    }
}

/// Particles that one thread takes at least.
const GRAIN: u32 = 2048;

/// Calls `work` with every tile and its number, in parallel. The work is split in halves by particles, `start` being their running
/// count, so that a thin layer and a dense heap balance.
fn for_each_tile(
    tiles: &mut [TileNode],
    (nodes, first): (usize, usize),
    start: &[u32],
    work: &(impl Fn(&mut [TileNode], usize) + Sync),
) {
    let count = tiles.len() / nodes;
    let (low, high) = (start[first], start[first + count]);
    if count < 2 || high - low <= GRAIN {
        tiles.chunks_mut(nodes).enumerate().for_each(|(t, tile)| work(tile, first + t));
        return;
    }
    let middle = low + (high - low) / 2;
    let half = start[first + 1..first + count].partition_point(|before| *before < middle) + 1;
    let half = half.min(count - 1);
    let (left, right) = tiles.split_at_mut(half * nodes);
    rayon::join(
        || for_each_tile(left, (nodes, first), start, work),
        || for_each_tile(right, (nodes, first + half), start, work),
    );
}

/// Most nodes of a block.
const BLOCK_NODES: usize = block_nodes(3);

/// Adds up, corner by corner, what the tiles around a block hold for its nodes, and writes the halves of each node. Tiles have left
/// the caches since they were filled: those of the next block are asked for while this one is summed.
struct Pull<'a, const D: usize> {
    tiles: &'a Tiles,
    all: &'a [Neighbours],
    block: usize,
    low: &'a mut [Lanes],
    high: Option<&'a mut [Lanes]>,
}

impl<const D: usize> Kernel for Pull<'_, D> {
    type Output = ();
    #[inline(always)]
    fn run<V: Vector>(self) {
        let Self { tiles, all, block, low, high } = self;
        let mut sums = [TileNode::default(); BLOCK_NODES];
        for corner in 0..1 << D {
            for tile in tiles.around::<D>(all.get(block + 1), corner).take(1) {
                for (from, _, len) in shared_rows::<D>(tiles.edge, corner) {
                    for n in 0..len {
                        prefetch(tile, from + n);
                    }
                }
            }
            for tile in tiles.around::<D>(all.get(block), corner) {
                for (from, to, len) in shared_rows::<D>(tiles.edge, corner) {
                    for (sum, node) in sums[to..to + len].iter_mut().zip(&tile[from..]) {
                        (V::load_node(sum) + V::load_node(node)).store_node(sum);
                    }
                }
            }
        }
        for (to, TileNode([m, x, y, z, ..])) in low.iter_mut().zip(&sums) {
            *to = [*m, *x, *y, *z];
        }
        if let Some(high) = high {
            for (to, TileNode([.., m, x, y, z])) in high.iter_mut().zip(&sums) {
                *to = [*m, *x, *y, *z];
            }
        }
    }
}

/// What the axes of eight stencils contribute to their nodes: w_n, and the two halves of c_n.
pub struct Weights<const N: usize, const D: usize> {
    w: [[[f64; LANES]; N]; D],
    low: [[[f64; LANES]; N]; D],
    high: [[[f64; LANES]; N]; D],
}

impl<const N: usize, const D: usize> Weights<N, D> {
    /// c_n = [n w_n; w'_n], or [w'_n; w'_n] if not `moments`.
    #[inline(always)]
    pub fn new<V: Vector>(stencil: &Stencil<V, N, D>, moments: bool) -> Self {
        let zeros = [[[0.0; LANES]; N]; D];
        let mut weights = Self { w: zeros, low: zeros, high: zeros };
        for d in 0..D {
            let axis = &stencil.axes[d];
            for n in 0..N {
                weights.w[d][n] = axis.w[n].to_array();
                weights.high[d][n] = axis.dw[n].to_array();
                let low = if moments { V::splat(n as f64) * axis.w[n] } else { axis.dw[n] };
                weights.low[d][n] = low.to_array();
            }
        }
        weights
    }

    /// w_n in all lanes, and c_n, of particle l.
    #[inline(always)]
    pub fn node<V: Vector>(&self, d: usize, n: usize, l: usize) -> (V, V) {
        (V::splat(self.w[d][n][l]), V::halves(self.low[d][n][l], self.high[d][n][l]))
    }

    /// The same for all nodes of an axis.
    #[inline(always)]
    pub fn axis<V: Vector>(&self, d: usize, l: usize) -> [(V, V); N] {
        let mut nodes = [self.node(d, 0, l); N];
        for n in 1..N {
            nodes[n] = self.node(d, n, l);
        }
        nodes
    }
}

/// Places of the lowest nodes of eight stencils in the tile of block `key`, whose edge is 4 + N − 1 nodes.
#[inline(always)]
pub fn corners<V: Vector, const N: usize, const D: usize>(
    stencil: &Stencil<V, N, D>,
    key: Key<D>,
) -> [u32; LANES] {
    let edge = V::splat((EDGE + N - 1) as f64);
    let mut at = V::splat(0.0);
    for d in 0..D {
        let lowest = V::splat(f64::from(key[d]) * EDGE as f64);
        at = at.mul_add(edge, stencil.axes[d].first - lowest);
    }
    at.to_indices()
}

/// Nodes from the first to the last of a stencil in a tile, inclusive.
pub const fn span(nodes: usize, dimension: usize) -> usize {
    let edge = EDGE + nodes - 1;
    let rows = if dimension == 3 { edge + 1 } else { 1 };
    (nodes - 1) * (rows * edge + 1) + 1
}

/// Kernel of a run.
pub fn scatter_run<S: ShapeFunction<N>, const N: usize, const D: usize>(
    job: &ScatterJob<'_, D>,
    tile: &mut [TileNode],
) {
    job.isa.dispatch(ScatterRun::<S, N, D>(job, tile, PhantomData));
}

struct ScatterRun<'a, S, const N: usize, const D: usize>(
    &'a ScatterJob<'a, D>,
    &'a mut [TileNode],
    PhantomData<S>,
);

impl<S: ShapeFunction<N>, const N: usize, const D: usize> Kernel for ScatterRun<'_, S, N, D> {
    type Output = ();
    #[inline(always)]
    fn run<V: Vector>(self) {
        let Self(job, tile, _) = self;
        let columns = Columns::<D>::new(job);
        let count = (job.run.end - job.run.first) as usize;
        for k in (0..count).step_by(LANES) {
            columns.prefetch(k + AHEAD);
            let x = each!(d in D => V::load(&columns.position[d][k..k + LANES]));
            let stencil = Stencil::<V, N, D>::new::<S>(job.space.to_units(x));
            let weights = Weights::new(&stencil, true);
            let corners = corners(&stencil, job.key);
            let (value, slopes) = payload(job, &columns, k, &stencil);
            for l in 0..LANES.min(count - k) {
                let nodes = &mut tile[corners[l] as usize..][..span(N, D)];
                spread(nodes, &weights, l, value[l], each!(d in D => slopes[d][l]));
            }
        }
    }
}

/// How many particles before its use a line of a column is asked for.
const AHEAD: usize = 32;

/// The columns of a run that the scatter reads.
struct Columns<'a, const D: usize> {
    position: [&'a [f64]; D],
    velocity: [&'a [f64]; D],
    mass: &'a [f64],
    volume: &'a [f64],
    stress: [&'a [f64]; 6],
    affine: Option<[[&'a [f64]; D]; D]>,
}

impl<'a, const D: usize> Columns<'a, D> {
    fn new(job: &ScatterJob<'a, D>) -> Self {
        let (particles, layout) = (job.particles, &job.particles.layout);
        let (first, end) = (job.run.first as usize, job.run.end as usize);
        let row = |a: usize| particles.read(layout.affine + a * D, first, end);
        let affine = layout.deformation_gradient > layout.affine;
        Self {
            position: particles.read(layout.position, first, end),
            velocity: particles.read(layout.velocity, first, end),
            mass: particles.read::<1>(layout.mass, first, end)[0],
            volume: particles.read::<1>(layout.volume, first, end)[0],
            stress: particles.read(layout.stress, first, end),
            affine: affine.then(|| std::array::from_fn(row)),
        }
    }

    /// Asks the memory for the particles from k on.
    #[inline(always)]
    fn prefetch(&self, k: usize) {
        for d in 0..D {
            prefetch(self.position[d], k);
            prefetch(self.velocity[d], k);
        }
        for c in 0..6 {
            prefetch(self.stress[c], k);
        }
        prefetch(self.mass, k);
        prefetch(self.volume, k);
        if let Some(affine) = &self.affine {
            for d in 0..D {
                for a in 0..D {
                    prefetch(affine[a][d], k);
                }
            }
        }
    }
}

/// Value at the lowest node and columns of affine matrix and stress, of eight particles from k on.
#[inline(always)]
fn payload<V: Vector, const N: usize, const D: usize>(
    job: &ScatterJob<'_, D>,
    columns: &Columns<'_, D>,
    k: usize,
    stencil: &Stencil<V, N, D>,
) -> ([V; LANES], [[V; LANES]; D]) {
    let zero = V::splat(0.0);
    let mass = V::load(&columns.mass[k..k + LANES]);
    let mut value = [zero; LANES];
    value[0] = mass;
    for a in 0..D {
        value[1 + a] = mass * V::load(&columns.velocity[a][k..k + LANES]);
    }
    let mut slopes = [[zero; LANES]; D];
    if let Some(affine) = &columns.affine {
        let mh = mass * V::splat(job.space.spacing);
        for d in 0..D {
            for a in 0..D {
                let slope = mh * V::load(&affine[a][d][k..k + LANES]);
                slopes[d][1 + a] = slope;
                value[1 + a] = (-stencil.axes[d].fraction).mul_add(slope, value[1 + a]);
            }
        }
    }
    if job.forces {
        let scale = V::load(&columns.volume[k..k + LANES]) * V::splat(-job.space.inverse);
        for d in 0..D {
            for a in 0..D {
                let stress = &columns.stress[SYMMETRIC_INDEX[a][d]];
                slopes[d][5 + a] = scale * V::load(&stress[k..k + LANES]);
            }
        }
    }
    for d in 0..D {
        slopes[d] = V::transpose(slopes[d]);
    }
    (V::transpose(value), slopes)
}

/// Adds what particle l gives to the nodes of its stencil.
#[inline(always)]
fn spread<V: Vector, const N: usize, const D: usize>(
    nodes: &mut [TileNode],
    weights: &Weights<N, D>,
    l: usize,
    value: V,
    columns: [V; D],
) {
    let edge = EDGE + N - 1;
    let last = weights.axis::<V>(D - 1, l);
    for i in 0..N {
        let (wx, cx) = weights.node::<V>(0, i, l);
        let plane = wx.mul_add(value, cx * columns[0]);
        if D == 2 {
            add_row(&mut nodes[i * edge..][..N], &last, plane, wx * columns[1]);
        } else {
            let (along_y, along_z) = (wx * columns[1], wx * columns[D - 1]);
            for j in 0..N {
                let (wy, cy) = weights.node::<V>(1, j, l);
                let row = wy.mul_add(plane, cy * along_y);
                add_row(&mut nodes[(i * edge + j) * edge..][..N], &last, row, wy * along_z);
            }
        }
    }
}

#[inline(always)]
fn add_row<V: Vector, const N: usize>(
    nodes: &mut [TileNode],
    last: &[(V, V); N],
    value: V,
    column: V,
) {
    for (n, node) in nodes.iter_mut().enumerate() {
        let sum = last[n].0.mul_add(value, V::load_node(node));
        last[n].1.mul_add(column, sum).store_node(node);
    }
}
