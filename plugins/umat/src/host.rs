//! The engine as the adapter sees it: its log, its error text, and the wall against panics.

use lahar_plugin_abi::*;
use std::any::Any;
use std::ffi::{CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr;
use std::sync::atomic::{AtomicPtr, Ordering};

static HOST: AtomicPtr<lahar_host_api> = AtomicPtr::new(ptr::null_mut());

/// Keeps the host table, if there is one that is long enough.
///
/// # Safety
///
/// `host` is NULL or points to a host table that stays valid for the life of the process.
pub unsafe fn keep(host: *const lahar_host_api) {
    // SAFETY: guaranteed by the caller; every table of the ABI begins with its size.
    let size = unsafe { host.cast::<u32>().as_ref() }.copied().unwrap_or(0) as usize;
    if size >= size_of::<lahar_host_api>() {
        HOST.store(host.cast_mut(), Ordering::Release);
    }
}

fn table() -> Option<&'static lahar_host_api> {
    // SAFETY: NULL, or a pointer that came through `keep`, whose caller guarantees that it lives as long.
    unsafe { HOST.load(Ordering::Acquire).as_ref() }
}

/// Hands a line to the host's log at one of `LAHAR_PLUGIN_LOG_*`.
pub fn log(level: i32, message: &str) {
    if let Some(log) = table().and_then(|h| h.log) {
        let message = c_string(message);
        // SAFETY: the string ends with a NUL and lives through the call, which copies it.
        unsafe { log(level, message.as_ptr()) };
    }
}

/// What the utility routine `STDB_ABQERR` of a user's library calls.
pub unsafe extern "C" fn log_text(level: i32, message: *const c_char) {
    if let Some(log) = table().and_then(|h| h.log) {
        // SAFETY: the utility routine passes a text that ends with a NUL; it is copied.
        unsafe { log(level, message) };
    }
}

/// Tells the host why the function that is running returns an error.
pub fn set_error(message: &str) {
    if let Some(set_error) = table().and_then(|h| h.set_error) {
        let message = c_string(message);
        // SAFETY: the string ends with a NUL and lives through the call, which copies it.
        unsafe { set_error(message.as_ptr()) };
    }
}

/// The text as a C string.
pub fn c_string(text: &str) -> CString {
    CString::new(text.replace('\0', " ")).unwrap_or_default()
}

/// Runs `body`; an error or a panic becomes None and a text for the host.
pub fn guard<T>(body: impl FnOnce() -> Result<T, String>) -> Option<T> {
    let text = match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(value)) => return Some(value),
        Ok(Err(text)) => text,
        Err(payload) => format!("panic in the UMAT adapter: {}", panic_text(payload.as_ref())),
    };
    set_error(&text);
    None
}

fn panic_text(payload: &(dyn Any + Send)) -> &str {
    let text = payload.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| payload.downcast_ref::<&str>().copied()).unwrap_or("without a text")
}
