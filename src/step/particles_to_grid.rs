//! Stage 2, particles to grid: m_i = Σ w m, (mv)_i = Σ w m (v + C r), f_i = −Σ V σ ∇w with r = x_i − x_p.
//!
//! The particles of a block add into the block's tile; then every block pulls from the tiles that reach it, in a fixed order.
//!
//! Mass, momentum and force go in one pass over nodes of eight lanes, [m, mv; –, f]. With the weights w_n, their slopes w'_n and
//! the pairs c_n = [r_n w_n; w'_n] of an axis, a particle gives the node n of an axis w_n B + c_n G: its value B = [m, m v; 0] and
//! the column G = [0, m h C_d; –, −V σ_d / h] of affine matrix and stress. The axes nest (see [`Axes`]). Eight particles share the
//! arithmetic before the nodes. Cost per particle, quadratic in 3D: 62 products and 63 sums of eight lanes, 27 nodes read and
//! written, 23 doubles read.

use std::marker::PhantomData;

use rayon::prelude::*;

use crate::background::blocks::Neighbours;
use crate::background::key::block_nodes;
use crate::background::tiles::{TileNode, Tiles, shared_rows};
use crate::background::{EDGE, Key, Lanes, Run};
use crate::particles::Particles;
use crate::shape::stencil::ShapeFunction;
use crate::shape::weights::{Axes, BATCH, GROUPS, Weights, corners, span};
use crate::simd::{Isa, Kernel, LANES, Vector, each, prefetch};
use crate::tensor::SYMMETRIC_INDEX;
use crate::world::state::{Body, Space, State};

/// What a scatter needs beside the tiles that it fills.
#[derive(Clone, Copy)]
pub struct ScatterJob<'a, const D: usize> {
    /// The instruction set.
    pub isa: Isa,
    /// The bodies.
    pub bodies: &'a [Body],
    /// Keys of the blocks, by slot.
    pub keys: &'a [Key<D>],
    /// Origin and spacing.
    pub space: &'a Space<D>,
    /// All runs.
    pub runs: &'a [Run],
    /// For each tile to fill its runs, as a range of `runs`.
    pub tiles: &'a [(u32, u32)],
    /// What to map.
    pub what: Scattered,
    /// Whether x is a radius, and hoop stresses push along it.
    pub axisymmetric: bool,
}

/// What a scatter maps beside the mass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scattered {
    /// Momentum and forces.
    Everything,
    /// Momentum alone.
    Momentum,
    /// The momentum of the filtered velocities.
    Filtered,
}

