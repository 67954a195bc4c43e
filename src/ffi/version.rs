//! Version of the library: constants of the header and their run-time twins.

use super::arguments::out;
use super::entry::entry;
use super::status::lahar_status;

/// Major version of this header.
pub const LAHAR_VERSION_MAJOR: i32 = 0;
/// Minor version of this header.
pub const LAHAR_VERSION_MINOR: i32 = 1;
/// Patch version of this header.
pub const LAHAR_VERSION_PATCH: i32 = 0;
/// Number of the binary interface of this header. A library is usable if `lahar_abi_version()`
/// returns the same number.
pub const LAHAR_ABI_VERSION: i32 = 1;

// The package's version is the one that counts.
const _: () = {
    const fn is_number(text: &str, number: i32) -> bool {
        matches!(i32::from_str_radix(text, 10), Ok(n) if n == number)
    }
    assert!(is_number(env!("CARGO_PKG_VERSION_MAJOR"), LAHAR_VERSION_MAJOR));
    assert!(is_number(env!("CARGO_PKG_VERSION_MINOR"), LAHAR_VERSION_MINOR));
    assert!(is_number(env!("CARGO_PKG_VERSION_PATCH"), LAHAR_VERSION_PATCH));
};

/// Version of the library that is running.
///
/// `major`, `minor`, `patch`: written; must not be NULL.
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_version(
    major: *mut i32,
    minor: *mut i32,
    patch: *mut i32,
) -> lahar_status {
    entry("lahar_version", |_| {
        // SAFETY: the host passes NULL or writable integers.
        let (a, b, c) =
            unsafe { (out(major, "major")?, out(minor, "minor")?, out(patch, "patch")?) };
        a.set(LAHAR_VERSION_MAJOR);
        b.set(LAHAR_VERSION_MINOR);
        c.set(LAHAR_VERSION_PATCH);
        Ok(())
    })
}

/// Number of the binary interface of the library that is running; compare with LAHAR_ABI_VERSION.
/// Cannot fail.
/// Thread: any
#[unsafe(no_mangle)]
pub extern "C" fn lahar_abi_version() -> i32 {
    LAHAR_ABI_VERSION
}
