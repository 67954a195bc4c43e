//! Calls the functions of a model: builds the C batch from the safe one and turns return values
//! into errors.

use super::checked::{self, checks};
use super::exclusive;
use super::host::take_error;
use crate::error::{Error, Result, Status};
use crate::material::{Kinematics, Model, StressBatch};
use lahar_plugin_abi::*;
use std::ffi::{CStr, c_char, c_void};
use std::ptr;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// At least as many inputs as there are kinds; the handshake refuses duplicates.
const INPUTS: usize = 12;

type Call = unsafe extern "C" fn(*const c_void, *const lahar_stress_batch) -> i32;

/// An extension's function, which writes into an array of its own.
type WithOutput = unsafe extern "C" fn(*const c_void, *const lahar_stress_batch, *mut f64) -> i32;

type Check =
    unsafe extern "C" fn(*const lahar_model_desc, *const f64, i64, *mut c_char, i64) -> i32;

/// The functions of a model, checked by the handshake.
pub(crate) struct Functions {
    /// The table that holds the functions; `create` and `check` are given it.
    pub(super) desc: &'static lahar_model_desc,
    pub(super) create:
        unsafe extern "C" fn(*const lahar_model_desc, *const f64, i64, *mut *mut c_void) -> i32,
    pub(super) destroy: unsafe extern "C" fn(*mut c_void),
    pub(super) check: Option<Check>,
    pub(super) init_state: Option<Call>,
    pub(super) update: Call,
    pub(super) wave_speed: Call,
    pub(super) tangent: Option<WithOutput>,
    pub(super) stored_energy: Option<WithOutput>,
    /// Serialises the calls of a plugin that has a model which is not thread-safe.
    pub(super) serial: Option<&'static Mutex<()>>,
}

impl Functions {
    /// Excludes other calls of the library's models if they are not thread-safe; locked after
    /// [`exclusive`] where both are held.
    fn alone(&self) -> Option<MutexGuard<'static, ()>> {
        self.serial.map(|m| m.lock().unwrap_or_else(PoisonError::into_inner))
    }

    pub(crate) fn offers_tangent(&self) -> bool {
        self.tangent.is_some()
    }

    pub(crate) fn offers_stored_energy(&self) -> bool {
        self.stored_energy.is_some()
    }
}

/// The functions that work on a batch.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Verb {
    InitState,
    Update,
    WaveSpeed,
    Tangent,
    StoredEnergy,
}

impl Verb {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::InitState => "init_state",
            Self::Update => "update",
            Self::WaveSpeed => "wave_speed",
            Self::Tangent => "tangent",
            Self::StoredEnergy => "stored_energy",
        }
    }

    /// Components of the array of its own that an extension's function writes; 0 for the others.
    pub(super) fn own_components(self) -> usize {
        match self {
            Self::Tangent => 36,
            Self::StoredEnergy => 1,
            _ => 0,
        }
    }
}

/// An instance of a model.
pub(crate) struct Instance {
    model: &'static Model,
    pointer: *mut c_void,
    /// Whether every call is checked, see `checked.rs`.
    checked: bool,
}

// SAFETY: the ABI lets any thread call an instance; `serial` excludes other threads where the model
// asks for it, and the lock of exclusive functions excludes them from creation and destruction.
unsafe impl Send for Instance {}
// SAFETY: as above.
unsafe impl Sync for Instance {}

