//! Isotropic linear elasticity in rate form: Δσ = λ tr(Δε) I + 2 G Δε on the objectively rotated stress.
#![forbid(unsafe_code)]

use lahar_plugin::elastic::{self, Elastic, lame};
use lahar_plugin::{
    Batch, Driver, Input, Kinematics, Model, ModelTable, Parameter, Point, PointLaw, Updated,
    elastic_model,
};
use std::ffi::CStr;

lahar_plugin::plugin!(c"org.lahar.linear_elastic", [LinearElastic, LinearElasticGreenNaghdi]);

/// `n` points for a bench, strained and stressed, different in each point.
pub fn sample(n: usize) -> Result<Driver, String> {
    let named = [("youngs_modulus", 1.0e7), ("poissons_ratio", 0.3)];
    let mut driver = Driver::new(ModelTable::of::<LinearElastic>().desc(), &named, n)?;
    for k in 0..n {
        let e = 1e-6 * (1.0 + (k % 7) as f64);
        driver.set_strain_increment(k, [e, -2.0 * e, e, 3.0 * e, -e, 0.0]);
        driver.set_stress(k, [-1e3, -2e3, -1e3, 1e2, 0.0, 1e7 * e]);
    }
    Ok(driver)
}

/// Constants of an instance.
pub struct LinearElastic {
    /// Lamé's constants [Pa].
    lame: [f64; 2],
}

impl Elastic for LinearElastic {
    #[inline(always)]
    fn lame(&self) -> [f64; 2] {
        self.lame
    }
}

impl Model for LinearElastic {
    const NAME: &'static CStr = c"linear_elastic";
    const SUMMARY: &'static CStr = c"Isotropic linear elasticity in rate form";
    const REFERENCE: &'static CStr =
        c"Belytschko, Liu, Moran, Elkhodary: Nonlinear Finite Elements, 2nd ed. (2014), section 5.4";
    const PARAMETERS: &'static [Parameter] = &[elastic::YOUNGS_MODULUS, elastic::POISSONS_RATIO];
    const INPUTS: &'static [Input] = &[Input::Density];
    const HAS_TANGENT: bool = true;
    elastic_model!();

    fn new(values: &[f64]) -> Result<Self, String> {
        let [e, nu] = values[..] else { return Err("expected 2 values".into()) };
        Ok(Self { lame: lame(e, nu)? })
    }

    #[inline(always)]
    fn update(&self, batch: &mut Batch<'_>) {
        batch.for_each_point(self);
    }

    fn tangent(&self, _: &Batch<'_>, _: usize) -> [[f64; 6]; 6] {
        elastic::stiffness(self.lame)
    }
}

impl PointLaw<0> for LinearElastic {
    type Model = Self;

    #[inline(always)]
    fn update(&self, point: &Point<0>) -> Updated<0> {
        let stress1 = elastic::stress(self.lame, point.stress0, point.strain_increment);
        Updated::checked(stress1, [], self.wave_speed_of(point.inputs[0]), true)
    }
}

/// The same law on a stress that the engine turns with R of F = R U instead of with the spin.
pub struct LinearElasticGreenNaghdi(LinearElastic);

impl Elastic for LinearElasticGreenNaghdi {
    #[inline(always)]
    fn lame(&self) -> [f64; 2] {
        self.0.lame
    }
}

impl Model for LinearElasticGreenNaghdi {
    const NAME: &'static CStr = c"linear_elastic_green_naghdi";
    const SUMMARY: &'static CStr =
        c"Isotropic linear elasticity in rate form with the Green-Naghdi rate";
    const REFERENCE: &'static CStr =
        c"Dienes: Acta Mechanica 32 (1979) 217-232, doi:10.1007/BF01379008";
    const KINEMATICS: Kinematics = Kinematics::GreenNaghdi;
    const PARAMETERS: &'static [Parameter] = LinearElastic::PARAMETERS;
    const INPUTS: &'static [Input] = LinearElastic::INPUTS;
    const HAS_TANGENT: bool = true;
    elastic_model!();

    fn new(values: &[f64]) -> Result<Self, String> {
        LinearElastic::new(values).map(Self)
    }

    #[inline(always)]
    fn update(&self, batch: &mut Batch<'_>) {
        batch.for_each_point(self);
    }

    fn tangent(&self, batch: &Batch<'_>, k: usize) -> [[f64; 6]; 6] {
        self.0.tangent(batch, k)
    }
}

impl PointLaw<0> for LinearElasticGreenNaghdi {
    type Model = Self;

    #[inline(always)]
    fn update(&self, point: &Point<0>) -> Updated<0> {
        PointLaw::update(&self.0, point)
    }
}
