//! Runs a model through its table, without an engine.

use crate::wall;
use lahar_plugin_abi::*;
use std::cell::RefCell;
use std::ffi::{CStr, c_char, c_void};
use std::ptr;
use std::time::Instant;

thread_local! {
    static ERROR: RefCell<String> = const { RefCell::new(String::new()) };
}

unsafe extern "C" fn set_error(message: *const c_char) {
    // SAFETY: plugins pass a NUL-terminated string.
    let text = unsafe { CStr::from_ptr(message) }.to_string_lossy().into_owned();
    ERROR.set(text);
}

static HOST: lahar_host_api = lahar_host_api {
    struct_size: size_of::<lahar_host_api>() as u32,
    abi_minor: LAHAR_PLUGIN_ABI_MINOR,
    log: None,
    set_error: Some(set_error),
    should_stop: None,
};

/// Values with a 64-byte aligned base.
struct Aligned {
    data: Vec<f64>,
    start: usize,
    length: usize,
}

impl Aligned {
    fn new(length: usize, value: f64) -> Self {
        let data = vec![value; length + 8];
        let start = data.as_ptr().align_offset(64).min(8);
        Self { data, start, length }
    }

    fn get(&self) -> &[f64] {
        &self.data[self.start..self.start + self.length]
    }

    fn get_mut(&mut self) -> &mut [f64] {
        &mut self.data[self.start..self.start + self.length]
    }
}

/// An instance of a model with `n` points: the element test of an author.
///
/// Deformation and inputs are set by the caller; [`Driver::update`] runs one step; [`Driver::commit`] makes its end the
/// start of the next. Calls go through the C table only, as those of an engine do. A driver changes what the models of
/// this program see as their host.
pub struct Driver {
    model: &'static lahar_model_desc,
    instance: *mut c_void,
    n: usize,
    stride: usize,
    kinematics: Aligned,
    stress: [Aligned; 2],
    state: [Aligned; 2],
    inputs: Vec<Aligned>,
    wave_speed: Aligned,
    diffusivity: Aligned,
    energy: Aligned,
    dt_factor: Aligned,
    status: Vec<i32>,
}

impl Driver {
    /// An instance from named values (others take their defaults) with `n` points: zero stress, initial state,
    /// density 1000 kg/m^3, element length 1 m, temperature 293.15 K, other inputs 0. Errors: unknown or missing parameter, or the model's own refusal.
    pub fn new(
        model: &'static lahar_model_desc,
        named: &[(&str, f64)],
        n: usize,
    ) -> Result<Self, String> {
        Self::with_values(model, &collect_values(model, named, false)?, n)
    }

    /// The same with typical values for required parameters that are not named.
    pub fn typical(
        model: &'static lahar_model_desc,
        named: &[(&str, f64)],
        n: usize,
    ) -> Result<Self, String> {
        Self::with_values(model, &collect_values(model, named, true)?, n)
    }

    fn with_values(
        model: &'static lahar_model_desc,
        values: &[f64],
        n: usize,
    ) -> Result<Self, String> {
        wall::set_host(&HOST);
        let instance = create(model, values)?;
        let stride = n.next_multiple_of(8);
        let states = states(model);
        let components: usize = states.iter().map(|s| state_size(s.kind)).sum();
        let gradient = if takes_strain_increment(model.kinematics) { 6 } else { 9 };
        let mut driver = Self {
            model,
            instance,
            n,
            stride,
            kinematics: Aligned::new(gradient * stride, 0.0),
            stress: [Aligned::new(6 * stride, 0.0), Aligned::new(6 * stride, f64::NAN)],
            state: [Aligned::new(components * stride, 0.0), Aligned::new(components * stride, 0.0)],
            inputs: (0..model.input_count)
                .map(|i| Aligned::new(stride, usual_input(inputs(model)[i as usize])))
                .collect(),
            wave_speed: Aligned::new(stride, f64::NAN),
            diffusivity: Aligned::new(stride, f64::NAN),
            energy: Aligned::new(stride, f64::NAN),
            dt_factor: Aligned::new(stride, f64::NAN),
            status: vec![0; stride],
        };
        let mut first = 0;
        for s in states {
            let next = first + state_size(s.kind) * stride;
            driver.state[0].get_mut()[first..next].fill(s.initial);
            driver.state[1].get_mut()[first..next].fill(s.initial);
            first = next;
        }
        Ok(driver)
    }