impl Instance {
    /// Asks the model whether the values (one per parameter) go together and makes an instance.
    /// Errors: [`Status::OutOfBounds`] with the model's text.
    pub(crate) fn new(model: &'static Model, values: &[f64]) -> Result<Self> {
        let checked = checks()?;
        let functions = &model.functions;
        let _alone = (exclusive(), functions.alone());
        take_error();
        let refused = |text: Option<String>| {
            let text = text.unwrap_or_else(|| "without saying why".into());
            let text = format!("`{}` refuses its parameter values: {text}", model.name);
            Error::new(Status::OutOfBounds, text)
        };
        let count = values.len() as i64;
        if let Some(check) = functions.check {
            let mut text = [0_u8; 1024];
            let capacity = text.len() as i64;
            // SAFETY: `values` has `count` values and `text` has `capacity` bytes.
            let code = unsafe {
                check(functions.desc, values.as_ptr(), count, text.as_mut_ptr().cast(), capacity)
            };
            if code != LAHAR_PLUGIN_OK {
                let text = CStr::from_bytes_until_nul(&text).unwrap_or_default().to_string_lossy();
                let fallback = take_error();
                return Err(refused(if text.is_empty() { fallback } else { Some(text.into()) }));
            }
        }
        let mut pointer = ptr::null_mut();
        // SAFETY: `values` has `count` values and `pointer` can hold one pointer.
        let code =
            unsafe { (functions.create)(functions.desc, values.as_ptr(), count, &mut pointer) };
        if code != LAHAR_PLUGIN_OK {
            return Err(refused(take_error()));
        }
        Ok(Self { model, pointer, checked })
    }

