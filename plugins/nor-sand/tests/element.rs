//! Element tests through the plugin table: the critical state, dilatancy and its limit, loose and dense sand.
#![forbid(unsafe_code)]

mod support;

use support::*;

use lahar_plugin::Driver;
use lahar_plugin::tensor::trace;

const P0: f64 = 100.0e3;

/// Constant volume; the highest and the last q, and the least pressure on the way.
fn undrained(d: &mut Driver, axial: f64, steps: usize) -> (f64, f64, f64) {
    let (mut peak, mut least) = (0.0_f64, f64::INFINITY);
    for _ in 0..steps {
        one_step(d, [-0.5 * axial, -0.5 * axial, axial, 0.0, 0.0, 0.0]);
        let (p, q) = invariants(d.stress0(0));
        (peak, least) = (peak.max(q), least.min(p));
    }
    (peak, invariants(d.stress0(0)).1, least)
}

#[test]
fn undrained_triaxial_tests_end_at_the_critical_state() {
    for (axial, ratio) in [(-1e-3, M), (1e-3, 3.0 * M / (3.0 + M))] {
        for psi in [-0.08, -0.02, 0.0, 0.02] {
            let mut d = consolidated(&[], P0, psi, 1);
            let e0 = d.state0(0, 0);
            undrained(&mut d, axial, 5000);
            let (p, q) = invariants(d.stress0(0));
            assert!((d.state0(0, 0) - e0).abs() < 1e-12, "the volume is kept");
            // p at which e_c(p) = e0.
            let expected = 1e3 * ((GAMMA - e0) / LAMBDA).exp();
            assert!((p / expected - 1.0).abs() < 1e-3, "{psi}: {p} {expected}");
            assert!((q / p / ratio - 1.0).abs() < 1e-3, "{psi}: {q} {p}");
            assert!((p / d.state0(0, 1) - 1.0).abs() < 1e-3);
        }
    }
}

#[test]
fn drained_triaxial_tests_end_at_the_critical_state() {
    // The pressure at the end follows from σ_3 = p0 and q = M p.
    for (axial, ratio, p_end) in
        [(-1e-3, M, P0 / (1.0 - M / 3.0)), (1e-3, 3.0 * M / (3.0 + M), P0 / (1.0 + M / (3.0 + M)))]
    {
        for psi in [-0.2, -0.05, 0.05] {
            let mut d = consolidated(&[], P0, psi, 1);
            for _ in 0..5000 {
                confined_step(&mut d, axial, P0);
            }
            let (p, q) = invariants(d.stress0(0));
            assert!((q / p / ratio - 1.0).abs() < 2e-3, "{psi}: {q} {p}");
            let distance = d.state0(0, 0) - critical_void_ratio(p_end);
            assert!(distance.abs() < 1e-3, "{psi}: {distance}");
        }
    }
}

#[test]
fn loose_sand_softens_without_drainage_and_dense_sand_hardens() {
    let (peak, last, _) = undrained(&mut consolidated(&[], P0, 0.06, 1), -1e-4, 3000);
    assert!(last < 0.4 * peak, "{last} {peak}");
    let (peak, last, least) = undrained(&mut consolidated(&[], P0, -0.1, 1), -1e-4, 3000);
    assert!(last == peak && last > 2.0 * P0 && least > 0.4 * P0, "{last} {peak} {least}");
}

#[test]
fn loose_sand_contracts_and_dense_sand_dilates_after_a_peak() {
    let test = |psi: f64| {
        let mut d = consolidated(&[], P0, psi, 1);
        let e0 = d.state0(0, 0);
        let (mut peak, mut ratio) = (0.0_f64, 0.0);
        for _ in 0..1000 {
            confined_step(&mut d, -2e-4, P0);
            let (p, q) = invariants(d.stress0(0));
            ratio = q / p;
            peak = peak.max(ratio);
        }
        (d.state0(0, 0) - e0, peak, ratio)
    };
    let (volume, peak, last) = test(-0.15);
    assert!(volume > 0.05 && peak > 1.2 * M && last < 0.95 * peak, "{volume} {peak} {last}");
    let (volume, peak, last) = test(0.05);
    assert!(volume < -0.02 && peak <= M && last == peak, "{volume} {peak} {last}");
}

/// Plastic volumetric over deviatoric strain of a confined step, compression positive.
fn plastic_dilatancy(d: &mut Driver, axial: f64) -> f64 {
    let before = d.stress0(0);
    let plastic = d.state0(0, 2);
    let strain = confined_step(d, axial, P0);
    let (p0, _) = invariants(before);
    let (p1, _) = invariants(d.stress0(0));
    // The elastic part of the compression: moduli grow with the root of the pressure.
    let bulk = 3.0e7 / (1.5 * (1.0 - 0.4) / 1.2);
    let elastic = 2.0 * (P0 / bulk) * ((p1 / P0).sqrt() - (p0 / P0).sqrt());
    (-trace(strain) - elastic) / (d.state0(0, 2) - plastic)
}

#[test]
fn dilatancy_is_the_distance_of_the_stress_ratio_from_the_image_ratio() {
    let mut d = consolidated(&[], P0, -0.15, 1);
    let mut range = (f64::INFINITY, f64::NEG_INFINITY);
    for _ in 0..600 {
        let dilatancy = plastic_dilatancy(&mut d, -1e-4);
        let (p, q) = invariants(d.stress0(0));
        let mi = image_ratio(d.stress0(0), d.state0(0, 0), d.state0(0, 1));
        assert!((dilatancy - (mi - q / p)).abs() < 1e-6, "{dilatancy} {}", mi - q / p);
        range = (range.0.min(dilatancy), range.1.max(dilatancy));
    }
    // Both contraction and dilation have been passed.
    assert!(range.0 < -0.3 && range.1 > 0.5, "{range:?}");
}

