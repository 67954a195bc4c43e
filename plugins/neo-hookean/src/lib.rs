//! Compressible neo-Hookean elasticity: σ = [μ (b − I) + λ ln J I] / J with b = F Fᵀ, J = det F.
#![forbid(unsafe_code)]

use lahar_plugin::elastic::{self, lame};
use lahar_plugin::math::ln;
use lahar_plugin::tensor::{contract, determinant, deviator, is_finite, left_cauchy_green, trace};
use lahar_plugin::{
    Batch, Driver, Input, Kinematics, Model, ModelTable, Output, Parameter, Point, PointLaw,
    Updated,
};
use std::ffi::CStr;

lahar_plugin::plugin!(c"org.lahar.neo_hookean", [NeoHookean]);

/// `n` points for a bench, deformed by tens of per cent, different in each point.
pub fn sample(n: usize) -> Result<Driver, String> {
    let named = [("youngs_modulus", 1.0e6), ("poissons_ratio", 0.3)];
    let mut driver = Driver::new(ModelTable::of::<NeoHookean>().desc(), &named, n)?;
    for k in 0..n {
        let e = 0.05 * (1.0 + (k % 7) as f64);
        driver.set_gradient(k, [1.0 + e, e, 0.0, -0.5 * e, 1.0 - e, 0.1, 0.0, e, 1.0 + 0.5 * e]);
    }
    Ok(driver)
}

/// Elastic constants of an instance [Pa].
pub struct NeoHookean {
    lambda: f64,
    shear_modulus: f64,
}

impl NeoHookean {
    /// Speed of the fastest wave [m/s] from F and the current density [kg/m^3], or a little more.
    ///
    /// Small waves of direction n on top of the deformation have the acoustic tensor
    /// ρ J c² a = μ (n·b n) a + (μ + λ − λ ln J) n (n·a), so that ρ J c² is at most μ b_max + max(μ + λ − λ ln J, 0). The largest
    /// principal value of b is at most tr b / 3 + √(2/3) |dev b|, and equal to it when the two others are equal.
    #[inline(always)]
    fn wave_speed_of(&self, f: [f64; 9], density: f64) -> f64 {
        let (b, j) = (left_cauchy_green(f), determinant(f));
        let d = deviator(b);
        let largest = trace(b) / 3.0 + (2.0 / 3.0 * contract(d, d)).sqrt();
        let axial = self.shear_modulus + self.lambda - self.lambda * ln(j);
        let axial = if axial < 0.0 { 0.0 } else { axial };
        ((self.shear_modulus * largest + axial) / (j * density)).sqrt() // [STR-12]
    }
}

impl Model for NeoHookean {
    const NAME: &'static CStr = c"neo_hookean";
    const SUMMARY: &'static CStr =
        c"Compressible neo-Hookean elasticity, for large elastic strains";
    const REFERENCE: &'static CStr = c"Simo, Pister: Comput. Methods Appl. Mech. Engrg 46 (1984) 201-215, doi:10.1016/0045-7825(84)90062-8";
    const KINEMATICS: Kinematics = Kinematics::DeformationGradient;
    const PARAMETERS: &'static [Parameter] = &[
        elastic::YOUNGS_MODULUS.described(c"Young's modulus at small strains"),
        elastic::POISSONS_RATIO.described(c"Poisson's ratio at small strains"),
    ];
    const INPUTS: &'static [Input] = &[Input::Density];
    const OUTPUTS: Output = Output::WAVE_SPEED.and(Output::ENERGY).and(Output::STATUS);

    fn new(values: &[f64]) -> Result<Self, String> {
        let [e, nu] = values[..] else { return Err("expected 2 values".into()) };
        let [lambda, shear_modulus] = lame(e, nu)?;
        Ok(Self { lambda, shear_modulus })
    }

    #[inline(always)]
    fn update(&self, batch: &mut Batch<'_>) {
        batch.for_each_point(self);
    }

    #[inline(always)]
    fn wave_speed(&self, batch: &mut Batch<'_>) {
        let density = batch.input(0);
        for k in 0..batch.n() {
            let speed = self.wave_speed_of(batch.deformation_gradient_rows(k), density[k]);
            batch.set_wave_speed(k, speed);
        }
    }
}

impl PointLaw<0> for NeoHookean {
    type Model = Self;

    #[inline(always)]
    fn update(&self, point: &Point<0>) -> Updated<0> {
        let (f, mu) = (point.gradient, self.shear_modulus);
        let (b, j) = (left_cauchy_green(f), determinant(f));
        let (inverse, ln_j) = (1.0 / j, ln(j));
        let volumetric = self.lambda * ln_j;
        let stress1 = [
            (mu * (b[0] - 1.0) + volumetric) * inverse,
            (mu * (b[1] - 1.0) + volumetric) * inverse,
            (mu * (b[2] - 1.0) + volumetric) * inverse,
            mu * b[3] * inverse,
            mu * b[4] * inverse,
            mu * b[5] * inverse, // [STR-10]
        ];
        let stretched = 0.5 * mu * (trace(b) - 3.0);
        let energy = (stretched - mu * ln_j + 0.5 * volumetric * ln_j) * inverse; // [STR-11]
        let wave_speed = self.wave_speed_of(f, point.inputs[0]);
        Updated { energy, ..Updated::checked(stress1, [], wave_speed, is_finite([energy])) }
    }
}