    /// Number of points.
    pub fn n(&self) -> usize {
        self.n
    }

    /// Sets the strain increment of point `k`: xx, yy, zz, xy, yz, zx [-].
    pub fn set_strain_increment(&mut self, k: usize, value: [f64; 6]) {
        put(self.kinematics.get_mut(), self.stride, k, &value);
    }

    /// Sets the velocity gradient [1/s] or the deformation gradient [-] of point `k`, row-major.
    pub fn set_gradient(&mut self, k: usize, value: [f64; 9]) {
        put(self.kinematics.get_mut(), self.stride, k, &value);
    }

    /// Sets the start stress of point `k` [Pa].
    pub fn set_stress(&mut self, k: usize, value: [f64; 6]) {
        put(self.stress[0].get_mut(), self.stride, k, &value);
    }

    /// Sets component `c` of the start state of point `k`.
    pub fn set_state(&mut self, k: usize, c: usize, value: f64) {
        self.state[0].get_mut()[c * self.stride + k] = value;
    }

    /// Sets input `i` of point `k`.
    pub fn set_input(&mut self, i: usize, k: usize, value: f64) {
        self.inputs[i].get_mut()[k] = value;
    }

    /// Points for a bench: all get the start stress [Pa], and point `k` the strain increment
    /// `direction` times `size` (1 + k mod 7) [-].
    pub fn set_samples(&mut self, size: f64, direction: [f64; 6], stress: [f64; 6]) {
        for k in 0..self.n {
            let e = size * (1.0 + (k % 7) as f64);
            self.set_strain_increment(k, direction.map(|part| part * e));
            self.set_stress(k, stress);
        }
    }

    /// Stress of point `k` at the start of the next step [Pa].
    pub fn stress0(&self, k: usize) -> [f64; 6] {
        std::array::from_fn(|c| self.stress[0].get()[c * self.stride + k])
    }

    /// Stress of point `k` at the end of the last update [Pa].
    pub fn stress1(&self, k: usize) -> [f64; 6] {
        std::array::from_fn(|c| self.stress[1].get()[c * self.stride + k])
    }

    /// Component `c` of the state of point `k` at the end of the last update.
    pub fn state1(&self, k: usize, c: usize) -> f64 {
        self.state[1].get()[c * self.stride + k]
    }

    /// Component `c` of the state of point `k` at the start of the next step.
    pub fn state0(&self, k: usize, c: usize) -> f64 {
        self.state[0].get()[c * self.stride + k]
    }

    /// Wave speed of point `k` from the last call [m/s].
    pub fn wave_speed_of(&self, k: usize) -> f64 {
        self.wave_speed.get()[k]
    }

    /// Diffusivity of point `k` from the last call [m^2/s].
    pub fn diffusivity_of(&self, k: usize) -> f64 {
        self.diffusivity.get()[k]
    }

    /// Stored energy per current volume of point `k` from the last call [J/m^3].
    pub fn energy_of(&self, k: usize) -> f64 {
        self.energy.get()[k]
    }

    /// Status of point `k` from the last update: one of `LAHAR_POINT_*`.
    pub fn status_of(&self, k: usize) -> i32 {
        self.status[k]
    }

    /// Runs `update` with the step `dt` [s]. The end arrays and outputs hold NaN before.
    pub fn update(&mut self, dt: f64) -> Result<(), String> {
        let update = self.model.update.ok_or("the model has no update")?;
        self.stress[1].get_mut().fill(f64::NAN);
        self.state[1].get_mut().fill(f64::NAN);
        self.call(update, dt)
    }

