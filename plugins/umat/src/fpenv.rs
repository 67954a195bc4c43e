//! The floating-point environment: a Fortran library may change rounding or set traps, and must not leave them behind.

use std::ffi::c_int;
use std::mem::MaybeUninit;

/// Room for a `fenv_t`: 32 bytes on x86-64, 8 on AArch64; larger than any known one.
#[repr(C, align(16))]
pub struct Environment([MaybeUninit<u8>; 128]);

#[link(name = "m")]
unsafe extern "C" {
    fn fegetenv(environment: *mut Environment) -> c_int;
    fn fesetenv(environment: *const Environment) -> c_int;
}

impl Environment {
    /// The environment of this thread.
    pub fn current() -> Self {
        let mut environment = Self([MaybeUninit::uninit(); 128]);
        // SAFETY: fegetenv writes a fenv_t, which fits into the struct.
        unsafe { fegetenv(&mut environment) };
        environment
    }
}

impl Drop for Environment {
    fn drop(&mut self) {
        // SAFETY: the environment was filled by fegetenv.
        unsafe { fesetenv(self) };
    }
}

/// The control bits of vector arithmetic, to be looked at between calls: rounding, traps, flushing to zero.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
pub fn control() -> u32 {
    let mut value = 0u32;
    // SAFETY: the instruction stores four bytes at the address.
    unsafe {
        std::arch::asm!("stmxcsr [{}]", in(reg) &raw mut value, options(nostack, preserves_flags));
    }
    value & !0x3f
}

/// Sets the control bits back if they are not as `wanted`.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
pub fn set_back(wanted: u32) {
    if control() != wanted {
        // SAFETY: the instruction loads four bytes that `control` has read before.
        unsafe {
            std::arch::asm!("ldmxcsr [{}]", in(reg) &raw const wanted, options(nostack, readonly));
        }
    }
}

/// Elsewhere the environment is set back after each batch only.
#[cfg(not(target_arch = "x86_64"))]
pub fn control() -> u32 {
    0
}

/// Elsewhere the environment is set back after each batch only.
#[cfg(not(target_arch = "x86_64"))]
pub fn set_back(_: u32) {}
