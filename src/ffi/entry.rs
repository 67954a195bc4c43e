//! The one boundary between C and the engine.
//!
//! [`entry`] runs the body of every exported function that can fail. On the way in it silences the
//! panic hook for this thread and sets the default floating-point environment. On the way out it
//! turns an error or a panic into a status, records the error for `lahar_last_error_*` and for the
//! context, poisons the world after a panic, and delivers the log lines that were queued. By then
//! every lock is released, so callbacks may call the library.

use super::answers;
use super::cells::{ContextCell, WorldCell};
use super::status::lahar_status;
use crate::error::{Error, Place, Result, Status, one_line};
use crate::memory;
use crate::platform::{self, Silence};
use crate::simd::environment;
use std::any::Any;
use std::cell::{Cell, RefCell};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex};

thread_local! {
    /// Where the last silent panic of this thread happened.
    static PANIC_LOCATION: RefCell<Option<String>> = const { RefCell::new(None) };
    /// The error of the last call of this thread that failed.
    static LAST_ERROR: RefCell<Option<Error>> = const { RefCell::new(None) };
    /// Whether another call failed since then, with not even memory for its message.
    static NO_MEMORY: Cell<bool> = const { Cell::new(false) };
}

/// Longest message [bytes]; one that names a path may be that long.
const LONGEST_MESSAGE: usize = 8192;

/// End of the message of an error that the function is not documented to return; tests look for it.
const UNDOCUMENTED: &str = " (this status is not documented for this function: please report it)";

/// The objects that a call works on. They live until the log is flushed, even if a callback frees
/// the handle.
#[derive(Default)]
pub(super) struct Scope {
    context: Option<Arc<ContextCell>>,
    world: Option<Arc<WorldCell>>,
}

impl Scope {
    /// Errors and log lines of this call belong to `context`.
    pub(super) fn attach_context(&mut self, context: &Arc<ContextCell>) {
        self.context = Some(context.clone());
    }

    /// As [`Scope::attach_context`]; a panic in this call poisons `world`.
    pub(super) fn attach_world(&mut self, world: &Arc<WorldCell>) {
        self.attach_context(&world.context);
        self.world = Some(world.clone());
    }

    fn finish(self, function: &str, outcome: std::thread::Result<Result<()>>) -> Status {
        let result = outcome.unwrap_or_else(|payload| {
            if let Some(world) = &self.world {
                world.poison();
            }
            Err(panic_error(payload))
        });
        let status = match result {
            Ok(()) => Status::Ok,
            Err(mut error) => {
                let message = one_line(&error.message, LONGEST_MESSAGE);
                error.message = format!("{function}: {message}");
                if answers::is_unexpected(function, error.status) {
                    error.message += UNDOCUMENTED;
                }
                self.record_error(error)
            }
        };
        if let Some(context) = &self.context {
            context.context.flush_log();
        }
        status
    }

    fn record_error(&self, error: Error) -> Status {
        let status = error.status;
        if let Some(context) = &self.context {
            context.set_last_error(error.clone());
        }
        let _ = LAST_ERROR.try_with(|last| last.replace(Some(error)));
        NO_MEMORY.set(false);
        status
    }
}

/// Runs the body of an exported function; `function` is its name, for the message.
pub(super) fn entry(function: &str, body: impl FnOnce(&mut Scope) -> Result<()>) -> lahar_status {
    if !memory::has_spare() {
        NO_MEMORY.set(true);
        return Status::OutOfMemory as lahar_status;
    }
    install_hook();
    let _silence = Silence::enter();
    let _environment = environment::Guard::new();
    let status = catch_unwind(AssertUnwindSafe(|| {
        let mut scope = Scope::default();
        let outcome = catch_unwind(AssertUnwindSafe(|| body(&mut scope)));
        scope.finish(function, outcome)
    }));
    status.unwrap_or(Status::Panic) as lahar_status
}

/// Runs code without errors, such as a destructor, under the same protection; a panic ends here.
pub(super) fn quiet_entry(body: impl FnOnce()) {
    install_hook();
    let _silence = Silence::enter();
    let _environment = environment::Guard::new();
    let _ = catch_unwind(AssertUnwindSafe(body));
}

