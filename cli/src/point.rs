//! Material points outside a world: what a model is given, what it gives, and how a point moves on,
//! all as the engine does it.

use lahar::error::Result;
use lahar::material::{Input, Kinematics, Material, Model, Rotation, StressBatch};
use lahar::tensor::{Mat3, rotate, rotation_between, step_rotation, symmetric, symmetric_part};
use lahar_plugin_abi as abi;
use std::sync::Arc;

/// Grid spacing that models are given [m].
const ELEMENT_LENGTH: f64 = 0.1;
/// Temperature that models are given [K].
const TEMPERATURE: f64 = 293.15;

/// A material point between steps.
#[derive(Clone, Debug)]
pub struct Point {
    /// Cauchy stress [Pa].
    pub stress: [f64; 6],
    /// All components of all state variables.
    pub state: Vec<f64>,
    /// Deformation gradient [-].
    pub deformation: Mat3,
    /// Density [kg/m^3].
    pub density: f64,
    /// Specific internal energy [J/kg].
    pub energy: f64,
}

/// What a model is given of one point.
#[derive(Clone, Debug, PartialEq)]
pub struct Given {
    /// Length of the step [s]; the same for all points of a batch.
    pub dt: f64,
    /// dt sym L [-].
    pub strain: [f64; 6],
    /// L [1/s], row-major.
    pub gradient: [f64; 9],
    /// F at the end of the step, row-major.
    pub deformation: [f64; 9],
    /// Stress at the start [Pa].
    pub stress: [f64; 6],
    /// State at the start.
    pub state: Vec<f64>,
    /// One value per input of the model.
    pub inputs: Vec<f64>,
}

/// What a model gives for one point.
#[derive(Clone, Debug)]
pub struct Got {
    /// Stress at the end [Pa].
    pub stress: [f64; 6],
    /// State at the end.
    pub state: Vec<f64>,
    /// Wave speed [m/s].
    pub wave_speed: f64,
    /// Diffusivity [m^2/s], energy [J/m^3] and factor on the time step, those that the model
    /// declares.
    pub others: Vec<f64>,
    /// One of `LAHAR_POINT_*`.
    pub status: i32,
}

impl Got {
    /// Whether the model says that it has a result.
    pub fn is_done(&self) -> bool {
        self.status < abi::LAHAR_POINT_FAILED
    }

    pub fn is_finite(&self) -> bool {
        self.values().iter().all(|v| v.is_finite())
    }

    /// All numbers, for comparisons.
    pub fn values(&self) -> Vec<f64> {
        let speed = [self.wave_speed];
        let parts: [&[f64]; 4] = [&self.stress, &self.state, &speed, &self.others];
        parts.concat()
    }

    /// All of it, bit for bit.
    pub fn bits(&self) -> Vec<u64> {
        let status = [self.status as u64];
        self.values().iter().map(|v| v.to_bits()).chain(status).collect()
    }
}

fn row_major(m: &Mat3) -> [f64; 9] {
    std::array::from_fn(|c| m[(c / 3, c % 3)])
}

/// Rows of a matrix, as the engine's kernels take them.
fn rows(m: &Mat3) -> [[f64; 3]; 3] {
    std::array::from_fn(|a| std::array::from_fn(|b| m[(a, b)]))
}

/// State variables turned by `r`, those that the engine turns.
pub fn turned_state(model: &Model, state: &[f64], r: &Mat3) -> Vec<f64> {
    let mut out = state.to_vec();
    let mut first = 0;
    for variable in &model.states {
        let count = variable.components();
        let part = &mut out[first..first + count];
        first += count;
        if variable.rotation != Rotation::Objective {
            continue;
        }
        match count {
            3 => part.copy_from_slice((r * nalgebra::Vector3::from_column_slice(part)).as_slice()),
            6 => part.copy_from_slice(&rotate(r, std::array::from_fn(|c| part[c]))),
            9 => {
                let m = Mat3::from_row_slice(part);
                part.copy_from_slice(&row_major(&(r * m * r.transpose())));
            }
            _ => {}
        }
    }
    out
}

impl Point {
    /// An isotropic start: the state variables have their initial values.
    pub fn new(model: &Model, pressure: f64, density: f64, energy: f64) -> Self {
        let initial = model.states.iter().flat_map(|s| vec![s.initial; s.components()]);
        Self {
            stress: [-pressure, -pressure, -pressure, 0.0, 0.0, 0.0],
            state: initial.collect(),
            deformation: Mat3::identity(),
            density,
            energy,
        }
    }

    fn inputs(&self, model: &Model, density: f64) -> Vec<f64> {
        let value = |input: &Input| match input {
            Input::Density => density,
            Input::ElementLength => ELEMENT_LENGTH,
            Input::Temperature => TEMPERATURE,
            Input::InternalEnergy => self.energy,
            Input::PorePressure => 0.0,
            Input::PositionX | Input::PositionY | Input::PositionZ => 0.5,
            Input::ParticleId => 7.0,
        };
        model.inputs.iter().map(value).collect()
    }

