//! Builds the guests of `tests/fortran`, adapts them, and runs their tables on batches, as an engine does.
#![allow(dead_code)] // each test binary uses a part

use lahar_plugin_abi::*;
use lahar_umat::build::{Order, build};
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char, c_void};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::{fs, ptr, slice};

thread_local! {
    static ERROR: RefCell<String> = const { RefCell::new(String::new()) };
    static LOG: RefCell<Vec<(i32, String)>> = const { RefCell::new(Vec::new()) };
}

unsafe extern "C" fn set_error(message: *const c_char) {
    // SAFETY: the adapter passes a text that ends with a NUL.
    ERROR.set(unsafe { CStr::from_ptr(message) }.to_string_lossy().into_owned());
}

unsafe extern "C" fn log(level: i32, message: *const c_char) {
    // SAFETY: as above.
    let text = unsafe { CStr::from_ptr(message) }.to_string_lossy().into_owned();
    LOG.with_borrow_mut(|log| log.push((level, text)));
}

static HOST: lahar_host_api = lahar_host_api {
    struct_size: size_of::<lahar_host_api>() as u32,
    abi_minor: LAHAR_PLUGIN_ABI_MINOR,
    log: Some(log),
    set_error: Some(set_error),
    should_stop: None,
};

/// What this thread's calls have logged since it was asked last.
pub fn logged() -> Vec<(i32, String)> {
    LOG.take()
}

/// A new folder for one test.
pub fn folder() -> PathBuf {
    static NUMBER: AtomicUsize = AtomicUsize::new(0);
    let number = NUMBER.fetch_add(1, Ordering::Relaxed);
    let name = format!("umat-{}-{number}", std::process::id());
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::create_dir_all(&folder).expect("a folder for the test");
    folder
}

/// A source of `tests/fortran`.
pub fn source(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fortran").join(name)
}

/// The library of a source of `tests/fortran`, with this sidecar beside it.
pub fn library(name: &str, sidecar: Option<&str>) -> PathBuf {
    library_of(&source(name), sidecar)
}

/// The library of a source.
pub fn library_of(source: &Path, sidecar: Option<&str>) -> PathBuf {
    let stem = source.file_stem().expect("a name").to_string_lossy().into_owned();
    let library = folder().join(format!("lib{stem}.so"));
    let order = Order { output: Some(library.clone()), ..Order::new([source.to_path_buf()]) };
    build(&order).unwrap_or_else(|e| panic!("{e}"));
    if let Some(text) = sidecar {
        fs::write(library.with_extension("json"), text).expect("a sidecar");
    }
    library
}

/// The model made of a library.
pub fn adapt(library: &Path) -> Result<&'static lahar_model_desc, String> {
    static ONE: Mutex<()> = Mutex::new(());
    let _one = ONE.lock().expect("adapt does not panic");
    let path = CString::new(library.to_str().expect("UTF-8")).expect("no NUL");
    // SAFETY: the host table is static, the path ends with a NUL.
    unsafe {
        let plugin = lahar_umat::adapt(&HOST, path.as_ptr()).as_ref();
        let plugin = plugin.ok_or_else(|| ERROR.take())?;
        assert_eq!((plugin.abi_major, plugin.model_count), (LAHAR_PLUGIN_ABI_MAJOR, 1));
        Ok(&**plugin.models)
    }
}

/// Text of a table.
pub fn text(text: *const c_char) -> &'static str {
    // SAFETY: the tables hold texts that end with a NUL and live as long as the process.
    unsafe { CStr::from_ptr(text) }.to_str().expect("UTF-8")
}

pub fn parameters(model: &lahar_model_desc) -> &'static [lahar_parameter_desc] {
    table(model.parameters, model.parameter_count)
}

pub fn states(model: &lahar_model_desc) -> &'static [lahar_state_desc] {
    table(model.states, model.state_count)
}

pub fn inputs(model: &lahar_model_desc) -> &'static [i32] {
    table(model.inputs, model.input_count)
}

