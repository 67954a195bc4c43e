//! The wall between C and the models: C functions of the tables, panic boundary, host table.

use crate::batch::{Batch, Call};
use crate::model::Model;
use crate::simd::{self, Work};
use crate::table::Plugin;
use lahar_plugin_abi::*;
use std::any::Any;
use std::ffi::{CString, c_char, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr;
use std::slice;
use std::sync::atomic::{AtomicPtr, Ordering};

static HOST: AtomicPtr<lahar_host_api> = AtomicPtr::new(ptr::null_mut());

/// What [`export_plugin!`](crate::export_plugin) calls: keeps the host table and returns the plugin's.
///
/// The panic hook of this library's own standard library is made silent, since a plugin must not print.
///
/// # Safety
///
/// `host` is NULL or points to a host table that stays valid for the life of the process.
pub unsafe fn enter(
    host: *const lahar_host_api,
    plugin: &'static Plugin,
) -> *const lahar_plugin_desc {
    std::panic::set_hook(Box::new(|_| ()));
    // SAFETY: guaranteed by the caller.
    if let Some(host) = unsafe { host.as_ref() } {
        set_host(host);
    }
    plugin.desc()
}

/// Keeps the host table if it is at least as large as the one known here.
pub(crate) fn set_host(host: &'static lahar_host_api) {
    if host.struct_size as usize >= size_of::<lahar_host_api>() {
        HOST.store(ptr::from_ref(host).cast_mut(), Ordering::Release);
    }
}

fn host() -> Option<&'static lahar_host_api> {
    // SAFETY: the pointer is NULL or came through `set_host`, whose callers give one that is never dropped.
    unsafe { HOST.load(Ordering::Acquire).as_ref() }
}

/// Whether the host wants long work to end.
pub fn should_stop() -> bool {
    // SAFETY: the host's function takes nothing and may be called from any thread.
    host().and_then(|h| h.should_stop).is_some_and(|stop| unsafe { stop() } != 0)
}

/// Hands a line to the host's log. `level` is one of those of `lahar.h`: 0 error, 1 warning, 2 information, 3 detail.
pub fn log(level: i32, message: &str) {
    if let Some(log) = host().and_then(|h| h.log) {
        let message = c_string(message);
        // SAFETY: the string ends with a NUL and lives through the call, which copies it.
        unsafe { log(level, message.as_ptr()) };
    }
}

fn set_error(message: &str) {
    if let Some(set_error) = host().and_then(|h| h.set_error) {
        let message = c_string(message);
        // SAFETY: the string ends with a NUL and lives through the call, which copies it.
        unsafe { set_error(message.as_ptr()) };
    }
}

fn c_string(text: &str) -> CString {
    CString::new(text.replace('\0', " ")).unwrap_or_default()
}

/// Runs `body`; a returned error or a panic becomes `LAHAR_PLUGIN_ERROR` and the text for the host.
fn guard(body: impl FnOnce() -> Result<(), String>) -> i32 {
    let text = match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(())) => return LAHAR_PLUGIN_OK,
        Ok(Err(text)) => text,
        Err(payload) => format!("panic: {}", panic_text(payload.as_ref())),
    };
    set_error(&text);
    LAHAR_PLUGIN_ERROR
}

fn panic_text(payload: &(dyn Any + Send)) -> &str {
    let text = payload.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| payload.downcast_ref::<&str>().copied()).unwrap_or("without a text")
}

pub(crate) unsafe extern "C" fn create<M: Model>(
    _model: *const lahar_model_desc,
    values: *const f64,
    count: i64,
    instance: *mut *mut c_void,
) -> i32 {
    guard(|| {
        // SAFETY: the ABI gives NULL or a place for one pointer.
        let place = unsafe { instance.as_mut() }.ok_or("the place for the instance is NULL")?;
        *place = ptr::null_mut();
        // SAFETY: the ABI gives `count` values.
        let values = unsafe { parameter_values::<M>(values, count) }?;
        *place = Box::into_raw(Box::new(M::new(values)?)).cast();
        Ok(())
    })
}

pub(crate) unsafe extern "C" fn destroy<M: Model>(instance: *mut c_void) {
    guard(|| {
        if !instance.is_null() {
            // SAFETY: the instance came from `create::<M>` and is destroyed once.
            drop(unsafe { Box::from_raw(instance.cast::<M>()) });
        }
        Ok(())
    });
}

pub(crate) unsafe extern "C" fn check<M: Model>(
    _model: *const lahar_model_desc,
    values: *const f64,
    count: i64,
    message: *mut c_char,
    capacity: i64,
) -> i32 {
    let mut text = String::new();
    let code = guard(|| {
        // SAFETY: the ABI gives `count` values.
        let values = unsafe { parameter_values::<M>(values, count) }?;
        M::check(values).inspect_err(|e| text.clone_from(e))
    });
    let room = usize::try_from(capacity).unwrap_or(0);
    if code != LAHAR_PLUGIN_OK && !message.is_null() && room > 0 {
        let text = c_string(&text);
        let mut length = text.as_bytes().len().min(room - 1);
        while length > 0 && std::str::from_utf8(&text.as_bytes()[..length]).is_err() {
            length -= 1;
        }
        // SAFETY: the host's buffer has `capacity` bytes, of which `length + 1` are written.
        unsafe {
            ptr::copy_nonoverlapping(text.as_ptr(), message, length);
            *message.add(length) = 0;
        }
    }
    code
}

