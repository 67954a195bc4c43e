//! Element tests through the plugin table, against the closed forms of critical state soil mechanics.
#![forbid(unsafe_code)]

mod support;

use support::*;

use lahar_plugin::abi::LAHAR_POINT_OK;
use lahar_plugin::tensor::trace;

const P0: f64 = 100.0e3;
const EXPONENT: f64 = 0.8; // Λ = 1 - κ/λ

/// The undrained path from normal consolidation at `p0`: p = p0 (M² / (M² + η²))^Λ.
fn undrained_pressure(p0: f64, eta: f64) -> f64 {
    p0 * (M * M / (M * M + eta * eta)).powf(EXPONENT)
}

#[test]
fn the_undrained_path_of_normally_consolidated_clay_is_that_of_the_closed_form() {
    // η, p, q [kPa]
    let table = [(0.3, 95.266, 28.580), (0.6, 83.651, 50.191), (0.9, 69.975, 62.978)];
    for (eta, p, q) in table {
        assert!((undrained_pressure(P0, eta) / 1e3 - p).abs() < 6e-4);
        assert!((eta * undrained_pressure(P0, eta) / 1e3 - q).abs() < 6e-4);
    }
    for step in [1e-5, 1e-4, 1e-3] {
        let mut d = consolidated(&[], P0, 1);
        let (mut worst, mut wrong) = (0.0_f64, 0.0_f64);
        for _ in 0..(0.4 / step) as usize {
            one_step(&mut d, [0.5 * step, 0.5 * step, -step, 0.0, 0.0, 0.0]);
            let (p, q) = invariants(d.stress0(0));
            worst = worst.max((p / undrained_pressure(P0, q / p) - 1.0).abs());
            let other = P0 * (M * M / (M * M + (q / p).powi(2))).powf(0.75);
            wrong = wrong.max((p / other - 1.0).abs());
        }
        // Yield and hardening hold exactly, whatever the step.
        assert!(worst < 1e-11, "step {step}: {worst:e}");
        // Negative control: another Λ is seen.
        assert!(wrong > 0.03);
        let (p, q) = invariants(d.stress0(0));
        assert!((p / 57.435e3 - 1.0).abs() < 1e-5 && (q / 68.922e3 - 1.0).abs() < 1e-5, "{p} {q}");
        assert!((0.5 * q / 34.461e3 - 1.0).abs() < 1e-5);
    }
}

#[test]
fn undrained_strength_grows_with_the_overconsolidation_ratio() {
    for ratio in [1.0, 2.0, 4.0, 8.0, 30.0_f64] {
        let mut d = consolidated(&[("overconsolidation_ratio", ratio)], P0, 1);
        for _ in 0..3000 {
            one_step(&mut d, [1e-4, 1e-4, -2e-4, 0.0, 0.0, 0.0]);
        }
        let (p, q) = invariants(d.stress0(0));
        let expected = P0 * (0.5 * ratio).powf(EXPONENT);
        assert!((p / expected - 1.0).abs() < 1e-6, "{ratio}: {p} {expected}");
        assert!((q / p / M - 1.0).abs() < 1e-6);
    }
}

#[test]
fn drained_triaxial_compression_ends_at_the_critical_state() {
    let mut d = consolidated(&[], P0, 1);
    let e0 = d.state0(0, 0);
    for _ in 0..2000 {
        confined_step(&mut d, -1e-3, P0);
    }
    let (p, q) = invariants(d.stress0(0));
    assert!((p / 166.667e3 - 1.0).abs() < 1e-5 && (q / 200.0e3 - 1.0).abs() < 1e-5, "{p} {q}");
    // The critical state line, on which p_c = 2 p: e = e0 - (λ - κ) ln(2 p / p0) - κ ln(p / p0).
    let expected = e0 - 0.16 * (2.0 * p / P0).ln() - 0.04 * (p / P0).ln();
    let distance = d.state0(0, 0) - expected;
    assert!(distance.abs() < 1e-5, "{distance:e}");
    let plastic = d.state0(0, 2);
    assert!(plastic > 1.5 && plastic < 2.0);
}

