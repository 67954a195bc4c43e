//! Velocities prescribed on regions: the nodes of the box with any mass get the velocity of the end of the step, in the components that
//! are prescribed, and what that changes is the reaction. Blocks outside the box are passed over. The nodes of a box are few beside
//! the particles, so that one thread does it, in the order of the blocks.

use std::ops::Range;

use crate::background::key::block_nodes;
use crate::background::{EDGE, Key, Lanes};
use crate::boundary::PrescribedVelocity;
use crate::world::state::{Space, State};

use super::ROUND_OFF;

/// Prescribes v_i and Δv_i, and sums the forces on the material.
pub fn prescribe<const D: usize>(world: &mut State<D>, dt: f64) {
    let end = world.time + dt;
    let (gravity, damped) = (world.gravity(world.time + 0.5 * dt), world.options.damping > 0.0);
    for n in 0..world.conditions.prescribed.len() {
        let target = world.conditions.prescribed[n].condition.velocity.at(end);
        let mut impulse = [0.0; 3];
        for_each_prescribed(world, n, |a, r0, r1, force| {
            let (mass, change) = (r0[0], target[a] - r0[a + 1]);
            // once for each component of a node, whatever number of conditions hold it: lane 0 of R1, which is free, remembers
            let seen = f64::from(1 << a);
            if damped && r0[a + 1] != 0.0 && r1[0] as i32 >> a & 1 == 0 {
                r1[0] += seen;
                impulse[a] -= dt * (force[a + 1] + mass * gravity[a]) - mass * r1[a + 1];
            }
            r0[a + 1] = target[a]; // [CND-3]
            r1[a + 1] += change;
            impulse[a] += mass * change;
        });
        let entry = &mut world.conditions.prescribed[n];
        entry.target = target;
        entry.reaction = impulse.map(|impulse| impulse / dt);
    }
}

/// Prescribes the velocities of the second scatter (R1).
pub fn prescribe_again<const D: usize>(world: &mut State<D>) {
    for n in 0..world.conditions.prescribed.len() {
        let target = world.conditions.prescribed[n].target;
        for_each_prescribed(world, n, |a, _, r1, _| r1[a + 1] = target[a]);
    }
}

/// Calls `visit` with every prescribed component of condition `n` and the records R0, R1 and force of its node.
fn for_each_prescribed<const D: usize>(
    world: &mut State<D>,
    n: usize,
    mut visit: impl FnMut(usize, &mut Lanes, &mut Lanes, &Lanes),
) {
    let space = world.space();
    let State { grid, conditions, .. } = world;
    let condition = &conditions.prescribed[n].condition;
    for place in 0..grid.order().len() {
        let slot = grid.order()[place] as usize;
        let key = grid.keys()[slot];
        let first = slot * block_nodes(D);
        for_nodes_inside(condition, &space, &key, |node| {
            let node = first + node;
            if grid.velocity[node][0] > 0.0 {
                for a in (0..D).filter(|a| condition.holds(*a)) {
                    let (r0, r1) = (&mut grid.velocity[node], &mut grid.increment[node]);
                    visit(a, r0, r1, &grid.force[node]);
                }
            }
        });
    }
}

/// Calls `visit` with the places in block `key` of the nodes inside the box of a condition.
pub fn for_nodes_inside<const D: usize>(
    condition: &PrescribedVelocity,
    space: &Space<D>,
    key: &Key<D>,
    mut visit: impl FnMut(usize),
) {
    let mut layers: [Range<usize>; D] = std::array::from_fn(|_| 0..0);
    for d in 0..D {
        layers[d] = layers_inside(condition, space, key, d);
        if layers[d].is_empty() {
            return;
        }
    }
    for node in 0..block_nodes(D) {
        let layer = |d: usize| node / EDGE.pow((D - 1 - d) as u32) % EDGE;
        if (0..D).all(|d| layers[d].contains(&layer(d))) {
            visit(node);
        }
    }
}

/// Layers of nodes of block `key`, along axis d, that are inside the box.
fn layers_inside<const D: usize>(
    condition: &PrescribedVelocity,
    space: &Space<D>,
    key: &Key<D>,
    d: usize,
) -> Range<usize> {
    let lowest = f64::from(key[d]) * EDGE as f64;
    let units = |x: f64| (x - space.origin[d]) * space.inverse;
    let clamp = |layer: f64| layer.clamp(0.0, EDGE as f64) as usize;
    let first = (units(condition.region.min[d]) - ROUND_OFF).ceil() - lowest;
    let last = (units(condition.region.max[d]) + ROUND_OFF).floor() - lowest;
    clamp(first)..clamp(last + 1.0)
}
