//! Statuses: the return values of functions.

use crate::error::Status;
use std::ffi::c_char;

/// Return value of a function: 0 done; positive: refused, nothing has changed; negative: the object
/// is poisoned, it answers queries and can be freed. 1 to 99: a mistake of the caller; 100 to 199:
/// numerics; 200 to 299: files, plugins and threads.
pub type lahar_status = i32;

/// Name of a status, such as "LAHAR_ERROR_BUSY"; "unknown status" if no status has this number.
/// The text is static: do not free it. Cannot fail.
/// Thread: any
#[unsafe(no_mangle)]
pub extern "C" fn lahar_status_name(status: lahar_status) -> *const c_char {
    let value = Status::LIST.values.iter().find(|value| value.number == status);
    value.map_or(c"unknown status", |value| value.constant_c).as_ptr()
}
