//! Hencky elasticity: the Kirchhoff stress J σ = λ tr(ε) I + 2 μ ε of the logarithmic strain ε = ½ ln b, b = F Fᵀ.
#![forbid(unsafe_code)]

use lahar_plugin::elastic::{self, lame};
use lahar_plugin::math::ln;
use lahar_plugin::tensor::{determinant, is_finite, left_cauchy_green};
use lahar_plugin::{
    Batch, Driver, Input, Kinematics, Model, ModelTable, Output, Parameter, Point, PointLaw,
    Updated, principal,
};
use std::ffi::CStr;

lahar_plugin::plugin!(c"org.lahar.hencky", [Hencky]);

/// `n` points for a bench, deformed by tens of per cent, different in each point.
pub fn sample(n: usize) -> Result<Driver, String> {
    let named = [("youngs_modulus", 1.0e6), ("poissons_ratio", 0.3)];
    let mut driver = Driver::new(ModelTable::of::<Hencky>().desc(), &named, n)?;
    for k in 0..n {
        let e = 0.05 * (1.0 + (k % 7) as f64);
        driver.set_gradient(k, [1.0 + e, e, 0.0, -0.5 * e, 1.0 - e, 0.1, 0.0, e, 1.0 + 0.5 * e]);
    }
    Ok(driver)
}

/// Elastic constants of an instance [Pa].
pub struct Hencky {
    lambda: f64,
    shear_modulus: f64,
}

/// The principal values of b, their logarithms and those of the Kirchhoff stress [Pa].
struct Principal {
    square: [f64; 3],
    log: [f64; 3],
    kirchhoff: [f64; 3],
}

impl Hencky {
    #[inline(always)]
    fn principal(&self, square: [f64; 3]) -> Principal {
        let log = [ln(square[0]), ln(square[1]), ln(square[2])]; // 2 ε
        let volumetric = 0.5 * self.lambda * (log[0] + log[1] + log[2]);
        let mu = self.shear_modulus;
        let kirchhoff =
            [volumetric + mu * log[0], volumetric + mu * log[1], volumetric + mu * log[2]];
        Principal { square, log, kirchhoff }
    }

    /// Bound of ρ J c² of small waves on top of the deformation [Pa].
    ///
    /// In principal axes their acoustic tensor is Q_ij = δ_ij μ Σ_k n_k² g_ki + n_i n_j (λ + μ g_ij − τ_i) with
    /// g_ij = b_i (ln b_i − ln b_j) / (b_i − b_j), g_ii = 1; both terms are bounded by their largest factor.
    #[inline(always)]
    fn stiffness(&self, p: &Principal) -> f64 {
        let (mut shear, mut axial) = (1.0, 0.0);
        for i in 0..3 {
            let j = (i + 1) % 3;
            let (gap, logs) = (p.square[i] - p.square[j], p.log[i] - p.log[j]);
            let close = gap.abs() < 1e-4 * p.square[j];
            let quotient = p.square[i] * logs / if close { 1.0 } else { gap };
            // The mean of 1/b at both ends is above that between them.
            let g = if close { 0.5 + 0.5 * p.square[i] / p.square[j] } else { quotient };
            let same = (self.lambda + self.shear_modulus - p.kirchhoff[i]).abs();
            let other = (self.lambda + self.shear_modulus * g - p.kirchhoff[i]).abs();
            shear = larger(shear, larger(g, g - logs)); // g_ij − g_ji = ln b_i − ln b_j
            axial = larger(axial, larger(same, other));
        }
        self.shear_modulus * shear + axial // [STR-15]
    }

    /// Speed of the fastest wave [m/s] at the current density [kg/m^3], or a little more.
    #[inline(always)]
    fn wave_speed_of(&self, p: &Principal, j: f64, density: f64) -> f64 {
        (self.stiffness(p) / (j * density)).sqrt()
    }
}

#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

impl Model for Hencky {
    const NAME: &'static CStr = c"hencky";
    const SUMMARY: &'static CStr = c"Hencky elasticity: linear in the logarithmic strain";
    const REFERENCE: &'static CStr =
        c"Anand: J. Appl. Mech. 46 (1979) 78-82, doi:10.1115/1.3424532";
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
            let f = batch.deformation_gradient_rows(k);
            let p = self.principal(principal(left_cauchy_green(f)).0);
            let speed = self.wave_speed_of(&p, determinant(f), density[k]);
            batch.set_wave_speed(k, speed);
        }
    }
}

impl PointLaw<0> for Hencky {
    type Model = Self;

    #[inline(always)]
    fn update(&self, point: &Point<0>) -> Updated<0> {
        let f = point.gradient;
        let (square, v) = principal(left_cauchy_green(f));
        let p = self.principal(square);
        let j = determinant(f);
        let (inverse, t) = (1.0 / j, p.kirchhoff);
        let mut stress1 = [0.0; 6];
        for (c, (a, b)) in [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)].into_iter().enumerate()
        {
            let kirchhoff =
                t[0] * v[a][0] * v[b][0] + t[1] * v[a][1] * v[b][1] + t[2] * v[a][2] * v[b][2];
            stress1[c] = kirchhoff * inverse; // [STR-13]
        }
        let work = t[0] * p.log[0] + t[1] * p.log[1] + t[2] * p.log[2]; // 2 τ : ε
        let energy = 0.25 * work * inverse; // [STR-14]
        let wave_speed = self.wave_speed_of(&p, j, point.inputs[0]);
        let sane = is_finite([energy]) & (j > 0.0);
        Updated { energy, ..Updated::checked(stress1, [], wave_speed, sane) }
    }
}