#[test]
fn isotropic_compression_and_swelling_follow_their_lines_in_any_number_of_steps() {
    for steps in [1, 7, 100] {
        let mut d = consolidated(&[], P0, 1);
        let e0 = d.state0(0, 0);
        // The strain that takes the void ratio down by λ ln 4.
        let fall = 0.2 * 4f64.ln();
        let strain = ((1.0 + e0 - fall) / (1.0 + e0)).ln() / 3.0 / steps as f64;
        for _ in 0..steps {
            one_step(&mut d, [strain, strain, strain, 0.0, 0.0, 0.0]);
        }
        assert!((d.state0(0, 0) - e0 + 0.277259).abs() < 1e-6);
        let (p, q) = invariants(d.stress0(0));
        assert!((p / 400.0e3 - 1.0).abs() < 1e-12 && q == 0.0, "{steps}: {p} {q}");
        assert!((d.state0(0, 1) / p - 1.0).abs() < 1e-12);
        let e1 = d.state0(0, 0);
        let rise = 0.04 * 4f64.ln();
        let strain = ((1.0 + e1 + rise) / (1.0 + e1)).ln() / 3.0 / steps as f64;
        for _ in 0..steps {
            one_step(&mut d, [strain, strain, strain, 0.0, 0.0, 0.0]);
        }
        assert!((d.state0(0, 0) - e1 - 0.055452).abs() < 1e-6);
        let (p, _) = invariants(d.stress0(0));
        assert!((p / 100.0e3 - 1.0).abs() < 1e-12);
        assert!((d.state0(0, 1) / 400.0e3 - 1.0).abs() < 1e-12);
        // Round-off of the deviator of the strain.
        assert!(d.state0(0, 2) < 1e-15);
    }
}

#[test]
fn one_dimensional_compression_has_the_slope_of_the_virgin_line() {
    let mut d = consolidated(&[], P0, 1);
    let mut last = (0.0, 0.0, 0.0);
    for n in 0..4000 {
        one_step(&mut d, [0.0, 0.0, -1e-4, 0.0, 0.0, 0.0]);
        let stress = d.stress0(0);
        let now = (d.state0(0, 0), -stress[2], stress[0] / stress[2]);
        if n > 3000 {
            let slope = (now.0 - last.0) / (now.1 / last.1).ln();
            assert!((slope / -0.2 - 1.0).abs() < 1e-5, "{n}: {slope}");
            assert!((now.2 - last.2).abs() < 1e-6, "the ratio of stresses is steady");
        }
        last = now;
    }
    // K0 of the model lies between those of elasticity and of the isotropic state.
    assert!(last.2 > 0.43 && last.2 < 1.0, "{}", last.2);
    let (p, q) = invariants(d.stress0(0));
    // Flow rule and elasticity at constant η, all strain vertical: dε_q = 2/3 dε_v, with G/K of Poisson's ratio.
    let eta = q / p;
    let shear_ratio = 1.5 * (1.0 - 2.0 * 0.3) / 1.3;
    let v = 1.0;
    let (elastic, plastic) = (0.04 / v, (0.2 - 0.04) / v);
    let deviatoric =
        elastic * eta / (3.0 * shear_ratio) + plastic * 2.0 * eta / (M * M - eta * eta);
    assert!((deviatoric / (elastic + plastic) - 2.0 / 3.0).abs() < 1e-3, "{deviatoric}");
}

#[test]
fn the_error_of_drained_shear_falls_with_the_step() {
    let end = |steps: usize| {
        let mut d = consolidated(&[], P0, 1);
        for _ in 0..steps {
            confined_step(&mut d, -0.1 / steps as f64, P0);
        }
        invariants(d.stress0(0)).1
    };
    let exact = end(2000);
    let errors = [10, 20, 40].map(|n| (end(n) / exact - 1.0).abs());
    assert!(errors[0] < 0.05, "{errors:?}");
    assert!(errors[1] < 0.6 * errors[0] && errors[2] < 0.6 * errors[1], "{errors:?}");
}