/// Runs the body of a function that asks for the last error and therefore must not replace it.
pub(super) fn status_only(body: impl FnOnce() -> Result<()>) -> lahar_status {
    let mut status = Status::Panic;
    quiet_entry(|| status = body().map_or_else(|error| error.status, |()| Status::Ok));
    status as lahar_status
}

/// Calls a function of the host: in its floating-point environment, and with its own panic hook.
pub(super) fn call_host<R>(f: impl FnOnce() -> R) -> R {
    platform::aloud(|| environment::with_host(f))
}

/// Calls `f` with status, message and place of the last error of this thread.
pub(super) fn with_last_error<R>(f: impl Fn(Status, &str, Place) -> R) -> R {
    let none = || f(Status::Ok, "", Place::default());
    if NO_MEMORY.get() {
        return f(Status::OutOfMemory, "there is not even memory for a message", Place::default());
    }
    let of = |error: &Error| f(error.status, &error.message, error.place);
    LAST_ERROR
        .try_with(|last| last.borrow().as_ref().map_or_else(none, of))
        .unwrap_or_else(|_| none())
}

/// Installs, once in a process, a panic hook that is silent on threads inside the library and calls
/// the previous hook on others.
fn install_hook() {
    static INSTALLED: Mutex<bool> = Mutex::new(false);
    thread_local!(static SEEN: Cell<bool> = const { Cell::new(false) });
    // A thread that is unwinding must not touch the hook; the next call does.
    if SEEN.try_with(Cell::get).unwrap_or(true) || std::thread::panicking() {
        return;
    }
    let mut installed = INSTALLED.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    if !*installed {
        let previous = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if !platform::is_silent() {
                previous(info);
            } else {
                let location = info.location().map(|at| format!(" at {}:{}", at.file(), at.line()));
                let _ = PANIC_LOCATION.try_with(|last| last.replace(location));
            }
        }));
        *installed = true;
    }
    let _ = SEEN.try_with(|seen| seen.set(true));
}

fn panic_error(payload: Box<dyn Any + Send>) -> Error {
    let text = match (payload.downcast_ref::<&str>(), payload.downcast_ref::<String>()) {
        (Some(text), _) => text,
        (_, Some(text)) => text.as_str(),
        _ => "no message",
    };
    let location = PANIC_LOCATION.try_with(|last| last.take()).unwrap_or(None).unwrap_or_default();
    Error::new(
        Status::Panic,
        format!("a defect of lahar was caught{location}: {text}; please report it"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message() -> String {
        with_last_error(|_, message, _| message.to_string())
    }

    #[test]
    fn a_panic_becomes_a_status_and_a_message_and_the_next_call_works() {
        let status = entry("lahar_test", |_| panic!("number {}", 7));
        assert_eq!(status, Status::Panic as i32);
        let message = message();
        assert!(message.starts_with("lahar_test: a defect of lahar was caught at "), "{message}");
        assert!(message.contains("number 7"), "{message}");
        assert_eq!(entry("lahar_test", |_| Ok(())), 0);
    }

    #[test]
    fn an_answer_that_is_not_documented_is_marked() {
        let refuse = |status| move |_: &mut Scope| Err(Error::new(status, "no"));
        entry("lahar_version", refuse(Status::Busy));
        assert_eq!(message(), format!("lahar_version: no{UNDOCUMENTED}"));
        entry("lahar_version", refuse(Status::NullArgument));
        assert_eq!(message(), "lahar_version: no");
    }

    #[test]
    fn a_panic_of_the_host_outside_of_lahar_reaches_the_previous_hook() {
        assert_eq!(entry("lahar_test", |_| Ok(())), 0);
        assert!(!platform::is_silent());
        let inside = Cell::new(false);
        entry("lahar_test", |_| {
            inside.set(platform::is_silent());
            assert!(!call_host(platform::is_silent));
            Ok(())
        });
        assert!(inside.get());
    }
}
