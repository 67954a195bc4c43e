//! Weakly compressible Newtonian fluid: σ = -p(J) I + 2 μ dev(Δε/Δt), J = V / V at zero pressure.
#![forbid(unsafe_code)]

use lahar_plugin::tensor::{deviator, is_finite, trace};
use lahar_plugin::{
    Batch, Input, Kinematics, Model, ModelTable, Output, Parameter, Plugin, PointStatus, State,
    c_text,
};
use std::ffi::CStr;

/// The plugin with this model.
pub static PLUGIN: Plugin = Plugin::new(
    c"org.lahar.newtonian",
    c_text(concat!(env!("CARGO_PKG_VERSION"), "\0")),
    &[ModelTable::of::<Newtonian>()],
)
.author(c"The lahar developers")
.licence(c"MIT OR Apache-2.0");

/// The table of the plugin, for programs that link the model statically.
pub fn plugin() -> &'static lahar_plugin::abi::lahar_plugin_desc {
    PLUGIN.desc()
}

#[derive(Clone, Copy)]
enum EquationOfState {
    /// p = K/γ (J^-γ - 1)
    Tait { exponent: f64 },
    /// p = K (1/J - 1)
    Linear,
}

/// Constants of an instance.
pub struct Newtonian {
    bulk_modulus: f64,
    viscosity: f64,
    equation_of_state: EquationOfState,
    zero_tension: bool,
}

impl Newtonian {
    /// Pressure at the volume ratio `j`, tension included, and the tangent -J dp/dJ [Pa].
    fn pressure_and_tangent(&self, j: f64) -> (f64, f64) {
        let k = self.bulk_modulus;
        match self.equation_of_state {
            EquationOfState::Tait { exponent } => {
                let power_minus_one = (-exponent * j.ln()).exp_m1();
                (k / exponent * power_minus_one, k * (power_minus_one + 1.0))
            }
            EquationOfState::Linear => (k * (1.0 - j) / j, k / j),
        }
    }

    /// Volume ratio at the pressure `p`; not a number or not positive if the fluid cannot have it.
    fn volume_ratio(&self, p: f64) -> f64 {
        match self.equation_of_state {
            EquationOfState::Tait { exponent } => {
                (-(exponent * p / self.bulk_modulus).ln_1p() / exponent).exp()
            }
            EquationOfState::Linear => 1.0 / (1.0 + p / self.bulk_modulus),
        }
    }

    /// Kinematic diffusivity of longitudinal motion, 4/3 μ/ρ [m^2/s].
    fn diffusivity(&self, density: f64) -> f64 {
        4.0 / 3.0 * self.viscosity / density
    }
}

impl Model for Newtonian {
    const NAME: &'static CStr = c"newtonian";
    const SUMMARY: &'static CStr = c"Weakly compressible Newtonian fluid";
    const REFERENCE: &'static CStr =
        c"Monaghan: Simulating free surface flows with SPH, J. Comput. Phys. 110 (1994), doi:10.1006/jcph.1994.1034";
    const KINEMATICS: Kinematics = Kinematics::StrainIncrement;
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::real(c"bulk_modulus", c"K", c"Pa", c"Bulk modulus at zero pressure")
            .hard(f64::MIN_POSITIVE, f64::INFINITY),
        Parameter::real(c"viscosity", c"mu", c"Pa s", c"Dynamic viscosity")
            .default(0.0)
            .hard(0.0, f64::INFINITY),
        Parameter::choice(
            c"equation_of_state",
            c"tait|linear",
            0,
            c"Pressure as a function of the volume ratio: K/gamma (J^-gamma - 1) or K (1/J - 1)",
        ),
        Parameter::real(c"exponent", c"gamma", c"-", c"Exponent of Tait's equation")
            .default(7.0)
            .hard(0.1, 100.0)
            .advised(1.0, 15.0),
        Parameter::choice(
            c"zero_tension",
            c"no|yes",
            0,
            c"Whether a negative pressure becomes zero",
        ),
    ];
    const STATES: &'static [State] =
        &[State::scalar(c"volume_ratio", c"-", c"Volume over the volume at zero pressure")
            .initial(1.0)];
    const INPUTS: &'static [Input] = &[Input::Density];
    const OUTPUTS: Output = Output::WAVE_SPEED.and(Output::DIFFUSIVITY).and(Output::STATUS);

    fn new(values: &[f64]) -> Result<Self, String> {
        let [bulk_modulus, viscosity, equation, exponent, zero_tension] = values[..] else {
            return Err("expected 5 values".into());
        };
        let equation_of_state = match equation as i64 {
            0 => EquationOfState::Tait { exponent },
            _ => EquationOfState::Linear,
        };
        Ok(Self { bulk_modulus, viscosity, equation_of_state, zero_tension: zero_tension != 0.0 })
    }

    fn init_state(&self, batch: &mut Batch<'_>) -> Result<(), String> {
        for k in 0..batch.n() {
            let p = -trace(batch.stress0(k)) / 3.0;
            let j = self.volume_ratio(p);
            if !(j.is_finite() && j > 0.0) {
                return Err(format!(
                    "the start pressure {p} Pa of point {k} of the batch is one that the equation of state never \
                     reaches; give a start stress with a pressure well above minus the bulk modulus"
                ));
            }
            batch.set_state1(k, [j]);
        }
        Ok(())
    }

    fn update(&self, batch: &mut Batch<'_>) {
        let density = batch.input(0);
        let two_mu_per_dt = match self.viscosity > 0.0 && batch.dt() > 0.0 {
            true => 2.0 * self.viscosity / batch.dt(),
            false => 0.0,
        };
        for k in 0..batch.n() {
            let strain = batch.strain_increment(k);
            let [j0] = batch.state0(k);
            let j = j0 * trace(strain).exp();
            let (p, tangent) = self.pressure_and_tangent(j);
            // An opened point keeps the wave speed of its volume ratio.
            let p = if self.zero_tension && p < 0.0 { 0.0 } else { p };
            let mut stress = deviator(strain).map(|e| two_mu_per_dt * e);
            for s in &mut stress[..3] {
                *s -= p;
            }
            let c = (tangent / density[k]).sqrt();
            batch.set_stress1(k, stress);
            batch.set_state1(k, [j]);
            batch.set_wave_speed(k, c);
            batch.set_diffusivity(k, self.diffusivity(density[k]));
            if !(is_finite(strain) && is_finite(stress) && j > 0.0 && c.is_finite()) {
                batch.set_status(k, PointStatus::Failed);
            }
        }
    }

    fn wave_speed(&self, batch: &mut Batch<'_>) {
        let density = batch.input(0);
        for k in 0..batch.n() {
            let [j] = batch.state0(k);
            let (_, tangent) = self.pressure_and_tangent(j);
            batch.set_wave_speed(k, (tangent / density[k]).sqrt());
            batch.set_diffusivity(k, self.diffusivity(density[k]));
        }
    }
}
