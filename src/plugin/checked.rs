//! Checked mode, `LAHAR_CHECK_PLUGINS=1`: every call of a model runs on guarded copies, and a
//! breach of the contract is an error that names the model, the function and the point, and says
//! what to do.
//!
//! The copies have guard words before, behind and between the components. What the model must write
//! holds a mark before the call: a signalling NaN, which arithmetic would turn into a quiet one.
//! After the call the guards, the start of the step and the floating-point environment must be what
//! they were, and every output written and in its range. A model that declares itself deterministic
//! is called again with the same points, one that is pointwise too with the points in another order
//! and one by one; the results must be equal bit by bit.

use super::adapter::{Instance, Verb};
use crate::error::{Error, Result, Status};
use crate::material::{Model, StressBatch};
use crate::memory::{Aligned, stride_of};
use crate::simd::{LANES, environment};
use lahar_plugin_abi::*;
use std::sync::OnceLock;

/// Whether the environment asks for checked mode; it is read once. Error:
/// [`Status::InvalidArgument`].
pub(crate) fn checks() -> Result<bool> {
    static CHECKS: OnceLock<std::result::Result<bool, String>> = OnceLock::new();
    let checks = CHECKS.get_or_init(|| match std::env::var_os("LAHAR_CHECK_PLUGINS") {
        None => Ok(false),
        Some(text) if text == "0" => Ok(false),
        Some(text) if text == "1" => Ok(true),
        Some(text) => Err(format!(
            "LAHAR_CHECK_PLUGINS must be 1 (every call of a model is checked, which is slow), 0 or unset, got `{}`",
            text.to_string_lossy()
        )),
    });
    checks.clone().map_err(Error::invalid)
}

/// Guard words before and behind an array.
const GUARD: usize = 64;

/// What guard words hold: quiet NaNs, which harm nobody who reads a whole vector.
const CANARY: u64 = 0x7ff8_ca4a_57ca_4a57;

/// What an output holds before it is written: a signalling NaN.
const UNWRITTEN: u64 = 0x7ff0_5eed_0000_5eed;

/// The same after arithmetic, which makes it quiet.
const USED: u64 = UNWRITTEN | 1 << 51;

/// Guard of the statuses.
const STATUS_CANARY: i32 = 0x5ca1_ab1e;

/// An array of the batch: its points between guards.
struct Column {
    name: &'static str,
    components: usize,
    stride: usize,
    data: Aligned,
}

impl Column {
    /// The points `order` of an array with this many components. An array that is too short was not
    /// asked for and stays away.
    fn new(
        name: &'static str,
        (source, from): (&[f64], usize),
        components: usize,
        order: &[usize],
    ) -> Result<Self> {
        let last = order.iter().max().copied().unwrap_or(0);
        let there = source.len() > components.saturating_sub(1) * from + last;
        let components = if there { components } else { 0 };
        let stride = stride_of(order.len()) + LANES;
        let mut data = Aligned::zeroed(components * stride + 2 * GUARD)?;
        data.as_mut_slice().fill(f64::from_bits(CANARY));
        let mut column = Self { name, components, stride, data };
        for c in 0..components {
            for (to, k) in order.iter().enumerate() {
                column.slice_mut()[c * stride + to] = source[c * from + k];
            }
        }
        Ok(column)
    }

    /// Puts the mark into the first `n` points.
    fn unwrite(&mut self, n: usize) {
        let stride = self.stride;
        for row in self.slice_mut().chunks_mut(stride) {
            row[..n].fill(f64::from_bits(UNWRITTEN));
        }
    }

    fn slice(&self) -> &[f64] {
        let all = self.data.as_slice();
        &all[GUARD..all.len() - GUARD]
    }

    fn slice_mut(&mut self) -> &mut [f64] {
        let all = self.data.as_mut_slice();
        let end = all.len() - GUARD;
        &mut all[GUARD..end]
    }

    fn at(&self, c: usize, k: usize) -> f64 {
        self.slice()[c * self.stride + k]
    }

    /// Index, as the model counts it, of a guard word that was overwritten.
    fn broken_guard(&self, n: usize) -> Option<isize> {
        let inside = |i: usize| {
            let i = i.wrapping_sub(GUARD);
            i < self.components * self.stride && i % self.stride < n
        };
        let all = self.data.as_slice().iter().enumerate();
        all.filter(|(i, word)| word.to_bits() != CANARY && !inside(*i))
            .map(|(i, _)| i as isize - GUARD as isize)
            .next()
    }
}