    pub(crate) fn model(&self) -> &'static Model {
        self.model
    }

    pub(crate) fn update(&self, batch: &mut StressBatch<'_>) -> Result<()> {
        if batch.n == 0 {
            return Ok(());
        }
        let kinematics = match self.model.kinematics {
            Kinematics::StrainIncrement | Kinematics::GreenNaghdi => {
                need("strain_increment", batch.strain_increment.len())
            }
            Kinematics::VelocityGradient => {
                need("velocity_gradient", batch.velocity_gradient.len())
            }
            Kinematics::DeformationGradient => {
                need("deformation_gradient", batch.deformation_gradient.len())
            }
        };
        kinematics?;
        need("stress1", batch.stress1.len())?;
        need("wave_speed", batch.wave_speed.len())?;
        self.need_state("state0", batch.state0.len())?;
        self.need_state("state1", batch.state1.len())?;
        self.need_output("diffusivity", LAHAR_OUTPUT_DIFFUSIVITY, batch.diffusivity.len())?;
        self.need_output("energy", LAHAR_OUTPUT_ENERGY, batch.energy.len())?;
        self.need_output("dt_factor", LAHAR_OUTPUT_DT_FACTOR, batch.dt_factor.len())?;
        self.need_output("status", LAHAR_OUTPUT_STATUS, batch.status.len())?;
        self.call(Verb::Update, batch, &mut [])
    }

    pub(crate) fn wave_speed(&self, batch: &mut StressBatch<'_>) -> Result<()> {
        if batch.n == 0 {
            return Ok(());
        }
        need("wave_speed", batch.wave_speed.len())?;
        self.need_state("state0", batch.state0.len())?;
        self.need_output("diffusivity", LAHAR_OUTPUT_DIFFUSIVITY, batch.diffusivity.len())?;
        self.call(Verb::WaveSpeed, batch, &mut [])
    }

    pub(crate) fn init_state(&self, batch: &mut StressBatch<'_>) -> Result<()> {
        if batch.n == 0 || self.model.functions.init_state.is_none() {
            return Ok(());
        }
        self.need_state("state1", batch.state1.len())?;
        self.call(Verb::InitState, batch, &mut [])
    }

    /// Writes dσ1/dΔε, 36 components, into `out`; None if the model does not offer it.
    pub(crate) fn tangent(
        &self,
        batch: &mut StressBatch<'_>,
        out: &mut [f64],
    ) -> Option<Result<()>> {
        self.model.functions.tangent?;
        Some(self.call(Verb::Tangent, batch, out))
    }

    /// Writes the stored energy per volume into `out`; None if the model does not offer it.
    pub(crate) fn stored_energy(
        &self,
        batch: &mut StressBatch<'_>,
        out: &mut [f64],
    ) -> Option<Result<()>> {
        self.model.functions.stored_energy?;
        Some(self.call(Verb::StoredEnergy, batch, out))
    }

    fn need_state(&self, name: &str, length: usize) -> Result<()> {
        if self.model.states.is_empty() { Ok(()) } else { need(name, length) }
    }

    fn need_output(&self, name: &str, output: u64, length: usize) -> Result<()> {
        if self.model.gives(output) { need(name, length) } else { Ok(()) }
    }

    /// `own`: the array of its own that an extension's function writes; empty for the others.
    fn call(&self, verb: Verb, batch: &mut StressBatch<'_>, own: &mut [f64]) -> Result<()> {
        if self.checked {
            checked::call(self, verb, batch, own)
        } else {
            self.run(verb, batch, own)
        }
    }

    /// Calls the model as it is.
    pub(super) fn run(
        &self,
        verb: Verb,
        batch: &mut StressBatch<'_>,
        own: &mut [f64],
    ) -> Result<()> {
        let name = verb.name();
        let inputs = self.input_pointers(batch)?;
        let raw = self.raw_batch(batch, &inputs)?;
        if verb.own_components() > 0 {
            need(name, own.len())?;
        }
        let own = array_mut(name, own, verb.own_components(), batch.stride)?;
        let functions = &self.model.functions;
        let with_own = |function: Option<WithOutput>| {
            // SAFETY: as below; `own` has the components that the extension writes.
            function.map_or(LAHAR_PLUGIN_OK, |f| unsafe { f(self.pointer, &raw, own) })
        };
        // SAFETY: the instance is of this model; `raw_batch` has checked every array that the model
        // may touch, the arrays are borrowed for the call, and mutable borrows do not alias.
        let plain = |function: Call| unsafe { function(self.pointer, &raw) };
        let _one_at_a_time = self.model.functions.alone();
        take_error();
        let code = match verb {
            Verb::Update => plain(functions.update),
            Verb::WaveSpeed => plain(functions.wave_speed),
            Verb::InitState => functions.init_state.map_or(LAHAR_PLUGIN_OK, plain),
            Verb::Tangent => with_own(functions.tangent),
            Verb::StoredEnergy => with_own(functions.stored_energy),
        };
        if code == LAHAR_PLUGIN_OK {
            return Ok(());
        }
        let why = take_error().unwrap_or_else(|| format!("it returned {code} without saying why"));
        Err(Error::new(
            Status::MaterialFailed,
            format!(
                "`{name}` of the model `{}` (plugin {}) failed: {why}",
                self.model.name, self.model.plugin_id
            ),
        ))
    }

    /// Checks the arrays of a batch without a call.
    pub(super) fn check(
        &self,
        verb: Verb,
        batch: &mut StressBatch<'_>,
        own: &mut [f64],
    ) -> Result<()> {
        self.raw_batch(batch, &self.input_pointers(batch)?)?;
        if verb.own_components() > 0 {
            need(verb.name(), own.len())?;
        }
        array_mut(verb.name(), own, verb.own_components(), batch.stride).map(|_| ())
    }

    /// One pointer per wanted input, in the descriptor's order.
    fn input_pointers(&self, batch: &StressBatch<'_>) -> Result<[*const f64; INPUTS]> {
        let mut pointers = [ptr::null(); INPUTS];
        let (n, stride, count) = (batch.n, batch.stride, self.model.inputs.len());
        if stride < n || !stride.is_multiple_of(8) || stride > i64::MAX as usize / 64 {
            return Err(defect(format!("stride {stride} for {n} points")));
        }
        if count > 0 {
            need("inputs", batch.inputs.len())?;
        }
        array("inputs", batch.inputs, count, stride)?;
        for (pointer, values) in pointers.iter_mut().zip(batch.inputs.chunks(stride.max(1))) {
            *pointer = values.as_ptr();
        }
        Ok(pointers)
    }

    /// The C batch: arrays that the model did not ask for become NULL, the lengths of the others
    /// are checked.
    fn raw_batch(
        &self,
        batch: &mut StressBatch<'_>,
        inputs: &[*const f64; INPUTS],
    ) -> Result<lahar_stress_batch> {
        let (n, stride) = (batch.n, batch.stride);
        need("stress0", batch.stress0.len())?;
        let model = self.model;
        let state = model.state_components();
        let asked = |wanted: bool, name: &str, data: &[f64], components: usize| {
            if wanted { array(name, data, components, stride) } else { Ok(ptr::null()) }
        };
        let output = |mask: u64, name: &str, data: &mut [f64]| {
            if model.gives(mask) { column_mut(name, data, n) } else { Ok(ptr::null_mut()) }
        };
        let kinematics = |k: Kinematics| model.kinematics == k;
        Ok(lahar_stress_batch {
            struct_size: size_of::<lahar_stress_batch>() as u32,
            flags: 0,
            n: n as i64,
            stride: stride as i64,
            dt: batch.dt,
            time: batch.time,
            step: batch.step,
            strain_increment: asked(
                model.kinematics.takes_strain_increment(),
                "strain_increment",
                batch.strain_increment,
                6,
            )?,
            velocity_gradient: asked(
                kinematics(Kinematics::VelocityGradient),
                "velocity_gradient",
                batch.velocity_gradient,
                9,
            )?,
            deformation_gradient: asked(
                kinematics(Kinematics::DeformationGradient),
                "deformation_gradient",
                batch.deformation_gradient,
                9,
            )?,
            stress0: array("stress0", batch.stress0, 6, stride)?,
            state0: asked(state > 0, "state0", batch.state0, state)?,
            stress1: array_mut("stress1", batch.stress1, 6, stride)?,
            state1: if state > 0 {
                array_mut("state1", batch.state1, state, stride)?
            } else {
                ptr::null_mut()
            },
            inputs: inputs.as_ptr(),
            wave_speed: output(LAHAR_OUTPUT_WAVE_SPEED, "wave_speed", batch.wave_speed)?,
            diffusivity: output(LAHAR_OUTPUT_DIFFUSIVITY, "diffusivity", batch.diffusivity)?,
            energy: output(LAHAR_OUTPUT_ENERGY, "energy", batch.energy)?,
            dt_factor: output(LAHAR_OUTPUT_DT_FACTOR, "dt_factor", batch.dt_factor)?,
            status: if model.gives(LAHAR_OUTPUT_STATUS) {
                column_mut("status", batch.status, n)?
            } else {
                ptr::null_mut()
            },
        })
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        let _alone = (exclusive(), self.model.functions.alone());
        // SAFETY: the instance came from this model's `create`, and nobody can use it any more.
        unsafe { (self.model.functions.destroy)(self.pointer) };
    }
}

