//! Models written as the formulas of one point, in loops that vectorise.

use crate::batch::{Batch, MAX_INPUTS, PointStatus};
use crate::model::Model;
use crate::table::{Kinematics, Output, state_components};

/// Points that are worked on together. They are copied to arrays of this length and their results back, so that the
/// compiler sees loops of a fixed length over arrays that do not overlap. Measured: 8 are unrolled, 32 are no faster.
const GROUP: usize = 16;

/// One component of the points of a group; aligned, so that no vector straddles two lines of the cache.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Column<T>([T; GROUP]);

const EMPTY: Column<f64> = Column([0.0; GROUP]);

/// A point before the step. What the model has not declared is zero. `S` is the number of components of all state
/// variables.
#[derive(Clone, Copy, Debug)]
pub struct Point<const S: usize> {
    /// dt sym L, tensor components [-].
    pub strain_increment: [f64; 6],
    /// Velocity gradient [1/s] or deformation gradient at the end of the step [-], whichever the model takes; row-major.
    pub gradient: [f64; 9],
    /// Cauchy stress at the start [Pa].
    pub stress0: [f64; 6],
    /// State at the start.
    pub state0: [f64; S],
    /// The wanted inputs in the order of [`Model::INPUTS`](crate::Model::INPUTS).
    pub inputs: [f64; MAX_INPUTS],
}

/// A point after the step. What the model has not declared is dropped.
#[derive(Clone, Copy, Debug)]
pub struct Updated<const S: usize> {
    /// Cauchy stress at the end [Pa].
    pub stress1: [f64; 6],
    /// State at the end.
    pub state1: [f64; S],
    /// Speed of the fastest wave [m/s].
    pub wave_speed: f64,
    /// Kinematic diffusivity [m^2/s].
    pub diffusivity: f64,
    /// Stored energy per current volume [J/m^3].
    pub energy: f64,
    /// What became of the point.
    pub status: PointStatus,
}

impl<const S: usize> Updated<S> {
    /// A point with a stress [Pa], a state and a wave speed [m/s], without diffusivity and energy.
    /// It has failed unless it is `sane` and all of its values are finite.
    #[inline(always)]
    pub fn checked(stress1: [f64; 6], state1: [f64; S], wave_speed: f64, sane: bool) -> Self {
        // In one sum: 0 times what is not finite is not a number.
        let mut zero = 0.0 * wave_speed;
        for c in 0..6 {
            zero += 0.0 * stress1[c];
        }
        for c in 0..S {
            zero += 0.0 * state1[c];
        }
        let sane = (zero == 0.0) & sane;
        let status = if sane { PointStatus::Ok } else { PointStatus::Failed };
        Self { stress1, state1, wave_speed, diffusivity: 0.0, energy: 0.0, status }
    }
}

/// The formulas of one point, with the constants that all points of a batch share.
///
/// The loop over the points vectorises if `update` is straight-line code: `#[inline(always)]`, as are the functions
/// that it calls; cases written as values (`let x = if a > b { y } else { z };`), with `&` and `|` between conditions;
/// no loops but those of a known small length; square roots as they are, exponentials from [`math`](crate::math).
pub trait PointLaw<const S: usize> {
    /// The model whose law this is; it says what a point has. `S` is the number of components of its state.
    type Model: Model;

    /// One step of one point.
    fn update(&self, point: &Point<S>) -> Updated<S>;
}

impl Batch<'_> {
    /// Updates every point with `law`, several at a time. [`Model::update`] must be `#[inline(always)]` as well.
    #[inline(always)]
    pub fn for_each_point<const S: usize, L: PointLaw<S>>(&mut self, law: &L) {
        const { assert!(S == state_components(L::Model::STATES), "S is not the size of the state") };
        const { assert!(!L::Model::OUTPUTS.has(Output::DT_FACTOR), "a law of a point gives no factor") };
        // One variable per array: those that the model does not use cost nothing.
        let mut before = Before::<S> {
            strain_increment: &mut [EMPTY; 6],
            gradient: &mut [EMPTY; 9],
            stress0: &mut [EMPTY; 6],
            state0: &mut [EMPTY; S],
            inputs: &mut [EMPTY; MAX_INPUTS],
        };
        let mut after = After::<S>::new();
        for first in (0..self.n()).step_by(GROUP) {
            // A last group that is not full is worked on as a whole; what is beyond the points is not written back.
            // The other groups are copied by a fixed length.
            let count = self.n() - first;
            match count >= GROUP {
                true => before.read::<L::Model>(self, first, GROUP),
                false => before.read::<L::Model>(self, first, count),
            }
            for k in 0..GROUP {
                after.set::<L::Model>(k, &law.update(&before.get::<L::Model>(k)));
            }
            match count >= GROUP {
                true => after.write(self, first, GROUP),
                false => after.write(self, first, count),
            }
        }
    }
}

