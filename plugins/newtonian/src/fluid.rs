//! What weakly compressible fluids share: σ = -p(J) I + s, with a pressure that follows from the volume ratio J alone. How the deviator s
//! follows from the strain is the fluid's own ([`Deviator`]).

use crate::pressure::{Pressure, Real, Whole};
use lahar_plugin::tensor::{deviator, is_finite, trace};
use lahar_plugin::{Batch, Model, Parameter, Point, PointLaw, State, Updated, elastic, math};
use std::marker::PhantomData;

/// The parameter `bulk_modulus` [Pa] of a fluid that may be made softer than it is.
pub const BULK_MODULUS: Parameter =
    Parameter::real(c"bulk_modulus", c"K", c"Pa", c"Bulk modulus at zero pressure")
        .typical(2.0e6)
        .hard(f64::MIN_POSITIVE, f64::INFINITY);
/// The parameter `equation_of_state`.
pub const EQUATION_OF_STATE: Parameter = Parameter::choice(
    c"equation_of_state",
    c"tait|linear",
    0,
    c"Pressure as a function of the volume ratio: K/gamma (J^-gamma - 1) or K (1/J - 1)",
);
/// The parameter `exponent` [-].
pub const EXPONENT: Parameter =
    Parameter::real(c"exponent", c"gamma", c"-", c"Exponent of Tait's equation")
        .default(7.0)
        .hard(0.1, 100.0)
        .advised(1.0, 15.0);
/// The parameter `zero_tension`.
pub const ZERO_TENSION: Parameter =
    Parameter::choice(c"zero_tension", c"no|yes", 0, c"Whether a negative pressure becomes zero");
/// The state of every fluid: the volume ratio.
pub const STATES: &[State] =
    &[State::scalar(c"volume_ratio", c"-", c"Volume over the volume at zero pressure")
        .initial(1.0)];

/// Form of the pressure law.
#[derive(Clone, Copy, Debug)]
pub enum EquationOfState {
    /// p = K/γ (J^-γ - 1)
    Tait {
        /// γ [-]
        exponent: f64,
    },
    /// p = K (1/J - 1), Tait's with the exponent 1
    Linear,
}

impl EquationOfState {
    /// From the values of [`EQUATION_OF_STATE`] and [`EXPONENT`].
    pub fn new(choice: f64, exponent: f64) -> Self {
        if choice == 0.0 { Self::Tait { exponent } } else { Self::Linear }
    }
}

/// The pressure of a fluid: p = max(p_b + K f(J), p_min).
#[derive(Clone, Copy, Debug)]
pub struct Fluid {
    /// K [Pa]
    pub bulk_modulus: f64,
    /// f
    pub equation_of_state: EquationOfState,
    /// p_b, the pressure at J = 1 [Pa]
    pub background_pressure: f64,
    /// p_min [Pa]; minus infinity if the fluid bears any tension.
    pub least_pressure: f64,
}

/// How the deviator of the stress follows from that at the start and from the strain.
pub trait Deviator: Copy {
    /// Deviator of the stress at the end [Pa] from the stress at the start [Pa] and the deviator of the strain increment [-].
    fn stress(&self, stress0: [f64; 6], strain: [f64; 6]) -> [f64; 6];
    /// Its derivative by the strain increment [Pa], counted as `Model::tangent` is.
    fn tangent(&self, stress0: [f64; 6], strain: [f64; 6]) -> [[f64; 6]; 6];
    /// Modulus of the fastest wave for a bulk modulus, K or, of an elastic deviator, K + 4/3 G [Pa].
    #[inline(always)]
    fn wave_modulus(&self, bulk_modulus: f64) -> f64 {
        bulk_modulus
    }
    /// 4/3 μ of a viscous deviator [Pa s]: over the density, the diffusivity of longitudinal motion.
    #[inline(always)]
    fn viscosity(&self) -> f64 {
        0.0
    }
}

