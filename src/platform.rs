//! Threads whose panics print nothing: callers inside an entry of the C interface, and workers for
//! all their life.

use std::cell::Cell;

thread_local! {
    /// How many entries this thread is inside of; a worker thread always counts as inside.
    static INSIDE: Cell<u32> = const { Cell::new(0) };
}

/// Panics of this thread print nothing from now on: for the worker threads of a pool.
pub(crate) fn silence() {
    let _ = INSIDE.try_with(|inside| inside.set(inside.get() + 1));
}

/// Whether panics of this thread print nothing now.
pub(crate) fn is_silent() -> bool {
    INSIDE.try_with(Cell::get).unwrap_or(0) > 0
}

/// Runs code of the host, whose panics are its own.
pub(crate) fn aloud<R>(f: impl FnOnce() -> R) -> R {
    let depth = INSIDE.try_with(|inside| inside.replace(0)).unwrap_or(0);
    let result = f();
    let _ = INSIDE.try_with(|inside| inside.set(depth));
    result
}

/// While it lives, panics of this thread print nothing.
pub(crate) struct Silence;

impl Silence {
    pub(crate) fn enter() -> Self {
        silence();
        Self
    }
}

impl Drop for Silence {
    fn drop(&mut self) {
        let _ = INSIDE.try_with(|inside| inside.set(inside.get().saturating_sub(1)));
    }
}