fn table<T>(base: *const T, count: u32) -> &'static [T] {
    // SAFETY: the model's tables have as many entries as it says.
    if count == 0 { &[] } else { unsafe { slice::from_raw_parts(base, count as usize) } }
}

fn size(state: &lahar_state_desc) -> usize {
    [1, 3, 6, 9][state.kind as usize]
}

/// An instance with `n` points.
pub struct Material {
    pub model: &'static lahar_model_desc,
    instance: *mut c_void,
    pub n: usize,
    stride: usize,
    pub dt: f64,
    pub time: f64,
    pub step: i64,
    gradient: Vec<f64>,
    stress: [Vec<f64>; 2],
    state: [Vec<f64>; 2],
    inputs: Vec<Vec<f64>>,
    pub wave_speed: Vec<f64>,
    pub energy: Vec<f64>,
    pub dt_factor: Vec<f64>,
    pub status: Vec<i32>,
}

impl Material {
    /// `values` for the first parameters, the others have their defaults; initial state, zero stress, density 1000, others 0.
    pub fn new(model: &'static lahar_model_desc, values: &[f64], n: usize) -> Result<Self, String> {
        let all = parameters(model);
        let values: Vec<f64> = (0..all.len())
            .map(|i| values.get(i).copied().unwrap_or(all[i].default_value))
            .collect();
        let mut instance = ptr::null_mut();
        let create = model.create.expect("create");
        // SAFETY: the values are as many as the model has parameters.
        let code = unsafe { create(model, values.as_ptr(), values.len() as i64, &mut instance) };
        if code != LAHAR_PLUGIN_OK {
            return Err(ERROR.take());
        }
        let stride = n.next_multiple_of(8);
        let mut state = Vec::new();
        for s in states(model) {
            state.extend(vec![s.initial; size(s) * stride]);
        }
        let density = |i: &i32| if *i == LAHAR_INPUT_DENSITY { 1000.0 } else { 0.0 };
        Ok(Self {
            model,
            instance,
            n,
            stride,
            dt: 1.0,
            time: 0.0,
            step: -1,
            gradient: vec![0.0; 9 * stride],
            stress: [vec![0.0; 6 * stride], vec![f64::NAN; 6 * stride]],
            state: [state.clone(), state],
            inputs: inputs(model).iter().map(|i| vec![density(i); stride]).collect(),
            wave_speed: vec![f64::NAN; stride],
            energy: vec![f64::NAN; stride],
            dt_factor: vec![f64::NAN; stride],
            status: vec![0; stride],
        })
    }

    /// The first component of a state variable.
    pub fn at(&self, key: &str) -> usize {
        let all = states(self.model);
        let place = all.iter().position(|s| text(s.key) == key);
        let place = place.unwrap_or_else(|| panic!("no state {key}"));
        all[..place].iter().map(size).sum()
    }

    pub fn set_gradient(&mut self, k: usize, l: [f64; 9]) {
        for c in 0..9 {
            self.gradient[c * self.stride + k] = l[c];
        }
    }

    pub fn set_stress(&mut self, k: usize, s: [f64; 6]) {
        for c in 0..6 {
            self.stress[0][c * self.stride + k] = s[c];
        }
    }

    pub fn set_state(&mut self, k: usize, first: usize, values: &[f64]) {
        for (c, value) in values.iter().enumerate() {
            self.state[0][(first + c) * self.stride + k] = *value;
        }
    }

    /// Sets an input, one of `LAHAR_INPUT_*`.
    pub fn set_input(&mut self, input: i32, k: usize, value: f64) {
        let place = inputs(self.model).iter().position(|i| *i == input).expect("a wanted input");
        self.inputs[place][k] = value;
    }

    pub fn stress0(&self, k: usize) -> [f64; 6] {
        std::array::from_fn(|c| self.stress[0][c * self.stride + k])
    }

    pub fn stress1(&self, k: usize) -> [f64; 6] {
        std::array::from_fn(|c| self.stress[1][c * self.stride + k])
    }