    /// What the model is given for a step of `dt` with the velocity gradient `l`.
    pub fn given(&self, model: &Model, l: &Mat3, dt: f64) -> Given {
        let deformation = (Mat3::identity() + l * dt) * self.deformation;
        let turn = match model.kinematics {
            Kinematics::GreenNaghdi => {
                let r = rotation_between(&rows(&self.deformation), &rows(&deformation));
                Mat3::from_fn(|a, b| r[a][b])
            }
            _ => step_rotation(l, dt),
        };
        let stress = match model.kinematics.takes_strain_increment() {
            true => rotate(&turn, self.stress),
            false => self.stress,
        };
        Given {
            dt,
            strain: symmetric_part(&(l * dt)),
            gradient: row_major(l),
            deformation: row_major(&deformation),
            stress,
            state: turned_state(model, &self.state, &turn),
            inputs: self.inputs(model, self.density / growth(model, l, dt)),
        }
    }

    /// What the model is given to derive a first state or a wave speed.
    pub fn at_rest(&self, model: &Model) -> Given {
        self.given(model, &Mat3::zeros(), 1e-3)
    }

    /// The point after the step.
    pub fn moved(&self, model: &Model, l: &Mat3, given: &Given, got: &Got) -> Self {
        let density = self.density / growth(model, l, given.dt);
        let energy = match model.gives(abi::LAHAR_OUTPUT_ENERGY) {
            true => got.others[usize::from(model.gives(abi::LAHAR_OUTPUT_DIFFUSIVITY))] / density,
            false => self.energy + work(&given.stress, &got.stress, &given.strain) / density,
        };
        Self {
            stress: got.stress,
            state: got.state.clone(),
            deformation: Mat3::from_row_slice(&given.deformation),
            density,
            energy,
        }
    }
}

/// Volume after the step over the volume before.
pub fn growth(model: &Model, l: &Mat3, dt: f64) -> f64 {
    match model.kinematics.carries_deformation_gradient() {
        true => (Mat3::identity() + l * dt).determinant(),
        false => (l.trace() * dt).exp(),
    }
}

/// Work per volume of a step [J/m^3].
pub fn work(start: &[f64; 6], end: &[f64; 6], strain: &[f64; 6]) -> f64 {
    (0..6).map(|c| if c < 3 { 0.5 } else { 1.0 } * (start[c] + end[c]) * strain[c]).sum()
}

impl Given {
    /// The same of a material that was turned by `r`, and the engine turned stress and state with
    /// it.
    pub fn turned(&self, model: &Model, r: &Mat3) -> Self {
        Self {
            strain: rotate(r, self.strain),
            stress: rotate(r, self.stress),
            state: turned_state(model, &self.state, r),
            ..self.clone()
        }
    }

    /// The same with `strain` [-] more in the step; the deformation gradient takes it on top of the
    /// rest, the density goes with it.
    pub fn strained(&self, model: &Model, strain: &[f64; 6]) -> Self {
        let mut out = self.clone();
        for c in 0..6 {
            out.strain[c] += strain[c];
        }
        let more = symmetric(*strain);
        for c in 0..9 {
            out.gradient[c] += more[(c / 3, c % 3)] / self.dt;
        }
        let f = Mat3::from_row_slice(&self.deformation);
        out.deformation = row_major(&((Mat3::identity() + more) * f));
        if let Some(density) = model.input(Input::Density) {
            out.inputs[density] /= growth(model, &more, 1.0);
        }
        out
    }

    /// The numbers that the model sees, each so that it can be typed back.
    pub fn describe(&self, model: &Model) -> String {
        let mut text = format!("dt = {:?}", self.dt);
        match model.kinematics {
            Kinematics::VelocityGradient => {
                text += &format!(", velocity gradient = {:?}", self.gradient);
            }
            Kinematics::DeformationGradient => {
                text += &format!(", deformation gradient = {:?}", self.deformation);
            }
            _ => text += &format!(", strain increment = {:?}", self.strain),
        }
        text += &format!(", stress = {:?}", self.stress);
        if !self.state.is_empty() {
            text += &format!(", state = {:?}", self.state);
        }
        for (input, value) in model.inputs.iter().zip(&self.inputs) {
            text += &format!(", {} = {value:?}", input.key());
        }
        text
    }
}

/// An array on a 64-byte boundary.
struct Array {
    data: Vec<f64>,
    start: usize,
    length: usize,
}

impl Array {
    fn new(length: usize) -> Self {
        let data = vec![0.0; length + 8];
        let start = data.as_ptr().align_offset(64).min(8);
        Self { data, start, length }
    }