    /// Runs `wave_speed`.
    pub fn wave_speed(&mut self) -> Result<(), String> {
        let wave_speed = self.model.wave_speed.ok_or("the model has no wave speed")?;
        self.call(wave_speed, 0.0)
    }

    /// The tangent [Pa] of point `k` in the step `dt` [s], from the extension `lahar.tangent`.
    pub fn tangent(&mut self, k: usize, dt: f64) -> Result<[[f64; 6]; 6], String> {
        let table: *const lahar_tangent_extension = self.extension(c"lahar.tangent")?;
        // SAFETY: the table of this id is of this type.
        let tangent = unsafe { (*table).tangent }.ok_or("the table has no tangent")?;
        let (instance, stride) = (self.instance, self.stride);
        let mut out = Aligned::new(36 * stride, f64::NAN);
        let inputs = self.input_pointers();
        let batch = self.batch(&inputs, dt);
        // SAFETY: as in `call`; `out` has 36 components.
        result(unsafe { tangent(instance, &batch, out.get_mut().as_mut_ptr()) })?;
        let at = |i: usize, j: usize| out.get()[(6 * i + j) * stride + k];
        Ok(std::array::from_fn(|i| std::array::from_fn(|j| at(i, j))))
    }

    /// Energy per current volume [J/m^3] of point `k` at the start, from the extension `lahar.energy`.
    pub fn stored_energy(&mut self, k: usize) -> Result<f64, String> {
        let table: *const lahar_energy_extension = self.extension(c"lahar.energy")?;
        // SAFETY: the table of this id is of this type.
        let stored = unsafe { (*table).stored }.ok_or("the table has no energy")?;
        let instance = self.instance;
        let mut out = Aligned::new(self.stride, f64::NAN);
        let inputs = self.input_pointers();
        let batch = self.batch(&inputs, 0.0);
        // SAFETY: as in `call`; `out` has one value per point.
        result(unsafe { stored(instance, &batch, out.get_mut().as_mut_ptr()) })?;
        Ok(out.get()[k])
    }

    fn extension<T>(&self, id: &CStr) -> Result<*const T, String> {
        let get = self.model.get_extension.ok_or("the model has no extensions")?;
        // SAFETY: the id ends with a NUL.
        let table: *const T = unsafe { get(self.model, id.as_ptr()) }.cast();
        if table.is_null() { Err(format!("the model does not offer {id:?}")) } else { Ok(table) }
    }

    /// Runs `init_state` and makes the result the start state.
    pub fn init_state(&mut self) -> Result<(), String> {
        if let Some(init) = self.model.init_state {
            self.call(init, 0.0)?;
            let [start, end] = &mut self.state;
            start.get_mut().copy_from_slice(end.get());
        }
        Ok(())
    }

    /// Makes the end of the last update the start of the next.
    pub fn commit(&mut self) {
        self.stress.swap(0, 1);
        self.state.swap(0, 1);
    }

    /// The same for point `k` alone.
    pub fn commit_point(&mut self, k: usize) {
        let stride = self.stride;
        for [start, end] in [&mut self.stress, &mut self.state] {
            for at in (k..end.length).step_by(stride) {
                start.get_mut()[at] = end.get()[at];
            }
        }
    }

