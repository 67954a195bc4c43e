//! The floating-point environment: rounding, traps and flags belong to the host, the engine runs with the defaults.
//!
//! A Fortran host compiled with `-ffpe-trap=invalid,zero,overflow` traps on operations that are harmless inside the
//! engine. Every entry therefore saves the host's environment, sets the default one, and puts the host's back when it
//! leaves; callbacks of the host run in the host's environment.

use std::cell::Cell;
use std::ffi::c_int;
use std::mem::MaybeUninit;

#[cfg(not(any(target_os = "linux", target_os = "macos")))]
compile_error!("FE_DFL_ENV is not known for this system: add it to src/ffi/fpenv.rs");

/// Room for a `fenv_t`: 32 bytes on x86-64, 8 on AArch64; larger than any known one.
#[derive(Clone, Copy)]
#[repr(C, align(16))]
struct Environment([MaybeUninit<u8>; 128]);

#[link(name = "m")]
unsafe extern "C" {
    fn fegetenv(environment: *mut Environment) -> c_int;
    fn fesetenv(environment: *const Environment) -> c_int;
}

#[cfg(target_os = "macos")]
unsafe extern "C" {
    static _FE_DFL_ENV: Environment;
}

thread_local! {
    /// The host's environment while this thread is inside the library.
    static HOST: Cell<Option<Environment>> = const { Cell::new(None) };
}

/// `FE_DFL_ENV` of the system's `fenv.h`.
fn default_environment() -> *const Environment {
    #[cfg(target_os = "macos")]
    // SAFETY: only the address of the C library's object is taken.
    return unsafe { &raw const _FE_DFL_ENV };
    #[cfg(not(target_os = "macos"))]
    return std::ptr::without_provenance(usize::MAX);
}

/// Sets the default environment on this thread for good: round to nearest, no traps, no flags. For worker threads.
pub(crate) fn set_default() {
    // SAFETY: FE_DFL_ENV is a valid argument of fesetenv on every system that compiles this file.
    unsafe { fesetenv(default_environment()) };
}

fn current() -> Environment {
    let mut environment = Environment([MaybeUninit::uninit(); 128]);
    // SAFETY: fegetenv writes a fenv_t, which fits into the struct.
    unsafe { fegetenv(&mut environment) };
    environment
}

fn restore(environment: &Environment) {
    // SAFETY: the environment was filled by fegetenv.
    unsafe { fesetenv(environment) };
}

/// While it lives, this thread runs in the default environment; the drop puts the host's back.
pub(super) struct Guard {
    host: Environment,
    outer: Option<Environment>,
}

impl Guard {
    /// Saves the host's environment and sets the default one.
    pub(super) fn new() -> Self {
        let host = current();
        let outer = HOST.try_with(|h| h.replace(Some(host))).unwrap_or(None);
        set_default();
        Self { host, outer }
    }
}

impl Drop for Guard {
    fn drop(&mut self) {
        let _ = HOST.try_with(|h| h.set(self.outer));
        restore(&self.host);
    }
}

/// Calls the host's code in the host's environment.
pub(super) fn with_host<R>(f: impl FnOnce() -> R) -> R {
    let host = HOST.try_with(Cell::get).unwrap_or(None);
    if let Some(environment) = &host {
        restore(environment);
    }
    let result = f();
    if host.is_some() {
        set_default();
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    unsafe extern "C" {
        fn fesetround(mode: c_int) -> c_int;
        fn fegetround() -> c_int;
    }
    #[cfg(target_arch = "x86_64")]
    const UPWARD: c_int = 0x800;
    #[cfg(target_arch = "aarch64")]
    const UPWARD: c_int = 0x400000;

    #[test]
    fn the_guard_sets_the_default_environment_and_puts_the_hosts_back() {
        // SAFETY: plain C library calls on this thread; the mode is restored below.
        let round = || unsafe { fegetround() };
        let nearest = round();
        // SAFETY: as above.
        unsafe { fesetround(UPWARD) };
        {
            let _guard = Guard::new();
            assert_eq!(round(), nearest);
            assert_eq!(with_host(round), UPWARD);
            assert_eq!(round(), nearest);
        }
        assert_eq!(round(), UPWARD);
        // SAFETY: as above.
        unsafe { fesetround(nearest) };
    }
}
