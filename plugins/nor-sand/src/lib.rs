//! NorSand: sand whose strength and dilatancy follow from its distance to the critical state.
//!
//! The yield surface passes through the image state, where the volume is momentarily constant; its size, the image pressure, hardens
//! towards a limit set by the state parameter, so that dilatancy is limited. Integration is implicit and uses one generic source for
//! stress, Newton matrix and consistent tangent, by numbers that carry derivatives.
#![forbid(unsafe_code)]

mod dual;
mod integrate;
mod law;

use dual::Dual;
use integrate::{LEAST_IMAGE, Sand};
use lahar_plugin::tensor::{contract, deviator, is_finite, trace};
use lahar_plugin::{
    Batch, Driver, Input, Model, ModelTable, Parameter, PointStatus, State, Transfer, elastic, gap,
    plastic,
};
use law::{Elasticity, Law};
use std::ffi::CStr;

lahar_plugin::plugin!(c"org.lahar.nor_sand", [NorSand]);

/// `n` points for a bench: sheared under pressure, all of them in plastic flow, different in each point.
pub fn sample(n: usize) -> Result<Driver, String> {
    let mut driver = Driver::typical(ModelTable::of::<NorSand>().desc(), &[], n)?;
    driver.set_samples(1e-5, [1.0, -2.0, 0.5, 3.0, -1.0, 0.0], [-1e5, -2e5, -1e5, 1e3, 0.0, 0.0]);
    driver.init_state()?;
    Ok(driver)
}

/// Constants of an instance.
pub struct NorSand {
    law: Law,
    /// Whether `start` is a void ratio; otherwise it is a state parameter [-].
    start_is_void_ratio: bool,
    start: f64,
    overconsolidation: f64,
}