    /// Time of one point in one `update` with the step `dt` [ns/point], through the table and with everything that a call
    /// costs: the fastest of several runs over all points of the driver, since what disturbs a run only makes it slower. The engine's batches have 256 points. All runs
    /// begin at the same start state; [`simd::force`](crate::simd::force) chooses the instructions.
    pub fn nanoseconds_per_point(&mut self, dt: f64) -> Result<f64, String> {
        const RUNS: usize = 20;
        const POINTS_A_RUN: usize = 1 << 17;
        self.update(dt)?;
        let update = self.model.update.ok_or("the model has no update")?;
        let (instance, calls) = (self.instance, (POINTS_A_RUN / self.n.max(1)).max(1));
        let points = (calls * self.n.max(1)) as f64;
        let inputs = self.input_pointers();
        let batch = self.batch(&inputs, dt);
        let mut fastest = f64::INFINITY;
        for _ in 0..RUNS {
            let start = Instant::now();
            for _ in 0..calls {
                // SAFETY: as in `call`.
                result(unsafe { update(instance, &batch) })?;
            }
            fastest = fastest.min(start.elapsed().as_secs_f64() * 1e9 / points);
        }
        Ok(fastest)
    }

    fn call(
        &mut self,
        function: unsafe extern "C" fn(*const c_void, *const lahar_stress_batch) -> i32,
        dt: f64,
    ) -> Result<(), String> {
        self.status.fill(0);
        for out in
            [&mut self.wave_speed, &mut self.diffusivity, &mut self.energy, &mut self.dt_factor]
        {
            out.get_mut().fill(f64::NAN);
        }
        let instance = self.instance;
        let inputs = self.input_pointers();
        let batch = self.batch(&inputs, dt);
        // SAFETY: the instance is of this model; the arrays belong to this driver, do not alias and are as long as the
        // ABI says.
        result(unsafe { function(instance, &batch) })
    }

    fn input_pointers(&self) -> Vec<*const f64> {
        self.inputs.iter().map(|i| i.get().as_ptr()).collect()
    }

    /// The C batch of all points; arrays that the model has not declared are NULL.
    fn batch(&mut self, inputs: &[*const f64], dt: f64) -> lahar_stress_batch {
        let given = |wanted: bool, array: &Aligned| {
            if wanted { array.get().as_ptr() } else { ptr::null() }
        };
        let kinematics = self.model.kinematics;
        let (strain, velocity, deformation) = (
            given(takes_strain_increment(kinematics), &self.kinematics),
            given(kinematics == LAHAR_KINEMATICS_VELOCITY_GRADIENT, &self.kinematics),
            given(kinematics == LAHAR_KINEMATICS_DEFORMATION_GRADIENT, &self.kinematics),
        );
        let outputs = self.model.outputs;
        let declared = |output: u64, array: &mut Aligned| {
            if outputs & output != 0 { array.get_mut().as_mut_ptr() } else { ptr::null_mut() }
        };
        let [stress0, stress1] = &mut self.stress;
        let [state0, state1] = &mut self.state;
        lahar_stress_batch {
            struct_size: size_of::<lahar_stress_batch>() as u32,
            flags: 0,
            n: self.n as i64,
            stride: self.stride as i64,
            dt,
            time: 0.0,
            step: -1,
            strain_increment: strain,
            velocity_gradient: velocity,
            deformation_gradient: deformation,
            stress0: stress0.get().as_ptr(),
            state0: state0.get().as_ptr(),
            stress1: stress1.get_mut().as_mut_ptr(),
            state1: state1.get_mut().as_mut_ptr(),
            inputs: inputs.as_ptr(),
            wave_speed: self.wave_speed.get_mut().as_mut_ptr(),
            diffusivity: declared(LAHAR_OUTPUT_DIFFUSIVITY, &mut self.diffusivity),
            energy: declared(LAHAR_OUTPUT_ENERGY, &mut self.energy),
            dt_factor: declared(LAHAR_OUTPUT_DT_FACTOR, &mut self.dt_factor),
            status: if outputs & LAHAR_OUTPUT_STATUS != 0 {
                self.status.as_mut_ptr()
            } else {
                ptr::null_mut()
            },
        }
    }
}

impl Drop for Driver {
    fn drop(&mut self) {
        if let Some(destroy) = self.model.destroy {
            // SAFETY: the instance came from this model's `create` and is destroyed once.
            unsafe { destroy(self.instance) };
        }
    }
}