#[test]
fn the_least_dilatancy_is_chi_times_the_state_parameter() {
    for psi in [-0.2, -0.1, -0.05] {
        let largest = |hardening: f64, step: f64, steps: usize| {
            let mut d = consolidated(&[("hardening_modulus", hardening)], P0, psi, 1);
            let (mut least, mut at) = (f64::INFINITY, 0.0);
            for _ in 0..steps {
                let dilatancy = plastic_dilatancy(&mut d, step);
                if dilatancy < least {
                    (least, at) = (dilatancy, state_parameter(&d));
                }
            }
            (least, CHI * at)
        };
        let (least, limit) = largest(4e3, -5e-6, 10_000);
        assert!((least / limit - 1.0).abs() < 1e-3, "{psi}: {least} {limit}");
        // Negative control: slow hardening does not.
        let (least, limit) = largest(30.0, -2e-4, 1000);
        assert!(least > 0.99 * limit, "{psi}: {least} {limit}");
    }
}

#[test]
fn isotropic_compression_yields_at_the_tip_and_hardens() {
    let mut d = consolidated(&[("overconsolidation_ratio", 2.0)], P0, 0.0, 1);
    assert!((d.state0(0, 1) / (2.0 * P0 / 1f64.exp()) - 1.0).abs() < 1e-12);
    let compress = |d: &mut Driver, e: f64| one_step(d, [-e, -e, -e, 0.0, 0.0, 0.0]);
    while d.state0(0, 1) < 2.0001 * P0 / 1f64.exp() {
        compress(&mut d, 1e-5);
    }
    let (p, _) = invariants(d.stress0(0));
    assert!((p / (2.0 * P0) - 1.0).abs() < 0.01, "{p}");
    for _ in 0..100 {
        compress(&mut d, 1e-5);
        let (p, q) = invariants(d.stress0(0));
        assert!((p / (1f64.exp() * d.state0(0, 1)) - 1.0).abs() < 1e-9 && q < 1e-9 * p);
    }
    // Elastic unloading keeps the image pressure.
    let image = d.state0(0, 1);
    compress(&mut d, -1e-4);
    assert_eq!(d.state0(0, 1), image);
}

#[test]
fn elasticity_is_exact_in_steps_of_any_size() {
    for exponent in [0.0, 0.5, 0.8, 1.0] {
        let named = [("elastic_exponent", exponent), ("overconsolidation_ratio", 50.0)];
        let strain = [-2e-4, 1e-4, -3e-4, 1e-4, 0.0, 5e-5];
        let end = |parts: usize| {
            let mut d = consolidated(&named, P0, -0.1, 1);
            for _ in 0..parts {
                one_step(&mut d, strain.map(|e| e / parts as f64));
            }
            assert_eq!(d.state0(0, 2), 0.0, "elastic");
            d.stress0(0)
        };
        let (once, often) = (end(1), end(100));
        assert!((0..6).all(|c| (once[c] - often[c]).abs() < 1e-9 * P0), "{once:?} {often:?}");
        let bulk = 3.0e7 / 0.75;
        let z = bulk / P0 * 4e-4;
        let n = 1.0 - exponent;
        let ratio = if n == 0.0 { z.exp() } else { (1.0 + n * z).powf(1.0 / n) };
        assert!((invariants(once).0 / (P0 * ratio) - 1.0).abs() < 1e-12);
    }
}

#[test]
fn the_error_of_a_drained_test_falls_with_the_step() {
    let end = |steps: usize| {
        let mut d = consolidated(&[], P0, -0.1, 1);
        for _ in 0..steps {
            confined_step(&mut d, -0.02 / steps as f64, P0);
        }
        invariants(d.stress0(0)).1
    };
    let exact = end(4000);
    let errors = [50, 100, 200].map(|n| (end(n) / exact - 1.0).abs());
    assert!(errors[0] < 0.02, "{errors:?}");
    assert!(errors[1] < 0.65 * errors[0] && errors[2] < 0.65 * errors[1], "{errors:?}");
}

#[test]
fn the_start_stress_decides_void_ratio_and_image_pressure() {
    let mut d = driver(&[("initial_state_parameter", -0.1)], 2);
    let stress = [-60.0e3, -60.0e3, -180.0e3, 0.0, 0.0, 0.0];
    d.set_stress(0, stress);
    d.init_state().unwrap();
    assert!((d.state0(0, 0) - (critical_void_ratio(100.0e3) - 0.1)).abs() < 1e-14);
    assert!(yield_residual(stress, d.state0(0, 0), d.state0(0, 1)).abs() < 1e-12);
    // Without stress the density is that of the minimum pressure, and so is isotropic yield.
    assert!((d.state0(1, 0) - (GAMMA - 0.1)).abs() < 1e-14);
    assert!((d.state0(1, 1) / (1e3 / 1f64.exp()) - 1.0).abs() < 1e-12);
    let mut d = driver(&[("initial_density", 1.0), ("initial_void_ratio", 0.61)], 1);
    d.init_state().unwrap();
    assert_eq!(d.state0(0, 0), 0.61);
    let mut d = driver(&[("initial_state_parameter", -0.9)], 1);
    let error = d.init_state().unwrap_err();
    assert!(error.contains("point 0") && error.contains("critical_void_ratio"), "{error}");
}

#[test]
fn values_that_give_no_moduli_are_refused() {
    let error = try_driver(&[("shear_modulus", 1e308), ("poissons_ratio", 0.49)], 1);
    assert!(error.err().unwrap().contains("positive and finite"));
}
