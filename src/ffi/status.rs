//! Statuses: what every function answers.

use crate::error::Status;
use std::ffi::{CStr, c_char};

/// What a function answers: 0 done; positive: refused, nothing has changed; negative: the object is poisoned, it
/// answers queries and can be freed. 1 to 99: a mistake of the caller; 100 to 199: numerics; 200 to 299: files,
/// plugins and threads.
pub type lahar_status = i32;

/// Done.
pub const LAHAR_OK: i32 = 0;
/// A pointer that must not be NULL is NULL.
pub const LAHAR_ERROR_NULL_ARGUMENT: i32 = 1;
/// `struct_size` is not one that this library knows, or the unknown tail is not zero.
pub const LAHAR_ERROR_STRUCT_SIZE: i32 = 2;
/// A value is not finite, of the wrong sign, or not one of those allowed.
pub const LAHAR_ERROR_INVALID_ARGUMENT: i32 = 3;
/// No model, parameter or field has this name; the message tells the closest one.
pub const LAHAR_ERROR_UNKNOWN_NAME: i32 = 4;
/// A required parameter of a model is missing.
pub const LAHAR_ERROR_MISSING_PARAMETER: i32 = 5;
/// A parameter lies outside its hard bounds, or the model refuses the combination.
pub const LAHAR_ERROR_OUT_OF_BOUNDS: i32 = 6;
/// No body, wall or plugin has this id.
pub const LAHAR_ERROR_NOT_FOUND: i32 = 7;
/// A view is open that forbids the call.
pub const LAHAR_ERROR_VIEW_OPEN: i32 = 8;
/// The view's data belong to an earlier step.
pub const LAHAR_ERROR_VIEW_STALE: i32 = 9;
/// Another thread is using the object.
pub const LAHAR_ERROR_BUSY: i32 = 10;
/// The field can be read but not written.
pub const LAHAR_ERROR_READ_ONLY: i32 = 11;
/// This combination of options is not supported; the message tells the nearest that is.
pub const LAHAR_ERROR_UNSUPPORTED: i32 = 12;
/// An array is shorter than the result; the needed size is given.
pub const LAHAR_ERROR_BUFFER_TOO_SMALL: i32 = 13;
/// The time step exceeds the stable one; nothing was done.
pub const LAHAR_ERROR_STEP_TOO_LARGE: i32 = 100;
/// The host left a value in a particle field that is not finite, not positive where it must be, or a position outside the
/// grid; nothing was done.
pub const LAHAR_ERROR_NON_FINITE_INPUT: i32 = 101;
/// A particle stands outside the box of a static grid, or beyond the range of block coordinates; nothing was done.
pub const LAHAR_ERROR_OUTSIDE_GRID: i32 = 102;
/// A material failed or asked for a smaller time step; nothing was done. Only with the option `retries`.
pub const LAHAR_ERROR_SMALLER_STEP: i32 = 103;
/// A material gave no wave speed or no first state; nothing was done.
pub const LAHAR_ERROR_MATERIAL_REFUSED: i32 = 104;
/// A file could not be read or written.
pub const LAHAR_ERROR_FILE: i32 = 200;
/// The plugin file is missing.
pub const LAHAR_ERROR_PLUGIN_NOT_FOUND: i32 = 201;
/// The file is not a plugin, or its tables break the rules.
pub const LAHAR_ERROR_PLUGIN_INVALID: i32 = 202;
/// The plugin speaks another major version of the plugin ABI.
pub const LAHAR_ERROR_PLUGIN_ABI: i32 = 203;
/// The plugin refused to load.
pub const LAHAR_ERROR_PLUGIN_REFUSED: i32 = 204;
/// Threads could not be started, or the process was forked after they were.
pub const LAHAR_ERROR_THREADS: i32 = 205;
/// The memory for particles or grid is not to be had; nothing has changed.
pub const LAHAR_ERROR_OUT_OF_MEMORY: i32 = 206;
/// A defect of lahar was caught; the object is poisoned.
pub const LAHAR_ERROR_PANIC: i32 = -1;
/// A material failed at a point in the middle of a step; the world is poisoned.
pub const LAHAR_ERROR_MATERIAL_FAILED: i32 = -2;
/// A particle's state became infinite or not a number in a step; the world is poisoned.
pub const LAHAR_ERROR_NON_FINITE: i32 = -3;
/// The object was poisoned by an earlier call; it can only be queried and freed.
pub const LAHAR_ERROR_POISONED: i32 = -4;
/// A plugin broke its contract, which LAHAR_CHECK_PLUGINS=1 found; in a step the world is poisoned.
pub const LAHAR_ERROR_PLUGIN_BROKEN: i32 = -5;