fn create(model: &lahar_model_desc, values: &[f64]) -> Result<*mut c_void, String> {
    let count = values.len() as i64;
    if let Some(check) = model.check {
        let mut text = [0_u8; 512];
        // SAFETY: `values` has `count` values and `text` its own length.
        let code = unsafe {
            check(
                model,
                values.as_ptr(),
                count,
                text.as_mut_ptr().cast::<c_char>(),
                text.len() as i64,
            )
        };
        if code != LAHAR_PLUGIN_OK {
            let text = CStr::from_bytes_until_nul(&text).unwrap_or(c"?");
            return Err(text.to_string_lossy().into_owned());
        }
    }
    let create = model.create.ok_or("the model has no create")?;
    let mut instance = ptr::null_mut();
    // SAFETY: `values` has `count` values and `instance` is a place for one pointer.
    result(unsafe { create(model, values.as_ptr(), count, &mut instance) })?;
    Ok(instance)
}

fn result(code: i32) -> Result<(), String> {
    if code == LAHAR_PLUGIN_OK { Ok(()) } else { Err(ERROR.take()) }
}

fn usual_input(kind: i32) -> f64 {
    match kind {
        LAHAR_INPUT_DENSITY => 1000.0,
        LAHAR_INPUT_ELEMENT_LENGTH => 1.0,
        LAHAR_INPUT_TEMPERATURE => 293.15,
        _ => 0.0,
    }
}

fn collect_values(
    model: &lahar_model_desc,
    named: &[(&str, f64)],
    typical: bool,
) -> Result<Vec<f64>, String> {
    let parameters = parameters(model);
    // SAFETY: keys are NUL-terminated static strings.
    let key = |p: &lahar_parameter_desc| unsafe { CStr::from_ptr(p.key) }.to_string_lossy();
    for (name, _) in named {
        if !parameters.iter().any(|p| key(p) == *name) {
            return Err(format!("no parameter is named `{name}`"));
        }
    }
    parameters
        .iter()
        .map(|p| match named.iter().find(|(name, _)| key(p) == *name) {
            Some((_, value)) => Ok(*value),
            None if p.required == 0 || typical => Ok(p.default_value),
            None => Err(format!("the parameter `{}` is missing", key(p))),
        })
        .collect()
}

fn parameters(model: &lahar_model_desc) -> &[lahar_parameter_desc] {
    // SAFETY: tables made by this crate are as long as their counts say.
    unsafe { table(model.parameters, model.parameter_count) }
}

fn states(model: &lahar_model_desc) -> &[lahar_state_desc] {
    // SAFETY: as above.
    unsafe { table(model.states, model.state_count) }
}

fn inputs(model: &lahar_model_desc) -> &[i32] {
    // SAFETY: as above.
    unsafe { table(model.inputs, model.input_count) }
}

/// # Safety
///
/// `base` is NULL or points to `count` elements that live for `'a`.
unsafe fn table<'a, T>(base: *const T, count: u32) -> &'a [T] {
    if base.is_null() {
        return &[];
    }
    // SAFETY: guaranteed by the caller.
    unsafe { std::slice::from_raw_parts(base, count as usize) }
}

fn takes_strain_increment(kinematics: i32) -> bool {
    [LAHAR_KINEMATICS_STRAIN_INCREMENT, LAHAR_KINEMATICS_GREEN_NAGHDI].contains(&kinematics)
}

fn state_size(kind: i32) -> usize {
    match kind {
        LAHAR_STATE_SCALAR => 1,
        LAHAR_STATE_VECTOR => 3,
        LAHAR_STATE_SYMMETRIC => 6,
        _ => 9,
    }
}

fn put(data: &mut [f64], stride: usize, k: usize, values: &[f64]) {
    for (c, value) in values.iter().enumerate() {
        data[c * stride + k] = *value;
    }
}
