//! The table of functions that plugins get: log, error text, request to stop.

use crate::log::push_current;
use lahar_plugin_abi::{LAHAR_PLUGIN_ABI_MINOR, lahar_host_api};
use std::cell::RefCell;
use std::ffi::{CStr, c_char};

/// What is longer of a text of a plugin is cut off [bytes].
const LONGEST_TEXT: usize = 4096;

thread_local! {
    static ERROR: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// The host table; plugins may store its address.
pub(super) static HOST: lahar_host_api = lahar_host_api {
    struct_size: size_of::<lahar_host_api>() as u32,
    abi_minor: LAHAR_PLUGIN_ABI_MINOR,
    log: Some(log),
    set_error: Some(set_error),
    should_stop: Some(should_stop),
};

/// Takes the text that a plugin has set on this thread since the last call.
pub(super) fn take_error() -> Option<String> {
    ERROR.try_with(|e| e.try_borrow_mut().ok()?.take()).ok().flatten()
}

unsafe extern "C" fn log(level: i32, message: *const c_char) {
    // SAFETY: the ABI asks for NULL or a string that ends with a NUL.
    if let Some(text) = unsafe { text_of(message) } {
        push_current(level.max(0), &text);
    }
}

unsafe extern "C" fn set_error(message: *const c_char) {
    // SAFETY: as in `log`.
    let text = unsafe { text_of(message) };
    let _ = ERROR.try_with(|e| e.replace(text)); // a thread that is being destroyed stores no text
}

unsafe extern "C" fn should_stop() -> i32 {
    0
}

/// # Safety
///
/// `message` is NULL or points to a string that ends with a NUL.
unsafe fn text_of(message: *const c_char) -> Option<String> {
    if message.is_null() {
        return None;
    }
    // SAFETY: by contract of the caller.
    let bytes = unsafe { CStr::from_ptr(message) }.to_bytes();
    Some(String::from_utf8_lossy(&bytes[..bytes.len().min(LONGEST_TEXT)]).into_owned())
}
