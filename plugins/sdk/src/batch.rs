//! The safe view of `lahar_stress_batch`.

use crate::model::Model;
use crate::table::{Kinematics, state_components};
use crate::tensor;
use lahar_plugin_abi::*;
use nalgebra::Matrix3;
use std::array;
use std::slice;

/// Largest number of inputs that a model may want.
pub const MAX_INPUTS: usize = 12;

/// What became of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum PointStatus {
    /// Updated.
    Ok = LAHAR_POINT_OK,
    /// Updated, less accurately than promised.
    Unreliable = LAHAR_POINT_UNRELIABLE,
    /// Updated, but the model wants a smaller step.
    SmallerStep = LAHAR_POINT_SMALLER_STEP,
    /// Not updated.
    Failed = LAHAR_POINT_FAILED,
}

/// A run of points. Points are numbered `0..n()`.
///
/// An array that the model did not declare is absent: reading it panics (which the engine sees as an error), writing
/// an absent output does nothing. [`Batch::for_each_point`] runs the formulas of one point over all of them in a loop
/// that vectorises; [`Batch::columns`] gives the same arrays component by component.
pub struct Batch<'a> {
    n: usize,
    pub(crate) stride: usize,
    dt: f64,
    time: f64,
    step: i64,
    pub(crate) strain_increment: &'a [f64],
    pub(crate) velocity_gradient: &'a [f64],
    pub(crate) deformation_gradient: &'a [f64],
    pub(crate) stress0: &'a [f64],
    pub(crate) state0: &'a [f64],
    pub(crate) inputs: [&'a [f64]; MAX_INPUTS],
    pub(crate) stress1: &'a mut [f64],
    pub(crate) state1: &'a mut [f64],
    pub(crate) wave_speed: &'a mut [f64],
    pub(crate) diffusivity: &'a mut [f64],
    pub(crate) energy: &'a mut [f64],
    dt_factor: &'a mut [f64],
    pub(crate) status: &'a mut [i32],
}

