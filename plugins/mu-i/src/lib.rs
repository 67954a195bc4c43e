//! Dry granular flow with the μ(I) rheology: elastic below the static friction, above it flowing with a friction that grows with the inertial
//! number, without stress where the grains have separated.
//!
//! With τ = sqrt(s:s / 2) and p = -tr σ / 3 the friction μ = τ/p and the rate of shear γ̇ obey
//! μ = μ_s + (μ_2 - μ_s) / (I0/I + 1), I = γ̇ d sqrt(ρ_s / p). The flow keeps its volume, so that p is that of the elastic trial, and the implicit
//! step is a quadratic equation for τ.
#![forbid(unsafe_code)]

use lahar_plugin::elastic::{self, Elastic, lame};
use lahar_plugin::tensor::{contract, deviator, is_finite, trace};
use lahar_plugin::{
    Batch, Driver, Input, Model, ModelTable, Parameter, Point, PointLaw, State, Transfer, Updated,
    elastic_model, gap,
};
use std::ffi::CStr;

lahar_plugin::plugin!(c"org.lahar.mu_i", [MuI]);

/// `n` points for a bench: sheared under pressure, all of them in flow, different in each point. Made for steps of 1e-4 s.
pub fn sample(n: usize) -> Result<Driver, String> {
    let mut driver = Driver::typical(ModelTable::of::<MuI>().desc(), &[], n)?;
    driver.set_samples(1e-4, [1.0, -2.0, 0.5, 30.0, -1.0, 0.0], [-1e4, -2e4, -1e4, 1e3, 0.0, 0.0]);
    Ok(driver)
}

/// Constants of an instance.
pub struct MuI {
    bulk_modulus: f64,
    shear_modulus: f64,
    static_friction: f64,
    limiting_friction: f64,
    reference_inertial_number: f64,
    /// d sqrt(ρ_s) [sqrt(Pa) s]: I = γ̇ times this over sqrt(p).
    inertia: f64,
}

/// The elastic trial of what loads a point in a step.
#[derive(Clone, Copy)]
struct Trial {
    /// s* [Pa]
    deviator: [f64; 6],
    /// τ* [Pa]
    shear: f64,
    /// p, 0 if the point opens [Pa]
    pressure: f64,
    /// Part of the increment that loads the point: all of it, unless the point was open.
    part: f64,
    /// Opened volumetric strain if it stays open or opens, else 0 [-].
    opened: f64,
}

/// The quadratic equation τ² - b τ + h = 0 of flow.
#[derive(Clone, Copy)]
struct Flow {
    /// μ_s p and μ_2 p [Pa]
    strengths: [f64; 2],
    /// A = G Δt I0 sqrt(p) / (d sqrt(ρ_s)) [Pa]
    relaxation: f64,
    /// b [Pa]
    sum: f64,
    /// τ [Pa]
    shear: f64,
}

impl Elastic for MuI {
    fn lame(&self) -> [f64; 2] {
        [self.bulk_modulus - 2.0 / 3.0 * self.shear_modulus, self.shear_modulus]
    }

    // Also of open points, which may close at any time.
    #[inline(always)]
    fn wave_modulus(&self) -> f64 {
        self.bulk_modulus + 4.0 / 3.0 * self.shear_modulus
    }
}

impl MuI {
    #[inline(always)]
    fn trial(&self, stress0: [f64; 6], strain: [f64; 6], opened0: f64) -> Trial {
        // An open point starts without stress.
        let was_open = opened0 != 0.0;
        let volumetric = trace(strain);
        let gap = opened0 + volumetric;
        let stays_open = was_open & (gap >= 0.0);
        let part = gap::loading_part(opened0, volumetric);
        let kept = if was_open { 0.0 } else { 1.0 };

        let (old, new) = (deviator(stress0), deviator(strain));
        let mut s = [0.0; 6];
        for c in 0..6 {
            s[c] = kept * old[c] + 2.0 * self.shear_modulus * part * new[c];
        }
        let p = -kept * trace(stress0) / 3.0 - self.bulk_modulus * part * volumetric;
        let opens = if p < 0.0 { -p / self.bulk_modulus } else { 0.0 }; // [MUI-3]
        Trial {
            deviator: s,
            shear: (0.5 * contract(s, s)).sqrt(),
            pressure: if p < 0.0 { 0.0 } else { p },
            part,
            opened: if stays_open { gap } else { opens },
        }
    }

