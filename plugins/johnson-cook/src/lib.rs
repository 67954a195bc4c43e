//! Johnson-Cook plasticity: the yield stress grows with the plastic strain and its rate and falls with the temperature,
//! σ_y = (A + B κ^n) (1 + C ln max(1, κ'/κ'_0)) (1 - T*^m); plastic work heats the point.
//!
//! The return goes along the deviator of the trial stress. Plastic strain, its rate Δκ/dt and the heating are those of
//! the end of the step: one equation for Δκ, solved by Newton's method between bounds.
#![forbid(unsafe_code)]

mod flow;

use flow::{Flow, Solution, Step};
use lahar_plugin::elastic::{self, Elastic, lame};
use lahar_plugin::radial::Trial;
use lahar_plugin::tensor::is_finite;
use lahar_plugin::{
    Batch, Driver, Input, Model, ModelTable, Parameter, PointStatus, State, Transfer,
    elastic_model, plastic,
};
use std::ffi::CStr;

lahar_plugin::plugin!(c"org.lahar.johnson_cook", [JohnsonCook]);

/// `n` points for a bench, copper in plastic flow at rates of 1e4 per second if a step takes 1e-7 s, different in each point.
pub fn sample(n: usize) -> Result<Driver, String> {
    let mut driver = Driver::typical(ModelTable::of::<JohnsonCook>().desc(), &[], n)?;
    driver.set_samples(2e-4, [1.0, -2.0, 0.5, 3.0, -1.0, 0.0], [-1e7, -2e7, -1e7, 5e7, 0.0, 0.0]);
    for k in 0..n {
        driver.set_state(k, 0, 0.05 * (k % 5) as f64);
        driver.set_input(0, k, 8960.0);
    }
    Ok(driver)
}

/// Constants of an instance.
pub struct JohnsonCook {
    /// Lamé's constants [Pa].
    lame: [f64; 2],
    flow: Flow,
    /// Part of the plastic work that heats over the heat capacity [K kg/J].
    heating: f64,
}

