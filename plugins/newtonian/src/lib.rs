//! Weakly compressible Newtonian fluid: σ = -p(J) I + 2 μ dev(Δε/Δt), J = V / V at zero pressure.
#![forbid(unsafe_code)]

mod pressure;

use lahar_plugin::abi::{lahar_host_api, lahar_plugin_desc};
use lahar_plugin::tensor::{deviator, is_finite, trace};
use lahar_plugin::{
    Batch, Driver, Input, Kinematics, Model, ModelTable, Output, Parameter, Plugin, Point,
    PointLaw, PointStatus, State, Updated, c_text, math,
};
use pressure::{Pressure, Real, Whole};
use std::ffi::CStr;

/// The plugin with this model.
pub static PLUGIN: Plugin = Plugin::new(
    c"org.lahar.newtonian",
    c_text(concat!(env!("CARGO_PKG_VERSION"), "\0")),
    &[ModelTable::of::<Newtonian>()],
)
.author(c"The lahar developers")
.licence(c"MIT OR Apache-2.0");

/// The entry of the plugin, for programs that link the model statically.
pub fn plugin(host: &'static lahar_host_api) -> &'static lahar_plugin_desc {
    PLUGIN.entered(host)
}

/// `n` points for a bench: a viscous fluid in shear under pressure, different in each point; Tait's equation with the
/// given exponent. Made for steps of 1e-4 s.
pub fn sample(exponent: f64, n: usize) -> Result<Driver, String> {
    let named = [("bulk_modulus", 2.0e6), ("viscosity", 1.0e-3), ("exponent", exponent)];
    let mut driver = Driver::new(ModelTable::of::<Newtonian>().desc(), &named, n)?;
    for k in 0..n {
        let e = 1e-5 * (1.0 + (k % 7) as f64);
        driver.set_strain_increment(k, [e, -2.0 * e, e, 3.0 * e, -e, 0.0]);
        driver.set_state(k, 0, 1.0 - 10.0 * e);
    }
    Ok(driver)
}

#[derive(Clone, Copy)]
enum EquationOfState {
    /// p = K/γ (J^-γ - 1)
    Tait { exponent: f64 },
    /// p = K (1/J - 1), Tait's with the exponent 1
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
    /// Volume ratio at the pressure `p`; not a number or not positive if the fluid cannot have it.
    fn volume_ratio(&self, p: f64) -> f64 {
        match self.equation_of_state {
            EquationOfState::Tait { exponent } => {
                (-(exponent * p / self.bulk_modulus).ln_1p() / exponent).exp()
            }
            EquationOfState::Linear => 1.0 / (1.0 + p / self.bulk_modulus),
        }
    }

    #[inline(always)]
    fn update_with(&self, batch: &mut Batch<'_>, pressure: impl Pressure) {
        let flows = self.viscosity > 0.0 && batch.dt() > 0.0;
        batch.for_each_point(&Law {
            bulk_modulus: self.bulk_modulus,
            kinematic: 4.0 / 3.0 * self.viscosity,
            two_mu_per_dt: if flows { 2.0 * self.viscosity / batch.dt() } else { 0.0 },
            least_pressure: if self.zero_tension { 0.0 } else { f64::NEG_INFINITY },
            pressure,
        });
    }

    #[inline(always)]
    fn wave_speed_with(&self, batch: &mut Batch<'_>, pressure: impl Pressure) {
        let density = batch.input(0);
        for k in 0..batch.n() {
            let [j] = batch.state0(k);
            let (_, tangent) = pressure.relative(j);
            batch.set_wave_speed(k, (self.bulk_modulus * tangent / density[k]).sqrt());
            batch.set_diffusivity(k, 4.0 / 3.0 * self.viscosity / density[k]);
        }
    }
}

/// The formulas of one point.
struct Law<P> {
    /// K [Pa]
    bulk_modulus: f64,
    /// 4/3 μ [Pa s]: over the density, the diffusivity of longitudinal motion.
    kinematic: f64,
    /// 2 μ / Δt [Pa]
    two_mu_per_dt: f64,
    /// 0 if there is no tension, else minus infinity [Pa]
    least_pressure: f64,
    pressure: P,
}

impl<P: Pressure> PointLaw<1> for Law<P> {
    type Model = Newtonian;

    #[inline(always)]
    fn update(&self, point: &Point<1>) -> Updated<1> {
        let (strain, density) = (point.strain_increment, point.inputs[0]);
        let j = point.state0[0] * math::exp(trace(strain));
        let (pressure, tangent) = self.pressure.relative(j);
        let p = self.bulk_modulus * pressure;
        // An opened point keeps the wave speed of its volume ratio.
        let p = if p < self.least_pressure { self.least_pressure } else { p };
        let [xx, yy, zz, xy, yz, zx] = deviator(strain).map(|e| self.two_mu_per_dt * e);
        let stress1 = [xx - p, yy - p, zz - p, xy, yz, zx]; // [NWT-2]
        let wave_speed = (self.bulk_modulus * tangent / density).sqrt();
        let sane = is_finite(strain) & is_finite(stress1) & (j > 0.0) & is_finite([wave_speed]);
        Updated {
            stress1,
            state1: [j],
            wave_speed,
            diffusivity: self.kinematic / density,
            energy: 0.0,
            status: if sane { PointStatus::Ok } else { PointStatus::Failed },
        }
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
            .typical(2.0e6)
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

    #[inline(always)]
    fn update(&self, batch: &mut Batch<'_>) {
        match self.equation_of_state {
            EquationOfState::Linear => self.update_with(batch, Whole::<1>),
            EquationOfState::Tait { exponent: 7.0 } => self.update_with(batch, Whole::<7>),
            EquationOfState::Tait { exponent } => self.update_with(batch, Real { exponent }),
        }
    }

    #[inline(always)]
    fn wave_speed(&self, batch: &mut Batch<'_>) {
        match self.equation_of_state {
            EquationOfState::Linear => self.wave_speed_with(batch, Whole::<1>),
            EquationOfState::Tait { exponent: 7.0 } => self.wave_speed_with(batch, Whole::<7>),
            EquationOfState::Tait { exponent } => self.wave_speed_with(batch, Real { exponent }),
        }
    }
}
