//! Mohr-Coulomb elastoplasticity with a tension cut-off and softening.
//!
//! The return is made in principal stresses, where the yield surface consists of planes: exact onto planes, edges and vertices
//! (`planes`). With softening the equivalent plastic strain at the end is the root of one scalar equation, found by Newton's
//! method inside a bracket that always contains it (`integrate`).
#![forbid(unsafe_code)]

mod integrate;
mod planes;
mod strength;

use integrate::{Material, Step};
use lahar_plugin::elastic::{self, Elastic, lame, stiffness};
use lahar_plugin::isotropic::{LARGEST_STRESS, compose, sorted_principal, tangent};
use lahar_plugin::tensor::{contract, deviator, is_finite, trace};
use lahar_plugin::{
    Batch, Driver, Input, Model, ModelTable, Parameter, PointStatus, State, Transfer,
    elastic_model, gap, plastic,
};
use planes::Elasticity;
use std::ffi::CStr;
use strength::{Angles, Law, Softening, Strength};

lahar_plugin::plugin!(c"org.lahar.mohr_coulomb", [MohrCoulomb]);

/// `n` points for a bench: sheared under pressure, all of them in plastic flow, different in each point.
pub fn sample(n: usize) -> Result<Driver, String> {
    let named = [("cohesion", 0.0), ("dilation_angle", 5.0)];
    let mut driver = Driver::typical(ModelTable::of::<MohrCoulomb>().desc(), &named, n)?;
    driver.set_samples(1e-4, [1.0, -2.0, 0.5, 30.0, -1.0, 0.0], [-1e4, -2e4, -1e4, 1e3, 0.0, 0.0]);
    Ok(driver)
}

/// Constants of an instance.
pub struct MohrCoulomb {
    material: Material,
    /// The strength at the peak and after softening: stresses far inside both are elastic, which is seen without their
    /// principal values.
    limits: [Strength; 2],
}

