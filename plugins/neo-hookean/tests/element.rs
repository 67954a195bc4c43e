//! Element tests through the plugin table, against closed forms and against the energy.
#![forbid(unsafe_code)]

mod hyperelastic;

use hyperelastic::{acoustic, looseness_of_the_wave_speed};
use lahar_model_neo_hookean::NeoHookean;
use lahar_plugin::abi::LAHAR_POINT_OK;
use lahar_plugin::nalgebra::{Matrix3, Vector3};
use lahar_plugin::tensor::to_matrix;
use lahar_plugin::{Driver, ModelTable};

const E: f64 = 1.0e6;
const NU: f64 = 0.3;
const MU: f64 = E / (2.0 * (1.0 + NU));
const LAMBDA: f64 = E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU));
const DENSITY: f64 = 1000.0; // of the driver [kg/m^3]

fn driver(n: usize) -> Driver {
    let model = ModelTable::of::<NeoHookean>().desc();
    Driver::new(model, &[("youngs_modulus", E), ("poissons_ratio", NU)], n).unwrap()
}

/// Stress, energy per current volume and wave speed at a deformation gradient.
fn answer(f: &Matrix3<f64>) -> (Matrix3<f64>, f64, f64) {
    let mut d = driver(1);
    d.set_gradient(0, std::array::from_fn(|c| f[(c / 3, c % 3)]));
    d.update(1.0).unwrap();
    assert_eq!(d.status_of(0), LAHAR_POINT_OK);
    let (stress, energy, given) = (to_matrix(d.stress1(0)), d.energy_of(0), d.wave_speed_of(0));
    d.wave_speed().unwrap();
    assert_eq!(d.wave_speed_of(0), given, "both ways to ask for the wave speed agree");
    (stress, energy, given)
}

/// Deformation gradients with stretches from about 0.4 to 2.5, turned.
fn samples() -> Vec<Matrix3<f64>> {
    let x = |n: usize, c: usize| ((17 * n + 5 * c + 1) as f64).sin();
    let one = |n| Matrix3::identity() + 0.7 * Matrix3::from_fn(|a, b| x(n, 3 * a + b));
    (0..400).map(one).filter(|f| f.determinant() > 0.1).collect()
}

#[test]
fn simple_shear_and_confined_compression_have_the_stresses_of_the_closed_form() {
    for gamma in [0.2, 0.5, 1.0, 3.0] {
        let (s, _, _) = answer(&Matrix3::new(1.0, gamma, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0));
        let expected = MU * Matrix3::new(gamma * gamma, gamma, 0.0, gamma, 0.0, 0.0, 0.0, 0.0, 0.0);
        assert!((s - expected).abs().max() < 1e-14 * E * (1.0 + gamma * gamma));
    }
    let known = [(0.5, -1376708.0), (0.8, -333997.8), (1.2, 228680.2), (1.5, 476460.9)];
    for (stretch, value) in known {
        let (s, _, _) = answer(&Matrix3::from_diagonal(&Vector3::new(stretch, 1.0, 1.0)));
        let axial = (MU * (stretch * stretch - 1.0) + LAMBDA * f64::ln(stretch)) / stretch;
        assert!((axial / value - 1.0).abs() < 1e-6, "the formula of the test");
        assert!((s[(0, 0)] - axial).abs() < 1e-14 * E);
        assert!((s[(1, 1)] - LAMBDA * f64::ln(stretch) / stretch).abs() < 1e-14 * E);
    }
}

#[test]
fn the_wave_speed_is_not_below_that_of_the_acoustic_tensor_nor_far_above() {
    let loosest = looseness_of_the_wave_speed();
    // the bound of the largest principal value is at most 4/3 of it
    assert!(loosest < 1.16, "{loosest}");
    // where the bound is exact: uniaxial stretch, along the axis
    let f = Matrix3::from_diagonal(&Vector3::new(1.6, 1.0, 1.0));
    let q = acoustic(&f, &Vector3::x()).symmetric_eigen().eigenvalues.max();
    assert!((answer(&f).2 / (q / DENSITY).sqrt() - 1.0).abs() < 1e-8);
}

#[test]
fn a_rotation_turns_the_stress_and_changes_neither_energy_nor_speed() {
    for (f, g) in samples().iter().zip(samples().iter().skip(1)) {
        let svd = g.svd(true, true);
        let r = svd.u.unwrap() * svd.v_t.unwrap();
        let ((s, w, c), (s1, w1, c1)) = (answer(f), answer(&(r * f)));
        assert!((s1 - r * s * r.transpose()).abs().max() < 1e-13 * s.abs().max().max(E));
        assert!((w1 - w).abs() < 1e-13 * E.max(w) && (c1 / c - 1.0).abs() < 1e-13);
    }
}

#[test]
fn a_point_that_is_inside_out_or_not_a_number_fails_alone() {
    let mut d = driver(9);
    for k in 0..9 {
        d.set_gradient(k, [1.1, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
    }
    d.set_gradient(2, [-1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
    d.set_gradient(3, [0.0; 9]);
    d.set_gradient(5, [1.0, f64::NAN, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
    d.set_input(0, 7, -1.0);
    d.update(1.0).unwrap();
    assert_eq!(d.failed_points().unwrap(), [2, 3, 5, 7]);
}

#[test]
fn values_that_give_no_moduli_are_refused() {
    let model = ModelTable::of::<NeoHookean>().desc();
    let error = Driver::new(model, &[("youngs_modulus", 1e308), ("poissons_ratio", 0.4999)], 1);
    assert!(error.err().unwrap().contains("not finite"));
}