/// The scatter of all particles of some tiles that stand one after the other.
pub type Scatter<const D: usize> = fn(&ScatterJob<'_, D>, &mut [TileNode]);

/// Maps mass, momentum and the forces of the stresses to the grid.
pub fn particles_to_grid<const D: usize>(world: &mut State<D>) {
    scatter(world, Scattered::Everything);
    let State { grid, tiles, parallel, context, .. } = world;
    let (isa, around, nodes) = (context.isa(), &grid.backward[..], BLOCKS * block_nodes(D));
    let pull = |(n, (low, high)): (usize, (&mut [Lanes], &mut [Lanes]))| {
        isa.dispatch(Pull::<D> { tiles, around, first: n * BLOCKS, low, high: Some(high) });
    };
    if *parallel {
        let records = grid.velocity.par_chunks_mut(nodes).zip(grid.force.par_chunks_mut(nodes));
        records.enumerate().for_each(pull);
    } else {
        let records = grid.velocity.chunks_mut(nodes).zip(grid.force.chunks_mut(nodes));
        records.enumerate().for_each(pull);
    }
}

/// Maps the momentum of the particles into R1: that of their new velocities (second scatter of MUSL), or of those that go through a filter.
pub fn velocities_to_grid<const D: usize>(world: &mut State<D>, what: Scattered) {
    scatter(world, what);
    let State { grid, tiles, parallel, context, .. } = world;
    let (isa, around, nodes) = (context.isa(), &grid.backward[..], BLOCKS * block_nodes(D));
    let pull = |(n, low): (usize, &mut [Lanes])| {
        isa.dispatch(Pull::<D> { tiles, around, first: n * BLOCKS, low, high: None });
    };
    if *parallel {
        grid.increment.par_chunks_mut(nodes).enumerate().for_each(pull);
    } else {
        grid.increment.chunks_mut(nodes).enumerate().for_each(pull);
    }
}

/// Fills the tiles.
fn scatter<const D: usize>(world: &mut State<D>, what: Scattered) {
    let (space, kernel) = (world.space(), world.kernels.scatter);
    let State { bodies, grid, tiles, context, options, .. } = world;
    let nodes = tiles.tile_nodes(D);
    let fill = |part: &mut [TileNode], first: usize| {
        let job = ScatterJob {
            isa: context.isa(),
            bodies,
            keys: grid.keys(),
            space: &space,
            runs: &tiles.runs,
            tiles: &tiles.tiles[first..first + part.len() / nodes],
            what,
            axisymmetric: options.axisymmetric,
        };
        kernel(&job, part);
    };
    let all = &mut tiles.nodes[..nodes * tiles.tiles.len()];
    if world.parallel {
        let work = |part: &mut [TileNode], first: usize| {
            context.mark_worker();
            fill(part, first);
        };
        split_tiles(all, (nodes, 0), &tiles.start, &work);
    } else {
        fill(all, 0);
    }
}

/// Particles that one thread takes at least.
const GRAIN: u32 = 4096;

/// Calls `work` with parts of the tiles and the number of the first of each, in parallel. The tiles are split in halves by particles,
/// `start` being their running count, so that a thin layer and a dense heap balance.
fn split_tiles(
    tiles: &mut [TileNode],
    (nodes, first): (usize, usize),
    start: &[u32],
    work: &(impl Fn(&mut [TileNode], usize) + Sync),
) {
    let count = tiles.len() / nodes;
    let (low, high) = (start[first], start[first + count]);
    if count < 2 || high - low <= GRAIN {
        work(tiles, first);
        return;
    }
    let middle = low + (high - low) / 2;
    let half = start[first + 1..first + count].partition_point(|before| *before < middle) + 1;
    let half = half.min(count - 1);
    let (left, right) = tiles.split_at_mut(half * nodes);
    rayon::join(
        || split_tiles(left, (nodes, first), start, work),
        || split_tiles(right, (nodes, first + half), start, work),
    );
}

/// Blocks that pull in one call.
const BLOCKS: usize = 16;

/// Most nodes of a block.
const BLOCK_NODES: usize = block_nodes(3);

/// Adds up, corner by corner, what the tiles around each block hold for its nodes, and writes the halves of each node. Tiles have left
/// the caches since they were filled: those of the next block are asked for while one is summed.
struct Pull<'a, const D: usize> {
    tiles: &'a Tiles,
    around: &'a [Neighbours],
    first: usize,
    low: &'a mut [Lanes],
    high: Option<&'a mut [Lanes]>,
}

impl<const D: usize> Kernel for Pull<'_, D> {
    type Output = ();
    #[inline(always)]
    fn run<V: Vector>(self) {
        let Self { tiles, around, first, low, mut high } = self;
        let nodes = block_nodes(D);
        let mut sums = [TileNode::default(); BLOCK_NODES];
        for (b, low) in low.chunks_exact_mut(nodes).enumerate() {
            let block = first + b;
            sums[..nodes].fill(TileNode::default());
            for corner in 0..1 << D {
                ask_for_tile::<D>(tiles, around.get(block + 1), corner);
                for tile in tiles.around::<D>(around.get(block), corner) {
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
            if let Some(high) = &mut high {
                let high = &mut high[b * nodes..][..nodes];
                for (to, TileNode([.., m, x, y, z])) in high.iter_mut().zip(&sums) {
                    *to = [*m, *x, *y, *z];
                }
            }
        }
    }
}

/// Asks the memory for the nodes that a block shares with the first tile at a corner.
#[inline(always)]
fn ask_for_tile<const D: usize>(tiles: &Tiles, around: Option<&Neighbours>, corner: usize) {
    if let Some(tile) = tiles.around::<D>(around, corner).next() {
        for (from, _, len) in shared_rows::<D>(tiles.edge, corner) {
            (from..from + len).for_each(|n| prefetch(tile, n));
        }
    }
}

/// Kernel of the scatter.
pub fn scatter_tiles<S: ShapeFunction<N>, const N: usize, const D: usize>(
    job: &ScatterJob<'_, D>,
    tiles: &mut [TileNode],
) {
    job.isa.dispatch(ScatterTiles::<S, N, D>(job, tiles, PhantomData));
}

struct ScatterTiles<'a, S, const N: usize, const D: usize>(
    &'a ScatterJob<'a, D>,
    &'a mut [TileNode],
    PhantomData<S>,
);

