//! Modified Cam-Clay with pressure-dependent elasticity, void ratio and preconsolidation pressure.
//!
//! The lines of normal compression and swelling are straight in e over ln p. Since the strain increment fixes the void
//! ratio at the end of a step, and void ratio and pressure fix the preconsolidation pressure, yield and hardening hold
//! exactly whatever the step; what is left is the flow rule, one equation for the place on the ellipse, whose solution
//! always exists between the elastic trial and the critical state.
#![forbid(unsafe_code)]

mod ellipse;
mod swelling;

use ellipse::{Ellipse, End, Step};
use lahar_plugin::tensor::{contract, deviator, is_finite, trace};
use lahar_plugin::{
    Batch, Driver, Input, Model, ModelTable, Parameter, PointStatus, State, Transfer, elastic,
    plastic,
};
use std::ffi::CStr;
use swelling::{SpecificVolume, Swelling};

lahar_plugin::plugin!(c"org.lahar.modified_cam_clay", [ModifiedCamClay]);

/// `n` points for a bench: normally consolidated and sheared, all of them in plastic flow, different in each point.
pub fn sample(n: usize) -> Result<Driver, String> {
    let mut driver = Driver::typical(ModelTable::of::<ModifiedCamClay>().desc(), &[], n)?;
    driver.set_samples(1e-5, [1.0, -2.0, 0.5, 3.0, -1.0, 0.0], [-1e5, -2e5, -1e5, 1e3, 0.0, 0.0]);
    driver.init_state()?;
    Ok(driver)
}

/// Constants of an instance.
pub struct ModifiedCamClay {
    ellipse: Ellipse,
    volume: SpecificVolume,
    /// Specific volume of normal compression at the minimum pressure [-].
    line: f64,
    /// λ [-]
    compression: f64,
    overconsolidation: f64,
}

/// p_min [Pa] from the parameter and p_r [Pa].
fn minimum_pressure(given: f64, reference: f64) -> f64 {
    if given > 0.0 { given } else { 0.01 * reference }
}

/// Where a point stands: void ratio, preconsolidation pressure, equivalent plastic strain.
type States = [f64; 3];

