//! Stage 1b, where the host allows retries: keep what the step starts from; and the way back to it.
//!
//! Particles have been located, so their order, runs and blocks stay as they are. The copy costs as much memory as the columns, and the
//! time to write them once in a step. What the grid held is not kept: it is mapped anew when somebody asks.

use crate::error::Result;
use crate::particles::reserve;
use crate::world::state::State;

/// What a step started from.
#[derive(Default)]
pub struct Start {
    columns: Vec<Vec<f64>>,
    /// Of walls, then of prescribed velocities [N].
    reactions: Vec<[f64; 3]>,
}

/// Copies the columns of all particles, and the reactions.
pub fn keep_start<const D: usize>(world: &mut State<D>) -> Result<()> {
    let Start { columns, reactions } = &mut world.start;
    columns.resize_with(world.bodies.len(), Vec::new);
    for (body, start) in world.bodies.iter().zip(columns) {
        body.particles.copy_columns(start)?;
    }
    let prescribed = &world.conditions.prescribed;
    reactions.clear();
    reserve(reactions, world.walls.len() + prescribed.len(), "the start of a step")?;
    reactions.extend(world.walls.iter().map(|entry| entry.reaction));
    reactions.extend(prescribed.iter().map(|entry| entry.reaction));
    Ok(())
}

/// Brings them back.
pub fn back_to_start<const D: usize>(world: &mut State<D>) {
    for (body, start) in world.bodies.iter_mut().zip(&world.start.columns) {
        body.particles.restore_columns(start);
    }
    let walls = world.walls.iter_mut().map(|entry| &mut entry.reaction);
    let prescribed = world.conditions.prescribed.iter_mut().map(|entry| &mut entry.reaction);
    for (reaction, start) in walls.chain(prescribed).zip(&world.start.reactions) {
        *reaction = *start;
    }
    world.stale = true;
}
