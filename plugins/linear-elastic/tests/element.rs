//! Element tests through the plugin table.
#![forbid(unsafe_code)]

use lahar_model_linear_elastic::{LinearElastic, LinearElasticGreenNaghdi};
use lahar_plugin::abi::{LAHAR_KINEMATICS_GREEN_NAGHDI, LAHAR_POINT_OK};
use lahar_plugin::{Driver, ModelTable};

const E: f64 = 2.0e6;
const NU: f64 = 0.25;

fn driver(n: usize) -> Driver {
    let model = ModelTable::of::<LinearElastic>().desc();
    Driver::new(model, &[("youngs_modulus", E), ("poissons_ratio", NU)], n).unwrap()
}

/// Strain increment of a point, different for each.
fn strain(k: usize) -> [f64; 6] {
    std::array::from_fn(|c| 1e-3 * ((3 * k + 7 * c) as f64).sin())
}

#[test]
fn stress_grows_by_hookes_law() {
    let mut d = driver(13);
    for k in 0..13 {
        d.set_strain_increment(k, strain(k));
        d.set_stress(k, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    }
    d.update(1e-3).unwrap();
    let (g, bulk) = (E / (2.0 * (1.0 + NU)), E / (3.0 * (1.0 - 2.0 * NU)));
    for k in 0..13 {
        let e = strain(k);
        let mean = (e[0] + e[1] + e[2]) / 3.0;
        for c in 0..6 {
            let normal = if c < 3 { 1.0 } else { 0.0 };
            let expected =
                (c + 1) as f64 + 3.0 * bulk * mean * normal + 2.0 * g * (e[c] - mean * normal);
            // Round-off of terms as large as E times the strain.
            assert!((d.stress1(k)[c] - expected).abs() < 1e-14 * E);
        }
        assert_eq!(d.status_of(k), LAHAR_POINT_OK);
    }
}

#[test]
fn uniaxial_stress_has_the_slope_of_youngs_modulus() {
    let mut d = driver(1);
    d.set_strain_increment(0, [1e-4, -NU * 1e-4, -NU * 1e-4, 0.0, 0.0, 0.0]);
    d.update(1.0).unwrap();
    assert!((d.stress1(0)[0] / 1e-4 / E - 1.0).abs() < 1e-12);
    assert!(d.stress1(0)[1].abs() < 1e-12 * E);
    // Negative control: without the lateral contraction the slope is the constrained modulus, 1.2 E.
    d.set_strain_increment(0, [1e-4, 0.0, 0.0, 0.0, 0.0, 0.0]);
    d.update(1.0).unwrap();
    assert!((d.stress1(0)[0] / 1e-4 / E - 1.2).abs() < 1e-12);
}

#[test]
fn wave_speed_is_that_of_the_constrained_modulus() {
    let mut d = driver(3);
    d.set_input(0, 1, 4000.0);
    d.wave_speed().unwrap();
    assert!((d.wave_speed_of(0) / (1.2 * E / 1000.0).sqrt() - 1.0).abs() < 1e-14);
    assert!((d.wave_speed_of(0) / d.wave_speed_of(1) - 2.0).abs() < 1e-14);
    d.update(1.0).unwrap();
    assert!((d.wave_speed_of(0) / d.wave_speed_of(1) - 2.0).abs() < 1e-14);
}

#[test]
fn a_point_that_is_not_a_number_fails_alone() {
    let mut d = driver(9);
    d.set_strain_increment(4, [0.0, f64::NAN, 0.0, 0.0, 0.0, 0.0]);
    d.set_stress(6, [0.0, 0.0, 0.0, 0.0, f64::INFINITY, 0.0]);
    d.set_input(0, 7, 0.0);
    d.set_input(0, 8, -1.0);
    d.update(1.0).unwrap();
    assert_eq!(d.failed_points().unwrap(), [4, 6, 7, 8]);
}

#[test]
fn values_that_give_no_moduli_are_refused() {
    let model = ModelTable::of::<LinearElastic>().desc();
    let error = Driver::new(model, &[("youngs_modulus", 1e308), ("poissons_ratio", 0.4999)], 1);
    assert!(error.err().unwrap().contains("not finite"));
}

#[test]
fn the_green_naghdi_variant_has_the_same_law_and_other_kinematics() {
    let model = ModelTable::of::<LinearElasticGreenNaghdi>().desc();
    assert_eq!(model.kinematics, LAHAR_KINEMATICS_GREEN_NAGHDI);
    let values = [("youngs_modulus", E), ("poissons_ratio", NU)];
    let (mut d, mut other) = (driver(13), Driver::new(model, &values, 13).unwrap());
    for d in [&mut d, &mut other] {
        for k in 0..13 {
            d.set_strain_increment(k, strain(k));
            d.set_stress(k, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        }
        d.update(1e-3).unwrap();
    }
    for k in 0..13 {
        assert_eq!(d.stress1(k), other.stress1(k));
        assert_eq!(d.wave_speed_of(k), other.wave_speed_of(k));
    }
}