impl Model for ModifiedCamClay {
    const NAME: &'static CStr = c"modified_cam_clay";
    const SUMMARY: &'static CStr =
        c"Modified Cam-Clay: critical state, volumetric hardening, pressure-dependent elasticity";
    const REFERENCE: &'static CStr =
        c"Roscoe, Burland: On the generalized stress-strain behaviour of wet clay, in Engineering Plasticity (1968); Borja, Lee: Comput. Methods Appl. Mech. Engrg. 78 (1990) 49-72, doi:10.1016/0045-7825(90)90152-C";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::real(c"critical_stress_ratio", c"M", c"-", c"q/p at the critical state")
            .typical(1.0)
            .hard(0.01, 3.0)
            .advised(0.4, 1.8),
        Parameter::real(
            c"compression_index",
            c"lambda",
            c"-",
            c"Slope of the normal compression line in e over ln p",
        )
        .typical(0.2)
        .hard(1e-6, 1e3)
        .advised(0.05, 0.5),
        Parameter::real(
            c"swelling_index",
            c"kappa",
            c"-",
            c"Slope of swelling lines in e over ln p, less than lambda",
        )
        .typical(0.02)
        .hard(1e-7, 1e3)
        .advised(0.001, 0.09),
        elastic::POISSONS_RATIO.advised(0.1, 0.45),
        Parameter::real(
            c"reference_void_ratio",
            c"e_N",
            c"-",
            c"Void ratio of isotropic normal compression at reference_pressure",
        )
        .typical(2.0)
        .hard(1e-3, 1e3)
        .advised(0.5, 5.0),
        Parameter::real(
            c"reference_pressure",
            c"p_r",
            c"Pa",
            c"Pressure at which reference_void_ratio is given",
        )
        .typical(1.0e3)
        .hard(1e-300, 1e300),
        Parameter::real(
            c"overconsolidation_ratio",
            c"OCR",
            c"-",
            c"Preconsolidation pressure over that of the ellipse through the start stress",
        )
        .default(1.0)
        .hard(1.0, 1e6)
        .advised(1.0, 50.0),
        Parameter::real(
            c"minimum_pressure",
            c"p_min",
            c"Pa",
            c"Smallest preconsolidation pressure, elasticity is linear below it; 0: reference_pressure / 100",
        )
        .default(0.0)
        .hard(0.0, 1e300),
    ];
    const STATES: &'static [State] = &[
        State::scalar(c"void_ratio", c"-", c"Volume of voids over that of grains"),
        State::scalar(
            c"preconsolidation_pressure",
            c"Pa",
            c"Pressure of isotropic yield, at least minimum_pressure",
        ),
        plastic::EQUIVALENT_STRAIN,
    ];
    const INPUTS: &'static [Input] = &[Input::Density];
    const HAS_TANGENT: bool = true;
    const TRANSFER: &'static [Transfer] = &[Transfer::Mean, Transfer::Mean, Transfer::Mean];

    fn check(values: &[f64]) -> Result<(), String> {
        let [_, lambda, kappa, _, void_ratio, reference, _, least] = values[..] else {
            return Err("expected 8 values".into());
        };
        if kappa >= lambda {
            return Err(format!(
                "swelling_index is {kappa}, but must be less than compression_index, which is {lambda}"
            ));
        }
        let least = minimum_pressure(least, reference);
        let loosest = void_ratio - lambda * (least / reference).ln();
        if loosest <= 0.0 {
            return Err(format!(
                "the normal compression line has the void ratio {loosest} at minimum_pressure = {least} Pa; give a larger \
                 reference_void_ratio or a smaller minimum_pressure"
            ));
        }
        Ok(())
    }

    fn new(values: &[f64]) -> Result<Self, String> {
        Self::check(values)?;
        let [slope, lambda, kappa, nu, void_ratio, reference, ocr, least] = values[..] else {
            return Err("expected 8 values".into());
        };
        let least = minimum_pressure(least, reference);
        let shear_ratio = 1.5 * (1.0 - 2.0 * nu) / (1.0 + nu);
        let elastic = Swelling { slope: kappa, shear_ratio, minimum: least };
        let line = 1.0 + void_ratio - lambda * (least / reference).ln();
        Ok(Self {
            ellipse: Ellipse { slope, hardening: lambda - kappa, elastic },
            volume: SpecificVolume { loosest: line + kappa },
            line,
            compression: lambda,
            overconsolidation: ocr,
        })
    }

    fn init_state(&self, batch: &mut Batch<'_>) -> Result<(), String> {
        for k in 0..batch.n() {
            let stress = batch.stress0(k);
            let s = deviator(stress);
            let least = self.ellipse.elastic.minimum;
            // A start in tension is taken as one without stress: the first step brings it back.
            let p = (-trace(stress) / 3.0).max(0.0);
            let q2 = 1.5 * contract(s, s);
            let through = p + q2 / (self.ellipse.slope.powi(2) * p.max(least));
            let preconsolidation = (self.overconsolidation * through).max(least); // [MCC-7]
            let grown = (preconsolidation / least).ln();
            let swelling = grown - self.ellipse.elastic.measure(p);
            let void_ratio =
                self.line - 1.0 - self.compression * grown + self.ellipse.elastic.slope * swelling;
            if !(is_finite(stress) && void_ratio > 0.0 && preconsolidation.is_finite()) {
                return Err(format!(
                    "point {k}: the start stress with p = {p} Pa and the preconsolidation pressure {preconsolidation} \
                     Pa give the void ratio {void_ratio}, which must be positive; give a larger reference_void_ratio \
                     or a smaller compression_index"
                ));
            }
            batch.set_state1(k, [void_ratio, preconsolidation, 0.0]);
        }
        Ok(())
    }

    #[inline(always)]
    fn update(&self, batch: &mut Batch<'_>) {
        for k in 0..batch.n() {
            let (stress0, strain) = (batch.stress0(k), batch.strain_increment(k));
            let state0 = batch.state0::<3>(k);
            let (stress1, state1) = self.advance(stress0, strain, state0);
            let density = batch.input(0)[k];
            let p = |stress: [f64; 6]| -trace(stress) / 3.0;
            let wave_speed =
                self.wave_speed_of(p(stress0).max(p(stress1)), state0[0].max(state1[0]), density);
            let sane = is_finite(stress1)
                && is_finite(state1)
                && is_finite([wave_speed])
                && is_finite(stress0)
                && is_finite(strain)
                && is_finite(state0)
                && state0[0] > -1.0;
            batch.set_stress1(k, stress1);
            batch.set_state1(k, state1);
            batch.set_wave_speed(k, wave_speed);
            let status = match (sane, state1[0] < 0.0) {
                (false, _) => PointStatus::Failed,
                (true, true) => PointStatus::Unreliable,
                (true, false) => PointStatus::Ok,
            };
            batch.set_status(k, status);
        }
    }

    #[inline(always)]
    fn wave_speed(&self, batch: &mut Batch<'_>) {
        for k in 0..batch.n() {
            let p = -trace(batch.stress0(k)) / 3.0;
            let [void_ratio, ..] = batch.state0::<3>(k);
            let density = batch.input(0)[k];
            batch.set_wave_speed(k, self.wave_speed_of(p, void_ratio, density));
        }
    }

    fn tangent(&self, batch: &Batch<'_>, k: usize) -> [[f64; 6]; 6] {
        let (step, end) =
            self.solve(batch.stress0(k), batch.strain_increment(k), batch.state0::<3>(k));
        self.ellipse.tangent(&step, &end)
    }
}

