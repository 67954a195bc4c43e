//! Stage 1b, where the host allows retries: save what the step starts from, and restore it.
//!
//! Particles have been located, so their order, runs and blocks stay as they are. The copy costs as
//! much memory as the columns, and the time to write them once in a step. The grid is not saved: it
//! is mapped anew when it is read.

use crate::boundary::Conditions;
use crate::error::Result;
use crate::memory::reserve;
use crate::particles::Body;

/// What a step started from.
#[derive(Default)]
pub struct Start {
    columns: Vec<Vec<f64>>,
    /// Of all conditions, one after the other [N].
    forces: Vec<[f64; 3]>,
}

/// Copies the columns of all particles, and the forces of conditions.
pub fn save_start(bodies: &[Body], conditions: &mut Conditions, start: &mut Start) -> Result<()> {
    reserve(&mut start.columns, bodies.len(), "the start of a step")?;
    start.columns.resize_with(bodies.len(), Vec::new);
    for (body, columns) in bodies.iter().zip(&mut start.columns) {
        body.particles.copy_columns(columns)?;
    }
    start.forces.clear();
    let count = conditions.forces().count();
    reserve(&mut start.forces, count, "the start of a step")?;
    start.forces.extend(conditions.forces().map(|force| *force));
    Ok(())
}

/// Restores them.
pub fn back_to_start(bodies: &mut [Body], conditions: &mut Conditions, start: &Start) {
    for (body, start) in bodies.iter_mut().zip(&start.columns) {
        body.particles.restore_columns(start);
    }
    for (force, before) in conditions.forces().zip(&start.forces) {
        *force = *before;
    }
}
