//! Tiles: the private grid patch into which the particles of a block scatter, and the copy from
//! which they gather.
//!
//! A tile covers its block and the first N − 1 node layers of the next blocks: (4 + N − 1)^D nodes.
//! After the scatter each block pulls from the tiles that reach it in a fixed order, so sums do not
//! depend on the number of threads.

use super::blocks::Neighbours;
use super::nodes::{Record, joined};
use super::{Blocks, EDGE, NONE, Nodes, room};
use crate::error::Result;
use crate::memory::{refill, reserve_exact};
use crate::simd::Vector;

/// What memory is for, if there is none.
const WHAT: &str = "the tiles of the grid";

/// A node of a tile: [m, mv; –, f] on the way to the grid, two records of it on the way back.
pub use crate::simd::TileNode;

/// Particles of one body that stand in one block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    /// Slot of the block.
    pub block: u32,
    /// Position of the body in the world.
    pub body: u32,
    /// First particle.
    pub first: u32,
    /// One past the last particle.
    pub end: u32,
}

/// Most particles that scatter into one tile; fuller blocks get several.
const TILE_PARTICLES: u32 = 2048;

/// All tiles of a grid.
#[derive(Debug, Default)]
pub struct Tiles {
    /// Nodes along the edge of a tile.
    pub edge: usize,
    /// Runs in the Morton order of blocks, then of bodies, cut at the size of a tile.
    pub runs: Vec<Run>,
    /// For each tile its runs, as a range of `runs`.
    pub tiles: Vec<(u32, u32)>,
    /// For each tile the number of particles in the tiles before it, and behind the last the number
    /// of all.
    pub start: Vec<u32>,
    /// For each slot of the grid its tiles, as a range of `tiles`.
    pub of_block: Vec<(u32, u32)>,
    /// Node records of all tiles, and of some more that may be needed.
    pub nodes: Vec<TileNode>,
}

impl Tiles {
    /// Tiles for stencils of `shape_nodes` nodes an axis.
    pub fn new(shape_nodes: usize) -> Self {
        Self { edge: EDGE + shape_nodes - 1, ..Self::default() }
    }

    /// Assigns the runs of all bodies to tiles. `place` gives for each slot of the grid its place
    /// in Morton order; `dimension` is the number of axes.
    ///
    /// Errors: [`Status::OutOfMemory`](crate::error::Status::OutOfMemory).
    pub fn assign(
        &mut self,
        runs: impl Iterator<Item = Run> + Clone,
        place: &[u32],
        dimension: usize,
    ) -> Result<()> {
        let count: usize =
            runs.clone().map(|r| (r.end - r.first).div_ceil(TILE_PARTICLES) as usize).sum();
        refill(&mut self.runs, count, WHAT)?;
        for mut run in runs {
            while run.end - run.first > TILE_PARTICLES {
                self.runs.push(Run { end: run.first + TILE_PARTICLES, ..run });
                run.first += TILE_PARTICLES;
            }
            self.runs.push(run);
        }
        let order = |run: &Run| (place[run.block as usize], run.body, run.first);
        if !self.runs.is_sorted_by_key(order) {
            self.runs.sort_unstable_by_key(order);
        }
        refill(&mut self.tiles, count, WHAT)?;
        refill(&mut self.start, count + 1, WHAT)?;
        refill(&mut self.of_block, place.len(), WHAT)?;
        self.of_block.resize(place.len(), (0, 0));
        let (mut block, mut load, mut all) = (NONE, 0, 0);
        for (r, run) in self.runs.iter().enumerate() {
            let r = r as u32;
            let size = run.end - run.first;
            if run.block != block || load + size > TILE_PARTICLES {
                let tile = self.tiles.len() as u32;
                let of_block = &mut self.of_block[run.block as usize];
                *of_block = (if run.block == block { of_block.0 } else { tile }, tile + 1);
                self.tiles.push((r, r));
                self.start.push(all);
                (block, load) = (run.block, 0);
            }
            load += size;
            all += size;
            if let Some(tile) = self.tiles.last_mut() {
                tile.1 = r + 1;
            }
        }
        self.start.push(all);
        self.fit_nodes(dimension)
    }

    /// Room for the nodes of all tiles; memory is released when less than a quarter is needed.
    fn fit_nodes(&mut self, dimension: usize) -> Result<()> {
        let nodes = room(self.tiles.len()) * self.tile_nodes(dimension);
        if nodes > self.nodes.len() || 4 * nodes < self.nodes.len() {
            self.nodes = Vec::new();
            reserve_exact(&mut self.nodes, nodes, WHAT)?;
            self.nodes.resize(nodes, TileNode::default());
        }
        Ok(())
    }

    /// Nodes of a tile.
    pub fn tile_nodes(&self, dimension: usize) -> usize {
        self.edge.pow(dimension as u32)
    }

    /// The tiles of the block at `corner` of a neighbourhood.
    #[inline(always)]
    pub fn around<const D: usize>(
        &self,
        neighbours: Option<&Neighbours>,
        corner: usize,
    ) -> impl Iterator<Item = &[TileNode]> {
        let block = neighbours.map_or(NONE, |n| n[corner]) as usize;
        let (first, end) = self.of_block.get(block).copied().unwrap_or_default();
        let n = self.tile_nodes(D);
        self.nodes[first as usize * n..end as usize * n].chunks_exact(n)
    }

    /// Memory [bytes].
    pub fn bytes(&self) -> usize {
        self.nodes.capacity() * size_of::<TileNode>()
            + self.runs.capacity() * size_of::<Run>()
            + (self.tiles.capacity() + self.of_block.capacity()) * size_of::<(u32, u32)>()
            + self.start.capacity() * size_of::<u32>()
    }
}

/// The rows that a tile shares with the block at `corner` of its neighbourhood: first node of the
/// row in the tile, in the block, and the number of nodes.
#[inline(always)]
pub fn shared_rows<const D: usize>(
    edge: usize,
    corner: usize,
) -> impl Iterator<Item = (usize, usize, usize)> {
    let part = move |d: usize| if corner >> d & 1 == 1 { (EDGE, edge - EDGE) } else { (0, EDGE) };
    let (from, len) = part(D - 1);
    let (x, nx) = part(0);
    let (y, ny) = if D == 2 { (0, 1) } else { part(1) };
    (0..nx * ny).map(move |row| {
        let (i, j) = (row / ny, row % ny);
        if D == 2 {
            ((x + i) * edge + from, i * EDGE, len)
        } else {
            (((x + i) * edge + y + j) * edge + from, (i * EDGE + j) * EDGE, len)
        }
    })
}

/// Copies the nodes that the particles of `block` see into a tile: the velocities in the first four
/// lanes, `second` in the others.
#[inline(always)]
pub fn load_tile<V: Vector, const D: usize>(
    (blocks, nodes): (&Blocks<D>, &Nodes),
    second: &[Record],
    block: u32,
    edge: usize,
    tile: &mut [TileNode],
) {
    for corner in 0..1 << D {
        let source = blocks.forward[block as usize][corner] as usize * EDGE.pow(D as u32);
        for (t, b, len) in shared_rows::<D>(edge, corner) {
            let r0 = &nodes.velocity[source + b..][..len];
            let r1 = &second[source + b..][..len];
            for ((node, r0), r1) in tile[t..t + len].iter_mut().zip(r0).zip(r1) {
                joined::<V>(r0, r1).store_node(node);
            }
        }
    }
}