    /// Row `c` of point `k` takes `value(k)[c]`.
    fn of(components: usize, stride: usize, points: &[&[f64]]) -> Self {
        let mut array = Self::new(components * stride);
        for (k, point) in points.iter().enumerate() {
            for c in 0..components {
                array.slice_mut()[c * stride + k] = point[c];
            }
        }
        array
    }

    fn slice(&self) -> &[f64] {
        &self.data[self.start..self.start + self.length]
    }

    fn slice_mut(&mut self) -> &mut [f64] {
        &mut self.data[self.start..self.start + self.length]
    }
}

/// The arrays of a batch.
pub struct Points {
    model: &'static Model,
    n: usize,
    stride: usize,
    dt: f64,
    /// Strain increment, velocity gradient, deformation gradient, stress, state, inputs.
    read: [Array; 6],
    /// Stress, state, wave speed, diffusivity, energy, factor on the time step, an extension's own.
    written: [Array; 7],
    status: Vec<i32>,
}

impl Points {
    /// A batch of these points; at least one.
    pub fn new(model: &'static Model, given: &[Given]) -> Self {
        let (n, stride) = (given.len(), given.len().next_multiple_of(8));
        let states = model.state_components();
        let of = |components, part: fn(&Given) -> &[f64]| {
            Array::of(components, stride, &given.iter().map(part).collect::<Vec<_>>())
        };
        let read = [
            of(6, |g| &g.strain),
            of(9, |g| &g.gradient),
            of(9, |g| &g.deformation),
            of(6, |g| &g.stress),
            of(states, |g| &g.state),
            of(model.inputs.len(), |g| &g.inputs),
        ];
        let output = |mask| Array::new(if model.gives(mask) { stride } else { 0 });
        let written = [
            Array::new(6 * stride),
            of(states, |g| &g.state),
            Array::new(stride),
            output(abi::LAHAR_OUTPUT_DIFFUSIVITY),
            output(abi::LAHAR_OUTPUT_ENERGY),
            output(abi::LAHAR_OUTPUT_DT_FACTOR),
            Array::new(36 * stride),
        ];
        let dt = given.first().map_or(0.0, |g| g.dt);
        Self { model, n, stride, dt, read, written, status: vec![0; stride] }
    }

    /// The batch, and the array of an extension's own.
    fn batch(&mut self) -> (StressBatch<'_>, &mut [f64]) {
        self.status.fill(0);
        let [strain, gradient, deformation, stress0, state0, inputs] = &self.read;
        let [stress1, state1, speed, diffusivity, energy, factor, own] = &mut self.written;
        let batch = StressBatch {
            n: self.n,
            stride: self.stride,
            dt: self.dt,
            time: 0.0,
            step: -1,
            strain_increment: strain.slice(),
            velocity_gradient: gradient.slice(),
            deformation_gradient: deformation.slice(),
            stress0: stress0.slice(),
            state0: state0.slice(),
            stress1: stress1.slice_mut(),
            state1: state1.slice_mut(),
            inputs: inputs.slice(),
            wave_speed: speed.slice_mut(),
            diffusivity: diffusivity.slice_mut(),
            energy: energy.slice_mut(),
            dt_factor: factor.slice_mut(),
            status: &mut self.status,
        };
        (batch, own.slice_mut())
    }

    pub fn update(&mut self, material: &Arc<Material>) -> Result<()> {
        material.update(&mut self.batch().0)
    }

    pub fn wave_speed(&mut self, material: &Arc<Material>) -> Result<()> {
        material.wave_speed(&mut self.batch().0)
    }

    pub fn init_state(&mut self, material: &Arc<Material>) -> Result<()> {
        material.init_state(&mut self.batch().0)
    }

    pub fn tangent(&mut self, material: &Arc<Material>) -> Option<Result<()>> {
        let (mut batch, own) = self.batch();
        material.tangent(&mut batch, own)
    }

    pub fn stored_energy(&mut self, material: &Arc<Material>) -> Option<Result<()>> {
        let (mut batch, own) = self.batch();
        material.stored_energy(&mut batch, own)
    }

    /// What the model gave for point `k`.
    pub fn got(&self, k: usize) -> Got {
        let [stress, state, speed, others @ .., _] = &self.written;
        let at = |array: &Array, c: usize| array.slice()[c * self.stride + k];
        let declared = others.iter().filter(|array| array.length > 0);
        Got {
            stress: std::array::from_fn(|c| at(stress, c)),
            state: (0..self.model.state_components()).map(|c| at(state, c)).collect(),
            wave_speed: at(speed, 0),
            others: declared.map(|array| at(array, 0)).collect(),
            status: self.status[k],
        }
    }

    /// Component `c` of what an extension gave for point `k`.
    pub fn own(&self, c: usize, k: usize) -> f64 {
        self.written[6].slice()[c * self.stride + k]
    }
}