/// A model that is a [`Fluid`] with a [`Deviator`]. In its `impl Model`,
/// [`fluid_model!`](crate::fluid_model) writes what follows from both.
pub trait FluidModel {
    /// The pressure law.
    fn fluid(&self) -> &Fluid;
    /// The law of the deviator in a step of `dt` [s].
    fn deviator(&self, dt: f64) -> impl Deviator;
}

/// Writes the state, the input and the functions in the `impl Model` of a type that is a
/// [`FluidModel`](crate::fluid::FluidModel).
#[macro_export]
macro_rules! fluid_model {
    () => {
        const STATES: &'static [::lahar_plugin::State] = $crate::fluid::STATES;
        const INPUTS: &'static [::lahar_plugin::Input] = &[::lahar_plugin::Input::Density];
        const HAS_TANGENT: bool = true;

        fn init_state(&self, batch: &mut ::lahar_plugin::Batch<'_>) -> Result<(), String> {
            $crate::fluid::FluidModel::fluid(self).init_state(batch)
        }

        #[inline(always)]
        fn update(&self, batch: &mut ::lahar_plugin::Batch<'_>) {
            let deviator = $crate::fluid::FluidModel::deviator(self, batch.dt());
            $crate::fluid::FluidModel::fluid(self).update::<Self>(batch, deviator);
        }

        #[inline(always)]
        fn wave_speed(&self, batch: &mut ::lahar_plugin::Batch<'_>) {
            let deviator = $crate::fluid::FluidModel::deviator(self, batch.dt());
            $crate::fluid::FluidModel::fluid(self).wave_speed(batch, deviator);
        }

        fn tangent(&self, batch: &::lahar_plugin::Batch<'_>, k: usize) -> [[f64; 6]; 6] {
            let deviator = $crate::fluid::FluidModel::deviator(self, batch.dt());
            $crate::fluid::FluidModel::fluid(self).tangent(batch, k, deviator)
        }
    };
}

/// A viscous deviator, s = 2 μ Δe / Δt.
#[derive(Clone, Copy, Debug)]
pub struct Viscous {
    viscosity: f64,
    two_mu_per_dt: f64,
}

impl Viscous {
    /// Of a viscosity [Pa s] and a step [s]; without a step there is no rate and no stress.
    pub fn new(viscosity: f64, dt: f64) -> Self {
        let flows = viscosity > 0.0 && dt > 0.0;
        Self { viscosity, two_mu_per_dt: if flows { 2.0 * viscosity / dt } else { 0.0 } }
    }
}

impl Deviator for Viscous {
    #[inline(always)]
    fn stress(&self, _: [f64; 6], strain: [f64; 6]) -> [f64; 6] {
        strain.map(|e| self.two_mu_per_dt * e) // [NWT-2]
    }

    fn tangent(&self, _: [f64; 6], _: [f64; 6]) -> [[f64; 6]; 6] {
        elastic::stiffness([-self.two_mu_per_dt / 3.0, 0.5 * self.two_mu_per_dt])
    }

    #[inline(always)]
    fn viscosity(&self) -> f64 {
        4.0 / 3.0 * self.viscosity
    }
}

/// Calls a closure-like expression with the pressure law in the form that is compiled for it.
macro_rules! with_pressure {
    ($fluid:expr, $pressure:ident => $body:expr) => {
        match $fluid.equation_of_state {
            EquationOfState::Linear => {
                let $pressure = Whole::<1>;
                $body
            }
            EquationOfState::Tait { exponent: 7.0 } => {
                let $pressure = Whole::<7>;
                $body
            }
            EquationOfState::Tait { exponent } => {
                let $pressure = Real { exponent };
                $body
            }
        }
    };
}

impl Fluid {
    /// A fluid without background pressure, from its bulk modulus [Pa], its form, and the value of [`ZERO_TENSION`].
    pub fn new(bulk_modulus: f64, equation_of_state: EquationOfState, zero_tension: f64) -> Self {
        let least_pressure = if zero_tension == 0.0 { f64::NEG_INFINITY } else { 0.0 };
        Self { bulk_modulus, equation_of_state, background_pressure: 0.0, least_pressure }
    }