pub(crate) unsafe extern "C" fn init_state<M: Model>(
    instance: *const c_void,
    batch: *const lahar_stress_batch,
) -> i32 {
    // SAFETY: the ABI gives an instance of this model and a batch made for it.
    guard(|| unsafe { with::<M>(instance, batch, Call::InitState, |m, b| m.init_state(b)) })
}

pub(crate) unsafe extern "C" fn update<M: Model>(
    instance: *const c_void,
    batch: *const lahar_stress_batch,
) -> i32 {
    // SAFETY: as in `init_state`.
    guard(|| unsafe {
        with::<M>(instance, batch, Call::Update, |model, batch| {
            simd::run(Update { model, batch });
            Ok(())
        })
    })
}

pub(crate) unsafe extern "C" fn wave_speed<M: Model>(
    instance: *const c_void,
    batch: *const lahar_stress_batch,
) -> i32 {
    // SAFETY: as in `init_state`.
    guard(|| unsafe {
        with::<M>(instance, batch, Call::WaveSpeed, |model, batch| {
            simd::run(WaveSpeed { model, batch });
            Ok(())
        })
    })
}

pub(crate) unsafe extern "C" fn tangent<M: Model>(
    instance: *const c_void,
    batch: *const lahar_stress_batch,
    tangent: *mut f64,
) -> i32 {
    // SAFETY: as in `init_state`; the ABI gives room for 36 components.
    guard(|| unsafe {
        with::<M>(instance, batch, Call::Tangent, |model, batch| {
            let out = output(tangent, 35 * batch.stride + batch.n(), batch.n())?;
            for k in 0..batch.n() {
                for (c, value) in model.tangent(batch, k).as_flattened().iter().enumerate() {
                    out[c * batch.stride + k] = *value;
                }
            }
            Ok(())
        })
    })
}

pub(crate) unsafe extern "C" fn stored_energy<M: Model>(
    instance: *const c_void,
    batch: *const lahar_stress_batch,
    energy: *mut f64,
) -> i32 {
    // SAFETY: as in `init_state`; the ABI gives room for one value per point.
    guard(|| unsafe {
        with::<M>(instance, batch, Call::StoredEnergy, |model, batch| {
            let out = output(energy, batch.n(), batch.n())?;
            for (k, value) in out.iter_mut().enumerate() {
                *value = model.stored_energy(batch, k);
            }
            Ok(())
        })
    })
}

/// # Safety
///
/// `base` is NULL or points to `length` values that nobody else touches during `'a`.
unsafe fn output<'a>(base: *mut f64, length: usize, n: usize) -> Result<&'a mut [f64], String> {
    match (n, base.is_null()) {
        (0, _) => Ok(&mut []),
        (_, true) => Err("the place for the result is NULL".into()),
        // SAFETY: guaranteed by the caller.
        _ => Ok(unsafe { slice::from_raw_parts_mut(base, length) }),
    }
}

/// A model's loops, to be compiled once per level of instructions.
struct Update<'c, 'b, M> {
    model: &'c M,
    batch: &'c mut Batch<'b>,
}

impl<M: Model> Work for Update<'_, '_, M> {
    #[inline(always)]
    fn run(self) {
        self.model.update(self.batch);
    }
}

struct WaveSpeed<'c, 'b, M> {
    model: &'c M,
    batch: &'c mut Batch<'b>,
}

impl<M: Model> Work for WaveSpeed<'_, '_, M> {
    #[inline(always)]
    fn run(self) {
        self.model.wave_speed(self.batch);
    }
}

/// # Safety
///
/// `instance` is NULL or from `create::<M>`; `batch` as for [`Batch::from_raw`].
unsafe fn with<M: Model>(
    instance: *const c_void,
    batch: *const lahar_stress_batch,
    call: Call,
    body: impl FnOnce(&M, &mut Batch<'_>) -> Result<(), String>,
) -> Result<(), String> {
    // SAFETY: guaranteed by the caller; instances are only read, and `M` is `Sync`.
    let model = unsafe { instance.cast::<M>().as_ref() }.ok_or("the instance is NULL")?;
    // SAFETY: guaranteed by the caller.
    let mut batch = unsafe { Batch::from_raw::<M>(batch, call) }?;
    body(model, &mut batch)
}

/// # Safety
///
/// `values` is NULL or points to `count` values that live and stay unwritten for `'a`.
unsafe fn parameter_values<'a, M: Model>(
    values: *const f64,
    count: i64,
) -> Result<&'a [f64], String> {
    let wanted = M::PARAMETERS.len();
    if usize::try_from(count) != Ok(wanted) {
        return Err(format!("expected {wanted} parameter values, got {count}"));
    }
    match (wanted, values.is_null()) {
        (0, _) => Ok(&[]),
        (_, true) => Err("the parameter values are NULL".into()),
        // SAFETY: guaranteed by the caller.
        _ => Ok(unsafe { slice::from_raw_parts(values, wanted) }),
    }
}
