//! Stage 1b, where the host allows retries: keep what the step starts from; and the way back to it.
//!
//! Particles have been located, so their order, runs and blocks stay as they are. The copy costs as much memory as the columns, and the
//! time to write them once in a step.

use crate::error::Result;
use crate::world::state::State;

/// Copies the columns of all particles.
pub fn keep_start<const D: usize>(world: &mut State<D>) -> Result<()> {
    world.start.resize_with(world.bodies.len(), Vec::new);
    for (body, start) in world.bodies.iter().zip(&mut world.start) {
        body.particles.copy_columns(start)?;
    }
    Ok(())
}

/// Brings the columns back.
pub fn back_to_start<const D: usize>(world: &mut State<D>) {
    for (body, start) in world.bodies.iter_mut().zip(&world.start) {
        body.particles.restore_columns(start);
    }
}
