//! Stage 4, velocities prescribed on regions: the nodes of the box with any mass get the velocity
//! of the end of the step, in the components that are prescribed, and what that changes is the
//! reaction. Blocks outside the box are skipped. The nodes of a box are few beside the particles,
//! so that one thread does it, in the order of the blocks.

use super::Undamped;
use crate::background::{Background, Record, block_nodes};
use crate::boundary::{List, Prescribed, PrescribedVelocity};

/// Prescribes v_i and Δv_i, and sums the forces on the material.
pub fn prescribe<const D: usize>(
    background: &mut Background<D>,
    conditions: &mut List<Prescribed>,
    (time, dt): (f64, f64),
    undamped: Undamped,
) {
    for entry in conditions.iter_mut() {
        let target = entry.condition.condition.velocity.at(time + dt);
        let mut impulse = [0.0; 3];
        for_each_held(background, &entry.condition.condition, |a, velocity, increment, force| {
            let (mass, before) = (velocity.mass(), velocity.component(a));
            let change = target[a] - before;
            // once for each component of a node, whatever number of conditions hold it
            if let Some((gravity, dt)) = undamped
                && before != 0.0
                && !increment.is_held(a)
            {
                increment.hold(a);
                let whole = dt * (force.component(a) + mass * gravity[a]);
                impulse[a] -= whole - mass * increment.component(a);
            }
            *velocity.component_mut(a) = target[a]; // [CND-3]
            *increment.component_mut(a) += change;
            impulse[a] += mass * change;
        });
        entry.condition.target = target;
        entry.force = impulse.map(|impulse| impulse / dt);
    }
}

/// Prescribes the velocities that stand in the increments.
pub fn prescribe_again<const D: usize>(
    background: &mut Background<D>,
    conditions: &List<Prescribed>,
) {
    for Prescribed { condition, target } in conditions.iter().map(|entry| &entry.condition) {
        for_each_held(background, condition, |a, _, increment, _| {
            *increment.component_mut(a) = target[a];
        });
    }
}

/// Calls `visit` with every component that a condition holds, and the velocity, increment and force
/// of its node.
fn for_each_held<const D: usize>(
    background: &mut Background<D>,
    condition: &PrescribedVelocity,
    mut visit: impl FnMut(usize, &mut Record, &mut Record, &Record),
) {
    let Background { space, blocks, nodes, .. } = background;
    for slot in blocks.owned() {
        let first = slot * block_nodes(D);
        condition.for_nodes_inside(space, &blocks.keys()[slot], |node| {
            let node = first + node;
            if nodes.velocity[node].mass() > 0.0 {
                for a in (0..D).filter(|a| condition.holds(*a)) {
                    let (v, dv) = (&mut nodes.velocity[node], &mut nodes.increment[node]);
                    visit(a, v, dv, &nodes.force[node]);
                }
            }
        });
    }
}
