//! Softening of friction, cohesion and dilation in element tests, and values at the ends of what the model accepts.
#![forbid(unsafe_code)]

mod support;

use lahar_model_mohr_coulomb::MohrCoulomb;
use lahar_plugin::abi::{LAHAR_POINT_FAILED, LAHAR_POINT_OK, LAHAR_POINT_UNRELIABLE};
use lahar_plugin::tensor::trace;
use lahar_plugin::testing::Random;
use lahar_plugin::{Driver, ModelTable};
use support::driver;

const CONFINEMENT: f64 = 100.0e3;

fn softening(kind: f64, strain: f64) -> Driver {
    let mut d = driver(
        &[
            ("softening", kind),
            ("softening_strain", strain),
            ("dilation_angle", 12.0),
            ("residual_friction_angle", 24.0),
            ("residual_cohesion", 2.0e3),
            ("residual_dilation_angle", 3.0),
        ],
        1,
    );
    d.set_stress(0, [-CONFINEMENT, -CONFINEMENT, -CONFINEMENT, 0.0, 0.0, 0.0]);
    d
}

/// Axial stress of triaxial compression at this strength, compression positive.
fn strength(friction: f64, cohesion: f64) -> f64 {
    let (sin, cos) = friction.to_radians().sin_cos();
    (CONFINEMENT * (1.0 + sin) + 2.0 * cohesion * cos) / (1.0 - sin)
}

/// What is left of the fall.
fn left(kind: f64, x: f64) -> f64 {
    if kind == 1.0 { (-x).exp() } else { (1.0 - x).max(0.0) }
}

#[test]
fn a_triaxial_test_follows_the_falling_strength_to_the_residual_one() {
    for kind in [1.0, 2.0] {
        let mut d = softening(kind, 0.05);
        let (mut largest, mut last) = (0.0_f64, [0.0; 6]);
        for n in 0..800 {
            last = d.triaxial_step(0, -2e-3, -CONFINEMENT, 1.0).unwrap();
            assert_eq!(d.status_of(0), LAHAR_POINT_OK);
            let (axial, kappa) = (-d.stress0(0)[2], d.state0(0, 0));
            if kappa > 0.0 {
                let left = left(kind, kappa / 0.05);
                let expected = strength(24.0 + 6.0 * left, 2e3 + 8e3 * left);
                assert!((axial / expected - 1.0).abs() < 1e-8, "{kind} {n}: {axial} {expected}");
            }
            largest = largest.max(axial);
        }
        // One step of softening below the peak strength at most; then the residual one, with the residual dilation.
        assert!(largest > 0.97 * strength(30.0, 10e3) && largest < strength(30.0, 10e3));
        let residual = -d.stress0(0)[2];
        assert!((residual / strength(24.0, 2e3) - 1.0).abs() < 1e-8, "{residual}");
        let sin = 3.0_f64.to_radians().sin();
        assert!((trace(last) / last[2] + 2.0 * sin / (1.0 - sin)).abs() < 1e-6);
    }
}

#[test]
fn the_strain_at_a_given_strength_converges_with_the_step() {
    // The implicit rule is of first order: half the step, half the error of the plastic strain.
    let kappa = |steps: i32| {
        let mut d = softening(1.0, 0.05);
        for _ in 0..steps {
            d.triaxial_step(0, -0.06 / f64::from(steps), -CONFINEMENT, 1.0).unwrap();
        }
        d.state0(0, 0)
    };
    let exact = kappa(3200);
    let errors = [50, 100, 200].map(|steps| (kappa(steps) - exact).abs());
    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((1.7..2.6).contains(&ratio), "{errors:?}");
    }
}

#[test]
fn strength_that_falls_faster_than_stress_can_makes_the_point_unreliable() {
    let status = |strain: f64| {
        let mut d = softening(1.0, strain);
        d.set_strain_increment(0, [0.01, 0.01, -0.03, 0.0, 0.0, 0.0]);
        d.update(1.0).unwrap();
        d.status_of(0)
    };
    assert_eq!(status(0.05), LAHAR_POINT_OK);
    assert_eq!(status(1e-5), LAHAR_POINT_UNRELIABLE);
}

#[test]
fn extreme_values_give_finite_stresses_or_a_failed_point() {
    let mut random = Random::new(23);
    let table = ModelTable::of::<MohrCoulomb>().desc();
    let (mut ran, mut failed) = (0, 0);
    for _ in 0..400 {
        let power =
            |random: &mut Random, low: f64, high: f64| 10f64.powf(random.between(low, high));
        let friction = [0.0, 1e-9, 45.0, 89.0][random.between(0.0, 3.999) as usize];
        let cohesion = power(&mut random, -3.0, 12.0);
        let named = [
            ("youngs_modulus", power(&mut random, -3.0, 15.0)),
            ("poissons_ratio", [-0.999, 0.0, 0.3, 0.4999][random.between(0.0, 3.999) as usize]),
            ("friction_angle", friction),
            ("cohesion", cohesion),
            ("dilation_angle", random.between(0.0, 1.0) * friction),
            ("tension_cutoff", (cohesion / friction.to_radians().tan()).min(1e30)),
            ("softening", random.between(0.0, 2.999).floor()),
            ("softening_strain", power(&mut random, -9.0, 2.0)),
            ("residual_friction_angle", friction),
        ];
        let mut d = Driver::new(table, &named, 8).unwrap();
        for _ in 0..10 {
            let size = power(&mut random, -9.0, 4.0);
            for k in 0..8 {
                d.set_strain_increment(k, random.symmetric(size));
            }
            d.update(1.0).unwrap();
            for k in 0..8 {
                ran += 1;
                failed += i32::from(d.status_of(k) == LAHAR_POINT_FAILED);
            }
            assert_eq!(d.silent_point(), None, "{named:?}");
            d.commit();
        }
    }
    assert!(failed * 100 < ran, "{failed} of {ran}");
}