fn defect(what: String) -> Error {
    Error::invalid(format!("a batch for a material is not well formed: {what}"))
}

fn need(name: &str, length: usize) -> Result<()> {
    if length > 0 { Ok(()) } else { Err(defect(format!("{name} is missing"))) }
}

/// Base of `components * stride` values on a 64-byte boundary; NULL for an empty slice.
fn array(name: &str, data: &[f64], components: usize, stride: usize) -> Result<*const f64> {
    debug_assert!(data.is_empty() || data.as_ptr().addr().is_multiple_of(64), "{name}: alignment");
    column(name, data, components * stride)
}

fn array_mut(name: &str, data: &mut [f64], components: usize, stride: usize) -> Result<*mut f64> {
    debug_assert!(data.is_empty() || data.as_ptr().addr().is_multiple_of(64), "{name}: alignment");
    column_mut(name, data, components * stride)
}

/// Base of at least `length` values; NULL for an empty slice.
fn column(name: &str, data: &[f64], length: usize) -> Result<*const f64> {
    match data.len() {
        0 => Ok(ptr::null()),
        l if l < length => Err(defect(format!("{name} has {l} values, needs {length}"))),
        _ => Ok(data.as_ptr()),
    }
}

fn column_mut<T>(name: &str, data: &mut [T], length: usize) -> Result<*mut T> {
    match data.len() {
        0 => Ok(ptr::null_mut()),
        l if l < length => Err(defect(format!("{name} has {l} values, needs {length}"))),
        _ => Ok(data.as_mut_ptr()),
    }
}
