//! Matsuoka-Nakai elastoplasticity: the smooth surface that has the strength of Mohr-Coulomb in triaxial compression and extension.
//!
//! Yield q Γ(θ) = M p + k, flow potential q Γ(θ) - M_ψ p, perfectly plastic: the return is one equation for the Lode angle, found
//! by Newton's method inside a bracket that always contains it (`returning`).
#![forbid(unsafe_code)]

mod returning;
mod surface;

use lahar_plugin::elastic::{self, Elastic, stiffness};
use lahar_plugin::isotropic::{LARGEST_STRESS, compose, sorted_principal, tangent};
use lahar_plugin::tensor::{contract, deviator, is_finite, trace};
use lahar_plugin::{
    Batch, Driver, Input, Model, ModelTable, Parameter, PointStatus, State, Transfer,
    elastic_model, plastic,
};
use returning::Material;
use std::ffi::CStr;
use surface::Surface;

lahar_plugin::plugin!(c"org.lahar.matsuoka_nakai", [MatsuokaNakai]);

/// `n` points for a bench: sheared under pressure, all of them in plastic flow, different in each point.
pub fn sample(n: usize) -> Result<Driver, String> {
    let named = [("cohesion", 0.0), ("dilation_angle", 5.0)];
    let mut driver = Driver::typical(ModelTable::of::<MatsuokaNakai>().desc(), &named, n)?;
    driver.set_samples(1e-4, [1.0, -2.0, 0.5, 30.0, -1.0, 0.0], [-1e4, -2e4, -1e4, 1e3, 0.0, 0.0]);
    Ok(driver)
}

/// Constants of an instance.
pub struct MatsuokaNakai {
    material: Material,
    /// Γ in triaxial extension, where it is largest [-].
    largest_shape: f64,
}

/// How far outside, relative to the stresses, still counts as inside: a stress that was returned to the surface stays there
/// when nothing is strained.
const INSIDE: f64 = 1e-11;

impl Model for MatsuokaNakai {
    const NAME: &'static CStr = c"matsuoka_nakai";
    const SUMMARY: &'static CStr =
        c"Matsuoka-Nakai, perfectly plastic, non-associated, with a cut-off of mean tension";
    const REFERENCE: &'static CStr =
        c"Matsuoka, Nakai: Stress-deformation and strength characteristics of soil under three different principal stresses, Proc. JSCE 232 (1974), doi:10.2208/jscej1969.1974.232_59";
    const PARAMETERS: &'static [Parameter] = &[
        elastic::YOUNGS_MODULUS,
        elastic::POISSONS_RATIO,
        Parameter::real(
            c"friction_angle",
            c"phi",
            c"deg",
            c"Friction angle in triaxial compression and extension",
        )
        .typical(30.0)
        .hard(0.0, 85.0)
        .advised(0.0, 55.0),
        Parameter::real(c"cohesion", c"c", c"Pa", c"Cohesion of the same Mohr-Coulomb strength")
            .typical(1.0e3)
            .hard(0.0, f64::INFINITY),
        Parameter::real(
            c"dilation_angle",
            c"psi",
            c"deg",
            c"Dilation angle in triaxial compression, at most phi",
        )
        .default(0.0)
        .hard(0.0, 85.0)
        .advised(0.0, 30.0),
        Parameter::real(
            c"tension_cutoff",
            c"p_t",
            c"Pa",
            c"Largest mean tension, at most c cot(phi); 0: no tension",
        )
        .default(0.0)
        .hard(0.0, f64::INFINITY),
    ];
    const STATES: &'static [State] = &[
        plastic::EQUIVALENT_STRAIN,
        State::scalar(
            c"opened_volumetric_strain",
            c"-",
            c"Volumetric strain beyond the cut-off, undone before compression changes the pressure",
        ),
    ];
    const INPUTS: &'static [Input] = &[Input::Density];
    const HAS_TANGENT: bool = true;
    const TRANSFER: &'static [Transfer] = &[Transfer::Max, Transfer::Never];
    elastic_model!();

    fn check(values: &[f64]) -> Result<(), String> {
        let [_, _, friction, cohesion, dilation, cutoff] = values[..] else {
            return Err("expected 6 values".into());
        };
        if dilation > friction {
            return Err(format!(
                "dilation_angle is {dilation} deg, but must not exceed friction_angle, which is {friction} deg"
            ));
        }
        let apex = surface::apex(friction, cohesion);
        if cutoff > apex * (1.0 + 1e-12) {
            return Err(format!(
                "tension_cutoff is {cutoff} Pa, but the surface ends at a mean tension of c cot(phi) = {apex} Pa; give at \
                 most that"
            ));
        }
        Ok(())
    }

    fn new(values: &[f64]) -> Result<Self, String> {
        let [e, nu, friction, cohesion, dilation, tension] = values[..] else {
            return Err("expected 6 values".into());
        };
        let [lambda, shear] = elastic::lame(e, nu)?;
        let surface = Surface::new(friction, cohesion, dilation);
        let bulk = lambda + 2.0 / 3.0 * shear;
        let largest_shape = surface.shape(std::f64::consts::FRAC_PI_3).value;
        Ok(Self { material: Material { bulk, shear, surface, tension }, largest_shape })
    }

    fn update(&self, batch: &mut Batch<'_>) {
        let density = batch.input(0);
        for k in 0..batch.n() {
            let (stress0, state0) = (batch.stress0(k), batch.state0(k));
            let end = self.step(stress0, state0, batch.strain_increment(k));
            batch.set_stress1(k, end.stress);
            batch.set_state1(k, end.state);
            let speed = self.wave_speed_of(density[k]);
            batch.set_wave_speed(k, speed);
            batch.set_status(k, if speed.is_finite() { end.status } else { PointStatus::Failed });
        }
    }

    fn tangent(&self, batch: &Batch<'_>, k: usize) -> [[f64; 6]; 6] {
        self.tangent_of(batch.stress0(k), batch.state0(k), batch.strain_increment(k))
    }
}