// Loops over fixed numbers of components, since `array::from_fn` is not always inlined.

/// A group of points before the step.
struct Before<'a, const S: usize> {
    strain_increment: &'a mut [Column<f64>; 6],
    gradient: &'a mut [Column<f64>; 9],
    stress0: &'a mut [Column<f64>; 6],
    state0: &'a mut [Column<f64>; S],
    inputs: &'a mut [Column<f64>; MAX_INPUTS],
}

impl<const S: usize> Before<'_, S> {
    #[inline(always)]
    fn read<M: Model>(&mut self, batch: &Batch<'_>, first: usize, count: usize) {
        let stride = batch.stride;
        match M::KINEMATICS {
            Kinematics::VelocityGradient => {
                read(batch.velocity_gradient, stride, first, count, self.gradient);
            }
            Kinematics::DeformationGradient => {
                read(batch.deformation_gradient, stride, first, count, self.gradient);
            }
            _ => read(batch.strain_increment, stride, first, count, self.strain_increment),
        }
        read(batch.stress0, stride, first, count, self.stress0);
        read(batch.state0, stride, first, count, self.state0);
        for i in 0..M::INPUTS.len() {
            self.inputs[i].0[..count].copy_from_slice(&batch.inputs[i][first..][..count]);
        }
    }

    #[inline(always)]
    fn get<M: Model>(&self, k: usize) -> Point<S> {
        let mut point = Point {
            strain_increment: [0.0; 6],
            gradient: [0.0; 9],
            stress0: at(self.stress0, k),
            state0: at(self.state0, k),
            inputs: [0.0; MAX_INPUTS],
        };
        match M::KINEMATICS {
            Kinematics::VelocityGradient | Kinematics::DeformationGradient => {
                point.gradient = at(self.gradient, k);
            }
            _ => point.strain_increment = at(self.strain_increment, k),
        }
        for i in 0..M::INPUTS.len() {
            point.inputs[i] = self.inputs[i].0[k];
        }
        point
    }
}

/// Copies points `first..first + count` of each component.
#[inline(always)]
fn read<const C: usize>(
    data: &[f64],
    stride: usize,
    first: usize,
    count: usize,
    columns: &mut [Column<f64>; C],
) {
    for c in 0..C {
        columns[c].0[..count].copy_from_slice(&data[c * stride + first..][..count]);
    }
}

#[inline(always)]
fn at<const C: usize>(columns: &[Column<f64>; C], k: usize) -> [f64; C] {
    let mut values = [0.0; C];
    for c in 0..C {
        values[c] = columns[c].0[k];
    }
    values
}

/// A group of points after the step.
struct After<const S: usize> {
    stress1: [Column<f64>; 6],
    state1: [Column<f64>; S],
    wave_speed: Column<f64>,
    diffusivity: Column<f64>,
    energy: Column<f64>,
    status: Column<i32>,
}

impl<const S: usize> After<S> {
    #[inline(always)]
    fn new() -> Self {
        Self {
            stress1: [EMPTY; 6],
            state1: [EMPTY; S],
            wave_speed: EMPTY,
            diffusivity: EMPTY,
            energy: EMPTY,
            status: Column([0; GROUP]),
        }
    }

    #[inline(always)]
    fn set<M: Model>(&mut self, k: usize, point: &Updated<S>) {
        for c in 0..6 {
            self.stress1[c].0[k] = point.stress1[c];
        }
        for c in 0..S {
            self.state1[c].0[k] = point.state1[c];
        }
        self.wave_speed.0[k] = point.wave_speed;
        if const { M::OUTPUTS.has(Output::DIFFUSIVITY) } {
            self.diffusivity.0[k] = point.diffusivity;
        }
        if const { M::OUTPUTS.has(Output::ENERGY) } {
            self.energy.0[k] = point.energy;
        }
        self.status.0[k] = point.status as i32;
    }

    #[inline(always)]
    fn write(&self, batch: &mut Batch<'_>, first: usize, count: usize) {
        let stride = batch.stride;
        for c in 0..6 {
            write(&self.stress1[c], batch.stress1, c * stride + first, count);
        }
        for c in 0..S {
            write(&self.state1[c], batch.state1, c * stride + first, count);
        }
        write(&self.wave_speed, batch.wave_speed, first, count);
        write(&self.diffusivity, batch.diffusivity, first, count);
        write(&self.energy, batch.energy, first, count);
        write(&self.status, batch.status, first, count);
    }
}

/// Copies the first `count` values to their place; an absent array takes nothing.
#[inline(always)]
fn write<T: Copy>(column: &Column<T>, data: &mut [T], at: usize, count: usize) {
    if !data.is_empty() {
        data[at..][..count].copy_from_slice(&column.0[..count]);
    }
}