/// Each status with the constant that carries its value and the constant's name.
pub(super) const TABLE: [(Status, i32, &CStr); Status::ALL.len()] = [
    (Status::Ok, LAHAR_OK, c"LAHAR_OK"),
    (Status::NullArgument, LAHAR_ERROR_NULL_ARGUMENT, c"LAHAR_ERROR_NULL_ARGUMENT"),
    (Status::StructSize, LAHAR_ERROR_STRUCT_SIZE, c"LAHAR_ERROR_STRUCT_SIZE"),
    (Status::InvalidArgument, LAHAR_ERROR_INVALID_ARGUMENT, c"LAHAR_ERROR_INVALID_ARGUMENT"),
    (Status::UnknownName, LAHAR_ERROR_UNKNOWN_NAME, c"LAHAR_ERROR_UNKNOWN_NAME"),
    (Status::MissingParameter, LAHAR_ERROR_MISSING_PARAMETER, c"LAHAR_ERROR_MISSING_PARAMETER"),
    (Status::OutOfBounds, LAHAR_ERROR_OUT_OF_BOUNDS, c"LAHAR_ERROR_OUT_OF_BOUNDS"),
    (Status::NotFound, LAHAR_ERROR_NOT_FOUND, c"LAHAR_ERROR_NOT_FOUND"),
    (Status::ViewOpen, LAHAR_ERROR_VIEW_OPEN, c"LAHAR_ERROR_VIEW_OPEN"),
    (Status::ViewStale, LAHAR_ERROR_VIEW_STALE, c"LAHAR_ERROR_VIEW_STALE"),
    (Status::Busy, LAHAR_ERROR_BUSY, c"LAHAR_ERROR_BUSY"),
    (Status::ReadOnly, LAHAR_ERROR_READ_ONLY, c"LAHAR_ERROR_READ_ONLY"),
    (Status::Unsupported, LAHAR_ERROR_UNSUPPORTED, c"LAHAR_ERROR_UNSUPPORTED"),
    (Status::BufferTooSmall, LAHAR_ERROR_BUFFER_TOO_SMALL, c"LAHAR_ERROR_BUFFER_TOO_SMALL"),
    (Status::StepTooLarge, LAHAR_ERROR_STEP_TOO_LARGE, c"LAHAR_ERROR_STEP_TOO_LARGE"),
    (Status::NonFiniteInput, LAHAR_ERROR_NON_FINITE_INPUT, c"LAHAR_ERROR_NON_FINITE_INPUT"),
    (Status::OutsideGrid, LAHAR_ERROR_OUTSIDE_GRID, c"LAHAR_ERROR_OUTSIDE_GRID"),
    (Status::SmallerStep, LAHAR_ERROR_SMALLER_STEP, c"LAHAR_ERROR_SMALLER_STEP"),
    (Status::MaterialRefused, LAHAR_ERROR_MATERIAL_REFUSED, c"LAHAR_ERROR_MATERIAL_REFUSED"),
    (Status::File, LAHAR_ERROR_FILE, c"LAHAR_ERROR_FILE"),
    (Status::PluginNotFound, LAHAR_ERROR_PLUGIN_NOT_FOUND, c"LAHAR_ERROR_PLUGIN_NOT_FOUND"),
    (Status::PluginInvalid, LAHAR_ERROR_PLUGIN_INVALID, c"LAHAR_ERROR_PLUGIN_INVALID"),
    (Status::PluginAbi, LAHAR_ERROR_PLUGIN_ABI, c"LAHAR_ERROR_PLUGIN_ABI"),
    (Status::PluginRefused, LAHAR_ERROR_PLUGIN_REFUSED, c"LAHAR_ERROR_PLUGIN_REFUSED"),
    (Status::Threads, LAHAR_ERROR_THREADS, c"LAHAR_ERROR_THREADS"),
    (Status::OutOfMemory, LAHAR_ERROR_OUT_OF_MEMORY, c"LAHAR_ERROR_OUT_OF_MEMORY"),
    (Status::Panic, LAHAR_ERROR_PANIC, c"LAHAR_ERROR_PANIC"),
    (Status::MaterialFailed, LAHAR_ERROR_MATERIAL_FAILED, c"LAHAR_ERROR_MATERIAL_FAILED"),
    (Status::NonFinite, LAHAR_ERROR_NON_FINITE, c"LAHAR_ERROR_NON_FINITE"),
    (Status::Poisoned, LAHAR_ERROR_POISONED, c"LAHAR_ERROR_POISONED"),
    (Status::PluginBroken, LAHAR_ERROR_PLUGIN_BROKEN, c"LAHAR_ERROR_PLUGIN_BROKEN"),
];

// The constants are written out because the header generator reads no enums of the engine; they cannot drift.
const _: () = {
    let mut i = 0;
    while i < TABLE.len() {
        assert!(TABLE[i].0 as i32 == Status::ALL[i] as i32);
        assert!(TABLE[i].1 == Status::ALL[i] as i32);
        i += 1;
    }
};

/// Name of a status, such as "LAHAR_ERROR_BUSY"; "unknown status" if there is none of this number.
/// The text is static: do not free it. Cannot fail.
/// Thread: any
#[unsafe(no_mangle)]
pub extern "C" fn lahar_status_name(status: lahar_status) -> *const c_char {
    let name =
        TABLE.iter().find(|(_, value, _)| *value == status).map_or(c"unknown status", |t| t.2);
    name.as_ptr()
}