impl Model for MohrCoulomb {
    const NAME: &'static CStr = c"mohr_coulomb";
    const SUMMARY: &'static CStr =
        c"Mohr-Coulomb, non-associated, with a tension cut-off and softening of phi, c and psi";
    const REFERENCE: &'static CStr =
        c"Clausen, Damkilde, Andersen: An efficient return algorithm for non-associated plasticity with linear yield criteria in principal stress space, Comput. Struct. 85 (2007), doi:10.1016/j.compstruc.2007.04.002";
    const PARAMETERS: &'static [Parameter] = &[
        elastic::YOUNGS_MODULUS,
        elastic::POISSONS_RATIO,
        Parameter::real(c"friction_angle", c"phi", c"deg", c"Friction angle at the peak")
            .typical(30.0)
            .hard(0.0, 89.0)
            .advised(0.0, 55.0),
        Parameter::real(c"cohesion", c"c", c"Pa", c"Cohesion at the peak")
            .typical(1.0e3)
            .hard(0.0, f64::INFINITY),
        Parameter::real(
            c"dilation_angle",
            c"psi",
            c"deg",
            c"Dilation angle at the peak, at most phi",
        )
        .default(0.0)
        .hard(0.0, 89.0)
        .advised(0.0, 30.0),
        Parameter::real(
            c"tension_cutoff",
            c"sigma_t",
            c"Pa",
            c"Largest principal tension, at most c cot(phi); falls like c; 0: no tension",
        )
        .default(0.0)
        .hard(0.0, f64::INFINITY),
        Parameter::choice(
            c"softening",
            c"none|exponential|linear",
            0,
            c"How phi, c and psi fall to their residual values",
        ),
        Parameter::real(
            c"softening_strain",
            c"kappa_s",
            c"-",
            c"Plastic strain: exp(-kappa/kappa_s) of the fall is left, or 1 - kappa/kappa_s",
        )
        .default(0.05)
        .hard(1.0e-9, f64::INFINITY)
        .advised(1.0e-3, 10.0),
        Parameter::real(
            c"residual_friction_angle",
            c"phi_r",
            c"deg",
            c"Friction angle after softening, at most phi; of no meaning without softening",
        )
        .default(0.0)
        .hard(0.0, 89.0)
        .advised(0.0, 55.0),
        Parameter::real(c"residual_cohesion", c"c_r", c"Pa", c"Cohesion after softening")
            .default(0.0)
            .hard(0.0, f64::INFINITY),
        Parameter::real(
            c"residual_dilation_angle",
            c"psi_r",
            c"deg",
            c"Dilation angle after softening",
        )
        .default(0.0)
        .hard(0.0, 89.0)
        .advised(0.0, 30.0),
    ];
    const STATES: &'static [State] = &[
        plastic::EQUIVALENT_STRAIN,
        State::scalar(
            c"opened_volumetric_strain",
            c"-",
            c"Volumetric strain beyond the cut-off in all directions, undone before compression loads the point",
        ),
    ];
    const INPUTS: &'static [Input] = &[Input::Density];
    const HAS_TANGENT: bool = true;
    const TRANSFER: &'static [Transfer] = &[Transfer::Max, Transfer::Never];
    elastic_model!();

    fn check(values: &[f64]) -> Result<(), String> {
        let Values { friction, cohesion, dilation, cutoff, softening, residual, .. } =
            Values::new(values)?;
        if dilation > friction {
            return Err(format!(
                "dilation_angle is {dilation} deg, but must not exceed friction_angle, which is {friction} deg"
            ));
        }
        let apex = cohesion / friction.to_radians().tan();
        if friction > 0.0 && cutoff > apex * (1.0 + 1e-12) {
            return Err(format!(
                "tension_cutoff is {cutoff} Pa, but the shear planes meet at a tension of c cot(phi) = {apex} Pa; give \
                 at most that"
            ));
        }
        if softening == Softening::None {
            return Ok(());
        }
        let [friction_r, cohesion_r, dilation_r] = residual;
        if friction_r == 0.0 && friction > 0.0 {
            return Err(format!(
                "residual_friction_angle is 0 deg, but softening is on: give the angle that is left, or friction_angle, \
                 which is {friction} deg, if it does not fall"
            ));
        }
        let falling = [
            ("friction_angle", friction_r, friction, "deg"),
            ("cohesion", cohesion_r, cohesion, "Pa"),
            ("dilation_angle", dilation_r, dilation, "deg"),
        ];
        for (name, residual, peak, unit) in falling {
            if residual > peak {
                return Err(format!(
                    "residual_{name} is {residual} {unit}, but must not exceed {name}, which is {peak} {unit}"
                ));
            }
        }
        if dilation_r > friction_r {
            return Err(format!(
                "residual_dilation_angle is {dilation_r} deg, but must not exceed residual_friction_angle, which is \
                 {friction_r} deg"
            ));
        }
        Ok(())
    }

    fn new(values: &[f64]) -> Result<Self, String> {
        let v = Values::new(values)?;
        let [lambda, shear] = lame(v.youngs_modulus, v.poissons_ratio)?;
        let angles = |friction: f64, cohesion: f64, dilation: f64| Angles {
            friction: friction.to_radians(),
            cohesion,
            dilation: dilation.to_radians(),
        };
        let [friction, cohesion, dilation] = v.residual;
        let law = Law {
            softening: v.softening,
            peak: angles(v.friction, v.cohesion, v.dilation),
            residual: angles(friction, cohesion, dilation),
            tension_cutoff: v.cutoff,
            softening_strain: v.softening_strain,
        };
        let elasticity = Elasticity { lambda, two_g: 2.0 * shear };
        Ok(Self {
            material: Material { elasticity, law },
            limits: [law.at(0.0)[0], law.at(f64::INFINITY)[0]],
        })
    }

    fn update(&self, batch: &mut Batch<'_>) {
        let density = batch.input(0);
        for k in 0..batch.n() {
            let end = self.step(batch.stress0(k), batch.state0(k), batch.strain_increment(k));
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

/// The parameters by name; angles in degrees, residuals in the order friction, cohesion, dilation.
struct Values {
    youngs_modulus: f64,
    poissons_ratio: f64,
    friction: f64,
    cohesion: f64,
    dilation: f64,
    cutoff: f64,
    softening: Softening,
    softening_strain: f64,
    residual: [f64; 3],
}

impl Values {
    fn new(values: &[f64]) -> Result<Self, String> {
        let [
            e,
            nu,
            friction,
            cohesion,
            dilation,
            cutoff,
            kind,
            softening_strain,
            ref residual @ ..,
        ] = values[..]
        else {
            return Err("expected 11 values".into());
        };
        let softening = *Softening::ALL.get(kind as usize).ok_or("softening is no choice")?;
        Ok(Self {
            youngs_modulus: e,
            poissons_ratio: nu,
            friction,
            cohesion,
            dilation,
            cutoff,
            softening,
            softening_strain,
            residual: residual.try_into().map_err(|_| "expected 11 values")?,
        })
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
    /// Equivalent plastic strain with that of an open point [-].
    kappa: f64,
    /// What is left of the gap while the point stays open [-].
    gap: Option<f64>,
}

impl Elastic for MohrCoulomb {
    fn lame(&self) -> [f64; 2] {
        let Elasticity { lambda, two_g } = self.material.elasticity;
        [lambda, 0.5 * two_g]
    }
}

impl MohrCoulomb {
    /// An open point stands at the cut-off in all directions; its deviatoric strain is plastic.
    fn trial(&self, stress0: [f64; 6], [kappa, opened]: [f64; 2], strain: [f64; 6]) -> Trial {
        let Elasticity { lambda, two_g } = self.material.elasticity;
        let (mut start, mut kappa, mut part, mut gap) = (stress0, kappa, 1.0, None);
        if opened != 0.0 {
            let volumetric = trace(strain);
            part = gap::loading_part(opened, volumetric);
            let e = deviator(strain);
            kappa += (1.0 - part) * (2.0 / 3.0 * contract(e, e)).sqrt();
            let tension = self.material.law.at(kappa)[0].tension;
            start = [tension, tension, tension, 0.0, 0.0, 0.0];
            if part == 0.0 {
                gap = Some(opened + volumetric); // [MHC-7]
            }
        }
        let volumetric = lambda * part * trace(strain);
        let mut stress = [0.0; 6];
        for c in 0..6 {
            stress[c] = start[c] + two_g * part * strain[c] + if c < 3 { volumetric } else { 0.0 };
        }
        Trial { stress, kappa, gap }
    }

    /// Whether a stress is inside the cone and the mean tension that no plane enters. Between two strengths none is less than
    /// both: the cohesion is linear in what is left of the fall, and so is the friction angle, whose tangent is convex.
    fn surely_elastic(&self, stress: [f64; 6]) -> bool {
        let s = deviator(stress);
        let (mean, q) = (trace(stress) / 3.0, (1.5 * contract(s, s)).sqrt());
        self.limits.iter().all(|limit| {
            // s1 - s3 <= 2 q / sqrt(3), s1 + s3 <= 2 mean + q / 3, s1 <= mean + 2 q / 3.
            let shear = 1.1547006 * q + limit.sin_friction * (2.0 * mean + q / 3.0);
            shear <= limit.cohesion && mean + 2.0 / 3.0 * q <= limit.tension
        })
    }

    fn step(&self, stress0: [f64; 6], state0: [f64; 2], strain: [f64; 6]) -> End {
        let Trial { stress, kappa, gap } = self.trial(stress0, state0, strain);
        let failed = |stress| End { stress, state: [kappa, 0.0], status: PointStatus::Failed };
        let sane = stress.iter().all(|s| s.abs() < LARGEST_STRESS) && kappa.is_finite();
        if !(sane & is_finite(stress0) & is_finite(state0)) {
            return failed(stress);
        }
        if let Some(gap) = gap {
            return End { stress, state: [kappa, gap], status: PointStatus::Ok };
        }
        if self.surely_elastic(stress) {
            return End { stress, state: [kappa, 0.0], status: PointStatus::Ok };
        }
        let (values, axes) = sorted_principal(stress);
        let Step { stress: end, kappa: kappa1, opened, converged, unique, .. } =
            self.material.step(values, kappa, false);
        // An elastic stress is not taken apart and put together again.
        let end = if end == values { stress } else { compose(end, axes) };
        if !(is_finite(end) & kappa1.is_finite()) {
            return failed(end);
        }
        let status = match (converged, unique) {
            (false, _) => PointStatus::SmallerStep,
            (true, false) => PointStatus::Unreliable,
            (true, true) => PointStatus::Ok,
        };
        End { stress: end, state: [kappa1, opened], status }
    }

    fn tangent_of(&self, stress0: [f64; 6], state0: [f64; 2], strain: [f64; 6]) -> [[f64; 6]; 6] {
        let softens = self.material.law.softening != Softening::None;
        if state0[1] != 0.0 && softens {
            return self.differences(stress0, state0, strain);
        }
        let Trial { stress, kappa, gap } = self.trial(stress0, state0, strain);
        if gap.is_some() {
            return [[0.0; 6]; 6];
        }
        let (values, axes) = sorted_principal(stress);
        let step = self.material.step(values, kappa, true);
        let loading = match step.tangent {
            Some(normal) if step.stress != values => {
                tangent(values, step.stress, axes, normal, self.material.elasticity.two_g)
            }
            _ => stiffness(self.lame()),
        };
        gap::tangent(state0[1], strain, loading)
    }

    /// Central differences: the strength of an open point that softens depends on the strain in too many ways.
    fn differences(&self, stress0: [f64; 6], state0: [f64; 2], strain: [f64; 6]) -> [[f64; 6]; 6] {
        let size = strain.iter().fold(1e-7_f64, |size, e| size.max(e.abs()));
        let change = 1e-5 * size;
        let mut tangent = [[0.0; 6]; 6];
        for j in 0..6 {
            let at = |change: f64| {
                let mut changed = strain;
                changed[j] += change;
                self.step(stress0, state0, changed).stress
            };
            let (above, below) = (at(change), at(-change));
            for i in 0..6 {
                tangent[i][j] = (above[i] - below[i]) / (2.0 * change);
            }
        }
        tangent
    }
}
