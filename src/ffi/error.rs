//! The last error: a text for people and a struct for programs. A call that fails records its error
//! for the calling thread and for the context; a call that succeeds does not clear it.

use super::arguments::{Grows, copy_text, optional_out, reference, struct_out};
use super::context::lahar_context;
use super::entry::{status_only, with_last_error};
use super::status::lahar_status;
use std::ffi::c_char;

/// Where and why a call failed, for programs.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_error_info {
    /// sizeof(lahar_error_info); set by the host.
    pub struct_size: u32,
    /// The status that the call returned; LAHAR_OK if no call of this thread has failed yet.
    pub code: lahar_status,
    /// Id of the body; -1 if unknown.
    pub body: i64,
    /// Id of the particle inside its body, counted from 0 in the order of insertion; -1 if unknown.
    pub particle: i64,
    /// Number of committed steps before the one that failed; -1 if unknown.
    pub step: i64,
    /// Time at the start of the step that failed [s]; 0 if unknown.
    pub time: f64,
    /// Time step that would be accepted [s]; 0 if unknown.
    pub suggested_dt: f64,
}

// SAFETY: repr(C), begins with a u32, no padding (layout.rs), numbers only.
unsafe impl Grows for lahar_error_info {
    const NAME: &'static str = "lahar_error_info";
    const FIRST: usize = 48;
}

/// Text of the last error of the calling thread: which function, what was expected, what was
/// received, what to do.
///
/// `buffer`: `capacity` bytes, gets the text in UTF-8 with a NUL; may be NULL if `capacity` is 0,
/// to ask for the size.
/// `needed`: gets the size of the text with its NUL; may be NULL.
///
/// Errors of this function do not change the last error.
///
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_last_error_message(
    buffer: *mut c_char,
    capacity: i64,
    needed: *mut i64,
) -> lahar_status {
    status_only(|| {
        // SAFETY: the host passes NULL or a writable integer.
        let needed = unsafe { optional_out(needed, "needed") }?;
        // SAFETY: the host passes NULL or `capacity` writable bytes.
        with_last_error(|_, message, _| unsafe {
            copy_text(message, (buffer, capacity), needed.as_ref())
        })
    })
}

/// The last error of the calling thread, for programs.
///
/// `info`: written; the host has set `struct_size`.
///
/// Errors of this function do not change the last error.
///
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_last_error_info(info: *mut lahar_error_info) -> lahar_status {
    status_only(|| {
        // SAFETY: the host passes NULL or a writable struct.
        let info = unsafe { struct_out(info, "info") }?;
        let (status, place) = with_last_error(|status, _, place| (status, place));
        info.set(lahar_error_info {
            struct_size: 0,
            code: status as lahar_status,
            body: place.body.unwrap_or(-1),
            particle: place.particle.unwrap_or(-1),
            step: place.step.unwrap_or(-1),
            time: place.time.unwrap_or(0.0),
            suggested_dt: place.suggested_dt.unwrap_or(0.0),
        });
        Ok(())
    })
}

/// Text of the last error of any call on this context, its worlds, materials and views, from any
/// thread.
///
/// `buffer`, `capacity`, `needed`: as in lahar_last_error_message.
///
/// Errors of this function do not change the last error.
///
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_context_error_message(
    context: *const lahar_context,
    buffer: *mut c_char,
    capacity: i64,
    needed: *mut i64,
) -> lahar_status {
    status_only(|| {
        // SAFETY: the host passes NULL or a live handle.
        let cell = unsafe { reference(context, "context") }?.cell.clone();
        // SAFETY: the host passes NULL or a writable integer.
        let needed = unsafe { optional_out(needed, "needed") }?;
        // SAFETY: the host passes NULL or `capacity` writable bytes.
        cell.with_error_message(|message| unsafe {
            copy_text(message, (buffer, capacity), needed.as_ref())
        })
    })
}
