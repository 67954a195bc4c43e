//! Stage 2, particles to grid: m_i = Σ w m, (mv)_i = Σ w m (v + C r), f_i = −Σ V σ ∇w with r = x_i − x_p.
//!
//! The particles of a block add into the block's tile; then every block pulls from the tiles that reach it, in a fixed order.

use rayon::prelude::*;

use crate::grid::blocks::Neighbours;
use crate::grid::key::block_nodes;
use crate::grid::tiles::{TileNode, Tiles, shared_rows};
use crate::grid::{EDGE, Key, Lanes, NONE, Run, add_lanes};
use crate::particles::Particles;
use crate::shape::stencil::{Row, ShapeFunction, Stencil};
use crate::tensor::SYMMETRIC_INDEX;
use crate::world::state::{Space, State};

/// The scatter of one run of particles into a tile of the block with the given key.
pub type Scatter<const D: usize> = fn(&Particles, &Space<D>, Key<D>, Run, usize, &mut [TileNode]);

/// Maps mass, momentum and the forces of the stresses to the grid.
pub fn particles_to_grid<const D: usize>(world: &mut State<D>) {
    scatter(world, world.kernels.scatter);
    let (grid, tiles) = (&mut world.grid, &world.tiles);
    pull::<D>(&grid.backward, tiles, 0, world.parallel, &mut grid.velocity);
    pull::<D>(&grid.backward, tiles, 1, world.parallel, &mut grid.force);
}

/// Maps the new mass and momentum of the particles into R1 (second scatter of MUSL).
pub fn velocities_to_grid<const D: usize>(world: &mut State<D>) {
    scatter(world, world.kernels.scatter_velocity);
    let (grid, tiles) = (&mut world.grid, &world.tiles);
    pull::<D>(&grid.backward, tiles, 1, world.parallel, &mut grid.increment);
}

fn scatter<const D: usize>(world: &mut State<D>, kernel: Scatter<D>) {
    let space = world.space();
    let State { bodies, grid, tiles, context, .. } = world;
    let (nodes, edge) = (tiles.tile_nodes(D), tiles.edge);
    let used = &mut tiles.nodes[..nodes * tiles.tiles.len()];
    let fill = |(tile, runs): (&mut [TileNode], &(u32, u32))| {
        tile.fill([[0.0; 4]; 2]);
        for run in &tiles.runs[runs.0 as usize..runs.1 as usize] {
            let key = grid.keys()[run.block as usize];
            kernel(&bodies[run.body as usize].particles, &space, key, *run, edge, tile);
        }
    };
    if world.parallel {
        used.par_chunks_mut(nodes).zip(&tiles.tiles).for_each(|job| {
            context.mark_worker();
            fill(job);
        });
    } else {
        used.chunks_mut(nodes).zip(&tiles.tiles).for_each(fill);
    }
}

/// Every block takes record `record` of its nodes from the tiles that reach it, corner by corner.
fn pull<const D: usize>(
    backward: &[Neighbours],
    tiles: &Tiles,
    record: usize,
    parallel: bool,
    target: &mut [Lanes],
) {
    let add = |(nodes, neighbours): (&mut [Lanes], &Neighbours)| {
        nodes.fill([0.0; 4]);
        for corner in 0..1 << D {
            let source = neighbours[corner];
            let (first, end) =
                if source == NONE { (0, 0) } else { tiles.of_block[source as usize] };
            for t in first..end {
                let tile = tiles.tile(t as usize, D);
                shared_rows::<D>(tiles.edge, corner, |from, to, len| {
                    for (node, source) in nodes[to..to + len].iter_mut().zip(&tile[from..]) {
                        add_lanes(node, 1.0, &source[record]);
                    }
                });
            }
        }
    };
    let nodes = block_nodes(D);
    if parallel {
        target.par_chunks_mut(nodes).zip(backward).for_each(add);
    } else {
        target.chunks_mut(nodes).zip(backward).for_each(add);
    }
}

/// A vector in lanes 1, 2, 3.
#[inline(always)]
fn lanes<const D: usize>(first: f64, v: [f64; D]) -> Lanes {
    std::array::from_fn(|l| {
        if l == 0 {
            first
        } else if l <= D {
            v[l - 1]
        } else {
            0.0
        }
    })
}

/// Position of the lowest node of a stencil in the tile of block `key`.
#[inline(always)]
pub fn corner<const N: usize, const D: usize>(
    stencil: &Stencil<N, D>,
    key: Key<D>,
    edge: usize,
) -> usize {
    (0..D).fold(0, |at, d| {
        let place = stencil.axes[d].first as i64 - i64::from(key[d]) * EDGE as i64;
        at * edge + place as usize
    })
}