    /// Its shear stress is that of flow, whether the point flows or not.
    #[inline(always)]
    fn flow(&self, trial: &Trial, dt: f64) -> Flow {
        let (p, shear) = (trial.pressure, trial.shear);
        let [slow, fast] = [self.static_friction * p, self.limiting_friction * p];
        let rate = self.reference_inertial_number * p.sqrt() / self.inertia;
        let relaxation = self.shear_modulus * dt * trial.part * rate;
        let sum = fast + shear + relaxation;
        let product = fast * shear + slow * relaxation;
        // sum² - 4 product without a difference of nearly equal numbers.
        let apart = fast - shear + relaxation;
        let root = (apart * apart + 4.0 * relaxation * (shear - slow)).sqrt();
        let shear = 2.0 * product / (sum + root); // [MUI-2]
        Flow { strengths: [slow, fast], relaxation, sum, shear }
    }
}

impl PointLaw<3> for Step<'_> {
    type Model = MuI;

    #[inline(always)]
    fn update(&self, point: &Point<3>) -> Updated<3> {
        let Self { model, dt } = *self;
        let [shear_strain0, opened0, _] = point.state0;
        let strain = point.strain_increment;
        let trial = model.trial(point.stress0, strain, opened0);
        let flow = model.flow(&trial, dt);
        let flows = trial.shear > flow.strengths[0];
        let (shear, p) = (if flows { flow.shear } else { trial.shear }, trial.pressure);
        let scale = if flows { shear / trial.shear } else { 1.0 };
        let plastic = if flows { (trial.shear - shear) / model.shear_modulus } else { 0.0 };
        let number = plastic / (trial.part * dt) * model.inertia / p.sqrt(); // [MUI-1]
        let moves = (plastic > 0.0) & (trial.part * dt > 0.0) & (p > 0.0);
        let number = if moves { number } else { 0.0 };

        // An open point is strained without stress.
        let open = trial.opened != 0.0;
        let free = deviator(strain);
        let free = (1.0 - trial.part) * (2.0 * contract(free, free)).sqrt();
        let scattered = trial.shear / model.shear_modulus;
        let plastic = if open { scattered } else { plastic };
        let [xx, yy, zz, xy, yz, zx] = trial.deviator.map(|s| scale * s);
        let stress = [xx - p, yy - p, zz - p, xy, yz, zx];
        let stress1 = stress.map(|x| if open { 0.0 } else { x });
        let state1 =
            [shear_strain0 + free + plastic, trial.opened, if open { 0.0 } else { number }];
        let wave_speed = model.wave_speed_of(point.inputs[0]);
        let sane = is_finite(strain) & is_finite(point.stress0) & (opened0 >= 0.0);
        Updated::checked(stress1, state1, wave_speed, sane)
    }
}

/// The law of one step.
struct Step<'m> {
    model: &'m MuI,
    dt: f64,
}

