//! Water after Tait, which cavitates.

use crate::fluid::{Deviator, EXPONENT, EquationOfState, Fluid, FluidModel, Viscous};
use crate::fluid_model;
use lahar_plugin::{Model, Output, Parameter};
use std::ffi::CStr;

/// Constants of an instance.
pub struct TaitWater {
    fluid: Fluid,
    viscosity: f64,
}

impl FluidModel for TaitWater {
    #[inline(always)]
    fn fluid(&self) -> &Fluid {
        &self.fluid
    }

    #[inline(always)]
    fn deviator(&self, dt: f64) -> impl Deviator {
        Viscous::new(self.viscosity, dt)
    }
}

impl Model for TaitWater {
    const NAME: &'static CStr = c"tait_water";
    const SUMMARY: &'static CStr =
        c"Water after Tait, which cavitates at a pressure and remembers its voids";
    const REFERENCE: &'static CStr =
        c"Monaghan: Simulating free surface flows with SPH, J. Comput. Phys. 110 (1994), doi:10.1006/jcph.1994.1034";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::real(c"bulk_modulus", c"K", c"Pa", c"rho0 c0^2: of the liquid at volume ratio 1")
            .typical(2.2e9)
            .hard(f64::MIN_POSITIVE, f64::INFINITY),
        EXPONENT,
        Parameter::real(c"viscosity", c"mu", c"Pa s", c"Dynamic viscosity")
            .typical(1.0e-3)
            .hard(0.0, f64::INFINITY),
        Parameter::real(
            c"background_pressure",
            c"p_b",
            c"Pa",
            c"Pressure at volume ratio 1; 0: pressures are counted from that of the atmosphere",
        )
        .default(0.0)
        .advised(0.0, f64::INFINITY),
        Parameter::real(
            c"cavitation_pressure",
            c"p_c",
            c"Pa",
            c"Pressure at which the liquid opens, at most p_b: that of the vapour, less the atmosphere if p_b is 0",
        )
        .typical(-98_986.0),
    ];
    const OUTPUTS: Output = Output::WAVE_SPEED.and(Output::DIFFUSIVITY).and(Output::STATUS);
    fluid_model!();

    fn check(values: &[f64]) -> Result<(), String> {
        let [.., background, cavitation] = values[..] else {
            return Err("expected 5 values".into());
        };
        if cavitation > background {
            return Err(format!(
                "cavitation_pressure is {cavitation} Pa, but must not exceed background_pressure, which is {background} \
                 Pa: the liquid would be open at its own volume"
            ));
        }
        Ok(())
    }

    fn new(values: &[f64]) -> Result<Self, String> {
        let [bulk_modulus, exponent, viscosity, background_pressure, least_pressure] = values[..]
        else {
            return Err("expected 5 values".into());
        };
        let equation_of_state = EquationOfState::Tait { exponent };
        let fluid = Fluid { bulk_modulus, equation_of_state, background_pressure, least_pressure };
        Ok(Self { fluid, viscosity })
    }
}
