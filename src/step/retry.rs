//! Stage 1b, where the host allows retries: keep what the step starts from; and the way back to it.
//!
//! Particles have been located, so their order, runs and blocks stay as they are. The copy costs as much memory as the columns, and the
//! time to write them once in a step. What the grid held is not kept: it is mapped anew when somebody asks.

use crate::error::Result;
use crate::memory::reserve;
use crate::world::state::State;

/// What a step started from.
#[derive(Default)]
pub struct Start {
    columns: Vec<Vec<f64>>,
    /// Of walls, prescribed velocities and tractions, one after the other [N].
    forces: Vec<[f64; 3]>,
}

/// Copies the columns of all particles, and the forces of conditions.
pub fn keep_start<const D: usize>(world: &mut State<D>) -> Result<()> {
    let mut start = std::mem::take(&mut world.start);
    start.columns.resize_with(world.bodies.len(), Vec::new);
    for (body, columns) in world.bodies.iter().zip(&mut start.columns) {
        body.particles.copy_columns(columns)?;
    }
    start.forces.clear();
    let count =
        world.walls.len() + world.conditions.prescribed.len() + world.conditions.tractions.len();
    reserve(&mut start.forces, count, "the start of a step")?;
    start.forces.extend(forces(world).map(|force| *force));
    world.start = start;
    Ok(())
}

/// Brings them back.
pub fn back_to_start<const D: usize>(world: &mut State<D>) {
    for (body, start) in world.bodies.iter_mut().zip(&world.start.columns) {
        body.particles.restore_columns(start);
    }
    let start = std::mem::take(&mut world.start);
    for (force, before) in forces(world).zip(&start.forces) {
        *force = *before;
    }
    world.start = start;
    world.stale = true;
}

/// The forces of conditions that hosts can ask for.
fn forces<const D: usize>(world: &mut State<D>) -> impl Iterator<Item = &mut [f64; 3]> {
    let walls = world.walls.iter_mut().map(|entry| &mut entry.reaction);
    let prescribed = world.conditions.prescribed.iter_mut().map(|entry| &mut entry.reaction);
    let tractions = world.conditions.tractions.iter_mut().map(|entry| &mut entry.force);
    walls.chain(prescribed).chain(tractions)
}