    pub fn state1<const N: usize>(&self, k: usize, first: usize) -> [f64; N] {
        std::array::from_fn(|c| self.state[1][(first + c) * self.stride + k])
    }

    /// The ends become the starts.
    pub fn commit(&mut self) {
        for array in [&mut self.stress, &mut self.state] {
            let [start, end] = array;
            start.copy_from_slice(end);
        }
        self.time += self.dt;
        self.step += 1;
    }

    pub fn update(&mut self) -> Result<(), String> {
        self.stress[1].fill(f64::NAN);
        self.state[1].fill(f64::NAN);
        let bits = |m: &Self| -> Vec<u64> {
            m.stress[0].iter().chain(&m.state[0]).map(|x| x.to_bits()).collect()
        };
        let before = bits(self);
        let result = self.call(self.model.update.expect("update"));
        assert!(before == bits(self), "the start was written");
        result
    }

    pub fn wave_speed(&mut self) -> Result<(), String> {
        self.call(self.model.wave_speed.expect("wave_speed"))
    }

    pub fn init_state(&mut self) -> Result<(), String> {
        let result = self.call(self.model.init_state.expect("init_state"));
        let [start, end] = &mut self.state;
        start.copy_from_slice(end);
        result
    }

    /// Runs `update` without looks before and after, for timing.
    pub fn update_only(&mut self) {
        self.call(self.model.update.expect("update")).expect("an update");
    }

    fn call(
        &mut self,
        function: unsafe extern "C" fn(*const c_void, *const lahar_stress_batch) -> i32,
    ) -> Result<(), String> {
        let inputs: Vec<*const f64> = self.inputs.iter().map(|i| i.as_ptr()).collect();
        let given = |output: u64, data: *mut f64| {
            if self.model.outputs & output != 0 { data } else { ptr::null_mut() }
        };
        let batch = lahar_stress_batch {
            struct_size: size_of::<lahar_stress_batch>() as u32,
            flags: 0,
            n: self.n as i64,
            stride: self.stride as i64,
            dt: self.dt,
            time: self.time,
            step: self.step,
            strain_increment: ptr::null(),
            velocity_gradient: self.gradient.as_ptr(),
            deformation_gradient: ptr::null(),
            stress0: self.stress[0].as_ptr(),
            state0: self.state[0].as_ptr(),
            stress1: self.stress[1].as_mut_ptr(),
            state1: self.state[1].as_mut_ptr(),
            inputs: inputs.as_ptr(),
            wave_speed: self.wave_speed.as_mut_ptr(),
            diffusivity: ptr::null_mut(),
            energy: given(LAHAR_OUTPUT_ENERGY, self.energy.as_mut_ptr()),
            dt_factor: given(LAHAR_OUTPUT_DT_FACTOR, self.dt_factor.as_mut_ptr()),
            status: self.status.as_mut_ptr(),
        };
        // SAFETY: the instance is of this model, and the arrays are as long as it expects.
        match unsafe { function(self.instance, &batch) } {
            LAHAR_PLUGIN_OK => Ok(()),
            _ => Err(ERROR.take()),
        }
    }
}

impl Drop for Material {
    fn drop(&mut self) {
        let destroy = self.model.destroy.expect("destroy");
        // SAFETY: the instance is of this model and not used any more.
        unsafe { destroy(self.instance) };
    }
}

/// Whether all values agree to `tolerance` times the largest of `b`, or 1e-300.
pub fn close(a: &[f64], b: &[f64], tolerance: f64) -> bool {
    let largest = b.iter().fold(1e-300, |m: f64, x| m.max(x.abs()));
    a.len() == b.len() && a.iter().zip(b).all(|(x, y)| (x - y).abs() <= tolerance * largest)
}

/// Repeatable numbers between -1 and 1.
pub struct Numbers(pub u64);

impl Numbers {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    pub fn array<const N: usize>(&mut self, size: f64) -> [f64; N] {
        std::array::from_fn(|_| size * self.next())
    }
}