    /// Volume ratio at the pressure `p` [Pa]; not a number or not positive if the fluid cannot have it.
    pub fn volume_ratio(&self, p: f64) -> f64 {
        let p = p - self.background_pressure;
        match self.equation_of_state {
            EquationOfState::Tait { exponent } => {
                (-(exponent * p / self.bulk_modulus).ln_1p() / exponent).exp()
            }
            EquationOfState::Linear => 1.0 / (1.0 + p / self.bulk_modulus),
        }
    }

    /// [`Model::init_state`]: the volume ratios of the start stresses.
    pub fn init_state(&self, batch: &mut Batch<'_>) -> Result<(), String> {
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

    /// [`Model::update`] of the model `M`, whose state is [`STATES`] and whose input is the density.
    #[inline(always)]
    pub fn update<M: Model>(&self, batch: &mut Batch<'_>, deviator: impl Deviator) {
        with_pressure!(self, pressure => batch.for_each_point(&Law {
            bulk_modulus: self.bulk_modulus,
            background_pressure: self.background_pressure,
            least_pressure: self.least_pressure,
            pressure,
            deviator,
            model: PhantomData::<M>,
        }));
    }

    /// [`Model::wave_speed`].
    #[inline(always)]
    pub fn wave_speed(&self, batch: &mut Batch<'_>, deviator: impl Deviator) {
        with_pressure!(self, pressure => self.wave_speed_with(batch, pressure, deviator));
    }

    #[inline(always)]
    fn wave_speed_with(
        &self,
        batch: &mut Batch<'_>,
        pressure: impl Pressure,
        deviator: impl Deviator,
    ) {
        let density = batch.input(0);
        for k in 0..batch.n() {
            let [j] = batch.state0(k);
            let modulus = deviator.wave_modulus(self.bulk_modulus * pressure.relative(j).1);
            batch.set_wave_speed(k, (modulus / density[k]).sqrt());
            batch.set_diffusivity(k, deviator.viscosity() / density[k]);
        }
    }

    /// [`Model::tangent`].
    pub fn tangent(&self, batch: &Batch<'_>, k: usize, flow: impl Deviator) -> [[f64; 6]; 6] {
        let strain = batch.strain_increment(k);
        let [j0] = batch.state0(k);
        let j = j0 * math::exp(trace(strain));
        let (p, slope) = with_pressure!(self, pressure => pressure.relative(j));
        let mut tangent = flow.tangent(batch.stress0(k), deviator(strain));
        if self.background_pressure + self.bulk_modulus * p >= self.least_pressure {
            for row in &mut tangent[..3] {
                for value in &mut row[..3] {
                    *value += self.bulk_modulus * slope;
                }
            }
        }
        tangent
    }
}

/// The formulas of one point.
struct Law<M, P, D> {
    bulk_modulus: f64,
    background_pressure: f64,
    least_pressure: f64,
    pressure: P,
    deviator: D,
    model: PhantomData<M>,
}

impl<M: Model, P: Pressure, D: Deviator> PointLaw<1> for Law<M, P, D> {
    type Model = M;

    #[inline(always)]
    fn update(&self, point: &Point<1>) -> Updated<1> {
        let (strain, density) = (point.strain_increment, point.inputs[0]);
        let Self { bulk_modulus, background_pressure, least_pressure, .. } = *self;
        let j = point.state0[0] * math::exp(trace(strain));
        let (pressure, tangent) = self.pressure.relative(j);
        let p = background_pressure + bulk_modulus * pressure;
        // An opened point keeps the wave speed of its volume ratio.
        let p = if p < least_pressure { least_pressure } else { p }; // [TWC-1]
        let [xx, yy, zz, xy, yz, zx] = self.deviator.stress(point.stress0, deviator(strain));
        let stress1 = [xx - p, yy - p, zz - p, xy, yz, zx];
        let wave_speed = (self.deviator.wave_modulus(bulk_modulus * tangent) / density).sqrt();
        let diffusivity = self.deviator.viscosity() / density;
        let sane = is_finite(strain) & (j > 0.0);
        Updated { diffusivity, ..Updated::checked(stress1, [j], wave_speed, sane) }
    }
}
