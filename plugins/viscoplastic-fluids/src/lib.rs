//! Fluids with a yield stress that come to rest: Bingham, τ = τ_y + μ γ̇, and Herschel-Bulkley, τ = τ_y + K γ̇^n.
//!
//! Below the yield stress they are elastic, above it the stress relaxes to the flow curve; the step is solved implicitly for the shear stress.
//! So nothing is regularised: a slope that should stand stands, and no viscosity bounds the time step.
#![forbid(unsafe_code)]

mod flow;

use flow::{Flow, Power, Viscosity};
use lahar_model_newtonian::fluid::{self, Deviator, EquationOfState, Fluid, FluidModel};
use lahar_model_newtonian::fluid_model;
use lahar_plugin::{Driver, Model, ModelTable, Parameter};
use std::ffi::CStr;

lahar_plugin::plugin!(c"org.lahar.viscoplastic_fluids", [Bingham, HerschelBulkley]);

/// `n` points of the model `M` for a bench: all of them in flow, different in each point. Made for steps of 1e-4 s.
pub fn sample<M: Model>(n: usize) -> Result<Driver, String> {
    let mut driver = Driver::typical(ModelTable::of::<M>().desc(), &[], n)?;
    driver.set_samples(
        1e-5,
        [1.0, -2.0, 1.0, 3.0, -1.0, 0.0],
        [-1e3, -1e3, -1e3, 60.0, 30.0, -20.0],
    );
    Ok(driver)
}

const SHEAR_MODULUS: Parameter = Parameter::real(
    c"shear_modulus",
    c"G",
    c"Pa",
    c"Shear modulus below the yield stress; a hundred times the yield stress or more",
)
.typical(1.0e4)
.hard(f64::MIN_POSITIVE, f64::INFINITY);
const YIELD_STRESS: Parameter =
    Parameter::real(c"yield_stress", c"tau_y", c"Pa", c"Shear stress at which it yields")
        .typical(50.0)
        .hard(0.0, f64::INFINITY);
const REFERENCE: &CStr = c"Saramito: A new elastoviscoplastic model based on the Herschel-Bulkley viscoplastic model, J. Non-Newton. Fluid Mech. 158 (2009), doi:10.1016/j.jnnfm.2008.12.001";

/// What the two models have in common.
#[derive(Clone, Copy)]
struct Constants {
    fluid: Fluid,
    shear_modulus: f64,
    yield_stress: f64,
}

impl Constants {
    /// In the order of the parameters: bulk modulus, shear modulus, yield stress, and at the end equation of state, exponent and
    /// tension.
    fn new(values: &[f64]) -> Result<Self, String> {
        let [bulk_modulus, shear_modulus, yield_stress, .., equation, exponent, zero_tension] =
            values[..]
        else {
            return Err("expected at least 6 values".into());
        };
        let equation = EquationOfState::new(equation, exponent);
        let fluid = Fluid::new(bulk_modulus, equation, zero_tension);
        Ok(Self { fluid, shear_modulus, yield_stress })
    }
}

/// Constants of a Bingham fluid.
pub struct Bingham {
    constants: Constants,
    viscosity: f64,
}

impl FluidModel for Bingham {
    #[inline(always)]
    fn fluid(&self) -> &Fluid {
        &self.constants.fluid
    }

    #[inline(always)]
    fn deviator(&self, dt: f64) -> impl Deviator {
        let Constants { shear_modulus, yield_stress, .. } = self.constants;
        let overstress = Viscosity::new(self.viscosity, shear_modulus * dt);
        Flow { shear_modulus, yield_stress, overstress }
    }
}

impl Model for Bingham {
    const NAME: &'static CStr = c"bingham";
    const SUMMARY: &'static CStr = c"Bingham fluid, elastic below its yield stress";
    const REFERENCE: &'static CStr = REFERENCE;
    const PARAMETERS: &'static [Parameter] = &[
        fluid::BULK_MODULUS,
        SHEAR_MODULUS,
        YIELD_STRESS,
        Parameter::real(
            c"viscosity",
            c"mu",
            c"Pa s",
            c"Plastic viscosity, beyond the yield stress",
        )
        .typical(10.0)
        .hard(0.0, f64::INFINITY),
        fluid::EQUATION_OF_STATE,
        fluid::EXPONENT,
        fluid::ZERO_TENSION,
    ];
    fluid_model!();

    fn new(values: &[f64]) -> Result<Self, String> {
        let [_, _, _, viscosity, _, _, _] = values[..] else {
            return Err("expected 7 values".into());
        };
        Ok(Self { constants: Constants::new(values)?, viscosity })
    }
}

/// Constants of a Herschel-Bulkley fluid.
pub struct HerschelBulkley {
    constants: Constants,
    consistency: f64,
    flow_index: f64,
}

impl FluidModel for HerschelBulkley {
    #[inline(always)]
    fn fluid(&self) -> &Fluid {
        &self.constants.fluid
    }

    #[inline(always)]
    fn deviator(&self, dt: f64) -> impl Deviator {
        let Constants { shear_modulus, yield_stress, .. } = self.constants;
        let overstress = Power::new(self.consistency, self.flow_index, shear_modulus * dt);
        Flow { shear_modulus, yield_stress, overstress }
    }
}

impl Model for HerschelBulkley {
    const NAME: &'static CStr = c"herschel_bulkley";
    const SUMMARY: &'static CStr = c"Herschel-Bulkley fluid, elastic below its yield stress";
    const REFERENCE: &'static CStr = REFERENCE;
    const PARAMETERS: &'static [Parameter] = &[
        fluid::BULK_MODULUS,
        SHEAR_MODULUS,
        YIELD_STRESS,
        Parameter::real(
            c"consistency",
            c"K",
            c"Pa s^n",
            c"Shear stress beyond that of yield, at 1/s",
        )
        .typical(10.0)
        .hard(f64::MIN_POSITIVE, f64::INFINITY),
        Parameter::real(
            c"flow_index",
            c"n",
            c"-",
            c"Exponent of the rate of shear; below 1: thinning",
        )
        .typical(0.5)
        .hard(0.05, 5.0)
        .advised(0.2, 2.0),
        fluid::EQUATION_OF_STATE,
        fluid::EXPONENT,
        fluid::ZERO_TENSION,
    ];
    fluid_model!();

    fn new(values: &[f64]) -> Result<Self, String> {
        let [_, _, _, consistency, flow_index, _, _, _] = values[..] else {
            return Err("expected 8 values".into());
        };
        Ok(Self { constants: Constants::new(values)?, consistency, flow_index })
    }
}
