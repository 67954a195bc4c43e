//! The functions of the tables, and the safe view of a batch.

use crate::describe::{Adapted, Floor};
use crate::fpenv::Environment;
use crate::host::guard;
use crate::kinematics::{LANES, Lane};
use crate::sidecar::Routine;
use crate::{sdvini, umat, vumat};
use lahar_plugin_abi::*;
use std::ffi::c_void;
use std::ptr;
use std::slice;
use std::sync::{Mutex, PoisonError};

/// The adapted libraries by the addresses of their models' tables.
static ADAPTED: Mutex<Vec<(usize, &'static Adapted)>> = Mutex::new(Vec::new());

/// Lets `create` find the library of a model.
pub fn remember(model: &'static lahar_model_desc, adapted: &'static Adapted) {
    let mut known = ADAPTED.lock().unwrap_or_else(PoisonError::into_inner);
    known.push((ptr::from_ref(model).addr(), adapted));
}

/// A material: an adapted library with values for its parameters.
pub struct Instance {
    pub adapted: &'static Adapted,
    /// `PROPS`.
    pub props: Vec<f64>,
    /// Lower bound of the modulus of waves [Pa]; 0 for none.
    pub floor: f64,
}

impl Instance {
    fn new(adapted: &'static Adapted, values: &[f64]) -> Result<Self, String> {
        let props = if adapted.counted { counted(values)? } else { values };
        let floor = match adapted.floor {
            None => 0.0,
            Some(Floor::Value(value)) => value,
            Some(Floor::Parameter(at)) => values[at],
        };
        let mut instance = Self { adapted, props: props.to_vec(), floor };
        if adapted.library.routine == Routine::Vumat {
            let _environment = Environment::current();
            instance.floor = vumat::first_modulus(&instance)?.max(floor);
        }
        Ok(instance)
    }
}

/// As many values as the first of all counts; the others must have been left alone.
fn counted(values: &[f64]) -> Result<&[f64], String> {
    let (props, others) = values[1..].split_at(values[0] as usize);
    match others.iter().position(|value| *value != 0.0) {
        None => Ok(props),
        Some(at) => Err(format!(
            "prop_{} is given, but nprops is {}: raise nprops, or leave it out",
            props.len() + at + 1,
            props.len()
        )),
    }
}

/// Makes an instance of the library that the model was made of.
pub unsafe extern "C" fn create(
    model: *const lahar_model_desc,
    values: *const f64,
    count: i64,
    instance: *mut *mut c_void,
) -> i32 {
    code(guard(|| {
        let known = ADAPTED.lock().unwrap_or_else(PoisonError::into_inner);
        let found = known.iter().find(|(table, _)| *table == model.addr()).map(|(_, a)| *a);
        drop(known);
        let adapted = found.ok_or("the model is not one of this adapter")?;
        let wanted = adapted.parameter_count;
        if usize::try_from(count) != Ok(wanted) {
            return Err(format!("expected {wanted} parameter values, got {count}"));
        }
        // SAFETY: the ABI gives `count` values.
        let values = unsafe { array(values, wanted) }?;
        // SAFETY: the ABI gives NULL or a place for one pointer.
        let place = unsafe { instance.as_mut() }.ok_or("the place for the instance is NULL")?;
        *place = Box::into_raw(Box::new(Instance::new(adapted, values)?)).cast();
        Ok(())
    }))
}

/// Frees an instance.
pub unsafe extern "C" fn destroy(instance: *mut c_void) {
    guard(|| {
        if !instance.is_null() {
            // SAFETY: the instance came from `create` and is destroyed once.
            drop(unsafe { Box::from_raw(instance.cast::<Instance>()) });
        }
        Ok(())
    });
}

/// What a batch is for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Call {
    InitState,
    Update,
    WaveSpeed,
}

/// First states by `SDVINI`.
pub unsafe extern "C" fn init_state(
    instance: *const c_void,
    batch: *const lahar_stress_batch,
) -> i32 {
    // SAFETY: guaranteed by the caller.
    unsafe { run(instance, batch, Call::InitState) }
}

/// One step.
pub unsafe extern "C" fn update(instance: *const c_void, batch: *const lahar_stress_batch) -> i32 {
    // SAFETY: guaranteed by the caller.
    unsafe { run(instance, batch, Call::Update) }
}

/// Wave speeds at the start.
pub unsafe extern "C" fn wave_speed(
    instance: *const c_void,
    batch: *const lahar_stress_batch,
) -> i32 {
    // SAFETY: guaranteed by the caller.
    unsafe { run(instance, batch, Call::WaveSpeed) }
}

/// # Safety
///
/// `instance` is NULL or from `create`, `batch` NULL or a batch made for its model and this call.
unsafe fn run(instance: *const c_void, batch: *const lahar_stress_batch, call: Call) -> i32 {
    code(guard(|| {
        // SAFETY: guaranteed by the caller.
        let instance = unsafe { instance.cast::<Instance>().as_ref() };
        let instance = instance.ok_or("the instance is NULL")?;
        // SAFETY: guaranteed by the caller.
        let mut points = unsafe { Points::of(instance.adapted, batch, call) }?;
        let _environment = Environment::current();
        match (call, instance.adapted.library.routine) {
            (Call::InitState, _) => sdvini::init_state(instance, &mut points),
            (_, Routine::Umat) => umat::run(instance, &mut points, call),
            (Call::Update, Routine::Vumat) => vumat::update(instance, &mut points),
            (Call::WaveSpeed, Routine::Vumat) => vumat::wave_speed(instance, &mut points),
        }
    }))
}

