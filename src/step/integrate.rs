//! The explicit integrator: one step, repeated smaller where materials fail or request that.
//!
//! What drives a world calls [`integrate`]; another integrator is another such function beside it.

use super::parts::Parts;
use super::retry::back_to_start;
use super::step;
use super::update_stress::{Failure, Unreliable, Wish};
use crate::error::Error;

/// A step that was made.
#[derive(Clone, Copy, Debug)]
pub struct Done {
    /// Its length [s].
    pub dt: f64,
    /// What the stress updates reported on their accuracy.
    pub unreliable: Option<Unreliable>,
}

/// Why there was no step.
pub enum Stop {
    /// It failed; nothing was done, or the world is broken, as the status says.
    Failed(Box<Failure>),
    /// It was taken back, and may not be repeated any more.
    TakenBack {
        /// Length of the last attempt [s].
        dt: f64,
        /// A length that may succeed [s].
        wanted: f64,
        /// The failure in the last attempt, if there was one.
        failure: Option<Box<Failure>>,
        /// The smallest step that a point requested.
        wish: Option<Wish>,
    },
}

/// Makes a step of `dt` [s], or a smaller one if a material requests that, `shorter` allows it, and
/// the host lets steps be repeated.
pub fn integrate<const D: usize>(
    world: &mut Parts<D>,
    mut dt: f64,
    shorter: bool,
) -> Result<Done, Stop> {
    let retries = world.method.options.retries;
    let mut left = if shorter { retries } else { 0 };
    loop {
        let time = world.clock.time;
        if time + dt == time {
            return Err(failed(world, does_not_change(time, dt)));
        }
        let team = world.team.clone();
        let outcome = match team.run(|| step(&mut *world, dt)) {
            Ok(outcome) => outcome,
            Err(error) => return Err(failed(world, error)),
        };
        let (unreliable, wish) = (outcome.unreliable(), outcome.wish());
        let (wanted, failure) = match outcome.limits(dt) {
            Ok(limits) if retries == 0 || limits.wanted_dt >= dt => {
                world.clock.step += 1;
                world.clock.time += dt;
                world.freshness.stepped(limits, world.clock.time - 0.5 * dt);
                return Ok(Done { dt, unreliable });
            }
            Ok(limits) => (limits.wanted_dt, None),
            Err(failure) if retries > 0 && failure.of_a_point => (0.5 * dt, Some(failure)),
            Err(failure) => return Err(failed(world, failure)),
        };
        let Parts { bodies, conditions, buffers, freshness, .. } = world;
        back_to_start(bodies, conditions, &buffers.start);
        freshness.taken_back();
        if left == 0 {
            let failure = failure.map(|failure| placed(world, failure));
            return Err(Stop::TakenBack { dt, wanted, failure, wish });
        }
        left -= 1;
        dt = wanted;
    }
}

fn failed<const D: usize>(world: &Parts<D>, failure: impl Into<Box<Failure>>) -> Stop {
    Stop::Failed(placed(world, failure.into()))
}

/// The failure, with the step and the time at which it happened.
fn placed<const D: usize>(world: &Parts<D>, mut failure: Box<Failure>) -> Box<Failure> {
    let (at, now) = (&mut failure.error.place, world.clock.place());
    (at.step, at.time) = (now.step, now.time);
    failure
}

fn does_not_change(time: f64, dt: f64) -> Error {
    Error::invalid(format!(
        "a step of {dt:e} s does not change the time, {time} s: something is too fast or too stiff for the spacing, or a \
         material asks for smaller and smaller steps"
    ))
}
