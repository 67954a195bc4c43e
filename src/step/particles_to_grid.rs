//! Stage 2, particles to grid: m_i = Σ w m, (mv)_i = Σ w m (v + C r), f_i = −Σ V σ ∇w with
//! r = x_i − x_p.
//!
//! The particles of a block add into the block's tile; then every block pulls from the tiles that
//! reach it, in a fixed order.
//!
//! Mass, momentum and force go in one pass over nodes of eight lanes, [m, mv; –, f]. With the
//! weights w_n, their slopes w'_n and the pairs c_n = [r_n w_n; w'_n] of an axis, a particle adds
//! to the node n of an axis w_n B + c_n G: its value B = [m, m v; 0] and the column G = [0, m h
//! C_d; –, −V σ_d / h] of affine matrix and stress. The axes nest (see [`Axes`]). Eight particles
//! share the arithmetic before the nodes. Cost per particle, quadratic in 3D: 62 products and 63
//! sums of eight lanes, 27 nodes read and written, 23 doubles read.

use std::marker::PhantomData;

use super::parts::Method;
use crate::background::blocks::Neighbours;
use crate::background::nodes::{FIRST, MASS, SECOND, parted};
use crate::background::tiles::{TileNode, Tiles, shared_rows};
use crate::background::{Background, EDGE, Key, Record, Run, Space, block_nodes};
use crate::parallel::{Cut, Divide, Team};
use crate::particles::{Body, Particles};
use crate::shape::stencil::{ShapeFunction, Stencil};
use crate::shape::weights::{Axes, BATCH, GROUPS, Weights, corners, span};
use crate::simd::{Isa, Kernel, LANES, Vector, each, prefetch};
use crate::tensor::SYMMETRIC_INDEX;

/// What a scatter needs beside the tiles that it fills.
#[derive(Clone, Copy)]
struct ScatterJob<'a, const D: usize> {
    isa: Isa,
    bodies: &'a [Body],
    /// Keys of the blocks, by slot.
    keys: &'a [Key<D>],
    space: &'a Space<D>,
    /// All runs.
    runs: &'a [Run],
    what: Scattered,
    /// Whether x is a radius, and hoop stresses push along it.
    axisymmetric: bool,
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

/// Maps mass, momentum and the forces of the stresses to the grid.
pub fn particles_to_grid<const D: usize>(
    background: &mut Background<D>,
    bodies: &[Body],
    method: &Method<D>,
    team: &Team,
) {
    (method.kernels.scatter)(background, bodies, method, team, Scattered::Everything);
    let Background { blocks, nodes, tiles, .. } = background;
    let (around, size) = (&blocks.backward[..], BLOCKS * block_nodes(D));
    let records = (Cut(&mut nodes.velocity[..], size), Cut(&mut nodes.force[..], size));
    team.for_each_piece(records, 1, |n, (low, high)| {
        let pull = Pull::<D> { tiles, around, first: n * BLOCKS, low, high: Some(high) };
        method.isa.dispatch(pull);
    });
}

/// Maps the momentum of the particles into the increments: that of their new velocities (second
/// scatter of MUSL), or of those that go through a filter.
pub fn velocities_to_grid<const D: usize>(
    background: &mut Background<D>,
    bodies: &[Body],
    method: &Method<D>,
    team: &Team,
    what: Scattered,
) {
    (method.kernels.scatter)(background, bodies, method, team, what);
    let Background { blocks, nodes, tiles, .. } = background;
    let (around, size) = (&blocks.backward[..], BLOCKS * block_nodes(D));
    team.for_each_piece(Cut(&mut nodes.increment[..], size), 1, |n, low| {
        let pull = Pull::<D> { tiles, around, first: n * BLOCKS, low, high: None };
        method.isa.dispatch(pull);
    });
}

/// Whole-stage entry of the kernel table: fills the tiles.
pub fn scatter<S: ShapeFunction<N>, const N: usize, const D: usize>(
    background: &mut Background<D>,
    bodies: &[Body],
    method: &Method<D>,
    team: &Team,
    what: Scattered,
) {
    let Background { blocks, tiles, space, .. } = background;
    let job = ScatterJob {
        isa: method.isa,
        bodies,
        keys: blocks.keys(),
        space,
        runs: &tiles.runs,
        what,
        axisymmetric: method.options.axisymmetric,
    };
    let nodes = tiles.tile_nodes(D);
    let all = Filling {
        nodes: &mut tiles.nodes[..nodes * tiles.tiles.len()],
        tile_nodes: nodes,
        first: 0,
        start: &tiles.start,
    };
    let runs_of_tiles = &tiles.tiles;
    team.for_each(all, |Filling { nodes, tile_nodes, first, .. }| {
        let of_tiles = &runs_of_tiles[first..first + nodes.len() / tile_nodes];
        job.isa.dispatch(ScatterTiles::<S, N, D>(&job, of_tiles, nodes, PhantomData));
    });
}

/// Particles that one thread takes at least.
const GRAIN: u32 = 4096;

/// Tiles to fill, the first of them number `first`. They are divided by particles, `start` being
/// their running count, so that a thin layer and a dense heap balance.
struct Filling<'a> {
    nodes: &'a mut [TileNode],
    tile_nodes: usize,
    first: usize,
    start: &'a [u32],
}

