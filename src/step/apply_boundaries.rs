//! Stage 4, boundaries: walls change the velocities of the nodes they reach and take up the
//! momentum; then come the conditions of other kinds that hold nodes, see
//! [`Condition::hold`](crate::boundary::Condition::hold).
//!
//! What is held of a node is decided once in a step, on the velocities at its end, and noted beside
//! its force. Every other field of velocities in the step loses the same: second ones, those in a
//! filter, and those at the start, of which USF takes gradients. See
//! [`law`](crate::boundary::law).

use super::parts::Method;
use crate::background::{Background, EDGE, Held, Nodes, Record, block_nodes};
use crate::boundary::law::{constrain, constrain_again};
use crate::boundary::wall::layer;
use crate::boundary::{Conditions, Entry, Holding, Reaching, Wall, WallKind};
use crate::parallel::{Cut, Team};
use crate::transfer::{TransferKind, pic_flip::pic_share};

/// Blocks that one thread takes at least.
const GRAIN: usize = 16;

/// Applies walls and prescribed velocities to v_i and Δv_i and sums their forces on the material;
/// `when` is the time at the start of the step and its length [s].
///
/// With FLIP, particles take Δv_i. Beside a sticky wall it counts from a start that does not move
/// along the wall either: the velocities that nodes there are given by shear are no motion that the
/// wall must stop anew in every step.
pub fn apply_boundaries<const D: usize>(
    background: &mut Background<D>,
    conditions: &mut Conditions,
    method: &Method<D>,
    impulses: &mut Vec<[f64; 3]>,
    team: &Team,
    when: (f64, f64),
) {
    let (time, dt) = when;
    let flip = match method.options.transfer {
        TransferKind::PicFlip => 1.0 - pic_share(method.options.pic_rate, dt),
        _ => 0.0,
    };
    let walls = &conditions.walls[..];
    for_nodes_at_walls(background, walls, impulses, team, |reaching, node, impulses| {
        let Node { velocity, increment, force } = node;
        let (mass, mut v) = (velocity.mass(), velocity.vector::<D>());
        let held = constrain(reaching, &mut v, &mut |n, a, change| {
            let wall = &walls[n].condition;
            let along = wall.kind == WallKind::Sticky && a != wall.axis;
            let still = if along { flip } else { 0.0 }; // [BND-5]
            let taken = increment.component(a);
            *increment.component_mut(a) = if still > 0.0 { 0.0 } else { taken + change };
            impulses[n][a] += mass * (change - still * (taken + change)); // [BND-4]
        });
        velocity.set_vector(v);
        force.set_held(held);
    });
    add_forces(conditions, background, impulses, dt, |entry| entry.force = [0.0; 3]);
    conditions.hold(background, &Holding { time, dt });
}

/// Adds the impulses that walls gave to the nodes of each block to their forces.
fn add_forces<const D: usize>(
    conditions: &mut Conditions,
    background: &Background<D>,
    impulses: &[[f64; 3]],
    dt: f64,
    begin: impl Fn(&mut Entry<Wall>),
) {
    let count = conditions.walls.len();
    for (w, entry) in conditions.walls.iter_mut().enumerate() {
        begin(entry);
        let mut total = [0.0; 3];
        for slot in background.blocks.owned() {
            for a in 0..D {
                total[a] += impulses[slot * count + w][a];
            }
        }
        for a in 0..D {
            entry.force[a] += total[a] / dt; // [BND-4]
        }
    }
}

/// Takes from the velocities of the grid, which are those at the start of a step, what is held: of
/// the velocities that gravity [m/s²] and the forces, as they stand, would lead to in the step
/// [s]. Without them, outside a step, walls act on the velocities themselves.
pub fn hold_velocities<const D: usize>(
    background: &mut Background<D>,
    conditions: &mut Conditions,
    impulses: &mut Vec<[f64; 3]>,
    team: &Team,
    ahead: Option<([f64; 3], f64)>,
) {
    for_nodes_at_walls(background, &conditions.walls, impulses, team, |reaching, node, _| {
        let Node { velocity, force, .. } = node;
        let (mass, v) = (velocity.mass(), velocity.vector::<D>());
        let mut end = v;
        if let Some((gravity, dt)) = ahead.filter(|_| mass > 0.0) {
            end = std::array::from_fn(|a| v[a] + dt * (force.component(a) / mass + gravity[a]));
        }
        let held = constrain(reaching, &mut end, &mut |_, _, _| {});
        let start = if ahead.is_some() { v } else { end };
        velocity.set_vector(std::array::from_fn::<_, D, _>(|a| without(held, start[a], a)));
        force.set_held(held);
    });
    if !conditions.prescribed.is_empty() {
        let Nodes { velocity, increment, .. } = &mut background.nodes;
        increment.copy_from_slice(velocity);
        conditions.hold_again(background, None);
        let Nodes { velocity, increment, .. } = &mut background.nodes;
        for (velocity, held) in velocity.iter_mut().zip(increment) {
            velocity.set_vector::<D>(held.vector());
        }
    }
}

