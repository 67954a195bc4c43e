//! Progress: the host is called between steps, and may cancel what is left of them.

use super::entry::{call_host, entry};
use super::status::lahar_status;
use super::world::lahar_world;
use crate::error::{Error, Result, Status};
use std::ffi::c_void;
use std::time::Duration;

/// Is told how far lahar_world_advance or lahar_world_settle is: the number of steps that the call
/// has committed, the time of the world [s], and the pointer given to lahar_world_set_progress.
/// Returns 0 to go on; anything else cancels the call with LAHAR_ERROR_CANCELLED. Called on the
/// thread that called lahar, in the host's floating-point environment, between two steps. It may call
/// functions tagged `callback-ok` or `any`, on this world too, for instance lahar_world_write_vtp;
/// functions that change the world return LAHAR_ERROR_BUSY. It must not unwind, throw or longjmp.
pub type lahar_progress_callback =
    Option<unsafe extern "C" fn(steps_done: i64, time: f64, user: *mut c_void) -> i32>;

/// The callback of a world.
#[derive(Clone, Copy)]
pub(super) struct Progress {
    callback: unsafe extern "C" fn(i64, f64, *mut c_void) -> i32,
    user: *mut c_void,
    /// Shortest time between two calls.
    pub(super) interval: Duration,
}

// SAFETY: the pointer is never followed here; lahar_world_set_progress documents that it is passed
// to the callback on the thread that steps the world.
unsafe impl Send for Progress {}

impl Progress {
    /// Calls the host; the error if it cancels.
    pub(super) fn call(&self, steps: i64, time: f64) -> Result<()> {
        // SAFETY: the host promised a function of this type that can be called until it is replaced.
        let answer = call_host(|| unsafe { (self.callback)(steps, time, self.user) });
        if answer == 0 {
            return Ok(());
        }
        let text = format!(
            "the progress callback returned {answer}: stopped after {steps} steps, at {time} s; the world can go on"
        );
        Err(Error::new(Status::Cancelled, text))
    }
}

/// Sets who is called between the steps of lahar_world_advance and lahar_world_settle, and may cancel
/// them. Results do not depend on it. A host with an interpreter lets it look for signals there.
///
/// `callback`: see lahar_progress_callback; NULL: nobody is called.
/// `user`: passed to the callback; lahar does not follow it. Both must stay valid until they are
/// replaced by another call or the world is freed, and until calls that run meanwhile have returned.
/// `interval`: shortest time between two calls [s of the clock on the wall], >= 0, finite; 0: after
/// every step. A step is never interrupted, so that the callback comes late by up to a step.
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_world_set_progress(
    world: *mut lahar_world,
    callback: lahar_progress_callback,
    user: *mut c_void,
    interval: f64,
) -> lahar_status {
    entry("lahar_world_set_progress", |scope| {
        // SAFETY: the host passes NULL or a live handle.
        let cell = unsafe { scope.world(world) }?;
        let Ok(interval) = Duration::try_from_secs_f64(interval) else {
            let text = format!("the interval must be finite and >= 0 [s], got {interval}");
            return Err(Error::invalid(text));
        };
        cell.set_progress(callback.map(|callback| Progress { callback, user, interval }));
        Ok(())
    })
}