impl Model for NorSand {
    const NAME: &'static CStr = c"nor_sand";
    const SUMMARY: &'static CStr =
        c"NorSand: critical state model of sand with the state parameter and limited hardening";
    const REFERENCE: &'static CStr =
        c"Jefferies: Nor-Sand: a simple critical state model for sand, Geotechnique 43 (1993) 91-103, doi:10.1680/geot.1993.43.1.91";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::real(
            c"shear_modulus",
            c"G_r",
            c"Pa",
            c"Shear modulus at elastic_reference_pressure",
        )
        .typical(3.0e7)
        .hard(f64::MIN_POSITIVE, f64::INFINITY),
        Parameter::real(c"elastic_exponent", c"m", c"-", c"Moduli grow with p to this power")
            .default(0.5)
            .hard(0.0, 1.0)
            .advised(0.0, 1.0),
        Parameter::real(
            c"elastic_reference_pressure",
            c"p_G",
            c"Pa",
            c"Pressure at which shear_modulus is given",
        )
        .typical(1.0e5)
        .hard(1e-300, 1e300),
        elastic::POISSONS_RATIO.typical(0.2).hard(0.0, 0.49).advised(0.05, 0.4),
        Parameter::real(
            c"critical_stress_ratio",
            c"M_tc",
            c"-",
            c"q/p of the critical state in triaxial compression",
        )
        .typical(1.25)
        .hard(0.1, 2.0)
        .advised(0.8, 1.7),
        Parameter::real(
            c"critical_void_ratio",
            c"Gamma",
            c"-",
            c"Void ratio of the critical state at reference_pressure",
        )
        .typical(0.9)
        .hard(1e-3, 1e3)
        .advised(0.5, 2.0),
        Parameter::real(
            c"critical_state_slope",
            c"lambda",
            c"-",
            c"Slope of the critical state line in e over ln p",
        )
        .typical(0.03)
        .hard(0.0, 10.0)
        .advised(0.005, 0.15),
        Parameter::real(
            c"reference_pressure",
            c"p_r",
            c"Pa",
            c"Pressure at which critical_void_ratio is given",
        )
        .typical(1.0e3)
        .hard(1e-300, 1e300),
        Parameter::real(
            c"volumetric_coupling",
            c"N",
            c"-",
            c"How much the stress ratio of the image state falls with the state parameter",
        )
        .default(0.3)
        .hard(0.0, 1.0)
        .advised(0.0, 0.5),
        Parameter::real(
            c"dilatancy_slope",
            c"chi",
            c"-",
            c"Least dilatancy over the state parameter at the image state",
        )
        .typical(3.5)
        .hard(0.0, 50.0)
        .advised(2.0, 6.0),
        Parameter::real(c"hardening_modulus", c"H", c"-", c"Rate of hardening towards its limit")
            .typical(150.0)
            .hard(0.0, 1e6)
            .advised(20.0, 1000.0),
        Parameter::choice(
            c"initial_density",
            c"state_parameter|void_ratio",
            0,
            c"Which of the two values below the start has",
        ),
        Parameter::real(
            c"initial_state_parameter",
            c"psi_0",
            c"-",
            c"Start void ratio less that of the critical state at the start pressure",
        )
        .default(-0.05)
        .hard(-10.0, 10.0)
        .advised(-0.3, 0.2),
        Parameter::real(c"initial_void_ratio", c"e_0", c"-", c"Start void ratio")
            .default(0.75)
            .hard(1e-3, 1e3)
            .advised(0.4, 1.5),
        Parameter::real(
            c"overconsolidation_ratio",
            c"R",
            c"-",
            c"Image pressure over that of the yield surface through the start stress",
        )
        .default(1.0)
        .hard(1.0, 1e6)
        .advised(1.0, 10.0),
        Parameter::real(
            c"minimum_pressure",
            c"p_min",
            c"Pa",
            c"Elasticity is linear below it, isotropic yield is not below it; 0: elastic_reference_pressure / 100",
        )
        .default(0.0)
        .hard(0.0, 1e300),
    ];
    const STATES: &'static [State] = &[
        State::scalar(c"void_ratio", c"-", c"Volume of voids over that of grains"),
        State::scalar(c"image_pressure", c"Pa", c"Pressure of the image state"),
        plastic::EQUIVALENT_STRAIN,
        gap::OPENED_STRAIN,
    ];
    const INPUTS: &'static [Input] = &[Input::Density];
    const HAS_TANGENT: bool = true;
    const TRANSFER: &'static [Transfer] =
        &[Transfer::Mean, Transfer::Mean, Transfer::Mean, Transfer::Mean];

    fn new(values: &[f64]) -> Result<Self, String> {
        let [
            shear,
            m,
            elastic_reference,
            nu,
            ratio,
            gamma,
            lambda,
            reference,
            n,
            chi,
            h,
            kind,
            psi,
            e,
            r,
            least,
        ] = values[..]
        else {
            return Err("expected 16 values".into());
        };
        let least = if least > 0.0 { least } else { 0.01 * elastic_reference };
        let shear_ratio = 1.5 * (1.0 - 2.0 * nu) / (1.0 + nu);
        let bulk = shear * (least / elastic_reference).powf(m) / shear_ratio;
        if !(bulk.is_finite() && bulk > 0.0) {
            return Err(format!(
                "shear_modulus {shear} Pa at {elastic_reference} Pa gives the bulk modulus {bulk} Pa at \
                 minimum_pressure, which must be positive and finite"
            ));
        }
        let elastic = Elasticity { minimum: least, bulk, shear_ratio, exponent: m };
        let law = Law {
            elastic,
            critical_ratio: ratio,
            extension: (3.0 / (3.0 + ratio)).powi(4),
            critical_void_ratio: gamma - lambda * (least / reference).ln(),
            critical_slope: lambda,
            coupling: n,
            dilatancy: chi,
            hardening: h,
        };
        let start_is_void_ratio = kind == 1.0;
        let start = if start_is_void_ratio { e } else { psi };
        Ok(Self { law, start_is_void_ratio, start, overconsolidation: r })
    }

    fn init_state(&self, batch: &mut Batch<'_>) -> Result<(), String> {
        for k in 0..batch.n() {
            let stress = batch.stress0(k);
            let [void_ratio, image_pressure] = self.first_state(stress);
            if !(is_finite(stress) && void_ratio > 0.0 && image_pressure.is_finite()) {
                let p = -trace(stress) / 3.0;
                return Err(format!(
                    "point {k}: the start stress with p = {p} Pa has the void ratio {void_ratio} and the image \
                     pressure {image_pressure} Pa, which must be positive and finite; give a larger \
                     critical_void_ratio or initial_state_parameter, or a stress that the sand can bear"
                ));
            }
            batch.set_state1(k, [void_ratio, image_pressure, 0.0, 0.0]);
        }
        Ok(())
    }

    #[inline(always)]
    fn update(&self, batch: &mut Batch<'_>) {
        for k in 0..batch.n() {
            let (stress0, strain) = (batch.stress0(k), batch.strain_increment(k));
            let state0 = batch.state0::<4>(k);
            let (stress1, state1, status) = self.advance(stress0, strain, state0);
            let p = |stress: [f64; 6]| -trace(stress) / 3.0;
            let wave_speed = self.wave_speed_of(p(stress0).max(p(stress1)), batch.input(0)[k]);
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
            batch.set_status(k, if sane { status } else { PointStatus::Failed });
        }
    }

    #[inline(always)]
    fn wave_speed(&self, batch: &mut Batch<'_>) {
        for k in 0..batch.n() {
            let p = -trace(batch.stress0(k)) / 3.0;
            batch.set_wave_speed(k, self.wave_speed_of(p, batch.input(0)[k]));
        }
    }

    fn tangent(&self, batch: &Batch<'_>, k: usize) -> [[f64; 6]; 6] {
        let constant = |x: f64| <Dual<6> as dual::Real>::of(x);
        let start = self.sand(batch.stress0(k), batch.state0::<4>(k));
        let start = Sand {
            stress: start.stress.map(constant),
            void_ratio: constant(start.void_ratio),
            image: constant(start.image),
            plastic: constant(start.plastic),
            opened: constant(start.opened),
        };
        let strain = batch.strain_increment(k);
        let variables = std::array::from_fn(|j| Dual::variable(strain[j], j));
        let (end, _) = self.law.advance(start, variables, &mut |_| {});
        end.stress.map(|s| s.derivatives)
    }
}

