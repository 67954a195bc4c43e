//! Makes plugins of lahar of shared libraries that export an Abaqus UMAT or VUMAT.
//!
//! The engine calls [`lahar_plugin_adapt_v1`], the only export, when a library has no entry of a plugin. What a UMAT does not contain,
//! names, units, bounds, the number of state variables, stands in an optional file beside the library (`sidecar`). `describe` makes
//! the tables of the ABI of both, `calls` has their functions, `umat` and `vumat` call the routine. README.md is the manual.

pub mod build;
mod calls;
mod describe;
mod fpenv;
mod host;
mod kinematics;
mod library;
mod modulus;
mod sdvini;
mod sidecar;
mod umat;
mod vumat;

use lahar_plugin_abi::{lahar_host_api, lahar_plugin_desc};
use std::ffi::{CStr, OsStr, c_char};
use std::os::unix::ffi::OsStrExt;
use std::path::Path;
use std::ptr;

/// A plugin of the library with a UMAT or VUMAT at `path`; NULL, after `set_error`, if it has none. The panic hook of this library's own
/// standard library is made silent, since a plugin must not print.
///
/// # Safety
///
/// As for [`adapt`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_plugin_adapt_v1(
    host: *const lahar_host_api,
    path: *const c_char,
) -> *const lahar_plugin_desc {
    std::panic::set_hook(Box::new(|_| ()));
    // SAFETY: guaranteed by the caller.
    unsafe { adapt(host, path) }
}

/// What [`lahar_plugin_adapt_v1`] does, for programs that link the adapter and have a panic hook of their own.
///
/// # Safety
///
/// `host` is NULL or a host table that stays valid for the life of the process, `path` is NULL or a text that ends with a NUL; one call at a
/// time. The initialisers of the library run.
pub unsafe fn adapt(host: *const lahar_host_api, path: *const c_char) -> *const lahar_plugin_desc {
    // SAFETY: guaranteed by the caller.
    unsafe { host::keep(host) };
    let adapted = host::guard(|| {
        if path.is_null() {
            return Err("the path of the library is NULL".into());
        }
        // SAFETY: not NULL, the rest is guaranteed by the caller.
        let path = Path::new(OsStr::from_bytes(unsafe { CStr::from_ptr(path) }.to_bytes()));
        describe::adapt(path)
    });
    adapted.map_or(ptr::null(), ptr::from_ref)
}