impl Model for JohnsonCook {
    const NAME: &'static CStr = c"johnson_cook";
    const SUMMARY: &'static CStr =
        c"Johnson-Cook plasticity of metals: hardening, rate, temperature and adiabatic heating";
    const REFERENCE: &'static CStr = c"Johnson, Cook: Proc. 7th Int. Symp. Ballistics (1983) 541-547; Eng. Fract. Mech. 21 (1985) 31-48, \
          doi:10.1016/0013-7944(85)90052-9";
    const PARAMETERS: &'static [Parameter] = &[
        elastic::YOUNGS_MODULUS.typical(1.24e11),
        elastic::POISSONS_RATIO.typical(0.34),
        Parameter::real(c"yield_stress", c"A", c"Pa", c"First yield stress, slow and cold")
            .typical(9.0e7)
            .hard(f64::MIN_POSITIVE, f64::INFINITY),
        Parameter::real(c"hardening_modulus", c"B", c"Pa", c"Hardening at a plastic strain of 1")
            .typical(2.92e8)
            .hard(0.0, f64::INFINITY),
        Parameter::real(c"hardening_exponent", c"n", c"-", c"Exponent of the plastic strain")
            .typical(0.31)
            .hard(0.01, 10.0)
            .advised(0.05, 1.0),
        Parameter::real(c"rate_factor", c"C", c"-", c"Growth of the stress by e-fold of the rate")
            .typical(0.025)
            .hard(0.0, f64::INFINITY)
            .advised(0.0, 0.2),
        Parameter::real(
            c"reference_rate",
            c"eps_0",
            c"1/s",
            c"Plastic rate up to which the rate has no effect",
        )
        .typical(1.0)
        .hard(f64::MIN_POSITIVE, f64::INFINITY),
        Parameter::real(c"softening_exponent", c"m", c"-", c"Exponent of the temperature")
            .typical(1.09)
            .hard(0.1, 10.0)
            .advised(0.4, 2.0),
        Parameter::real(
            c"reference_temperature",
            c"T_ref",
            c"K",
            c"Temperature up to which there is no softening",
        )
        .typical(293.15)
        .hard(0.0, f64::INFINITY),
        Parameter::real(
            c"melting_temperature",
            c"T_melt",
            c"K",
            c"Temperature from which on there is no shear strength; above the reference",
        )
        .typical(1356.0)
        .hard(0.0, f64::INFINITY),
        Parameter::real(c"heat_capacity", c"c_p", c"J/(kg K)", c"Specific heat capacity")
            .typical(383.0)
            .hard(f64::MIN_POSITIVE, f64::INFINITY),
        Parameter::real(
            c"taylor_quinney",
            c"chi",
            c"-",
            c"Part of the plastic work that becomes heat; 0: isothermal",
        )
        .default(0.9)
        .hard(0.0, 1.0)
        .advised(0.0, 1.0),
    ];
    const STATES: &'static [State] = &[
        plastic::EQUIVALENT_STRAIN,
        State::scalar(
            c"temperature_rise",
            c"K",
            c"What plastic work has added to the temperature that the host gives",
        ),
    ];
    const INPUTS: &'static [Input] = &[Input::Density, Input::Temperature];
    const HAS_TANGENT: bool = true;
    const TRANSFER: &'static [Transfer] = &[Transfer::Mean, Transfer::Mean];
    elastic_model!();

    fn check(values: &[f64]) -> Result<(), String> {
        Self::new(values).map(drop)
    }

    fn new(values: &[f64]) -> Result<Self, String> {
        let [e, nu, initial, hardening, exponent, rate_factor, reference_rate, softening, ..] =
            values[..]
        else {
            return Err("expected 12 values".into());
        };
        let [.., reference_temperature, melting_temperature, capacity, part] = values[..] else {
            return Err("expected 12 values".into());
        };
        if !(melting_temperature > reference_temperature) {
            return Err(format!(
                "melting_temperature is {melting_temperature} K, but must exceed reference_temperature, which is \
                 {reference_temperature} K"
            ));
        }
        let flow = Flow {
            initial,
            hardening,
            exponent,
            rate_factor,
            reference_rate,
            softening,
            reference_temperature,
            melting_temperature,
        };
        Ok(Self { lame: lame(e, nu)?, flow, heating: part / capacity })
    }

    #[inline(always)]
    fn update(&self, batch: &mut Batch<'_>) {
        for k in 0..batch.n() {
            self.update_point(batch, k);
        }
    }

    fn tangent(&self, batch: &Batch<'_>, k: usize) -> [[f64; 6]; 6] {
        let trial = Trial::new(self.lame, batch.stress0(k), batch.strain_increment(k));
        let step = self.step(batch, k, trial.q);
        if !step.is_plastic() {
            return elastic::stiffness(self.lame);
        }
        match step.solve() {
            Some(Solution { q1, slope, .. }) => trial.tangent(self.lame, q1, slope),
            None => [[f64::NAN; 6]; 6],
        }
    }
}

impl Elastic for JohnsonCook {
    #[inline(always)]
    fn lame(&self) -> [f64; 2] {
        self.lame
    }
}

impl JohnsonCook {
    /// The equation of point `k` for a trial q [Pa].
    fn step(&self, batch: &Batch<'_>, k: usize, q: f64) -> Step<'_> {
        let [strain0, rise0] = batch.state0(k);
        Step {
            flow: &self.flow,
            three_g: 3.0 * self.lame[1],
            q,
            strain0,
            warmth0: batch.input(1)[k] - self.flow.reference_temperature + rise0,
            heating: self.heating / batch.input(0)[k],
            dt: batch.dt(),
        }
    }

    #[inline(always)]
    fn update_point(&self, batch: &mut Batch<'_>, k: usize) {
        let (stress0, strain) = (batch.stress0(k), batch.strain_increment(k));
        let trial = Trial::new(self.lame, stress0, strain);
        let [strain0, rise0] = batch.state0(k);
        let step = self.step(batch, k, trial.q);
        let wave_speed = self.wave_speed_of(batch.input(0)[k]);
        let mut end = Some((trial.stress, [strain0, rise0]));
        if step.is_plastic() {
            end = step.solve().map(|Solution { increment, q1, .. }| {
                let rise = rise0 + step.heating * q1 * increment;
                (trial.returned(q1), [strain0 + increment, rise])
            });
        }
        let sane = |stress, state| {
            strain0 >= 0.0
                && is_finite(stress)
                && is_finite(state)
                && is_finite([wave_speed, trial.q, step.warmth0, step.heating])
        };
        match end {
            Some((stress, state)) if sane(stress, state) => {
                batch.set_stress1(k, stress);
                batch.set_state1(k, state);
            }
            _ => {
                batch.set_stress1(k, stress0);
                batch.set_state1(k, [strain0, rise0]);
                batch.set_status(k, PointStatus::Failed);
            }
        }
        batch.set_wave_speed(k, wave_speed);
    }
}
