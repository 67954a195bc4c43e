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
use crate::error::Result;
use crate::memory::reserve_exact;
use crate::parallel::{Cut, Team};
use crate::particles::Body;
use crate::transfer::{TransferKind, filter};

/// Nodes that one thread takes at a time.
const NODES: usize = 1024;

/// What filters: what a term needs on its way to the particles and back.
pub struct Filter<'a, const D: usize> {
    /// The bodies.
    pub bodies: &'a mut [Body],
    /// The grid.
    pub background: &'a mut Background<D>,
    /// How it computes.
    pub method: &'a Method<D>,
    /// What holds the velocities.
    pub conditions: &'a mut Conditions,
    /// The terms of the nodes.
    pub filtering: &'a mut Filtering,
    /// Room for what walls take.
    pub impulses: &'a mut Vec<[f64; 3]>,
    /// Who computes.
    pub team: &'a Team,
}

impl<const D: usize> Filter<'_, D> {
    /// Leaves in the increments the velocities that particles take in a step of `dt` [s]; with FMPM
    /// they are the velocities of the grid too. Σ m u changes where u is held: what is taken of the
    /// last term, and of the sum, becomes momentum of the particles beside the first impulse. (What
    /// is taken of the terms before, the next one, v + u − S⁺ S u, gives back.)
    pub fn velocities(&mut self, dt: f64) {
        if !self.begins() {
            return;
        }
        let xpic = self.method.options.transfer == TransferKind::Xpic;
        self.for_nodes(|terms, v, increment| {
            terms.start = *v;
            for a in (0..D).filter(|_| xpic) {
                *terms.start.component_mut(a) -= increment.component(a);
            }
        });
        self.sum_terms(Some(dt));
        self.for_nodes(|terms, v, increment| {
            for a in 0..D {
                let change = v.component(a) - terms.start.component(a);
                *increment.component_mut(a) = terms.sum.component(a) + change;
            }
        });
        self.hold(Some(dt));
        if !xpic {
            self.for_nodes(|_, v, increment| v.set_vector::<D>(increment.vector()));
        }
    }

    /// Filters the velocities at the start of a step, of which USF takes gradients.
    pub fn start(&mut self) {
        if self.begins() {
            self.for_nodes(|terms, v, _| terms.start = *v);
            self.sum_terms(None);
            self.for_nodes(|terms, v, _| v.set_vector::<D>(terms.sum.vector()));
        }
    }

    /// Filters the second velocities, of which MUSL takes gradients.
    pub fn again(&mut self) {
        if self.begins() {
            self.for_nodes(|terms, _, second| terms.start = *second);
            self.sum_terms(None);
        }
    }

    /// Leaves the sum of the terms that begin with `start` in `sum` and in the increments; with a
    /// step of `dt` [s] forces count what is taken of the last one.
    fn sum_terms(&mut self, dt: Option<f64>) {
        let order = self.method.options.filter_order;
        let counted = |term: i32| dt.filter(|_| term == order);
        self.for_nodes(|terms, _, u| *u = terms.start);
        self.hold(counted(1));
        self.for_nodes(|terms, _, u| terms.sum = *u);
        let pass = Pass { gather: Gather::Filter, dt: 0.0, then: Then::Nothing };
        for term in 2..=order {
            let Self { bodies, background, method, team, .. } = self;
            (method.kernels.pass)(bodies, background, method, team, &pass);
            velocities_to_grid(background, bodies, method, team, Scattered::Filtered);
            self.for_nodes(|terms, v, back| {
                let inverse = if v.mass() > 0.0 { 1.0 / v.mass() } else { 0.0 };
                for a in 0..D {
                    let (sum, start) = (terms.sum.component(a), terms.start.component(a));
                    let back = back.component_mut(a);
                    *back = filter::add_term(sum, start, inverse * *back);
                }
            });
            self.hold(counted(term));
            self.for_nodes(|terms, _, u| terms.sum = *u);
        }
    }

    /// Takes from u what is held.
    fn hold(&mut self, dt: Option<f64>) {
        hold_at_boundaries(self.background, self.conditions, self.impulses, self.team, dt);
    }

    /// Begins with the nodes, for which there is room, if the transfer is filtered; whether it is.
    fn begins(&mut self) -> bool {
        let filtered = self.method.options.transfer.is_filtered();
        if filtered {
            let empty = Terms { start: Record::ZERO, sum: Record::ZERO };
            self.filtering.0.clear();
            self.filtering.0.resize(self.background.nodes.len(), empty);
        }
        filtered
    }

    /// Calls `work` with the terms, the velocity and the increment of every node.
    fn for_nodes(&mut self, work: impl Fn(&mut Terms, &mut Record, &mut Record) + Sync) {
        let Nodes { velocity, increment, .. } = &mut self.background.nodes;
        let terms = Cut(&mut self.filtering.0[..], NODES);
        let records = (terms, Cut(&mut velocity[..], NODES), Cut(&mut increment[..], NODES));
        self.team.for_each_piece(records, 1, |_, (terms, velocity, increment)| {
            for ((terms, velocity), increment) in terms.iter_mut().zip(velocity).zip(increment) {
                work(terms, velocity, increment);
            }
        });
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
    /// Makes room for the nodes if the transfer is filtered.
    pub fn make_room<const D: usize>(&mut self, method: &Method<D>, nodes: &Nodes) -> Result<()> {
        let filtered = method.options.transfer.is_filtered();
        let all = if filtered { nodes.len() } else { 0 };
        reserve_exact(&mut self.0, all, "the terms of the filter")
    }
}
