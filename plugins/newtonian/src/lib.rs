//! Weakly compressible fluids: σ = -p(J) I + 2 μ dev(Δε/Δt), J = V / V at zero pressure. A Newtonian fluid of any stiffness, and water
//! that cavitates.
#![forbid(unsafe_code)]

pub mod fluid;
mod pressure;
mod tait_water;

pub use tait_water::TaitWater;

use fluid::{EquationOfState, Fluid, Viscous};
use lahar_plugin::{Batch, Driver, Input, Model, ModelTable, Output, Parameter, State};
use std::ffi::CStr;

lahar_plugin::plugin!(c"org.lahar.newtonian", [Newtonian, TaitWater]);

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

/// Constants of an instance.
pub struct Newtonian {
    fluid: Fluid,
    viscosity: f64,
}

impl Model for Newtonian {
    const NAME: &'static CStr = c"newtonian";
    const SUMMARY: &'static CStr = c"Weakly compressible Newtonian fluid";
    const REFERENCE: &'static CStr =
        c"Monaghan: Simulating free surface flows with SPH, J. Comput. Phys. 110 (1994), doi:10.1006/jcph.1994.1034";
    const PARAMETERS: &'static [Parameter] = &[
        fluid::BULK_MODULUS,
        Parameter::real(c"viscosity", c"mu", c"Pa s", c"Dynamic viscosity")
            .default(0.0)
            .hard(0.0, f64::INFINITY)
            .advised(0.0, 1.0e4),
        fluid::EQUATION_OF_STATE,
        fluid::EXPONENT,
        fluid::ZERO_TENSION,
    ];
    const STATES: &'static [State] = fluid::STATES;
    const INPUTS: &'static [Input] = &[Input::Density];
    const OUTPUTS: Output = Output::WAVE_SPEED.and(Output::DIFFUSIVITY).and(Output::STATUS);
    const HAS_TANGENT: bool = true;

    fn new(values: &[f64]) -> Result<Self, String> {
        let [bulk_modulus, viscosity, equation, exponent, zero_tension] = values[..] else {
            return Err("expected 5 values".into());
        };
        let fluid =
            Fluid::new(bulk_modulus, EquationOfState::new(equation, exponent), zero_tension);
        Ok(Self { fluid, viscosity })
    }

    fn init_state(&self, batch: &mut Batch<'_>) -> Result<(), String> {
        self.fluid.init_state(batch)
    }

    #[inline(always)]
    fn update(&self, batch: &mut Batch<'_>) {
        self.fluid.update::<Self>(batch, Viscous::new(self.viscosity, batch.dt()));
    }

    #[inline(always)]
    fn wave_speed(&self, batch: &mut Batch<'_>) {
        self.fluid.wave_speed(batch, Viscous::new(self.viscosity, batch.dt()));
    }

    fn tangent(&self, batch: &Batch<'_>, k: usize) -> [[f64; 6]; 6] {
        self.fluid.tangent(batch, k, Viscous::new(self.viscosity, batch.dt()))
    }
}
