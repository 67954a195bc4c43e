//! The floating-point environment: rounding, traps and flags belong to the host, the engine runs
//! with the defaults.
//!
//! A Fortran host compiled with `-ffpe-trap=invalid,zero,overflow` traps on operations that are
//! harmless inside the engine. Every entry therefore saves the host's environment, sets the default
//! one, and puts the host's back when it leaves; callbacks of the host run in the host's
//! environment.

use std::cell::Cell;
use std::ffi::c_int;
use std::mem::MaybeUninit;

#[cfg(not(any(target_os = "linux", target_os = "macos")))]
compile_error!("FE_DFL_ENV is not known for this system: add it to src/simd/environment.rs");

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

/// Sets the default environment on this thread for good: round to nearest, no traps, no flags. For
/// worker threads.
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

/// How this thread computes: rounding, traps, and whether tiny numbers are taken for zero.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct Control(u64);

impl Control {
    /// What differs from another, in words.
    pub(crate) fn changed(self, from: Control) -> &'static str {
        let bits = self.0 ^ from.0;
        match cfg!(target_arch = "x86_64") {
            true if bits & 0x6000 != 0 => "the rounding",
            true if bits & 0x1f80 != 0 => "the traps",
            true if bits & 0x8040 != 0 => "tiny numbers are taken for zero or no longer",
            true => "the x87 control word",
            false => "its control bits",
        }
    }
}

/// The control bits of this thread; the flags that operations raise are none of them.
pub(crate) fn control() -> Control {
    let environment = current();
    let word = |first: usize, count: usize| {
        environment.0[first..first + count].iter().rev().fold(0, |word, byte| {
            // SAFETY: fegetenv has written at least 32 bytes on x86-64 and 8 on AArch64.
            word << 8 | u64::from(unsafe { byte.assume_init() })
        })
    };
    #[cfg(target_arch = "x86_64")]
    return Control(word(0, 2) << 32 | word(28, 4) & !0x3f); // x87 control, MXCSR less its flags
    #[cfg(not(target_arch = "x86_64"))]
    return Control(word(0, 4)); // FPCR
}

/// While it lives, this thread runs in the default environment; the drop puts the host's back.
pub(crate) struct Guard {
    host: Environment,
    outer: Option<Environment>,
}

impl Guard {
    /// Saves the host's environment and sets the default one.
    pub(crate) fn new() -> Self {
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
pub(crate) fn with_host<R>(f: impl FnOnce() -> R) -> R {
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
            let inside = control();
            assert!(with_host(control) != inside && control() == inside);
            // raises a flag, no control bit
            std::hint::black_box(std::hint::black_box(1.0_f64) / 3.0);
            assert!(control() == inside);
            assert_eq!(with_host(round), UPWARD);
            assert_eq!(round(), nearest);
        }
        assert_eq!(round(), UPWARD);
        // SAFETY: as above.
        unsafe { fesetround(nearest) };
    }
}
