//! Stage 5, grid to particles: v_p from the transfer scheme, x_p += dt Σ w v, ∇v_p = Σ v ⊗ ∇w.

use crate::grid::key::EDGE;
use crate::grid::tiles::{TileNode, load_tile};
use crate::grid::{Grid, Key, Lanes, add_lanes};
use crate::particles::ChunkMut;
use crate::shape::stencil::{ShapeFunction, Stencil};
use crate::step::particles_to_grid::corner;
use crate::transfer::{Received, TransferKind, apic, pic_flip};
use crate::world::state::{Piece, Space};

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
    /// Origin and spacing.
    pub space: Space<D>,
    /// The block of the run.
    pub key: Key<D>,
    /// Nodes along the edge of the tile.
    pub edge: usize,
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
        load_tile::<D>(grid, run.block, piece.edge, tile);
        let job = GatherJob {
            space: piece.space,
            key: grid.keys()[run.block as usize],
            edge: piece.edge,
            range: (first.max(run.first as usize) - first, end.min(run.end as usize) - first),
            what,
            transfer: piece.transfer,
            pic_share: pic_flip::pic_share(piece.pic_rate, dt),
            dt,
            stride: scratch.stride,
        };
        (piece.gather)(&job, tile, chunk, scratch.velocity_gradient);
    }
}

/// Kernel of a run.
pub fn gather_run<S: ShapeFunction<N>, const N: usize, const D: usize>(
    job: &GatherJob<D>,
    tile: &[TileNode],
    chunk: &mut ChunkMut<'_>,
    gradient: &mut [f64],
) {
    let layout = chunk.layout;
    let from_r1 = job.what == Gather::PositionAndGradient;
    for k in job.range.0..job.range.1 {
        let x = chunk.get::<D>(layout.position, k);
        let stencil = Stencil::<N, D>::new::<S>(job.space.to_units(x));
        let nodes = &tile[corner(&stencil, job.key, job.edge)..];
        let received = if from_r1 {
            receive::<N, D, 1>(&stencil, nodes, job.edge, job.space.spacing)
        } else {
            receive::<N, D, 0>(&stencil, nodes, job.edge, job.space.spacing)
        };
        if job.what != Gather::PositionAndGradient {
            let v = match job.transfer {
                TransferKind::PicFlip => {
                    pic_flip::velocity(chunk.get(layout.velocity, k), &received, job.pic_share)
                }
                TransferKind::Apic => {
                    let c = apic::affine(&received, S::MOMENT, job.space.spacing);
                    for (a, row) in c.into_iter().enumerate() {
                        chunk.set(layout.affine + a * D, k, row);
                    }
                    received.velocity
                }
            };
            chunk.set(layout.velocity, k, v);
        }
        if job.what != Gather::Velocity {
            let moved = std::array::from_fn::<f64, D, _>(|a| x[a] + job.dt * received.velocity[a]);
            chunk.set(layout.position, k, moved);
            for a in 0..D {
                for b in 0..D {
                    gradient[(3 * a + b) * job.stride + k] = received.gradient[a][b];
                }
            }
        }
    }
}

/// Sums over the stencil: Σ w R0, Σ w R1, Σ w R0 ⊗ r and Σ R ⊗ ∇w with R the record `GRADIENT`.
#[inline(always)]
fn receive<const N: usize, const D: usize, const GRADIENT: usize>(
    stencil: &Stencil<N, D>,
    nodes: &[TileNode],
    edge: usize,
    h: f64,
) -> Received<D> {
    let z = *stencil.last();
    let mut sums = [[0.0; 4]; 2];
    let mut moment = [[0.0; 4]; D];
    let mut slope = [[0.0; 4]; D];
    stencil.rows(edge, |row| {
        let mut of_row = [[0.0; 4]; 2];
        let mut moment_of_row = [0.0; 4];
        let mut slope_of_row = [0.0; 4];
        for (n, node) in nodes[row.offset..row.offset + N].iter().enumerate() {
            add_lanes(&mut of_row[0], z.w[n], &node[0]);
            add_lanes(&mut of_row[1], z.w[n], &node[1]);
            add_lanes(&mut moment_of_row, z.w[n] * (n as f64 - z.fraction), &node[0]);
            add_lanes(&mut slope_of_row, z.dw[n], &node[GRADIENT]);
        }
        add_lanes(&mut sums[0], row.w, &of_row[0]);
        add_lanes(&mut sums[1], row.w, &of_row[1]);
        for d in 0..D - 1 {
            let r = row.node[d] as f64 - stencil.axes[d].fraction;
            add_lanes(&mut moment[d], row.w * r, &of_row[0]);
            add_lanes(&mut slope[d], row.dw[d], &of_row[GRADIENT]);
        }
        add_lanes(&mut moment[D - 1], row.w, &moment_of_row);
        add_lanes(&mut slope[D - 1], row.w, &slope_of_row);
    });
    let vector = |l: &Lanes| std::array::from_fn(|a| l[a + 1]);
    Received {
        velocity: vector(&sums[0]),
        increment: vector(&sums[1]),
        moment: std::array::from_fn(|a| std::array::from_fn(|b| moment[b][a + 1] * h)),
        gradient: std::array::from_fn(|a| std::array::from_fn(|b| slope[b][a + 1] / h)),
    }
}

/// Nodes of a stencil that a host's point sees: calls `visit` with node number and weight; false if a node is missing.
pub fn for_stencil_nodes<S: ShapeFunction<N>, const N: usize, const D: usize>(
    grid: &Grid<D>,
    xi: [f64; D],
    visit: &mut dyn FnMut(usize, f64),
) -> bool {
    let stencil = Stencil::<N, D>::new::<S>(xi);
    let mut complete = true;
    stencil.rows(EDGE, |row| {
        for n in 0..N {
            let mut index = [0i64; D];
            for d in 0..D - 1 {
                index[d] = stencil.axes[d].first as i64 + row.node[d] as i64;
            }
            index[D - 1] = stencil.last().first as i64 + n as i64;
            match grid.find_node(index) {
                Some(node) => visit(node, row.w * stencil.last().w[n]),
                None => complete = false,
            }
        }
    });
    complete
}
