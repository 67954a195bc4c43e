//! Stage 4, boundaries: walls change the velocities of the nodes they reach and take up the momentum; then come the velocities that are
//! [`prescribed`].
//!
//! A node that is held is not damped: its reaction is m Δv / dt − (f + m g), with the whole force, not with what local damping left of it.

pub mod prescribed;

use std::ops::Range;

use rayon::prelude::*;

use crate::background::key::block_nodes;
use crate::background::{EDGE, Key, Lanes};
use crate::boundary::Wall;
use crate::world::state::{Space, State, WallEntry};

use prescribed::{prescribe, prescribe_again};

/// Nodes this close to the reach of a wall, in cells, still count as reached: the round-off of positions.
const ROUND_OFF: f64 = 1e-9;

/// Applies walls and prescribed velocities to v_i and Δv_i and sums their forces on the material.
pub fn apply_boundaries<const D: usize>(world: &mut State<D>, dt: f64) {
    apply_walls(world, dt);
    prescribe(world, dt);
}

fn apply_walls<const D: usize>(world: &mut State<D>, dt: f64) {
    if world.walls.is_empty() {
        return;
    }
    let (gravity, damped) = (world.gravity(world.time + 0.5 * dt), world.options.damping > 0.0);
    for_each_block(world, |space, key, walls, Records { r0, r1, force }, impulses| {
        for (entry, impulse) in walls.iter().zip(impulses) {
            for_reached_nodes(&entry.wall, space, key, |n| {
                let mass = r0[n][0];
                let change = constrain::<D>(&entry.wall, &mut r0[n]);
                if damped {
                    for a in (0..D).filter(|a| change[*a] != 0.0 && r0[n][a + 1] == 0.0) {
                        let whole = dt * (force[n][a + 1] + mass * gravity[a]);
                        impulse[a] -= whole - mass * r1[n][a + 1]; // [BND-4]
                    }
                }
                for a in 0..D {
                    r1[n][a + 1] += change[a];
                    impulse[a] += mass * change[a];
                }
            });
        }
    });
    let count = world.walls.len();
    for (w, entry) in world.walls.iter_mut().enumerate() {
        let mut total = [0.0; 3];
        for slot in world.grid.order() {
            let impulse = world.impulses[*slot as usize * count + w];
            for a in 0..D {
                total[a] += impulse[a];
            }
        }
        entry.reaction = total.map(|impulse| impulse / dt); // [BND-4]
    }
}

/// Turns the momentum of the second scatter (R1) into velocity and applies walls and prescribed velocities to it.
pub fn apply_boundaries_again<const D: usize>(world: &mut State<D>) {
    for_each_block(world, |_, _, _, Records { r0, r1, .. }, _| {
        for (r0, r1) in r0.iter().zip(r1.iter_mut()) {
            *r1 = if r0[0] > 0.0 { r1.map(|momentum| momentum / r0[0]) } else { [0.0; 4] };
        }
    });
    hold_at_boundaries(world);
}

/// Applies the walls to the velocities in R1.
pub fn hold_at_boundaries<const D: usize>(world: &mut State<D>) {
    for_each_block(world, |space, key, walls, Records { r1, .. }, _| {
        for entry in walls {
            for_reached_nodes(&entry.wall, space, key, |n| {
                constrain::<D>(&entry.wall, &mut r1[n]);
            });
        }
    });
    prescribe_again(world);
}

/// Applies a wall to the velocity in lanes 1 to D and gives the change.
fn constrain<const D: usize>(wall: &Wall, node: &mut Lanes) -> [f64; D] {
    let before: [f64; D] = std::array::from_fn(|a| node[a + 1]);
    let after = wall.constrain(before);
    node[1..=D].copy_from_slice(&after);
    std::array::from_fn(|a| after[a] - before[a])
}

/// Calls `visit` with the places in block `key` of the nodes that the wall reaches.
pub fn for_reached_nodes<const D: usize>(
    wall: &Wall,
    space: &Space<D>,
    key: &Key<D>,
    mut visit: impl FnMut(usize),
) {
    let reached = reached_layers(wall, space, key);
    if reached.is_empty() {
        return;
    }
    let pitch = EDGE.pow((D - 1 - wall.axis) as u32);
    for slab in (0..block_nodes(D)).step_by(EDGE * pitch) {
        for layer in reached.clone() {
            let first = slab + layer * pitch;
            (first..first + pitch).for_each(&mut visit);
        }
    }
}

/// Layers of nodes of block `key`, along the wall's axis, that the wall reaches.
fn reached_layers<const D: usize>(wall: &Wall, space: &Space<D>, key: &Key<D>) -> Range<usize> {
    let at = (wall.position - space.origin[wall.axis]) / space.spacing;
    let reach = space.wall_reach + ROUND_OFF; // [BND-3]
    let lowest = f64::from(key[wall.axis]) * EDGE as f64;
    let clamp = |layer: f64| layer.clamp(0.0, EDGE as f64) as usize;
    if wall.side > 0 {
        0..clamp((at + reach).floor() - lowest + 1.0)
    } else {
        clamp((at - reach).ceil() - lowest)..EDGE
    }
}

/// Records of the nodes of a block.
struct Records<'a> {
    r0: &'a mut [Lanes],
    r1: &'a mut [Lanes],
    force: &'a [Lanes],
}

/// Calls `work` for every block.
fn for_each_block<const D: usize>(
    world: &mut State<D>,
    work: impl Fn(&Space<D>, &Key<D>, &[WallEntry], Records<'_>, &mut [[f64; 3]]) + Sync,
) {
    let (space, nodes, per_block) = (world.space(), block_nodes(D), world.walls.len().max(1));
    let State { grid, walls, impulses, .. } = world;
    let (keys, velocity, increment, force) = grid.keys_and_records();
    impulses.clear();
    impulses.resize(keys.len() * per_block, [0.0; 3]);
    if world.parallel {
        keys.par_iter()
            .zip(velocity.par_chunks_mut(nodes))
            .zip(increment.par_chunks_mut(nodes))
            .zip(force.par_chunks(nodes))
            .zip(impulses.par_chunks_mut(per_block))
            .for_each(|((((key, r0), r1), force), sums)| {
                work(&space, key, walls, Records { r0, r1, force }, sums);
            });
    } else {
        keys.iter()
            .zip(velocity.chunks_mut(nodes))
            .zip(increment.chunks_mut(nodes))
            .zip(force.chunks(nodes))
            .zip(impulses.chunks_mut(per_block))
            .for_each(|((((key, r0), r1), force), sums)| {
                work(&space, key, walls, Records { r0, r1, force }, sums);
            });
    }
}
