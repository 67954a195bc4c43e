//! Stage 4b, filter: the velocities u that particles take in XPIC and FMPM, see [`filter`](crate::transfer::filter). Other transfers pass.
//!
//! Each term of the filter goes from the grid to the particles and back, through R1. Walls act on u as they do on velocities.

use rayon::prelude::*;

use crate::grid::Lanes;
use crate::transfer::{TransferKind, filter};
use crate::world::state::State;

use super::apply_boundaries::hold_at_boundaries;
use super::grid_to_particles::{Gather, grid_to_particles};
use super::particles_to_grid::{Scattered, velocities_to_grid};
use super::update_stress::Outcome;

/// Nodes that one thread takes at a time.
const NODES: usize = 1024;

/// Leaves in R1 the velocities that particles take; with FMPM they are the velocities of the grid too.
pub fn filter_velocities<const D: usize>(world: &mut State<D>) {
    let (transfer, order) = (world.options.transfer, world.options.filter_order);
    if !transfer.is_filtered() {
        return;
    }
    let xpic = transfer == TransferKind::Xpic;
    let mut filtered = std::mem::take(&mut world.filtered);
    filtered.clear();
    filtered.resize(world.grid.velocity.len(), [0.0; 4]);
    // the first term, m v, and u, which begins with it and Δv
    for_nodes(world, &mut filtered, |u, v, r1| {
        for a in 1..=D {
            let (start, change) = if xpic { (v[a] - r1[a], r1[a]) } else { (v[a], 0.0) };
            r1[a] = f64::from(order) * start;
            u[a] = change + r1[a];
        }
    });
    for l in 2..=order {
        world.for_each_chunk(|piece| {
            grid_to_particles(piece, Gather::Filter, 0.0);
            Outcome::default()
        });
        velocities_to_grid(world, Scattered::Filtered);
        let factor = filter::factor(order, l);
        for_nodes(world, &mut filtered, |u, v, r1| {
            let inverse = if v[0] > 0.0 { factor / v[0] } else { 0.0 };
            for a in 1..=D {
                r1[a] *= inverse;
                u[a] += r1[a];
            }
        });
    }
    for_nodes(world, &mut filtered, |u, v, r1| {
        u[0] = v[0];
        *r1 = *u;
    });
    hold_at_boundaries(world);
    if !xpic {
        for_nodes(world, &mut filtered, |_, v, r1| v[1..=D].copy_from_slice(&r1[1..=D]));
    }
    world.filtered = filtered;
}

/// Calls `work` with u, R0 and R1 of every node.
fn for_nodes<const D: usize>(
    world: &mut State<D>,
    filtered: &mut [Lanes],
    work: impl Fn(&mut Lanes, &mut Lanes, &mut Lanes) + Sync,
) {
    let grid = &mut world.grid;
    let all = |((u, r0), r1): ((&mut [Lanes], &mut [Lanes]), &mut [Lanes])| {
        for ((u, r0), r1) in u.iter_mut().zip(r0).zip(r1) {
            work(u, r0, r1);
        }
    };
    if world.parallel {
        let records = filtered.par_chunks_mut(NODES).zip(grid.velocity.par_chunks_mut(NODES));
        records.zip(grid.increment.par_chunks_mut(NODES)).for_each(all);
    } else {
        all(((filtered, &mut grid.velocity), &mut grid.increment));
    }
}
