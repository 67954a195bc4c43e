//! Constants of isotropic elasticity.

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