fn code(result: Option<()>) -> i32 {
    if result.is_some() { LAHAR_PLUGIN_OK } else { LAHAR_PLUGIN_ERROR }
}

/// The safe view of a batch. What the call does not have is an empty slice.
pub struct Points<'a> {
    pub n: usize,
    pub stride: usize,
    pub dt: f64,
    pub time: f64,
    pub step: i64,
    pub gradient: &'a [f64],
    pub stress0: &'a [f64],
    pub state0: &'a [f64],
    pub inputs: [&'a [f64]; 9],
    pub stress1: &'a mut [f64],
    pub state1: &'a mut [f64],
    pub wave_speed: &'a mut [f64],
    pub energy: &'a mut [f64],
    pub dt_factor: &'a mut [f64],
    pub status: &'a mut [i32],
}

impl<'a> Points<'a> {
    /// # Safety
    ///
    /// `batch` is NULL or a batch made for the model of `adapted` and this call, whose arrays live and are touched by nobody else for `'a`.
    unsafe fn of(
        adapted: &Adapted,
        batch: *const lahar_stress_batch,
        call: Call,
    ) -> Result<Self, String> {
        // SAFETY: guaranteed by the caller.
        let b = unsafe { batch.as_ref() }.ok_or("the batch is NULL")?;
        if (b.struct_size as usize) < size_of::<lahar_stress_batch>() {
            return Err("the batch is shorter than that of the ABI".into());
        }
        let n = usize::try_from(b.n).map_err(|_| "n is negative")?;
        let stride = usize::try_from(b.stride).map_err(|_| "the stride is negative")?;
        if stride < n {
            return Err(format!("stride {stride} for {n} points"));
        }
        let components = adapted.components;
        let length = |count: usize| if n == 0 || count == 0 { 0 } else { (count - 1) * stride + n };
        let update = call == Call::Update;
        let mut inputs = [&[][..]; 9];
        // SAFETY: of what the model declares the ABI gives arrays of these lengths, which do not alias.
        unsafe {
            let pointers = slice_of(b.inputs, adapted.inputs)?;
            for (input, pointer) in inputs.iter_mut().zip(pointers) {
                *input = array(*pointer, n)?;
            }
            let only = |wanted: bool, count: usize| if wanted { length(count) } else { 0 };
            Ok(Self {
                n,
                stride,
                dt: b.dt,
                time: b.time,
                step: b.step,
                gradient: array(b.velocity_gradient, only(update, 9))?,
                stress0: array(b.stress0, length(6))?,
                state0: array(b.state0, only(call != Call::InitState, components))?,
                inputs,
                stress1: array_mut(b.stress1, only(update, 6))?,
                state1: array_mut(b.state1, only(call != Call::WaveSpeed, components))?,
                wave_speed: array_mut(b.wave_speed, only(call != Call::InitState, 1))?,
                energy: optional(b.energy, only(update, 1)),
                dt_factor: optional(b.dt_factor, only(update, 1)),
                status: optional(b.status, only(update, 1)),
            })
        }
    }

    /// Component `c` of the points from `k` on, zero in lanes without a point.
    #[inline(always)]
    fn load(&self, data: &[f64], c: usize, k: usize, out: &mut Lane) {
        let first = c * self.stride + k;
        if k + LANES <= self.n {
            out.copy_from_slice(&data[first..first + LANES]);
        } else {
            let m = self.n - k;
            out[..m].copy_from_slice(&data[first..first + m]);
            out[m..].fill(0.0);
        }
    }

    /// All components of the points from `k` on.
    #[inline(always)]
    pub fn load_all(&self, data: &[f64], first: usize, k: usize, out: &mut [Lane]) {
        for (c, lane) in out.iter_mut().enumerate() {
            self.load(data, first + c, k, lane);
        }
    }
}

/// Writes component `c` of the points from `k` on.
#[inline(always)]
pub fn store(data: &mut [f64], (n, stride): (usize, usize), c: usize, k: usize, lane: &Lane) {
    let first = c * stride + k;
    if k + LANES <= n {
        data[first..first + LANES].copy_from_slice(lane);
    } else {
        data[first..first + n - k].copy_from_slice(&lane[..n - k]);
    }
}

/// # Safety
///
/// `base` is NULL or points to `length` values that live and stay unwritten for `'a`.
unsafe fn slice_of<'a, T>(base: *const T, length: usize) -> Result<&'a [T], String> {
    match (length, base.is_null()) {
        (0, _) => Ok(&[]),
        (_, true) => Err("an array of the batch is NULL".into()),
        // SAFETY: guaranteed by the caller.
        _ => Ok(unsafe { slice::from_raw_parts(base, length) }),
    }
}

/// # Safety
///
/// As for [`slice_of`].
unsafe fn array<'a>(base: *const f64, length: usize) -> Result<&'a [f64], String> {
    // SAFETY: guaranteed by the caller.
    unsafe { slice_of(base, length) }
}

/// # Safety
///
/// `base` is NULL or points to `length` values that nobody else touches for `'a`.
unsafe fn array_mut<'a>(base: *mut f64, length: usize) -> Result<&'a mut [f64], String> {
    match (length, base.is_null()) {
        (0, _) => Ok(&mut []),
        (_, true) => Err("an output of the batch is NULL".into()),
        // SAFETY: guaranteed by the caller.
        _ => Ok(unsafe { slice::from_raw_parts_mut(base, length) }),
    }
}

/// # Safety
///
/// As for [`array_mut`].
unsafe fn optional<'a, T>(base: *mut T, length: usize) -> &'a mut [T] {
    // SAFETY: guaranteed by the caller.
    if base.is_null() { &mut [] } else { unsafe { slice::from_raw_parts_mut(base, length) } }
}
