//! Stage 4b, filter: the velocities u that particles take in XPIC and FMPM, see [`filter`](crate::transfer::filter). Other transfers pass.
//!
//! Each term of the filter sends u from the grid to the particles and back, through R1. Walls act on every u as they do on velocities: were
//! they to act on the last one alone, what the filter amplifies and the walls cut off would come back larger in the next step.
//! USF and MUSL take gradients of velocities that came from particles, S⁺ S u: they are filtered too, or gradients would be those of a field
//! that is smoothed once more than the one that moves the particles.

use rayon::prelude::*;

use crate::background::Lanes;
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
    let xpic = world.options.transfer == TransferKind::Xpic;
    filtered(world, |world, nodes| {
        for_nodes(world, nodes, |node, v, r1| {
            node.start = *v;
            for a in 1..=D {
                node.start[a] -= if xpic { r1[a] } else { 0.0 };
            }
        });
        sum_terms(world, nodes);
        for_nodes(world, nodes, |node, v, r1| {
            r1[0] = v[0];
            for a in 1..=D {
                r1[a] = node.u[a] + (v[a] - node.start[a]);
            }
        });
        hold_at_boundaries(world);
        if !xpic {
            for_nodes(world, nodes, |_, v, r1| v[1..=D].copy_from_slice(&r1[1..=D]));
        }
    });
}

/// Filters the velocities at the start of a step (R0), of which USF takes gradients.
pub fn filter_start<const D: usize>(world: &mut State<D>) {
    filtered(world, |world, nodes| {
        for_nodes(world, nodes, |node, v, _| node.start = *v);
        sum_terms(world, nodes);
        for_nodes(world, nodes, |node, v, _| v[1..=D].copy_from_slice(&node.u[1..=D]));
    });
}

/// Filters the second velocities (R1), of which MUSL takes gradients.
pub fn filter_again<const D: usize>(world: &mut State<D>) {
    filtered(world, |world, nodes| {
        for_nodes(world, nodes, |node, _, r1| node.start = *r1);
        sum_terms(world, nodes);
    });
}

/// Calls `work` with room for the nodes if the transfer is filtered.
fn filtered<const D: usize>(
    world: &mut State<D>,
    work: impl FnOnce(&mut State<D>, &mut [Filtered]),
) {
    if world.options.transfer.is_filtered() {
        let mut nodes = std::mem::take(&mut world.filtered);
        nodes.clear();
        nodes.resize(world.grid.velocity.len(), Filtered { start: [0.0; 4], u: [0.0; 4] });
        work(world, &mut nodes);
        world.filtered = nodes;
    }
}

/// Leaves the sum of the terms that begin with `start` in `u` and R1.
fn sum_terms<const D: usize>(world: &mut State<D>, nodes: &mut [Filtered]) {
    for_nodes(world, nodes, |node, _, r1| *r1 = node.start);
    hold(world, nodes);
    for _ in 1..world.options.filter_order {
        world.for_each_chunk(|piece| {
            grid_to_particles(piece, Gather::Filter, 0.0);
            Outcome::default()
        });
        velocities_to_grid(world, Scattered::Filtered);
        for_nodes(world, nodes, |node, v, r1| {
            let inverse = if v[0] > 0.0 { 1.0 / v[0] } else { 0.0 };
            for a in 1..=D {
                r1[a] = filter::add_term(node.u[a], node.start[a], inverse * r1[a]);
            }
        });
        hold(world, nodes);
    }
}

/// Applies the boundaries to the sum of the terms, which stands in R1.
fn hold<const D: usize>(world: &mut State<D>, filtered: &mut [Filtered]) {
    hold_at_boundaries(world);
    for_nodes(world, filtered, |node, _, r1| node.u = *r1);
}

/// Velocities of a node on their way through a filter, in lanes 1 to D.
#[derive(Clone, Copy)]
pub struct Filtered {
    /// What goes in.
    start: Lanes,
    /// The sum of the terms so far.
    u: Lanes,
}

/// Calls `work` with the filtered velocities, R0 and R1 of every node.
fn for_nodes<const D: usize>(
    world: &mut State<D>,
    filtered: &mut [Filtered],
    work: impl Fn(&mut Filtered, &mut Lanes, &mut Lanes) + Sync,
) {
    let grid = &mut world.grid;
    let all = |((nodes, r0), r1): ((&mut [Filtered], &mut [Lanes]), &mut [Lanes])| {
        for ((node, r0), r1) in nodes.iter_mut().zip(r0).zip(r1) {
            work(node, r0, r1);
        }
    };
    if world.parallel {
        let records = filtered.par_chunks_mut(NODES).zip(grid.velocity.par_chunks_mut(NODES));
        records.zip(grid.increment.par_chunks_mut(NODES)).for_each(all);
    } else {
        all(((filtered, &mut grid.velocity), &mut grid.increment));
    }
}
