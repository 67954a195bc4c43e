//! own_material: a constitutive model for lahar in Rust, to be copied and changed.
//!
//! Isotropic linear elasticity with a von Mises cap: perfect plasticity, radial return. From the folder of the repository:
//!
//! ```sh
//! cargo build --release -p own-material
//! ```
//!
//! makes `target/release/libown_material.so`. Change what stands under the comments CHANGE. In short: units are those of the host,
//! tension is positive, stresses and strains have the tensor components xx, yy, zz, xy, yz, zx in plane strain too, and a function
//! neither prints nor exits. A panic becomes an error of the host.

use lahar_plugin::elastic::lame;
use lahar_plugin::tensor::{contract, deviator, trace};
use lahar_plugin::{
    Batch, Input, Kinematics, Model, ModelTable, Output, Parameter, Plugin, Point, PointLaw, State,
    Updated, export_plugin,
};
use std::ffi::CStr;

// CHANGE who and what; the list may have several models.
static PLUGIN: Plugin =
    Plugin::new(c"org.example.own_material", c"1.0", &[ModelTable::of::<OwnMaterial>()])
        .author(c"You")
        .licence(c"MIT OR Apache-2.0");

export_plugin!(PLUGIN);

// CHANGE the constants of one instance, made once from the parameters.
struct OwnMaterial {
    lambda: f64,        // [Pa]
    shear_modulus: f64, // [Pa]
    yield_stress: f64,  // [Pa]
}

impl OwnMaterial {
    // CHANGE the speed of the fastest wave [m/s]: the time step follows from it, too low a speed makes the run unstable.
    #[inline(always)]
    fn speed(&self, density: f64) -> f64 {
        ((self.lambda + 2.0 * self.shear_modulus) / density).sqrt()
    }
}

impl Model for OwnMaterial {
    // CHANGE names, kinematics, parameters, state variables, inputs and outputs. A typical value of a required parameter is one with
    // which tools try the model. Values outside the hard bounds are refused, those outside the advised ones are warned of.
    const NAME: &'static CStr = c"own_material";
    const SUMMARY: &'static CStr = c"Linear elasticity with a von Mises cap";
    const REFERENCE: &'static CStr =
        c"Simo, Hughes: Computational Inelasticity (1998), section 3.3, doi:10.1007/b98904";
    const KINEMATICS: Kinematics = Kinematics::StrainIncrement;
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::real(c"youngs_modulus", c"E", c"Pa", c"Young's modulus")
            .typical(1e7)
            .hard(f64::MIN_POSITIVE, f64::INFINITY),
        Parameter::real(c"poissons_ratio", c"nu", c"-", c"Poisson's ratio")
            .typical(0.3)
            .hard(-0.999, 0.4999)
            .advised(0.0, 0.495),
        Parameter::real(c"yield_stress", c"Y", c"Pa", c"Largest von Mises stress")
            .typical(1e4)
            .hard(f64::MIN_POSITIVE, f64::INFINITY),
    ];
    const STATES: &'static [State] = &[State::scalar(
        c"equivalent_plastic_strain",
        c"-",
        c"Integral of the rate of plastic strain",
    )];
    const INPUTS: &'static [Input] = &[Input::Density];
    const OUTPUTS: Output = Output::WAVE_SPEED.and(Output::STATUS);

    // CHANGE how an instance is made. Values come in the order of PARAMETERS, inside their hard bounds.
    fn new(values: &[f64]) -> Result<Self, String> {
        let [e, nu, yield_stress] = values[..] else { return Err("expected 3 values".into()) };
        let [lambda, shear_modulus] = lame(e, nu)?;
        Ok(Self { lambda, shear_modulus, yield_stress })
    }

    #[inline(always)]
    fn update(&self, batch: &mut Batch<'_>) {
        batch.for_each_point(self);
    }

    #[inline(always)]
    fn wave_speed(&self, batch: &mut Batch<'_>) {
        for (k, density) in batch.input(0).iter().enumerate() {
            batch.set_wave_speed(k, self.speed(*density));
        }
    }
}

/// The law of one point, with one component of state.
impl PointLaw<1> for OwnMaterial {
    type Model = Self;

    // CHANGE the law. The engine has turned the start stress with the material. Straight-line code becomes vector instructions.
    #[inline(always)]
    fn update(&self, point: &Point<1>) -> Updated<1> {
        let strain = point.strain_increment;
        let (volumetric, two_g) = (self.lambda * trace(strain), 2.0 * self.shear_modulus);
        let mut stress = point.stress0;
        // the elastic trial
        for c in 0..6 {
            let pressure = if c < 3 { volumetric } else { 0.0 };
            stress[c] = stress[c] + pressure + two_g * strain[c];
        }
        // its deviator and von Mises stress
        let s = deviator(stress);
        let mises = (1.5 * contract(s, s)).sqrt();
        // what is beyond the cap goes back along the deviator
        let is_plastic = mises > self.yield_stress;
        let share = if is_plastic { (mises - self.yield_stress) / mises } else { 0.0 };
        for c in 0..6 {
            stress[c] -= share * s[c];
        }
        let state1 = [point.state0[0] + share * mises / (3.0 * self.shear_modulus)];
        // a point with a value that is not finite fails; further conditions replace `true`
        Updated::checked(stress, state1, self.speed(point.inputs[0]), true)
    }
}