#[test]
fn elastic_steps_are_exact_and_return_to_where_they_began() {
    let mut d = consolidated(&[("overconsolidation_ratio", 10.0)], P0, 1);
    let strain = [-1e-3, 5e-4, -2e-3, 1e-3, 0.0, 2e-4];
    let start = d.stress0(0);
    one_step(&mut d, strain);
    let once = d.stress0(0);
    let v0 = 1.0 + consolidated(&[("overconsolidation_ratio", 10.0)], P0, 1).state0(0, 0);
    let v1 = v0 * trace(strain).exp();
    let (p, _) = invariants(once);
    assert!((p / (P0 * ((v0 - v1) / 0.04).exp()) - 1.0).abs() < 1e-13);
    one_step(&mut d, strain.map(|e| -e));
    let back = d.stress0(0);
    assert!((0..6).all(|c| (back[c] - start[c]).abs() < 1e-10 * P0), "{back:?}");
    // Ten parts of the strain give the stress of the whole.
    for _ in 0..10 {
        one_step(&mut d, strain.map(|e| 0.1 * e));
    }
    let parts = d.stress0(0);
    assert!((0..6).all(|c| (parts[c] - once[c]).abs() < 1e-9 * P0), "{parts:?} {once:?}");
    assert_eq!(d.state0(0, 2), 0.0);
}

#[test]
fn the_start_stress_decides_void_ratio_and_preconsolidation() {
    let mut d = driver(&[("overconsolidation_ratio", 2.0)], 3);
    d.set_stress(0, [-50.0e3, -50.0e3, -125.0e3, 0.0, 0.0, 0.0]);
    d.set_stress(2, [10.0e3, 10.0e3, 10.0e3, 0.0, 0.0, 0.0]);
    d.init_state().unwrap();
    let (p, q) = (75.0e3, 75.0e3);
    let through = p + q * q / (M * M * p);
    assert!((d.state0(0, 1) / (2.0 * through) - 1.0).abs() < 1e-14);
    let e = 2.0 - 0.2 * (2.0 * through / 1e3).ln() + 0.04 * (2.0 * through / p).ln();
    assert!((d.state0(0, 0) - e).abs() < 1e-14);
    // Without compression the point stands at the loose end of the normal compression line.
    for k in [1, 2] {
        assert_eq!(d.state0(k, 1), 1.0e3);
        assert!((d.state0(k, 0) - (2.0 + 0.04)).abs() < 1e-14);
    }
    let mut d = driver(&[], 2);
    d.set_stress(1, [-1e9, -1e9, -1e9, 0.0, 0.0, 0.0]);
    let error = d.init_state().unwrap_err();
    assert!(error.contains("point 1") && error.contains("reference_void_ratio"), "{error}");
}

#[test]
fn values_that_do_not_go_together_are_refused() {
    let refused = |named: &[(&str, f64)]| try_driver(named, 1).err().unwrap();
    assert!(refused(&[("swelling_index", 0.2)]).contains("less than compression_index"));
    let error = refused(&[("minimum_pressure", 1.0e9)]);
    assert!(error.contains("smaller minimum_pressure"), "{error}");
}

#[test]
fn a_void_ratio_below_zero_is_reported_and_stays_finite() {
    let mut d = consolidated(&[], P0, 1);
    for _ in 0..1000 {
        one_step(&mut d, [0.0, 0.0, -2e-3, 0.0, 0.0, 0.0]);
    }
    assert!(d.state0(0, 0) < 0.0);
    d.set_strain_increment(0, [0.0, 0.0, -1e-4, 0.0, 0.0, 0.0]);
    d.update(1.0).unwrap();
    assert_ne!(d.status_of(0), LAHAR_POINT_OK);
    assert!(d.stress1(0).iter().all(|s| s.is_finite()));
}
