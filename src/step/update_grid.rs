//! Stage 3, the grid: v_i = (mv)_i / m_i + dt (f_i / m_i + g); and stage 4a, local non-viscous
//! damping.
//!
//! Every node with any mass takes part, however light: m_i and (mv)_i carry the same small weight,
//! so that their quotient is as good as any, and a cut-off would leave holes in the velocity
//! gradient of a body that flies by. The quotient f_i / m_i of a light node does grow, as ∇w / w.
//! Quadratic shapes bear it, since their gradient vanishes with the weight; linear ones do not, and
//! need FLIP with MUSL, whose second mapping takes the light nodes out of the velocity gradient.
//!
//! Damping takes α |F| from every component of the force F = m Δv / dt, against the velocity at the
//! start: F ← F − α |F| sgn(v). F is what is left of all forces once walls and prescribed velocities
//! have acted: what they hold is not damped, and reactions and friction are those of the whole
//! forces. P. A. Cundall, in: E. T. Brown (ed.), Analytical and Computational Methods in
//! Engineering Rock Mechanics (1987) 129–163.

use super::parts::Method;
use crate::background::nodes::pair_of_vectors;
use crate::background::{Nodes, Record};
use crate::parallel::{Cut, Team};
use crate::simd::{Kernel, LANES, Vector};

/// Nodes that one thread takes at a time.
const NODES: usize = 1024;

/// Turns momentum and force into velocity and its increment.
pub fn update_grid<const D: usize>(
    nodes: &mut Nodes,
    gravity: [f64; 3],
    method: &Method<D>,
    team: &Team,
    dt: f64,
) {
    let g = pair_of_vectors::<D>(std::array::from_fn(|a| gravity[a]));
    let Nodes { velocity, increment, force } = nodes;
    let records =
        (Cut(&mut velocity[..], NODES), Cut(&mut increment[..], NODES), Cut(&force[..], NODES));
    team.for_each_piece(records, 1, |_, (velocity, increment, force)| {
        method.isa.dispatch(Update { velocity, increment, force, g, dt });
    });
}

/// Damps the changes of velocity that nothing holds.
pub fn damp_grid<const D: usize>(nodes: &mut Nodes, damping: f64, team: &Team) {
    if damping == 0.0 {
        return;
    }
    let Nodes { velocity, increment, force } = nodes;
    let records =
        (Cut(&mut velocity[..], NODES), Cut(&mut increment[..], NODES), Cut(&force[..], NODES));
    team.for_each_piece(records, 1, |_, (velocity, increment, force)| {
        for ((velocity, increment), force) in velocity.iter_mut().zip(increment).zip(force) {
            let held = force.held() | increment.held();
            for a in (0..D).filter(|a| !held.has(*a)) {
                let change = increment.component(a);
                let before = velocity.component(a) - change;
                if before != 0.0 {
                    let resistance = damping * change.abs() * before.signum(); // [GRD-2]
                    *increment.component_mut(a) = change - resistance;
                    *velocity.component_mut(a) -= resistance;
                }
            }
        }
    });
}

struct Update<'a> {
    velocity: &'a mut [Record],
    increment: &'a mut [Record],
    force: &'a [Record],
    g: [f64; LANES],
    dt: f64,
}

impl Kernel for Update<'_> {
    type Output = ();
    #[inline(always)]
    fn run<V: Vector>(self) {
        let (g, dt) = (V::from_array(self.g), V::splat(self.dt));
        let velocities = self.velocity.as_chunks_mut::<2>().0;
        let increments = self.increment.as_chunks_mut::<2>().0;
        let forces = self.force.as_chunks::<2>().0;
        for ((velocity, increment), force) in velocities.iter_mut().zip(increments).zip(forces) {
            let (m, n) = (velocity[0].mass(), velocity[1].mass());
            let inverse = V::halves(inverse(m), inverse(n));
            let present = V::halves(present(m), present(n));
            let before = Record::load_pair::<V>(velocity) * inverse;
            let force = Record::load_pair::<V>(force);
            let change = force.mul_add(inverse, g * present) * dt;
            Record::store_pair(increment, change);
            Record::store_pair(velocity, before + change); // [GRD-1]
            velocity[0].set_mass(m);
            velocity[1].set_mass(n);
        }
    }
}

/// 1 / m; zero for an empty node, whose velocity is then zero too. A mass that has no inverse
/// counts as none.
#[inline(always)]
fn inverse(m: f64) -> f64 {
    if m >= f64::MIN_POSITIVE { 1.0 / m } else { 0.0 }
}

/// 1 for a node with mass, else 0.
#[inline(always)]
fn present(m: f64) -> f64 {
    f64::from(m >= f64::MIN_POSITIVE)
}
