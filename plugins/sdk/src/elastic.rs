//! Isotropic elasticity with constant moduli: parameters, formulas, and what its models share.

use crate::table::Parameter;
use crate::tensor::{contract, deviator, trace};

/// Young's modulus E [Pa] as a parameter; models change what is typical of theirs.
pub const YOUNGS_MODULUS: Parameter =
    Parameter::real(c"youngs_modulus", c"E", c"Pa", c"Young's modulus")
        .typical(1.0e7)
        .hard(f64::MIN_POSITIVE, f64::INFINITY);

/// Poisson's ratio ν [–] as a parameter.
pub const POISSONS_RATIO: Parameter =
    Parameter::real(c"poissons_ratio", c"nu", c"-", c"Poisson's ratio")
        .typical(0.3)
        .hard(-0.999, 0.4999)
        .advised(0.0, 0.495);

/// Lamé's constants λ and μ [Pa] of Young's modulus [Pa] and Poisson's ratio [–]; an error if they are not finite.
pub fn lame(youngs_modulus: f64, poissons_ratio: f64) -> Result<[f64; 2], String> {
    let (e, nu) = (youngs_modulus, poissons_ratio);
    let mu = e / (2.0 * (1.0 + nu));
    let lambda = e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
    if lambda.is_finite() && mu.is_finite() {
        return Ok([lambda, mu]);
    }
    Err(format!("Young's modulus {e} gives moduli that are not finite"))
}

/// The isotropic tangent dσ/dε [Pa] of Lamé's constants [Pa], as the extension `lahar.tangent` counts it: 2 μ on the shear diagonal.
#[inline(always)]
pub fn stiffness([lambda, mu]: [f64; 2]) -> [[f64; 6]; 6] {
    let mut c = [[0.0; 6]; 6];
    for i in 0..6 {
        c[i][i] = 2.0 * mu;
        for j in 0..3 {
            if i < 3 {
                c[i][j] += lambda;
            }
        }
    }
    c
}

/// Energy per volume [J/m^3] that isotropic elasticity with Lamé's constants [Pa] stores under a Cauchy stress [Pa].
#[inline(always)]
pub fn energy([lambda, mu]: [f64; 2], stress: [f64; 6]) -> f64 {
    let (mean, s) = (trace(stress) / 3.0, deviator(stress));
    0.5 * mean * mean / (lambda + 2.0 / 3.0 * mu) + 0.25 * contract(s, s) / mu
}

/// The stress [Pa] of isotropic elasticity with Lamé's constants [Pa] after a strain increment [-],
/// from a start stress [Pa].
#[inline(always)]
pub fn stress([lambda, mu]: [f64; 2], stress0: [f64; 6], strain: [f64; 6]) -> [f64; 6] {
    let volumetric = lambda * trace(strain);
    let two_mu = 2.0 * mu;
    [
        stress0[0] + volumetric + two_mu * strain[0], // [STR-9]
        stress0[1] + volumetric + two_mu * strain[1],
        stress0[2] + volumetric + two_mu * strain[2],
        stress0[3] + two_mu * strain[3],
        stress0[4] + two_mu * strain[4],
        stress0[5] + two_mu * strain[5],
    ]
}

/// A model that is elastic with constant moduli, until it yields if it does. In its `impl Model`,
/// [`elastic_model!`](crate::elastic_model) writes what follows from the moduli alone.
pub trait Elastic {
    /// Lamé's constants λ and μ [Pa].
    fn lame(&self) -> [f64; 2];

    /// Modulus of the fastest wave [Pa]: λ + 2 μ.
    #[inline(always)]
    fn wave_modulus(&self) -> f64 {
        let [lambda, mu] = self.lame();
        lambda + 2.0 * mu
    }

    /// Speed of the fastest wave [m/s] at a density [kg/m^3].
    #[inline(always)]
    fn wave_speed_of(&self, density: f64) -> f64 {
        (self.wave_modulus() / density).sqrt()
    }
}

/// Writes `wave_speed`, `stored_energy` and `HAS_STORED_ENERGY` in the `impl Model` of a type that
/// is [`Elastic`](crate::elastic::Elastic). The first of its inputs must be the density.
#[macro_export]
macro_rules! elastic_model {
    () => {
        const HAS_STORED_ENERGY: bool = true;

        #[inline(always)]
        fn wave_speed(&self, batch: &mut $crate::Batch<'_>) {
            const { assert!(matches!(Self::INPUTS, [$crate::Input::Density, ..])) };
            let density = batch.input(0);
            for k in 0..batch.n() {
                batch.set_wave_speed(k, $crate::elastic::Elastic::wave_speed_of(self, density[k]));
            }
        }

        fn stored_energy(&self, batch: &$crate::Batch<'_>, k: usize) -> f64 {
            $crate::elastic::energy($crate::elastic::Elastic::lame(self), batch.stress0(k))
        }
    };
}