/// The arrays of a batch as one slice of `n` values per component; absent arrays are empty slices.
/// `S` is the number of components of all state variables.
pub struct Columns<'b, const S: usize> {
    /// dt sym L, 6 components [-].
    pub strain_increment: [&'b [f64]; 6],
    /// L, 9 components [1/s].
    pub velocity_gradient: [&'b [f64]; 9],
    /// F at the end of the step, 9 components [-].
    pub deformation_gradient: [&'b [f64]; 9],
    /// Cauchy stress at the start, 6 components [Pa].
    pub stress0: [&'b [f64]; 6],
    /// State at the start.
    pub state0: [&'b [f64]; S],
    /// The wanted inputs in the order of [`Model::INPUTS`].
    pub inputs: [&'b [f64]; MAX_INPUTS],
    /// Cauchy stress at the end, 6 components [Pa].
    pub stress1: [&'b mut [f64]; 6],
    /// State at the end.
    pub state1: [&'b mut [f64]; S],
    /// Speed of the fastest wave [m/s].
    pub wave_speed: &'b mut [f64],
    /// Kinematic diffusivity [m^2/s].
    pub diffusivity: &'b mut [f64],
    /// One of `LAHAR_POINT_*` per point.
    pub status: &'b mut [i32],
}

/// Which function a batch was made for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Call {
    InitState,
    Update,
    WaveSpeed,
    Tangent,
    StoredEnergy,
}

impl<'a> Batch<'a> {
    /// Number of points.
    #[inline]
    pub fn n(&self) -> usize {
        self.n
    }

    /// Length of the step [s].
    #[inline]
    pub fn dt(&self) -> f64 {
        self.dt
    }

    /// Time at the start of the step [s].
    #[inline]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Number of steps before this one; -1 if there is no such count.
    #[inline]
    pub fn step(&self) -> i64 {
        self.step
    }

    /// Strain increment of point `k`, tensor components [-].
    #[inline]
    pub fn strain_increment(&self, k: usize) -> [f64; 6] {
        self.gather(self.strain_increment, k)
    }

    /// Velocity gradient of point `k` [1/s].
    #[inline]
    pub fn velocity_gradient(&self, k: usize) -> Matrix3<f64> {
        Matrix3::from_row_slice(&self.gather::<9>(self.velocity_gradient, k))
    }

    /// Deformation gradient of point `k` at the end of the step [-].
    #[inline]
    pub fn deformation_gradient(&self, k: usize) -> Matrix3<f64> {
        Matrix3::from_row_slice(&self.gather::<9>(self.deformation_gradient, k))
    }

    /// The same row by row.
    #[inline]
    pub fn deformation_gradient_rows(&self, k: usize) -> [f64; 9] {
        self.gather(self.deformation_gradient, k)
    }

    /// Cauchy stress of point `k` at the start [Pa].
    #[inline]
    pub fn stress0(&self, k: usize) -> [f64; 6] {
        self.gather(self.stress0, k)
    }

    /// Cauchy stress of point `k` at the start as a matrix [Pa].
    #[inline]
    pub fn stress0_matrix(&self, k: usize) -> Matrix3<f64> {
        tensor::to_matrix(self.stress0(k))
    }

    /// The `S` state components of point `k` at the start.
    #[inline]
    pub fn state0<const S: usize>(&self, k: usize) -> [f64; S] {
        self.gather(self.state0, k)
    }

    /// One value per point of input `i`, counted in the order of [`Model::INPUTS`].
    #[inline]
    pub fn input(&self, i: usize) -> &'a [f64] {
        self.inputs[i]
    }

    /// Sets the Cauchy stress of point `k` at the end [Pa].
    #[inline]
    pub fn set_stress1(&mut self, k: usize, stress: [f64; 6]) {
        scatter(self.stress1, self.stride, k, stress);
    }

    /// Sets the Cauchy stress of point `k` at the end from the symmetric part of a matrix [Pa].
    #[inline]
    pub fn set_stress1_matrix(&mut self, k: usize, stress: &Matrix3<f64>) {
        self.set_stress1(k, tensor::from_matrix(stress));
    }

    /// Sets the `S` state components of point `k` at the end.
    #[inline]
    pub fn set_state1<const S: usize>(&mut self, k: usize, state: [f64; S]) {
        scatter(self.state1, self.stride, k, state);
    }

    /// Sets the speed of the fastest wave at point `k` [m/s].
    #[inline]
    pub fn set_wave_speed(&mut self, k: usize, value: f64) {
        set(self.wave_speed, k, value);
    }

    /// Sets the kinematic diffusivity of point `k` [m^2/s].
    #[inline]
    pub fn set_diffusivity(&mut self, k: usize, value: f64) {
        set(self.diffusivity, k, value);
    }

    /// Sets the stored energy per current volume of point `k` [J/m^3].
    #[inline]
    pub fn set_energy(&mut self, k: usize, value: f64) {
        set(self.energy, k, value);
    }

    /// Sets the factor by which point `k` wants the next time step changed [-].
    #[inline]
    pub fn set_dt_factor(&mut self, k: usize, value: f64) {
        set(self.dt_factor, k, value);
    }

    /// Sets the status of point `k`; it is `Ok` on entry.
    #[inline]
    pub fn set_status(&mut self, k: usize, status: PointStatus) {
        set(self.status, k, status as i32);
    }

    /// The arrays component by component. `S` is the number of components of all state variables.
    pub fn columns<const S: usize>(&mut self) -> Columns<'_, S> {
        let (n, stride) = (self.n, self.stride);
        Columns {
            strain_increment: split(self.strain_increment, stride, n),
            velocity_gradient: split(self.velocity_gradient, stride, n),
            deformation_gradient: split(self.deformation_gradient, stride, n),
            stress0: split(self.stress0, stride, n),
            state0: split(self.state0, stride, n),
            inputs: self.inputs,
            stress1: split_mut(self.stress1, stride, n),
            state1: split_mut(self.state1, stride, n),
            wave_speed: self.wave_speed,
            diffusivity: self.diffusivity,
            status: self.status,
        }
    }

    #[inline]
    fn gather<const C: usize>(&self, data: &[f64], k: usize) -> [f64; C] {
        debug_assert!(k < self.n);
        array::from_fn(|c| data[c * self.stride + k])
    }

    /// Checks what a C caller passed and borrows its arrays.
    ///
    /// # Safety
    ///
    /// `raw` is NULL or points to a batch whose arrays are NULL or as long as the ABI says for the model `M`, stay
    /// valid for `'a`, and do not alias; nobody else writes them meanwhile.
    pub(crate) unsafe fn from_raw<M: Model>(
        raw: *const lahar_stress_batch,
        call: Call,
    ) -> Result<Batch<'a>, String> {
        // SAFETY: the caller guarantees that a pointer that is not NULL is valid.
        let raw = unsafe { raw.as_ref() }.ok_or("the batch is NULL")?;
        if (raw.struct_size as usize) < size_of::<lahar_stress_batch>() {
            return Err(format!("the batch has {} bytes, too few", raw.struct_size));
        }
        let n = usize::try_from(raw.n).map_err(|_| "the number of points is negative")?;
        let stride = usize::try_from(raw.stride).map_err(|_| "the stride is negative")?;
        if stride < n || stride > isize::MAX as usize / 4096 {
            return Err(format!("the stride {stride} does not fit {n} points"));
        }
        let states = const { state_components(M::STATES) };
        let length = |components: usize| match components {
            0 => 0,
            c => (c - 1) * stride + n,
        };
        let mut inputs: [&[f64]; MAX_INPUTS] = [&[]; MAX_INPUTS];
        if !M::INPUTS.is_empty() && raw.inputs.is_null() {
            return Err("the array of inputs is NULL".into());
        }
        for (i, input) in inputs.iter_mut().enumerate().take(M::INPUTS.len()) {
            // SAFETY: the ABI gives one pointer per wanted input, each NULL or with n values.
            *input = unsafe { read(*raw.inputs.add(i), n) };
            require(input, n, "a wanted input")?;
        }
        // SAFETY: the ABI fixes the number of components of each array; NULL becomes an empty slice; the arrays do
        // not alias, and the end state and the outputs are ours alone for the call.
        let batch = unsafe {
            Batch {
                n,
                stride,
                dt: raw.dt,
                time: raw.time,
                step: raw.step,
                strain_increment: read(raw.strain_increment, length(6)),
                velocity_gradient: read(raw.velocity_gradient, length(9)),
                deformation_gradient: read(raw.deformation_gradient, length(9)),
                stress0: read(raw.stress0, length(6)),
                state0: read(raw.state0, length(states)),
                inputs,
                stress1: write(raw.stress1, length(6)),
                state1: write(raw.state1, length(states)),
                wave_speed: write(raw.wave_speed, n),
                diffusivity: write(raw.diffusivity, n),
                energy: write(raw.energy, n),
                dt_factor: write(raw.dt_factor, n),
                status: write(raw.status, n),
            }
        };
        batch.check::<M>(call)?;
        Ok(batch)
    }

    /// Refuses a batch that lacks an array without which the call makes no sense.
    fn check<M: Model>(&self, call: Call) -> Result<(), String> {
        let (n, states) = (self.n, state_components(M::STATES));
        require(self.stress0, n, "stress0")?;
        if call != Call::InitState {
            require(self.state0, n.min(states), "state0")?;
            if matches!(call, Call::Update | Call::WaveSpeed) {
                require(self.wave_speed, n, "wave_speed")?;
            }
            if M::KINEMATICS == Kinematics::DeformationGradient {
                require(self.deformation_gradient, n, "deformation_gradient")?;
            }
        }
        if matches!(call, Call::InitState | Call::Update) {
            require(self.state1, n.min(states), "state1")?;
        }
        if call == Call::Update {
            require(self.stress1, n, "stress1")?;
        }
        if matches!(call, Call::Update | Call::Tangent) {
            let (kinematics, name) = match M::KINEMATICS {
                Kinematics::VelocityGradient => (self.velocity_gradient, "velocity_gradient"),
                Kinematics::DeformationGradient => {
                    (self.deformation_gradient, "deformation_gradient")
                }
                _ => (self.strain_increment, "strain_increment"),
            };
            require(kinematics, n, name)?;
        }
        Ok(())
    }
}

fn require(data: &[f64], n: usize, name: &str) -> Result<(), String> {
    if n > 0 && data.is_empty() { Err(format!("{name} is NULL")) } else { Ok(()) }
}

/// # Safety
///
/// `base` is NULL or points to `length` values that nobody writes during `'a`.
unsafe fn read<'a>(base: *const f64, length: usize) -> &'a [f64] {
    if base.is_null() {
        return &[];
    }
    // SAFETY: guaranteed by the caller.
    unsafe { slice::from_raw_parts(base, length) }
}

/// # Safety
///
/// `base` is NULL or points to `length` values that nobody else touches during `'a`.
unsafe fn write<'a, T>(base: *mut T, length: usize) -> &'a mut [T] {
    if base.is_null() {
        return &mut [];
    }
    // SAFETY: guaranteed by the caller.
    unsafe { slice::from_raw_parts_mut(base, length) }
}

#[inline]
fn scatter<const C: usize>(data: &mut [f64], stride: usize, k: usize, values: [f64; C]) {
    for (c, value) in values.into_iter().enumerate() {
        data[c * stride + k] = value;
    }
}

#[inline]
fn set<T>(data: &mut [T], k: usize, value: T) {
    if let Some(place) = data.get_mut(k) {
        *place = value;
    }
}

fn split<const C: usize>(data: &[f64], stride: usize, n: usize) -> [&[f64]; C] {
    let mut runs = data.chunks(stride.max(1));
    array::from_fn(|_| runs.next().map_or(&[][..], |run| &run[..n]))
}

fn split_mut<const C: usize>(data: &mut [f64], stride: usize, n: usize) -> [&mut [f64]; C] {
    let mut runs = data.chunks_mut(stride.max(1));
    array::from_fn(|_| runs.next().map_or(&mut [][..], |run| &mut run[..n]))
}
