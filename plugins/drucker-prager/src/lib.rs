//! Drucker-Prager elastoplasticity with a tension cut-off that remembers how far a point has opened.
//!
//! In the invariants p = -tr σ / 3 and q = sqrt(3 J2): yield q = M p + k, flow potential q - M_ψ p, perfectly plastic.
//! The cone is linear, hence the return from a trial state is Δλ = (q - M p - k) / (3 G + K M M_ψ), q - 3 G Δλ and
//! p + K M_ψ Δλ: exact, without iteration. All sums are three-dimensional; σ_zz of plane strain is carried along.
#![forbid(unsafe_code)]

mod cone;

use cone::{Cone, ConeKind};
use lahar_plugin::tensor::{contract, deviator, trace};
use lahar_plugin::{
    Batch, Columns, Input, Kinematics, Model, ModelTable, Output, Parameter, Plugin, PointStatus,
    State, c_text,
};
use std::ffi::CStr;

/// The plugin with this model.
pub static PLUGIN: Plugin = Plugin::new(
    c"org.lahar.drucker_prager",
    c_text(concat!(env!("CARGO_PKG_VERSION"), "\0")),
    &[ModelTable::of::<DruckerPrager>()],
)
.author(c"The lahar developers")
.licence(c"MIT OR Apache-2.0");

/// The table of the plugin, for programs that link the model statically.
pub fn plugin() -> &'static lahar_plugin::abi::lahar_plugin_desc {
    PLUGIN.desc()
}

/// Constants of an instance: moduli and strengths [Pa], slopes of the cone and of the flow potential [-].
pub struct DruckerPrager {
    bulk_modulus: f64,
    shear_modulus: f64,
    cone: Cone,
    tension_cutoff: f64,
}

/// State of a point.
#[derive(Clone, Copy)]
struct History {
    equivalent_plastic_strain: f64,
    opened_volumetric_strain: f64,
}

impl Model for DruckerPrager {
    const NAME: &'static CStr = c"drucker_prager";
    const SUMMARY: &'static CStr =
        c"Drucker-Prager, perfectly plastic, non-associated, with a tension cut-off";
    const REFERENCE: &'static CStr =
        c"Drucker, Prager: Soil mechanics and plastic analysis or limit design, Q. Appl. Math. 10 (1952), doi:10.1090/qam/48291";
    const KINEMATICS: Kinematics = Kinematics::StrainIncrement;
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::real(c"youngs_modulus", c"E", c"Pa", c"Young's modulus")
            .hard(f64::MIN_POSITIVE, f64::INFINITY),
        Parameter::real(c"poissons_ratio", c"nu", c"-", c"Poisson's ratio")
            .hard(-0.999, 0.4999)
            .advised(0.0, 0.495),
        Parameter::real(c"friction_angle", c"phi", c"deg", c"Mohr-Coulomb friction angle")
            .hard(0.0, 89.0)
            .advised(0.0, 55.0),
        Parameter::real(c"cohesion", c"c", c"Pa", c"Mohr-Coulomb cohesion")
            .hard(0.0, f64::INFINITY),
        Parameter::real(c"dilation_angle", c"psi", c"deg", c"Dilation angle, at most phi")
            .default(0.0)
            .hard(0.0, 89.0)
            .advised(0.0, 30.0),
        Parameter::choice(
            c"cone",
            c"compression|extension|plane_strain",
            0,
            c"Which Mohr-Coulomb strength the cone meets",
        ),
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
        State::scalar(
            c"equivalent_plastic_strain",
            c"-",
            c"Sum of sqrt(2/3 de_p : de_p) of the deviatoric plastic strain",
        ),
        State::scalar(
            c"opened_volumetric_strain",
            c"-",
            c"Volumetric strain that compression must undo before the point carries stress again",
        ),
    ];
    const INPUTS: &'static [Input] = &[Input::Density];
    const OUTPUTS: Output = Output::WAVE_SPEED.and(Output::STATUS);

    fn check(values: &[f64]) -> Result<(), String> {
        let [_, _, friction, cohesion, dilation, _, cutoff] = values[..] else {
            return Err("expected 7 values".into());
        };
        if dilation > friction {
            return Err(format!(
                "dilation_angle is {dilation} deg, but must not exceed friction_angle, which is {friction} deg"
            ));
        }
        let apex = cone::apex(friction, cohesion);
        if cutoff > apex * (1.0 + 1e-12) {
            return Err(format!(
                "tension_cutoff is {cutoff} Pa, but the cone ends at a mean tension of c cot(phi) = {apex} Pa; give \
                 at most that"
            ));
        }
        Ok(())
    }

    fn new(values: &[f64]) -> Result<Self, String> {
        let [e, nu, friction, cohesion, dilation, kind, cutoff] = values[..] else {
            return Err("expected 7 values".into());
        };
        let kind = ConeKind::ALL.get(kind as usize).ok_or("the cone is not one of the choices")?;
        let bulk_modulus = e / (3.0 * (1.0 - 2.0 * nu));
        let shear_modulus = e / (2.0 * (1.0 + nu));
        if !(bulk_modulus.is_finite() && shear_modulus.is_finite()) {
            return Err(format!("Young's modulus {e} gives moduli that are not finite"));
        }
        let cone = Cone::new(*kind, friction, cohesion, dilation);
        Ok(Self { bulk_modulus, shear_modulus, cone, tension_cutoff: cutoff })
    }

    fn update(&self, batch: &mut Batch<'_>) {
        let n = batch.n();
        let Columns {
            strain_increment,
            stress0,
            state0,
            mut stress1,
            state1,
            inputs,
            wave_speed,
            status,
            ..
        } = batch.columns::<2>();
        let density = inputs[0];
        for k in 0..n {
            let strain = strain_increment.map(|e| e[k]);
            let start = stress0.map(|s| s[k]);
            let history = History {
                equivalent_plastic_strain: state0[0][k],
                opened_volumetric_strain: state0[1][k],
            };
            let (stress, history) = self.step(start, history, strain);
            let c = self.wave_speed_of(density[k]);
            for (column, value) in stress1.iter_mut().zip(stress) {
                column[k] = value;
            }
            state1[0][k] = history.equivalent_plastic_strain;
            state1[1][k] = history.opened_volumetric_strain;
            wave_speed[k] = c;
            // Sums of absolute values: finite if and only if every term is (short of overflow, which fails as well).
            let magnitude =
                [stress, start, strain].iter().flatten().fold(c, |sum, x| sum + x.abs());
            let history = history.equivalent_plastic_strain + history.opened_volumetric_strain;
            if !(magnitude + history).is_finite() {
                status[k] = PointStatus::Failed as i32;
            }
        }
    }

    fn wave_speed(&self, batch: &mut Batch<'_>) {
        let density = batch.input(0);
        for k in 0..batch.n() {
            batch.set_wave_speed(k, self.wave_speed_of(density[k]));
        }
    }
}