impl Model for MuI {
    const NAME: &'static CStr = c"mu_i";
    const SUMMARY: &'static CStr =
        c"Dry granular flow: mu(I) rheology, elastic at rest, open in tension";
    const REFERENCE: &'static CStr = c"Jop, Forterre, Pouliquen: A constitutive law for dense granular flows, Nature 441 (2006), doi:10.1038/nature04801; Dunatunga, Kamrin: J. Fluid Mech. 779 (2015), doi:10.1017/jfm.2015.383";
    const PARAMETERS: &'static [Parameter] = &[
        elastic::YOUNGS_MODULUS.described(c"Young's modulus of the packing").typical(1.0e6),
        elastic::POISSONS_RATIO.described(c"Poisson's ratio of the packing").advised(0.0, 0.45),
        Parameter::real(c"static_friction", c"mu_s", c"-", c"Friction tau/p of slow flow")
            .typical(0.3819)
            .hard(0.0, f64::INFINITY)
            .advised(0.1, 1.0),
        Parameter::real(
            c"limiting_friction",
            c"mu_2",
            c"-",
            c"Friction of fast flow, at least mu_s",
        )
        .typical(0.6435)
        .hard(0.0, f64::INFINITY)
        .advised(0.2, 1.5),
        Parameter::real(
            c"reference_inertial_number",
            c"I0",
            c"-",
            c"Inertial number at which the friction is half-way",
        )
        .default(0.279)
        .hard(1.0e-6, f64::INFINITY)
        .advised(0.01, 10.0),
        Parameter::real(c"grain_diameter", c"d", c"m", c"Diameter of the grains")
            .typical(1.0e-3)
            .hard(f64::MIN_POSITIVE, f64::INFINITY),
        Parameter::real(c"grain_density", c"rho_s", c"kg/m3", c"Density of the grains' matter")
            .typical(2500.0)
            .hard(f64::MIN_POSITIVE, f64::INFINITY),
    ];
    const STATES: &'static [State] = &[
        State::scalar(
            c"plastic_shear_strain",
            c"-",
            c"Sum of sqrt(2 de_p : de_p) of the deviatoric plastic strain",
        ),
        gap::OPENED_STRAIN,
        State::scalar(c"inertial_number", c"-", c"I of the last step; 0 where nothing flows"),
    ];
    const INPUTS: &'static [Input] = &[Input::Density];
    const HAS_TANGENT: bool = true;
    // The mean of an open and a closed point would lose the stress of the closed one.
    const TRANSFER: &'static [Transfer] = &[Transfer::Mean, Transfer::Never, Transfer::Mean];
    elastic_model!();

    fn check(values: &[f64]) -> Result<(), String> {
        let [_, _, slow, fast, ..] = values[..] else {
            return Err("expected 7 values".into());
        };
        if fast < slow {
            return Err(format!(
                "limiting_friction is {fast}, but must be at least static_friction, which is {slow}"
            ));
        }
        Ok(())
    }

    fn new(values: &[f64]) -> Result<Self, String> {
        let [e, nu, static_friction, limiting_friction, number, diameter, density] = values[..]
        else {
            return Err("expected 7 values".into());
        };
        let [lambda, shear_modulus] = lame(e, nu)?;
        Ok(Self {
            bulk_modulus: lambda + 2.0 / 3.0 * shear_modulus,
            shear_modulus,
            static_friction,
            limiting_friction,
            reference_inertial_number: number,
            inertia: diameter * density.sqrt(),
        })
    }

    #[inline(always)]
    fn update(&self, batch: &mut Batch<'_>) {
        let dt = batch.dt();
        batch.for_each_point(&Step { model: self, dt });
    }

    fn tangent(&self, batch: &Batch<'_>, k: usize) -> [[f64; 6]; 6] {
        let (strain, [_, opened0, _]) = (batch.strain_increment(k), batch.state0(k));
        let (bulk, g) = (self.bulk_modulus, self.shear_modulus);
        let trial = self.trial(batch.stress0(k), strain, opened0);
        if trial.opened != 0.0 {
            return [[0.0; 6]; 6];
        }
        let Flow { strengths: [slow, fast], relaxation, sum, shear } =
            self.flow(&trial, batch.dt());
        let flows = trial.shear > slow;
        // Of τ by τ*, p and A, the implicit function of the quadratic equation.
        let [by_trial, by_pressure, by_relaxation] = match flows {
            true => [
                shear - fast,
                self.limiting_friction * (shear - trial.shear) - self.static_friction * relaxation,
                shear - slow,
            ]
            .map(|x| x / (2.0 * shear - sum)),
            false => [1.0, 0.0, 0.0],
        };
        let scale = if flows { shear / trial.shear } else { 1.0 };
        let (e, volumetric) = (deviator(strain), trace(strain));
        let mut tangent = elastic::stiffness([-2.0 / 3.0 * trial.part * g, trial.part * g]);
        for j in 0..6 {
            let by_volume = if j < 3 { 1.0 } else { 0.0 };
            let dp = -bulk * by_volume;
            // The part of the increment that closes an open point depends on the increment.
            let dpart = match opened0 != 0.0 {
                true => -opened0 / (volumetric * volumetric) * by_volume,
                false => 0.0,
            };
            let ds: [f64; 6] = std::array::from_fn(|i| tangent[i][j] + 2.0 * g * e[i] * dpart);
            let drelaxation = match relaxation > 0.0 {
                true => relaxation * (0.5 * dp / trial.pressure + dpart / trial.part),
                false => 0.0,
            };
            let dtrial = if flows { 0.5 * contract(trial.deviator, ds) / trial.shear } else { 0.0 };
            let dshear = by_trial * dtrial + by_pressure * dp + by_relaxation * drelaxation;
            for i in 0..6 {
                let along = if flows { trial.deviator[i] / trial.shear } else { 0.0 };
                tangent[i][j] = scale * ds[i] + along * (dshear - scale * dtrial);
                if i < 3 {
                    tangent[i][j] -= dp;
                }
            }
        }
        tangent
    }
}