impl NorSand {
    /// Elastic speed at a pressure [m/s].
    fn wave_speed_of(&self, p: f64, density: f64) -> f64 {
        let elastic = &self.law.elastic;
        let bulk = elastic.bulk_modulus(p);
        (bulk * (1.0 + 4.0 / 3.0 * elastic.shear_ratio) / density).sqrt()
    }

    /// Void ratio [-] and image pressure [Pa] of a start stress.
    fn first_state(&self, stress: [f64; 6]) -> [f64; 2] {
        let (law, least) = (&self.law, self.law.elastic.minimum);
        let (s, p) = (deviator(stress), (-trace(stress) / 3.0).max(least));
        let (q, lnp) = ((1.5 * contract(s, s)).sqrt(), (p / least).ln());
        let critical = law.critical_void_ratio - law.critical_slope * lnp;
        let void_ratio = if self.start_is_void_ratio { self.start } else { critical + self.start };
        // The image pressure of the yield surface through the stress; the excess falls as it grows.
        let ratio = law.critical_ratio_of(s, q);
        let (mut low, mut high) = (lnp - 1.0, lnp + 2.0 * q / (p * ratio));
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            let outside = law.excess(q, p, ratio, middle, void_ratio) > 0.0;
            (low, high) = if outside { (middle, high) } else { (low, middle) };
        }
        let image = high + self.overconsolidation.ln(); // [NRS-12]
        [void_ratio, least * image.max(LEAST_IMAGE).exp()]
    }

    fn sand(&self, stress: [f64; 6], state: [f64; 4]) -> Sand<f64> {
        let [void_ratio, image_pressure, plastic, opened] = state;
        let image = (image_pressure / self.law.elastic.minimum).ln().max(LEAST_IMAGE);
        Sand { stress, void_ratio, image, plastic, opened }
    }

    fn advance(
        &self,
        stress0: [f64; 6],
        strain: [f64; 6],
        state0: [f64; 4],
    ) -> ([f64; 6], [f64; 4], PointStatus) {
        if strain == [0.0; 6] {
            return (stress0, state0, PointStatus::Ok);
        }
        let start = self.sand(stress0, state0);
        let (end, status) = self.law.advance(start, strain, &mut |_| {});
        let image_pressure = if end.image == start.image {
            state0[1]
        } else {
            self.law.elastic.minimum * end.image.exp()
        };
        (end.stress, [end.void_ratio, image_pressure, end.plastic, end.opened], status)
    }
}
