//! Element tests through the plugin table, against closed forms and against the energy.
#![forbid(unsafe_code)]

#[path = "../../neo-hookean/tests/hyperelastic/mod.rs"]
mod hyperelastic;

use hyperelastic::{acoustic, looseness_of_the_wave_speed};
use lahar_model_hencky::Hencky;
use lahar_plugin::abi::LAHAR_POINT_OK;
use lahar_plugin::nalgebra::{Matrix3, Rotation3, Vector3};
use lahar_plugin::tensor::to_matrix;
use lahar_plugin::{Driver, ModelTable};

const E: f64 = 1.0e6;
const NU: f64 = 0.3;
const MU: f64 = E / (2.0 * (1.0 + NU));
const LAMBDA: f64 = E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU));
const DENSITY: f64 = 1000.0; // of the driver [kg/m^3]

fn driver(n: usize) -> Driver {
    let model = ModelTable::of::<Hencky>().desc();
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
fn simple_shear_and_uniaxial_stretch_have_the_stresses_of_the_closed_form() {
    // The larger principal stretch of a simple shear is e^k, sinh k = γ/2; its axis leans by half of acot(γ/2).
    let known = [(0.2, 76414.3, 7641.4), (0.5, 184675.2, 46168.8), (1.0, 331083.8, 165541.9)];
    for (gamma, shear, normal) in known {
        let (s, _, _) = answer(&Matrix3::new(1.0, gamma, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0));
        let k = f64::asinh(0.5 * gamma);
        let xy = 2.0 * MU * k / k.cosh();
        let xx = xy * 0.5 * gamma;
        assert!((xy / shear - 1.0).abs() < 1e-6 && (xx / normal - 1.0).abs() < 1e-5);
        let expected = Matrix3::new(xx, xy, 0.0, xy, -xx, 0.0, 0.0, 0.0, 0.0);
        assert!((s - expected).abs().max() < 1e-14 * E, "{s}");
    }
    for stretch in [0.3, 0.5, 0.9, 1.0, 1.0 + 1e-9, 1.5, 3.0] {
        let (s, _, _) = answer(&Matrix3::from_diagonal(&Vector3::new(stretch, 1.0, 1.0)));
        let (axial, lateral) = (LAMBDA + 2.0 * MU, LAMBDA);
        let log = f64::ln(stretch) / stretch;
        let expected = log * Matrix3::from_diagonal(&Vector3::new(axial, lateral, lateral));
        assert!((s - expected).abs().max() < 1e-12 * E, "{stretch}: {s}");
    }
}

#[test]
fn principal_stretches_from_0_3_to_3_in_any_direction_are_exact_to_1e_12() {
    for n in 0..2000 {
        let x = |c: usize| ((13 * n + 7 * c + 1) as f64).sin();
        let mut log = 3f64.ln() * Vector3::new(x(0), x(1), x(2));
        match n % 5 {
            0 => log[1] = log[0],
            1 => log = Vector3::repeat(log[0]),
            2 => log = 3f64.ln() * Vector3::new(1.0, -1.0, 1.0),
            _ => {}
        }
        let turn = |c| Rotation3::new(3.0 * Vector3::new(x(c), x(c + 1), x(c + 2))).into_inner();
        let (q, p) = (turn(3), turn(6));
        let f = q * Matrix3::from_diagonal(&log.map(f64::exp)) * p;
        let j = log.sum().exp();
        let tau = log.map(|e| LAMBDA * log.sum() + 2.0 * MU * e);
        let expected = q * Matrix3::from_diagonal(&tau) * q.transpose() / j;
        let (s, energy, _) = answer(&f);
        assert!((s - expected).abs().max() < 1e-12 * expected.abs().max().max(E), "{f}");
        assert!((energy - 0.5 * tau.dot(&log) / j).abs() < 1e-12 * energy.abs().max(E), "{f}");
    }
}

#[test]
fn the_wave_speed_is_not_below_that_of_the_acoustic_tensor_nor_far_above() {
    let loosest = looseness_of_the_wave_speed();
    // the two terms of the bound are largest in different directions
    assert!(loosest < 1.25, "{loosest}");
    // where the bound is exact: equal stretches
    let f = 1.3 * Matrix3::identity();
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
    let model = ModelTable::of::<Hencky>().desc();
    let error = Driver::new(model, &[("youngs_modulus", 1e308), ("poissons_ratio", 0.4999)], 1);
    assert!(error.err().unwrap().contains("not finite"));
}