/// What a particle spreads: mass and momentum at the lowest node of its stencil, and their change from node to node along each axis.
struct Spread<const D: usize> {
    lowest: Lanes,
    slope: [Lanes; D],
}

impl<const D: usize> Spread<D> {
    /// m (1, v + C r); without an affine matrix C = 0.
    #[inline(always)]
    fn new<const N: usize>(
        particles: &Particles,
        k: usize,
        stencil: &Stencil<N, D>,
        h: f64,
    ) -> Self {
        let layout = &particles.layout;
        let [mass] = particles.get::<1>(layout.mass, k);
        let v = particles.get::<D>(layout.velocity, k);
        let mut spread = Self { lowest: lanes(mass, v.map(|c| mass * c)), slope: [[0.0; 4]; D] };
        if layout.deformation_gradient > layout.affine {
            for d in 0..D {
                let c = |a: usize| particles.column(layout.affine + a * D + d)[k];
                spread.slope[d] = lanes(0.0, std::array::from_fn::<f64, D, _>(|a| mass * h * c(a)));
                add_lanes(&mut spread.lowest, -stencil.axes[d].fraction, &spread.slope[d]);
            }
        }
        spread
    }

    /// Its value at the first node of a row.
    #[inline(always)]
    fn at(&self, row: &Row) -> Lanes {
        let mut value = self.lowest;
        for d in 0..D - 1 {
            add_lanes(&mut value, row.node[d] as f64, &self.slope[d]);
        }
        value
    }
}

/// Kernel: m (1, v + C r) into record 0 and −V σ ∇w into record 1.
pub fn scatter_run<S: ShapeFunction<N>, const N: usize, const D: usize>(
    particles: &Particles,
    space: &Space<D>,
    key: Key<D>,
    run: Run,
    edge: usize,
    tile: &mut [TileNode],
) {
    let layout = &particles.layout;
    for k in run.first as usize..run.end as usize {
        let xi = space.to_units(particles.get::<D>(layout.position, k));
        let stencil = Stencil::<N, D>::new::<S>(xi);
        let spread = Spread::new(particles, k, &stencil, space.spacing);
        let [volume] = particles.get::<1>(layout.volume, k);
        let stress = particles.get::<6>(layout.stress, k);
        // −V σ / h by columns
        let scale = -volume / space.spacing;
        let flux: [Lanes; D] = std::array::from_fn(|d| {
            let column = |a: usize| scale * stress[SYMMETRIC_INDEX[a][d]];
            lanes(0.0, std::array::from_fn::<f64, D, _>(column))
        });
        let z = *stencil.last();
        let nodes = &mut tile[corner(&stencil, key, edge)..];
        stencil.rows(edge, |row| {
            let mut momentum = spread.at(&row);
            let mut outer = [0.0; 4];
            for d in 0..D - 1 {
                add_lanes(&mut outer, row.dw[d], &flux[d]);
            }
            for (n, node) in nodes[row.offset..row.offset + N].iter_mut().enumerate() {
                add_lanes(&mut node[0], row.w * z.w[n], &momentum);
                add_lanes(&mut node[1], z.w[n], &outer);
                add_lanes(&mut node[1], row.w * z.dw[n], &flux[D - 1]);
                add_lanes(&mut momentum, 1.0, &spread.slope[D - 1]);
            }
        });
    }
}

/// Kernel: m (1, v + C r) into record 1.
pub fn scatter_velocity_run<S: ShapeFunction<N>, const N: usize, const D: usize>(
    particles: &Particles,
    space: &Space<D>,
    key: Key<D>,
    run: Run,
    edge: usize,
    tile: &mut [TileNode],
) {
    for k in run.first as usize..run.end as usize {
        let xi = space.to_units(particles.get::<D>(particles.layout.position, k));
        let stencil = Stencil::<N, D>::new::<S>(xi);
        let spread = Spread::new(particles, k, &stencil, space.spacing);
        let z = *stencil.last();
        let nodes = &mut tile[corner(&stencil, key, edge)..];
        stencil.rows(edge, |row| {
            let mut momentum = spread.at(&row);
            for (n, node) in nodes[row.offset..row.offset + N].iter_mut().enumerate() {
                add_lanes(&mut node[1], row.w * z.w[n], &momentum);
                add_lanes(&mut momentum, 1.0, &spread.slope[D - 1]);
            }
        });
    }
}