/// The arrays of a call, copied.
struct Copies<'a> {
    instance: &'a Instance,
    verb: Verb,
    n: usize,
    /// Strain increment, velocity gradient, deformation gradient, start stress, start state,
    /// inputs.
    read: [Column; 6],
    /// End stress, end state, wave speed, diffusivity, energy, factor on the time step, the
    /// extension's own.
    written: [Column; 7],
    status: Vec<i32>,
}

const STATE0: usize = 4;
const STRESS1: usize = 0;
const STATE1: usize = 1;
const WAVE_SPEED: usize = 2;
const DT_FACTOR: usize = 5;

/// Which of the arrays a function has to write.
fn outputs(verb: Verb) -> &'static [usize] {
    match verb {
        Verb::InitState => &[STATE1],
        Verb::Update => &[STRESS1, STATE1, WAVE_SPEED, 3, 4, DT_FACTOR],
        Verb::WaveSpeed => &[WAVE_SPEED, 3],
        Verb::Tangent | Verb::StoredEnergy => &[6],
    }
}

/// Calls the model on copies, checks what it did, and passes the results on.
pub(super) fn call(
    instance: &Instance,
    verb: Verb,
    batch: &mut StressBatch<'_>,
    own: &mut [f64],
) -> Result<()> {
    instance.check(verb, batch, own)?;
    let all: Vec<usize> = (0..batch.n).collect();
    let run = |batch: &StressBatch<'_>, own: &[f64], points: &[usize]| -> Result<Copies<'_>> {
        let mut copies = Copies::new(instance, verb, (batch, own), points)?;
        copies.run(batch)?;
        Ok(copies)
    };
    let first = run(batch, own, &all)?;
    first.check_outputs()?;
    let declares = |capability| instance.model().capabilities & capability != 0;
    if declares(LAHAR_CAPABILITY_DETERMINISTIC) {
        first.compare(
            &run(batch, own, &all)?,
            &all,
            "when called again with equal input",
            "keep nothing between calls but state variables, or do not declare LAHAR_CAPABILITY_DETERMINISTIC",
        )?;
    }
    if declares(LAHAR_CAPABILITY_DETERMINISTIC) && declares(LAHAR_CAPABILITY_POINTWISE) {
        let advice = "a point's result must depend on that point alone, or do not declare LAHAR_CAPABILITY_POINTWISE";
        let reversed: Vec<usize> = all.iter().rev().copied().collect();
        let turned = run(batch, own, &reversed)?;
        first.compare(&turned, &reversed, "with the points in reversed order", advice)?;
        for k in 0..batch.n {
            first.compare(&run(batch, own, &[k])?, &[k], "in a batch of its own", advice)?;
        }
    }
    first.hand_on(batch, own);
    Ok(())
}

