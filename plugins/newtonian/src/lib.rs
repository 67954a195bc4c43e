//! Weakly compressible fluids: σ = -p(J) I + 2 μ dev(Δε/Δt), J = V / V at zero pressure. A Newtonian fluid of any stiffness, and water
//! that cavitates.
#![forbid(unsafe_code)]

pub mod fluid;
mod pressure;
mod tait_water;

pub use tait_water::TaitWater;

use fluid::{Deviator, EquationOfState, Fluid, FluidModel, Viscous};
use lahar_plugin::{Driver, Model, ModelTable, Output, Parameter};
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

impl FluidModel for Newtonian {
    #[inline(always)]
    fn fluid(&self) -> &Fluid {
        &self.fluid
    }

    #[inline(always)]
    fn deviator(&self, dt: f64) -> impl Deviator {
        Viscous::new(self.viscosity, dt)
    }
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
            .hard(0.0, f64::INFINITY),
        fluid::EQUATION_OF_STATE,
        fluid::EXPONENT,
        fluid::ZERO_TENSION,
    ];
    const OUTPUTS: Output = Output::WAVE_SPEED.and(Output::DIFFUSIVITY).and(Output::STATUS);
    fluid_model!();

    fn new(values: &[f64]) -> Result<Self, String> {
        let [bulk_modulus, viscosity, equation, exponent, zero_tension] = values[..] else {
            return Err("expected 5 values".into());
        };
        let fluid =
            Fluid::new(bulk_modulus, EquationOfState::new(equation, exponent), zero_tension);
        Ok(Self { fluid, viscosity })
    }
}
