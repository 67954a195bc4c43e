//! What every hyperelastic model must obey; the tests of hencky include this file too. `answer` gives the stress, the energy per volume and
//! the wave speed for a deformation gradient, `samples` gives some.

use super::{DENSITY, E, LAMBDA, MU, answer, samples};
use lahar_plugin::nalgebra::{Matrix3, Vector3};

#[test]
fn small_strains_give_hookes_law() {
    let h = 1e-6;
    let strain = Matrix3::new(1.0, 0.5, -0.3, 0.5, -2.0, 0.7, -0.3, 0.7, 0.4);
    let (s, energy, speed) = answer(&(Matrix3::identity() + h * strain));
    let hooke = LAMBDA * strain.trace() * Matrix3::identity() + 2.0 * MU * strain;
    // what follows is of second order in h; the energy also has the round-off of tr b - 3
    assert!((s / h - hooke).abs().max() < 1e-5 * E);
    assert!((energy / (h * h) - 0.5 * hooke.dot(&strain)).abs() < 1e-3 * E);
    assert!((speed / ((LAMBDA + 2.0 * MU) / DENSITY).sqrt() - 1.0).abs() < 1e-5);
}

#[test]
fn the_stress_is_the_derivative_of_the_energy() {
    let h = 1e-5;
    for f in samples() {
        let (s, _, _) = answer(&f);
        let w = |f: &Matrix3<f64>| answer(f).1 * f.determinant();
        let piola = Matrix3::from_fn(|a, b| {
            let mut dir = Matrix3::zeros();
            dir[(a, b)] = h;
            (w(&(f + dir)) - w(&(f - dir))) / (2.0 * h)
        });
        let cauchy = piola * f.transpose() / f.determinant();
        // central differences: error of order h^2 and round-off of order 1e-16 / h
        assert!((cauchy - s).abs().max() < 1e-6 * s.abs().max().max(E), "{f}");
        assert!((cauchy - 1.01 * s).abs().max() > 1e-6 * E, "the test sees 1 %");
    }
}

/// The acoustic tensor ρ c² of waves of direction n on top of the deformation f, from differences of the traction:
/// det(G) σ(G F) G⁻ᵀ n with G = I + a n.
pub fn acoustic(f: &Matrix3<f64>, n: &Vector3<f64>) -> Matrix3<f64> {
    let h = 1e-5;
    let traction = |a: Vector3<f64>| {
        let g = Matrix3::identity() + a * n.transpose();
        g.determinant() * answer(&(g * f)).0 * g.try_inverse().unwrap().transpose() * n
    };
    let column = |a: usize| {
        let a = h * Vector3::ith(a, 1.0);
        (traction(a) - traction(-a)) / (2.0 * h)
    };
    Matrix3::from_columns(&[column(0), column(1), column(2)])
}

/// Checks that no wave is faster than the model says, and gives the largest ratio of what it says to the fastest wave.
pub fn looseness_of_the_wave_speed() -> f64 {
    let mut loosest = 1.0_f64;
    for (k, f) in samples().iter().enumerate() {
        let speed = answer(f).2;
        let axes = (f * f.transpose()).symmetric_eigen().eigenvectors;
        let mut fastest = 0.0_f64;
        for m in 0..40 {
            let x = |c: usize| ((29 * k + 11 * m + 7 * c) as f64).sin();
            let any = Vector3::new(x(0), x(1), x(2)).normalize();
            let n = if m < 3 { axes.column(m).into_owned() } else { any };
            let q = acoustic(f, &n).symmetric_eigen().eigenvalues.max();
            fastest = fastest.max((q / DENSITY).sqrt());
        }
        assert!(speed >= fastest * (1.0 - 1e-6), "{speed} is below {fastest} at {f}");
        loosest = loosest.max(speed / fastest);
    }
    loosest
}
