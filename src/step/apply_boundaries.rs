//! Stage 4, boundaries: walls change the velocities of the nodes they reach and take up the
//! momentum; then come the conditions of other kinds that hold nodes, see
//! [`Condition::hold`](crate::boundary::Condition::hold).
//!
//! A node that is held is not damped: its reaction is m Δv / dt − (f + m g), with the whole force,
//! not with what local damping left of it.

use super::options::Options;
use crate::background::{Background, Key, Nodes, Record, Space, block_nodes};
use crate::boundary::{Conditions, Entry, Holding, Wall};
use crate::parallel::{Cut, Team};

/// Blocks that one thread takes at least.
const GRAIN: usize = 16;

/// Applies walls and prescribed velocities to v_i and Δv_i and sums their forces on the material;
/// `when` is the time at the start of the step and its length [s].
pub fn apply_boundaries<const D: usize>(
    background: &mut Background<D>,
    conditions: &mut Conditions,
    options: &Options,
    impulses: &mut Vec<[f64; 3]>,
    team: &Team,
    when: (f64, f64),
) {
    let (time, dt) = when;
    let gravity = conditions.gravity(options.gravity, time + 0.5 * dt);
    let undamped = (options.damping > 0.0).then_some((gravity, dt));
    apply_walls(background, &conditions.walls, impulses, team, undamped);
    let count = conditions.walls.len();
    for (w, entry) in conditions.walls.iter_mut().enumerate() {
        let mut total = [0.0; 3];
        for slot in background.blocks.owned() {
            let impulse = impulses[slot * count + w];
            for a in 0..D {
                total[a] += impulse[a];
            }
        }
        entry.force = total.map(|impulse| impulse / dt); // [BND-4]
    }
    conditions
        .hold(background, &Holding { time, dt, undamped: undamped.map(|(gravity, _)| gravity) });
}

/// Where local damping is on: gravity [m/s²] and the step [s], of which the force without damping
/// follows.
type Undamped = Option<([f64; 3], f64)>;

fn apply_walls<const D: usize>(
    background: &mut Background<D>,
    walls: &[Entry<Wall>],
    impulses: &mut Vec<[f64; 3]>,
    team: &Team,
    undamped: Undamped,
) {
    if walls.is_empty() {
        return;
    }
    for_each_block(background, walls.len(), impulses, team, |space, key, records, impulses| {
        let Records { velocity, increment, force } = records;
        for (entry, impulse) in walls.iter().zip(impulses) {
            let wall = entry.condition;
            wall.reached(space, key, |nodes| {
                let of_row = velocity[nodes.clone()].iter_mut().zip(&mut increment[nodes.clone()]);
                for ((v, dv), f) in of_row.zip(&force[nodes]) {
                    let (mass, change) = (v.mass(), constrain::<D>(&wall, v));
                    if let Some(undamped) = undamped {
                        undo_damping(undamped, (v, dv, f), &change, impulse); // [BND-4]
                    }
                    for a in 0..D {
                        *dv.component_mut(a) += change[a];
                        impulse[a] += mass * change[a];
                    }
                }
            });
        }
    });
}

/// Takes from the impulse of a condition what local damping took from the force on the components
/// that it stopped.
fn undo_damping<const D: usize>(
    (gravity, dt): ([f64; 3], f64),
    (velocity, increment, force): (&Record, &Record, &Record),
    change: &[f64; D],
    impulse: &mut [f64; 3],
) {
    let mass = velocity.mass();
    for a in (0..D).filter(|a| change[*a] != 0.0 && velocity.component(*a) == 0.0) {
        let whole = dt * (force.component(a) + mass * gravity[a]);
        impulse[a] -= whole - mass * increment.component(a);
    }
}

/// Applies walls and prescribed velocities to the velocities of a grid that was mapped outside a
/// step; the forces of the last step stay.
pub fn hold_velocities<const D: usize>(
    background: &mut Background<D>,
    conditions: &Conditions,
    team: &Team,
) {
    let Nodes { velocity, increment, .. } = &mut background.nodes;
    increment.copy_from_slice(velocity);
    hold_at_boundaries(background, conditions, team);
    let Nodes { velocity, increment, .. } = &mut background.nodes;
    for (velocity, held) in velocity.iter_mut().zip(increment) {
        velocity.set_vector::<D>(held.vector());
    }
}

/// Turns the momentum of the second scatter into velocity and applies walls and prescribed
/// velocities to it.
pub fn apply_boundaries_again<const D: usize>(
    background: &mut Background<D>,
    conditions: &Conditions,
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
    hold_at_boundaries(background, conditions, team);
}

/// Applies walls and prescribed velocities to the velocities that stand in the increments.
pub fn hold_at_boundaries<const D: usize>(
    background: &mut Background<D>,
    conditions: &Conditions,
    team: &Team,
) {
    let walls = &conditions.walls;
    if !walls.is_empty() {
        for_each_block(background, 0, &mut Vec::new(), team, |space, key, records, _| {
            for entry in walls.iter() {
                let wall = entry.condition;
                wall.reached(space, key, |nodes| {
                    for increment in &mut records.increment[nodes] {
                        constrain::<D>(&wall, increment);
                    }
                });
            }
        });
    }
    conditions.hold_again(background);
}

/// Applies a wall to the velocity of a record and gives the change.
#[inline(always)]
fn constrain<const D: usize>(wall: &Wall, record: &mut Record) -> [f64; D] {
    let before: [f64; D] = record.vector();
    let after = wall.constrain(before);
    record.set_vector(after);
    std::array::from_fn(|a| after[a] - before[a])
}

/// Records of the nodes of a block.
struct Records<'a> {
    velocity: &'a mut [Record],
    increment: &'a mut [Record],
    force: &'a [Record],
}

/// Calls `work` for every block, with `sums` vectors of its own that are zero at first.
fn for_each_block<const D: usize>(
    background: &mut Background<D>,
    sums: usize,
    all_sums: &mut Vec<[f64; 3]>,
    team: &Team,
    work: impl Fn(&Space<D>, &Key<D>, Records<'_>, &mut [[f64; 3]]) + Sync,
) {
    let Background { space, blocks, nodes, .. } = background;
    let Nodes { velocity, increment, force } = nodes;
    let (n, keys) = (block_nodes(D), blocks.keys());
    all_sums.clear();
    all_sums.resize(keys.len() * sums, [0.0; 3]);
    let records = (Cut(&mut velocity[..], n), Cut(&mut increment[..], n), Cut(&force[..], n));
    let of_records = |block: usize, (velocity, increment, force), sums: &mut [[f64; 3]]| {
        work(space, &keys[block], Records { velocity, increment, force }, sums);
    };
    if sums == 0 {
        team.for_each_piece(records, GRAIN, |block, records| of_records(block, records, &mut []));
    } else {
        let with_sums = (records, Cut(&mut all_sums[..], sums));
        team.for_each_piece(with_sums, GRAIN, |block, (records, sums)| {
            of_records(block, records, sums);
        });
    }
}