/// Component a of a velocity, unless it is held.
fn without(held: Held, v: f64, a: usize) -> f64 {
    if held.has(a) { 0.0 } else { v }
}

/// Turns the momentum of the second scatter into velocity and holds it at walls and where
/// velocities are prescribed.
pub fn apply_boundaries_again<const D: usize>(
    background: &mut Background<D>,
    conditions: &mut Conditions,
    impulses: &mut Vec<[f64; 3]>,
    team: &Team,
) {
    let Nodes { velocity, increment, .. } = &mut background.nodes;
    let grain = GRAIN * block_nodes(D);
    let records = (Cut(&velocity[..], grain), Cut(&mut increment[..], grain));
    team.for_each_piece(records, 1, |_, (velocity, increment)| {
        for (velocity, momentum) in velocity.iter().zip(increment) {
            let mass = velocity.mass();
            *momentum = if mass > 0.0 { momentum.divided(mass) } else { Record::ZERO };
        }
    });
    hold_at_boundaries(background, conditions, impulses, team, None);
}

/// Takes from the velocities that stand in the increments what is held. If they are those that
/// particles take, `dt` [s] is the step, and the forces of walls and prescribed velocities count it.
pub fn hold_at_boundaries<const D: usize>(
    background: &mut Background<D>,
    conditions: &mut Conditions,
    impulses: &mut Vec<[f64; 3]>,
    team: &Team,
    dt: Option<f64>,
) {
    for_nodes_at_walls(
        background,
        &conditions.walls,
        impulses,
        team,
        |reaching, node, impulses| {
            let (mass, mut v) = (node.velocity.mass(), node.increment.vector::<D>());
            constrain_again(reaching, node.force.held(), &mut v, &mut |n, a, change| {
                impulses[n][a] += mass * change;
            });
            node.increment.set_vector(v);
        },
    );
    if let Some(dt) = dt {
        add_forces(conditions, background, impulses, dt, |_| {});
    }
    conditions.hold_again(background, dt);
}

/// Records of a node.
struct Node<'a> {
    velocity: &'a mut Record,
    increment: &'a mut Record,
    force: &'a mut Record,
}

/// Calls `work` for every node that walls reach, with the number of each of those walls, and with
/// the sums of its block, one for each wall, that are zero at first.
fn for_nodes_at_walls<const D: usize>(
    background: &mut Background<D>,
    walls: &[Entry<Wall>],
    sums: &mut Vec<[f64; 3]>,
    team: &Team,
    work: impl Fn(Reaching<'_, D>, Node<'_>, &mut [[f64; 3]]) + Sync,
) {
    if walls.is_empty() {
        return;
    }
    let Background { space, blocks, nodes, .. } = background;
    let Nodes { velocity, increment, force } = nodes;
    let (n, keys) = (block_nodes(D), blocks.keys());
    sums.clear();
    sums.resize(keys.len() * walls.len(), [0.0; 3]);
    let records = (Cut(&mut velocity[..], n), Cut(&mut increment[..], n), Cut(&mut force[..], n));
    let with_sums = (records, Cut(&mut sums[..], walls.len()));
    team.for_each_piece(with_sums, GRAIN, |block, ((velocity, increment, force), sums)| {
        let key = &keys[block];
        // layers of the block, along each axis, that any wall reaches
        let mut layers = [[false; EDGE]; D];
        for wall in walls.iter().map(|entry| &entry.condition) {
            layers[wall.axis][wall.reached(space, key)].fill(true);
        }
        if layers.as_flattened().iter().all(|reached| !reached) {
            return;
        }
        let nodes = velocity.iter_mut().zip(increment).zip(force).enumerate();
        for (node, ((velocity, increment), force)) in nodes {
            if (0..D).any(|d| layers[d][layer(node, d, D)]) {
                let reaching = Reaching::new(walls, space, key, node);
                work(reaching, Node { velocity, increment, force }, sums);
            }
        }
    });
}
