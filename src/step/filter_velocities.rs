//! Stage 4b, filter: the velocities u that particles take in XPIC and FMPM, see
//! [`filter`](crate::transfer::filter). Other transfers skip it.
//!
//! Each term of the filter sends u from the grid to the particles and back, through R1. Walls act
//! on every u as they do on velocities: were they to act on the last one alone, what the filter
//! amplifies and the walls cut off would come back larger in the next step. USF and MUSL take
//! gradients of velocities that came from particles, S⁺ S u: they are filtered too, or gradients
//! would be those of a field that is smoothed once more than the one that moves the particles.

use super::apply_boundaries::hold_at_boundaries;
use super::grid_to_particles::Gather;
use super::particles_to_grid::{Scattered, velocities_to_grid};
use super::parts::Method;
use super::pass::{Pass, Then};
use crate::background::{Background, Nodes, Record};
use crate::boundary::Conditions;
use crate::parallel::{Cut, Team};
use crate::particles::Body;
use crate::transfer::{TransferKind, filter};

/// Nodes that one thread takes at a time.
const NODES: usize = 1024;

/// Leaves in the increments the velocities that particles take; with FMPM they are the velocities
/// of the grid too.
pub fn filter_velocities<const D: usize>(
    bodies: &mut [Body],
    background: &mut Background<D>,
    method: &Method<D>,
    conditions: &Conditions,
    filtering: &mut Filtering,
    team: &Team,
) {
    let xpic = method.options.transfer == TransferKind::Xpic;
    if !filtering.begins(method, &background.nodes) {
        return;
    }
    filtering.for_nodes(&mut background.nodes, team, |terms, v, increment| {
        terms.start = *v;
        for a in (0..D).filter(|_| xpic) {
            *terms.start.component_mut(a) -= increment.component(a);
        }
    });
    sum_terms(bodies, background, method, conditions, filtering, team);
    filtering.for_nodes(&mut background.nodes, team, |terms, v, increment| {
        for a in 0..D {
            let change = v.component(a) - terms.start.component(a);
            *increment.component_mut(a) = terms.sum.component(a) + change;
        }
    });
    hold_at_boundaries(background, conditions, team);
    if !xpic {
        filtering.for_nodes(&mut background.nodes, team, |_, v, increment| {
            v.set_vector::<D>(increment.vector());
        });
    }
}

/// Filters the velocities at the start of a step, of which USF takes gradients.
pub fn filter_start<const D: usize>(
    bodies: &mut [Body],
    background: &mut Background<D>,
    method: &Method<D>,
    conditions: &Conditions,
    filtering: &mut Filtering,
    team: &Team,
) {
    if filtering.begins(method, &background.nodes) {
        filtering.for_nodes(&mut background.nodes, team, |terms, v, _| terms.start = *v);
        sum_terms(bodies, background, method, conditions, filtering, team);
        filtering.for_nodes(&mut background.nodes, team, |terms, v, _| {
            v.set_vector::<D>(terms.sum.vector());
        });
    }
}

/// Filters the second velocities, of which MUSL takes gradients.
pub fn filter_again<const D: usize>(
    bodies: &mut [Body],
    background: &mut Background<D>,
    method: &Method<D>,
    conditions: &Conditions,
    filtering: &mut Filtering,
    team: &Team,
) {
    if filtering.begins(method, &background.nodes) {
        filtering.for_nodes(&mut background.nodes, team, |terms, _, second| terms.start = *second);
        sum_terms(bodies, background, method, conditions, filtering, team);
    }
}

/// Leaves the sum of the terms that begin with `start` in `sum` and in the increments.
fn sum_terms<const D: usize>(
    bodies: &mut [Body],
    background: &mut Background<D>,
    method: &Method<D>,
    conditions: &Conditions,
    filtering: &mut Filtering,
    team: &Team,
) {
    filtering.for_nodes(&mut background.nodes, team, |terms, _, u| *u = terms.start);
    hold_at_boundaries(background, conditions, team);
    filtering.for_nodes(&mut background.nodes, team, |terms, _, u| terms.sum = *u);
    let pass = Pass { gather: Gather::Filter, dt: 0.0, then: Then::Nothing };
    for _ in 1..method.options.filter_order {
        (method.kernels.pass)(bodies, background, method, team, &pass);
        velocities_to_grid(background, bodies, method, team, Scattered::Filtered);
        filtering.for_nodes(&mut background.nodes, team, |terms, v, back| {
            let inverse = if v.mass() > 0.0 { 1.0 / v.mass() } else { 0.0 };
            for a in 0..D {
                let (sum, start) = (terms.sum.component(a), terms.start.component(a));
                *back.component_mut(a) = filter::add_term(sum, start, inverse * back.component(a));
            }
        });
        hold_at_boundaries(background, conditions, team);
        filtering.for_nodes(&mut background.nodes, team, |terms, _, u| terms.sum = *u);
    }
}

/// Velocities of the nodes on their way through a filter; used by filtered transfers alone.
#[derive(Default)]
pub struct Filtering(Vec<Terms>);

/// Velocities of a node on their way through a filter.
#[derive(Clone, Copy)]
struct Terms {
    /// What goes in.
    start: Record,
    /// The sum of the terms so far.
    sum: Record,
}

impl Filtering {
    /// Makes room for the nodes if the transfer is filtered; whether it is.
    fn begins<const D: usize>(&mut self, method: &Method<D>, nodes: &Nodes) -> bool {
        let filtered = method.options.transfer.is_filtered();
        if filtered {
            self.0.clear();
            self.0.resize(nodes.len(), Terms { start: Record::ZERO, sum: Record::ZERO });
        }
        filtered
    }

    /// Calls `work` with the terms, the velocity and the increment of every node.
    fn for_nodes(
        &mut self,
        nodes: &mut Nodes,
        team: &Team,
        work: impl Fn(&mut Terms, &mut Record, &mut Record) + Sync,
    ) {
        let Nodes { velocity, increment, .. } = nodes;
        let (terms, velocity) = (Cut(&mut self.0[..], NODES), Cut(&mut velocity[..], NODES));
        let records = (terms, velocity, Cut(&mut increment[..], NODES));
        team.for_each_piece(records, 1, |_, (terms, velocity, increment)| {
            for ((terms, velocity), increment) in terms.iter_mut().zip(velocity).zip(increment) {
                work(terms, velocity, increment);
            }
        });
    }
}