impl Divide for Filling<'_> {
    fn divide(self) -> (Self, Option<Self>) {
        let Self { nodes, tile_nodes, first, start } = self;
        let count = nodes.len() / tile_nodes;
        let (low, high) = (start[first], start[first + count]);
        if count < 2 || high - low <= GRAIN {
            return (Self { nodes, tile_nodes, first, start }, None);
        }
        let middle = low + (high - low) / 2;
        let half = start[first + 1..first + count].partition_point(|before| *before < middle) + 1;
        let half = half.min(count - 1);
        let (left, right) = nodes.split_at_mut(half * tile_nodes);
        let part = |nodes, first| Self { nodes, tile_nodes, first, start };
        (part(left, first), Some(part(right, first + half)))
    }
}

/// Blocks that pull in one call.
const BLOCKS: usize = 16;

/// Most nodes of a block.
const BLOCK_NODES: usize = block_nodes(3);

/// Adds up, corner by corner, what the tiles around each block hold for its nodes, and writes the
/// halves of each node. Tiles have left the caches since they were filled: those of the next block
/// are prefetched while one is summed.
struct Pull<'a, const D: usize> {
    tiles: &'a Tiles,
    around: &'a [Neighbours],
    first: usize,
    low: &'a mut [Record],
    high: Option<&'a mut [Record]>,
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
                prefetch_tile::<D>(tiles, around.get(block + 1), corner);
                for tile in tiles.around::<D>(around.get(block), corner) {
                    for (from, to, len) in shared_rows::<D>(tiles.edge, corner) {
                        for (sum, node) in sums[to..to + len].iter_mut().zip(&tile[from..]) {
                            (V::load_node(sum) + V::load_node(node)).store_node(sum);
                        }
                    }
                }
            }
            for (to, sum) in low.iter_mut().zip(&sums) {
                *to = parted(sum).0;
            }
            if let Some(high) = &mut high {
                let high = &mut high[b * nodes..][..nodes];
                for (to, sum) in high.iter_mut().zip(&sums) {
                    *to = parted(sum).1;
                }
            }
        }
    }
}

/// Prefetches the nodes that a block shares with the first tile at a corner.
#[inline(always)]
fn prefetch_tile<const D: usize>(tiles: &Tiles, around: Option<&Neighbours>, corner: usize) {
    if let Some(tile) = tiles.around::<D>(around, corner).next() {
        for (from, _, len) in shared_rows::<D>(tiles.edge, corner) {
            (from..from + len).for_each(|n| prefetch(tile, n));
        }
    }
}

struct ScatterTiles<'a, S, const N: usize, const D: usize>(
    &'a ScatterJob<'a, D>,
    &'a [(u32, u32)],
    &'a mut [TileNode],
    PhantomData<S>,
);

impl<S: ShapeFunction<N>, const N: usize, const D: usize> Kernel for ScatterTiles<'_, S, N, D> {
    type Output = ();
    #[inline(always)]
    fn run<V: Vector>(self) {
        let Self(job, of_tiles, tiles, _) = self;
        let nodes = (EDGE + N - 1).pow(D as u32);
        let mut batch = Batch::<V, N, D>::new();
        for (tile, (first, end)) in tiles.chunks_exact_mut(nodes).zip(of_tiles) {
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

/// Stencils of a batch, and what its particles give: value, and columns of affine matrix and
/// stress.
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
        let stencil = Stencil::<V, N, D>::of_particles::<S>(job.space, x, size);
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

/// Prefetch distance of the columns [particles].
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
        let vector = |component: usize| particles.read(component, first, end);
        let velocity = match layout.filtered {
            Some(filtered) if what == Scattered::Filtered => filtered.first,
            _ => layout.velocity,
        };
        let body_force = layout.body_force.filter(|_| what == Scattered::Everything);
        Self {
            position: vector(layout.position),
            velocity: vector(velocity),
            mass: particles.read::<1>(layout.mass, first, end)[0],
            volume: particles.read::<1>(layout.volume, first, end)[0],
            stress: particles.read(layout.stress, first, end),
            affine: layout.affine.map(|c| std::array::from_fn(|a| vector(c.first + a * D))),
            size: layout.size.map_or([&[]; D], |size| vector(size.first)),
            body_force: body_force.map(|force| vector(force.first)),
        }
    }

    /// Prefetches the particles from k on.
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

/// Values, and columns of affine matrix and stress, of eight particles from k on; `radius` is their
/// x.
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
    value[MASS] = mass; // [P2G-1]
    for a in 0..D {
        value[FIRST + a] = mass * V::load(&columns.velocity[a][k..k + LANES]); // [P2G-2]
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
                slopes[d][FIRST + a] = mh * V::load(&affine[a][d][k..k + LANES]); // [P2G-2]
            }
        }
    }
    if whole {
        let scale = V::load(&columns.volume[k..k + LANES]) * V::splat(-job.space.inverse);
        for d in 0..D {
            for a in 0..D {
                let stress = &columns.stress[SYMMETRIC_INDEX[a][d]];
                slopes[d][SECOND + a] = scale * V::load(&stress[k..k + LANES]); // [P2G-3]
            }
        }
    }
    for d in 0..D {
        of_axes[d] = V::transpose(slopes[d]);
    }
}

/// Adds the forces at the particles themselves to the values of eight: body forces, and in axial
/// symmetry that of the hoop stress.
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
            value[SECOND + a] = value[MASS] * V::load(&force[a][k..k + LANES]); // [P2G-4]
        }
    }
    if job.axisymmetric {
        let volume = V::load(&columns.volume[k..k + LANES]);
        let hoop = V::load(&columns.stress[2][k..k + LANES]);
        value[SECOND] = value[SECOND] - volume * hoop / radius; // [AXI-1]
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