impl ModifiedCamClay {
    /// Elastic speed at a pressure and a void ratio [m/s].
    fn wave_speed_of(&self, p: f64, void_ratio: f64, density: f64) -> f64 {
        let Swelling { slope, shear_ratio, .. } = self.ellipse.elastic;
        let v = self.volume.slope(1.0 + void_ratio);
        let bulk = v * self.ellipse.elastic.slope_at(p) / slope;
        (bulk * (1.0 + 4.0 / 3.0 * shear_ratio) / density).sqrt()
    }

    fn solve(&self, stress0: [f64; 6], strain: [f64; 6], state0: States) -> (Step, End) {
        let [void_ratio, preconsolidation, _] = state0;
        let Swelling { slope, minimum, .. } = self.ellipse.elastic;
        let volume = self.volume.compress(1.0 + void_ratio, -trace(strain));
        let mut memory = (preconsolidation / minimum).ln();
        if !(memory > 1e-12) {
            // At the minimum the void ratio remembers how much looser the point has become.
            let p0 = -trace(stress0) / 3.0;
            let looseness = self.line - self.volume.of(1.0 + void_ratio);
            let g0 = self.ellipse.elastic.measure(p0);
            memory = ((looseness - slope * g0) / self.ellipse.hardening).min(0.0);
        }
        let start = (preconsolidation.max(minimum), memory);
        let step = self.ellipse.step(stress0, strain, start, volume);
        let end = self.ellipse.advance(&step, |_, _| {});
        (step, end)
    }

    fn advance(&self, stress0: [f64; 6], strain: [f64; 6], state0: States) -> ([f64; 6], States) {
        if strain == [0.0; 6] {
            return (stress0, state0);
        }
        let (step, end) = self.solve(stress0, strain, state0);
        let (stress1, plastic) = self.ellipse.stress(&step, stress0, &end);
        (stress1, [step.void_ratio(), end.preconsolidation, state0[2] + plastic])
    }
}