impl<'a> Copies<'a> {
    /// Copies of the points `order`, in that order.
    fn new(
        instance: &'a Instance,
        verb: Verb,
        (batch, own): (&StressBatch<'_>, &[f64]),
        order: &[usize],
    ) -> Result<Self> {
        let model = instance.model();
        let (n, from, state) = (order.len(), batch.stride, model.state_components());
        let column =
            |name, source, components| Column::new(name, (source, from), components, order);
        let given = |output| usize::from(model.gives(output));
        let read = [
            column("strain_increment", batch.strain_increment, 6)?,
            column("velocity_gradient", batch.velocity_gradient, 9)?,
            column("deformation_gradient", batch.deformation_gradient, 9)?,
            column("stress0", batch.stress0, 6)?,
            column("state0", batch.state0, state)?,
            column("inputs", batch.inputs, model.inputs.len())?,
        ];
        let mut written = [
            column("stress1", &*batch.stress1, 6)?,
            column("state1", &*batch.state1, state)?,
            column("wave_speed", &*batch.wave_speed, 1)?,
            column("diffusivity", &*batch.diffusivity, given(LAHAR_OUTPUT_DIFFUSIVITY))?,
            column("energy", &*batch.energy, given(LAHAR_OUTPUT_ENERGY))?,
            column("dt_factor", &*batch.dt_factor, given(LAHAR_OUTPUT_DT_FACTOR))?,
            column(verb.name(), own, verb.own_components())?,
        ];
        for (i, column) in written.iter_mut().enumerate() {
            if (verb, i) != (Verb::InitState, STATE1) {
                column.unwrite(n);
            }
        }
        let mut status = vec![STATUS_CANARY; stride_of(n) + LANES + 2 * GUARD];
        status[GUARD..GUARD + n].fill(0);
        Ok(Self { instance, verb, n, read, written, status })
    }

    /// Calls the model, and checks what it must not touch.
    fn run(&mut self, times: &StressBatch<'_>) -> Result<()> {
        let Self { instance, verb, n, read, written, status } = self;
        let stride = read[0].stride;
        let before = read.each_ref().map(|column| bits(column.slice()));
        let control = environment::control();
        let end = status.len() - GUARD;
        let [strain, velocity, deformation, stress0, state0, inputs] = read.each_ref();
        let [stress1, state1, speed, diffusivity, energy, factor, own] = written.each_mut();
        let result = instance.run(
            *verb,
            &mut StressBatch {
                n: *n,
                stride,
                dt: times.dt,
                time: times.time,
                step: times.step,
                strain_increment: strain.slice(),
                velocity_gradient: velocity.slice(),
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
                status: &mut status[GUARD..end],
            },
            own.slice_mut(),
        );
        let now = environment::control();
        if now != control {
            environment::set_default();
            return Err(self.breach(&format!(
                "it changed the floating-point environment ({}): put it back before returning",
                now.changed(control)
            )));
        }
        self.check_start(&before)?;
        self.check_guards()?;
        result
    }

    /// The arrays of the start are what they were.
    fn check_start(&self, before: &[Vec<u64>; 6]) -> Result<()> {
        for (i, (column, before)) in self.read.iter().zip(before).enumerate() {
            let now = bits(column.slice());
            let Some(at) = (0..now.len()).find(|at| now[*at] != before[*at]) else { continue };
            let (c, k) = (at / column.stride, at % column.stride);
            if k >= self.n {
                continue; // a guard
            }
            let what = if i == STATE0 { "start state" } else { "input" };
            return Err(self.breach(&format!(
                "it writes its {what}: {} of point {k} of {} was {:?} and is {:?} afterwards; results go to stress1 and state1",
                self.component(column, c),
                self.n,
                f64::from_bits(before[at]),
                f64::from_bits(now[at]),
            )));
        }
        Ok(())
    }

    /// Nothing was written beside the points.
    fn check_guards(&self) -> Result<()> {
        let statuses =
            self.status.iter().enumerate().filter(|(i, value)| {
                **value != STATUS_CANARY && !(GUARD..GUARD + self.n).contains(i)
            });
        let status = statuses.map(|(i, _)| ("status", i as isize - GUARD as isize, 1)).next();
        let columns = self.read.iter().chain(&self.written);
        let broken = columns.filter_map(|column| {
            Some((column.name, column.broken_guard(self.n)?, column.components))
        });
        let Some((name, at, components)) = broken.chain(status).next() else { return Ok(()) };
        let n = self.n;
        Err(self.breach(&format!(
            "it writes past its points: {name}[{at}], where n is {n}, the stride {} and the number of components {components}; component c of point \
             k < n stands at [c * stride + k]",
            self.read[0].stride,
        )))
    }

    /// Every output is written, and those that have a range are in it.
    fn check_outputs(&self) -> Result<()> {
        for k in 0..self.n {
            let status = self.status[GUARD + k];
            if self.verb == Verb::Update && !(LAHAR_POINT_OK..=LAHAR_POINT_FAILED).contains(&status)
            {
                return Err(self.breach(&format!(
                    "status of point {k} of {} is {status}: expected one of LAHAR_POINT_*, 0 to 3",
                    self.n
                )));
            }
            if status == LAHAR_POINT_FAILED {
                continue;
            }
            for i in outputs(self.verb) {
                self.check_written(&self.written[*i], k)?;
            }
            self.check_ranges(k)?;
        }
        Ok(())
    }

    fn check_written(&self, column: &Column, k: usize) -> Result<()> {
        for c in 0..column.components {
            let problem = match column.at(c, k).to_bits() & !(1 << 63) {
                UNWRITTEN => "leaves unwritten",
                USED => "computes from what it has not written:",
                _ => continue,
            };
            return Err(self.breach(&format!(
                "it {problem} {} of point {k} of {}; write every component of every declared output, or set the point's status to \
                 LAHAR_POINT_FAILED",
                self.component(column, c),
                self.n,
            )));
        }
        Ok(())
    }

    /// Wave speeds and factors of a point that did not fail. If the start or the end stress is not
    /// finite, they need not be: the step reports that.
    fn check_ranges(&self, k: usize) -> Result<()> {
        let finite = |column: &Column| (0..column.components).all(|c| column.at(c, k).is_finite());
        let [speed, factor] = [&self.written[WAVE_SPEED], &self.written[DT_FACTOR]];
        let sound = match self.verb {
            Verb::Update => self.read.iter().all(finite) && finite(&self.written[STRESS1]),
            _ => self.read[2..].iter().all(finite),
        };
        if outputs(self.verb).contains(&WAVE_SPEED) && sound {
            let c = speed.at(0, k);
            if !(c >= 0.0 && c.is_finite()) {
                return Err(self.breach(&format!(
                    "wave_speed of point {k} of {} is {c:?}: expected a finite speed [m/s] that is not negative, or the status \
                     LAHAR_POINT_FAILED",
                    self.n
                )));
            }
        }
        if self.verb == Verb::Update && factor.components > 0 {
            let f = factor.at(0, k);
            if !(f > 0.0 && f <= 1.0) {
                return Err(self.breach(&format!(
                    "dt_factor of point {k} of {} is {f:?}: expected a factor above 0 and at most 1",
                    self.n
                )));
            }
        }
        Ok(())
    }

    /// The results are those of another call, whose point j is the point `order[j]` of this one.
    fn compare(&self, other: &Self, order: &[usize], when: &str, advice: &str) -> Result<()> {
        let different = |name: &str, k: usize, values: [f64; 2]| {
            self.breach(&format!(
                "{name} of point {k} of {} is {:?} at first and {:?} {when}; {advice}",
                self.n, values[0], values[1]
            ))
        };
        for (j, k) in order.iter().enumerate() {
            let status = [self.status[GUARD + k], other.status[GUARD + j]];
            if status[0] != status[1] {
                return Err(different("status", *k, status.map(f64::from)));
            }
            if status[0] == LAHAR_POINT_FAILED {
                continue;
            }
            for i in outputs(self.verb) {
                let (one, two) = (&self.written[*i], &other.written[*i]);
                for c in 0..one.components {
                    let values = [one.at(c, *k), two.at(c, j)];
                    let same = values[0].to_bits() == values[1].to_bits()
                        || values.iter().all(|v| v.is_nan());
                    if !same {
                        return Err(different(&self.component(one, c), *k, values));
                    }
                }
            }
        }
        Ok(())
    }

    /// Copies the results to the caller's arrays.
    fn hand_on(&self, batch: &mut StressBatch<'_>, own: &mut [f64]) {
        let (n, stride) = (self.n, batch.stride);
        let targets = [
            &mut *batch.stress1,
            &mut *batch.state1,
            &mut *batch.wave_speed,
            &mut *batch.diffusivity,
            &mut *batch.energy,
            &mut *batch.dt_factor,
            own,
        ];
        for (i, target) in targets.into_iter().enumerate() {
            let column = &self.written[i];
            if outputs(self.verb).contains(&i) {
                for c in 0..column.components {
                    let from = &column.slice()[c * column.stride..][..n];
                    target[c * stride..][..n].copy_from_slice(from);
                }
            }
        }
        if self.verb == Verb::Update && self.instance.model().gives(LAHAR_OUTPUT_STATUS) {
            batch.status[..n].copy_from_slice(&self.status[GUARD..GUARD + n]);
        }
    }

    /// Name of a component of an array.
    fn component(&self, column: &Column, c: usize) -> String {
        component_name(self.instance.model(), column.name, c)
    }

    fn breach(&self, what: &str) -> Error {
        let (model, verb) = (self.instance.model(), self.verb.name());
        Error::new(
            Status::PluginBroken,
            format!(
                "the plugin {} breaks its contract in `{verb}` of the model `{}`: {what} (found by LAHAR_CHECK_PLUGINS=1)",
                model.plugin_id, model.name
            ),
        )
    }
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

const SYMMETRIC: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "zx"];
const TENSOR: [&str; 9] = ["xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"];

/// `stress1 xy`, `state0 memory`, `inputs density`.
fn component_name(model: &Model, array: &str, c: usize) -> String {
    let part = match array {
        "stress0" | "stress1" | "strain_increment" => SYMMETRIC[c].to_string(),
        "velocity_gradient" | "deformation_gradient" => TENSOR[c].to_string(),
        "inputs" => model.inputs[c].key().to_string(),
        "tangent" => format!("{} {}", SYMMETRIC[c / 6], SYMMETRIC[c % 6]),
        "state0" | "state1" => state_component(model, c),
        _ => return array.to_string(),
    };
    format!("{array} {part}")
}

fn state_component(model: &Model, c: usize) -> String {
    let mut first = 0;
    for state in &model.states {
        match state.components() {
            1 if c == first => return format!("`{}`", state.key),
            count if c < first + count => return format!("`{}` [{}]", state.key, c - first),
            count => first += count,
        }
    }
    c.to_string()
}