impl<S: ShapeFunction<N>, const N: usize, const D: usize> Kernel for ScatterTiles<'_, S, N, D> {
    type Output = ();
    #[inline(always)]
    fn run<V: Vector>(self) {
        let Self(job, tiles, _) = self;
        let nodes = (EDGE + N - 1).pow(D as u32);
        let mut batch = Batch::<V, N, D>::new();
        for (tile, (first, end)) in tiles.chunks_exact_mut(nodes).zip(job.tiles) {
            tile.fill(TileNode::default());
            for run in &job.runs[*first as usize..*end as usize] {
                let particles = &job.bodies[run.body as usize].particles;
                let columns = Columns::new(particles, run, job.what);
                let key = job.keys[run.block as usize];
                let all = (run.end - run.first) as usize;
                for start in (0..all).step_by(BATCH) {
                    let count = BATCH.min(all - start);
                    for g in 0..count.div_ceil(LANES) {
                        batch.set::<S>(g, job, (&columns, key), start + g * LANES);
                    }
                    batch.add(tile, count);
                }
            }
        }
    }
}

/// Stencils of a batch, and what its particles give: value, and columns of affine matrix and stress.
struct Batch<V, const N: usize, const D: usize> {
    weights: [Weights<N, D>; GROUPS],
    corners: [[u32; LANES]; GROUPS],
    values: [[V; LANES]; GROUPS],
    columns: [[[V; LANES]; D]; GROUPS],
}

impl<V: Vector, const N: usize, const D: usize> Batch<V, N, D> {
    #[inline(always)]
    fn new() -> Self {
        let zeros = [V::splat(0.0); LANES];
        Self {
            weights: [const { Weights::ZERO }; GROUPS],
            corners: [[0; LANES]; GROUPS],
            values: [zeros; GROUPS],
            columns: [[zeros; D]; GROUPS],
        }
    }