/// A point after the step.
struct End {
    stress: [f64; 6],
    state: [f64; 2],
    status: PointStatus,
}

/// The elastic trial of a step.
struct Trial {
    stress: [f64; 6],
    /// What is left of the gap while the point stays open [-].
    gap: Option<f64>,
    /// Round-off [Pa].
    tolerance: f64,
}

impl Elastic for MatsuokaNakai {
    fn lame(&self) -> [f64; 2] {
        let Material { bulk, shear, .. } = self.material;
        [bulk - 2.0 / 3.0 * shear, shear]
    }

    fn wave_modulus(&self) -> f64 {
        let Material { bulk, shear, .. } = self.material;
        bulk + 4.0 / 3.0 * shear
    }
}

impl MatsuokaNakai {
    /// Volumetric strain first closes the gap of an open point, whose pressure is at the cut-off.
    fn trial(&self, stress0: [f64; 6], opened: f64, strain: [f64; 6]) -> Trial {
        let Material { bulk, shear, surface, tension } = self.material;
        let (mut shift, mut loading, mut gap) = (0.0, trace(strain), None);
        let largest = |s: [f64; 6]| s.iter().fold(surface.strength, |size, s| size.max(s.abs()));
        if opened != 0.0 {
            let left = opened + loading;
            loading = left.min(0.0);
            gap = (left >= 0.0).then_some(left); // [MTN-6]
            let away = tension - trace(stress0) / 3.0;
            shift = if away.abs() > INSIDE * largest(stress0) { away } else { 0.0 };
        }
        let (mean, e) = (bulk * loading + shift, deviator(strain));
        let mut stress = [0.0; 6];
        for c in 0..6 {
            stress[c] = stress0[c] + 2.0 * shear * e[c] + if c < 3 { mean } else { 0.0 };
        }
        Trial { stress, gap, tolerance: INSIDE * largest(stress) }
    }

    /// Whether a stress is inside the round cone that the surface does not enter.
    fn surely_elastic(&self, stress: [f64; 6]) -> bool {
        let s = deviator(stress);
        let (p, q) = (-trace(stress) / 3.0, (1.5 * contract(s, s)).sqrt());
        q * self.largest_shape <= self.material.surface.capacity(p) && p >= -self.material.tension
    }

    fn step(&self, stress0: [f64; 6], state0: [f64; 2], strain: [f64; 6]) -> End {
        let [kappa, opened] = state0;
        let Trial { stress, gap, tolerance } = self.trial(stress0, opened, strain);
        let sane = stress.iter().all(|s| s.abs() < LARGEST_STRESS);
        if !(sane & is_finite(stress0) & is_finite(state0) & is_finite(strain)) {
            return End { stress, state: [kappa, 0.0], status: PointStatus::Failed };
        }
        if gap.is_none() && self.surely_elastic(stress) {
            return End { stress, state: [kappa, 0.0], status: PointStatus::Ok };
        }
        let (values, axes) = sorted_principal(stress);
        let trial = returning::State::of(values);
        let end = self.material.step(trial, gap.is_some(), tolerance);
        // A stress that does not change is not taken apart and put together again.
        let unchanged = end.is_elastic() || (gap.is_some() && !end.flows());
        let stress1 = if unchanged { stress } else { compose(end.state.stress(), axes) };
        let opened = match (end.at_cutoff, gap) {
            (false, _) => 0.0,
            (true, Some(gap)) => gap,
            (true, None) => (end.state.p - trial.p) / self.material.bulk,
        };
        let state = [kappa + end.plastic, opened];
        let status = match end.converged {
            _ if !(is_finite(stress1) & is_finite(state)) => PointStatus::Failed,
            true => PointStatus::Ok,
            false => PointStatus::SmallerStep,
        };
        End { stress: stress1, state, status }
    }

    fn tangent_of(&self, stress0: [f64; 6], state0: [f64; 2], strain: [f64; 6]) -> [[f64; 6]; 6] {
        let Trial { stress, gap, tolerance } = self.trial(stress0, state0[1], strain);
        let (values, axes) = sorted_principal(stress);
        let stays_open = gap.is_some();
        let end = self.material.step(returning::State::of(values), stays_open, tolerance);
        if end.is_elastic() {
            return stiffness(self.lame());
        }
        let normal = self.material.tangent(&end, if stays_open { 0.0 } else { 1.0 });
        tangent(values, end.state.stress(), axes, normal, 2.0 * self.material.shear)
    }
}