impl DruckerPrager {
    /// Elastic speed; also of opened points, which may close at any time.
    fn wave_speed_of(&self, density: f64) -> f64 {
        ((self.bulk_modulus + 4.0 / 3.0 * self.shear_modulus) / density).sqrt()
    }

    /// One point, one step.
    fn step(
        &self,
        stress0: [f64; 6],
        mut history: History,
        strain: [f64; 6],
    ) -> ([f64; 6], History) {
        if history.opened_volumetric_strain == 0.0 {
            return self.load(stress0, history, strain);
        }
        let volumetric = trace(strain);
        let gap = history.opened_volumetric_strain + volumetric;
        if gap >= 0.0 {
            history.equivalent_plastic_strain += equivalent(strain);
            history.opened_volumetric_strain = gap;
            return ([0.0; 6], history);
        }
        // The gap closes inside the step: what remains of the increment loads a point without stress.
        let rest = gap / volumetric;
        history.equivalent_plastic_strain += (1.0 - rest) * equivalent(strain);
        history.opened_volumetric_strain = 0.0;
        self.load([0.0; 6], history, strain.map(|e| rest * e))
    }

    /// A closed point: elastic trial, return to the cone, tension cut-off.
    fn load(
        &self,
        stress0: [f64; 6],
        mut history: History,
        strain: [f64; 6],
    ) -> ([f64; 6], History) {
        let (bulk, shear) = (self.bulk_modulus, self.shear_modulus);
        let strain_deviator = deviator(strain);
        let stress0_deviator = deviator(stress0);
        let s: [f64; 6] =
            std::array::from_fn(|c| stress0_deviator[c] + 2.0 * shear * strain_deviator[c]);
        let p = -trace(stress0) / 3.0 - bulk * trace(strain);
        let q = (1.5 * contract(s, s)).sqrt();

        let Cone { slope, strength, dilation } = self.cone;
        let excess = q - slope * p - strength;
        let multiplier =
            if excess > 0.0 { excess / (3.0 * shear + bulk * slope * dilation) } else { 0.0 };
        let p_end = p + bulk * dilation * multiplier;

        // The apex comes before the scaling of the deviator: beyond it q - 3 G Δλ would be negative.
        if -p_end > self.tension_cutoff {
            history.equivalent_plastic_strain += q / (3.0 * shear);
            history.opened_volumetric_strain = -p / bulk;
            return ([0.0; 6], history);
        }
        history.equivalent_plastic_strain += multiplier;
        let q_end = (q - 3.0 * shear * multiplier).max(0.0);
        let scale = if multiplier > 0.0 && q > 0.0 { q_end / q } else { 1.0 };
        let mut stress = s.map(|x| scale * x);
        for x in &mut stress[..3] {
            *x -= p_end;
        }
        (stress, history)
    }
}

/// sqrt(2/3 e : e) of the deviator e of a strain.
fn equivalent(strain: [f64; 6]) -> f64 {
    let e = deviator(strain);
    (2.0 / 3.0 * contract(e, e)).sqrt()
}