    /// Sets group g: the particles from k on of a run in the block `key`.
    #[inline(always)]
    fn set<S: ShapeFunction<N>>(
        &mut self,
        g: usize,
        job: &ScatterJob<'_, D>,
        (columns, key): (&Columns<'_, D>, Key<D>),
        k: usize,
    ) {
        columns.prefetch(k + AHEAD);
        let x = each!(d in D => V::load(&columns.position[d][k..k + LANES]));
        let mut size = [V::splat(0.0); D];
        if S::SIZED {
            size = each!(d in D => V::load(&columns.size[d][k..k + LANES]));
        }
        let stencil = job.space.stencil::<V, S, N>(x, size);
        self.weights[g].set(&stencil, true);
        self.corners[g] = corners(&stencil, key);
        payload(job, columns, (x[0], k), (&mut self.values[g], &mut self.columns[g]));
    }

    /// Adds what the first `count` particles give to the tile.
    #[inline(always)]
    fn add(&self, tile: &mut [TileNode], count: usize) {
        for p in 0..count {
            let (g, l) = (p / LANES, p % LANES);
            let nodes = &mut tile[self.corners[g][l] as usize..][..span(N, D)];
            let columns = each!(d in D => self.columns[g][d][l]);
            add(nodes, &self.weights[g].axes(l), self.values[g][l], columns);
        }
    }
}

/// How many particles before its use a line of a column is asked for.
const AHEAD: usize = 64;

/// The columns of a run that the scatter reads.
struct Columns<'a, const D: usize> {
    position: [&'a [f64]; D],
    velocity: [&'a [f64]; D],
    mass: &'a [f64],
    volume: &'a [f64],
    stress: [&'a [f64]; 6],
    affine: Option<[[&'a [f64]; D]; D]>,
    size: [&'a [f64]; D],
    body_force: Option<[&'a [f64]; D]>,
}

impl<'a, const D: usize> Columns<'a, D> {
    fn new(particles: &'a Particles, run: &Run, what: Scattered) -> Self {
        let layout = &particles.layout;
        let (first, end) = (run.first as usize, run.end as usize);
        let row = |a: usize| particles.read(layout.affine + a * D, first, end);
        let velocity = if what == Scattered::Filtered { layout.filtered } else { layout.velocity };
        let affine = layout.filtered > layout.affine;
        let sized = layout.body_force > layout.size;
        let body_force = layout.affine > layout.body_force && what == Scattered::Everything;
        let vector = |component: usize| particles.read(component, first, end);
        Self {
            position: particles.read(layout.position, first, end),
            velocity: particles.read(velocity, first, end),
            mass: particles.read::<1>(layout.mass, first, end)[0],
            volume: particles.read::<1>(layout.volume, first, end)[0],
            stress: particles.read(layout.stress, first, end),
            affine: affine.then(|| std::array::from_fn(row)),
            size: if sized { vector(layout.size) } else { [&[]; D] },
            body_force: body_force.then(|| vector(layout.body_force)),
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

/// Values, and columns of affine matrix and stress, of eight particles from k on; `radius` is their x.
#[inline(always)]
fn payload<V: Vector, const D: usize>(
    job: &ScatterJob<'_, D>,
    columns: &Columns<'_, D>,
    (radius, k): (V, usize),
    (values, of_axes): (&mut [V; LANES], &mut [[V; LANES]; D]),
) {
    let zero = V::splat(0.0);
    let mass = V::load(&columns.mass[k..k + LANES]);
    let mut value = [zero; LANES];
    value[0] = mass; // [P2G-1]
    for a in 0..D {
        value[1 + a] = mass * V::load(&columns.velocity[a][k..k + LANES]); // [P2G-2]
    }
    let whole = job.what == Scattered::Everything;
    if whole && (job.axisymmetric || columns.body_force.is_some()) {
        let mut value = value;
        add_forces(job, columns, radius, k, &mut value);
        *values = V::transpose(value);
    } else {
        *values = V::transpose(value); // three of its rows are zero
    }
    let mut slopes = [[zero; LANES]; D];
    if let Some(affine) = &columns.affine {
        let mh = mass * V::splat(job.space.spacing);
        for d in 0..D {
            for a in 0..D {
                slopes[d][1 + a] = mh * V::load(&affine[a][d][k..k + LANES]); // [P2G-2]
            }
        }
    }
    if whole {
        let scale = V::load(&columns.volume[k..k + LANES]) * V::splat(-job.space.inverse);
        for d in 0..D {
            for a in 0..D {
                let stress = &columns.stress[SYMMETRIC_INDEX[a][d]];
                slopes[d][5 + a] = scale * V::load(&stress[k..k + LANES]); // [P2G-3]
            }
        }
    }
    for d in 0..D {
        of_axes[d] = V::transpose(slopes[d]);
    }
}

/// Adds the forces at the particles themselves to the values of eight: body forces, and in axial symmetry that of the hoop stress.
#[inline(always)]
fn add_forces<V: Vector, const D: usize>(
    job: &ScatterJob<'_, D>,
    columns: &Columns<'_, D>,
    radius: V,
    k: usize,
    value: &mut [V; LANES],
) {
    if let Some(force) = &columns.body_force {
        for a in 0..D {
            value[5 + a] = value[0] * V::load(&force[a][k..k + LANES]); // [P2G-4]
        }
    }
    if job.axisymmetric {
        let volume = V::load(&columns.volume[k..k + LANES]);
        let hoop = V::load(&columns.stress[2][k..k + LANES]);
        value[5] = value[5] - volume * hoop / radius; // [AXI-1]
    }
}

/// Adds what a particle gives to the nodes of its stencil.
#[inline(always)]
fn add<V: Vector, const N: usize, const D: usize>(
    nodes: &mut [TileNode],
    axes: &Axes<V, N, D>,
    value: V,
    columns: [V; D],
) {
    let edge = EDGE + N - 1;
    let planes = axes.spread(0, value, columns[0]);
    let along_y = axes.share(0, columns[1]);
    let along_z = axes.share(0, columns[D - 1]);
    for i in 0..N {
        if D == 2 {
            add_row(&mut nodes[i * edge..][..N], axes.spread(1, planes[i], along_y[i]));
        } else {
            let rows = axes.spread(1, planes[i], along_y[i]);
            let along_z = axes.share(1, along_z[i]);
            for j in 0..N {
                let row = &mut nodes[(i * edge + j) * edge..][..N];
                add_row(row, axes.spread(D - 1, rows[j], along_z[j]));
            }
        }
    }
}

#[inline(always)]
fn add_row<V: Vector, const N: usize>(nodes: &mut [TileNode], row: [V; N]) {
    for (n, node) in nodes.iter_mut().enumerate() {
        (V::load_node(node) + row[n]).store_node(node);
    }
}
