//! Element tests through the plugin table: strengths on both meridians and in plane strain, dilation, tension, bad input.
#![forbid(unsafe_code)]

mod support;

use lahar_model_matsuoka_nakai::MatsuokaNakai;
use lahar_plugin::abi::{LAHAR_POINT_FAILED, LAHAR_POINT_OK};
use lahar_plugin::tensor::{contract, deviator, trace};
use lahar_plugin::testing::{Random, principal_axes};
use lahar_plugin::{Driver, ModelTable};
use support::{BULK, E, NU, driver, try_driver};

const CONFINEMENT: f64 = 100.0e3;

/// The in-plane principal stresses at the end of a biaxial test without cohesion, largest over smallest.
fn biaxial(phi: f64, psi: f64) -> f64 {
    let named = [("friction_angle", phi), ("dilation_angle", psi), ("cohesion", 0.0)];
    let mut d = driver(&named, 1).confined(CONFINEMENT);
    for _ in 0..400 {
        d.biaxial_step(0, -2e-3, -CONFINEMENT, 1.0).unwrap();
    }
    let s = d.stress0(0);
    let invariant = trace(s) * (1.0 / s[0] + 1.0 / s[1] + 1.0 / s[2]);
    let expected = 9.0 + 8.0 * phi.to_radians().tan().powi(2);
    assert!((invariant / expected - 1.0).abs() < 1e-9, "{invariant} {expected}");
    s[1] / s[0]
}

#[test]
fn triaxial_strengths_are_those_of_mohr_coulomb() {
    let mut d = driver(&[], 1).confined(CONFINEMENT);
    let (axial, _) = d.triaxial_test(0, -1e-3, CONFINEMENT, 40).unwrap();
    assert!((axial - 334_641.016_151_377_5).abs() < 1e-8 * CONFINEMENT, "{axial}");
    let mut d = driver(&[], 1).confined(CONFINEMENT);
    let (axial, _) = d.triaxial_test(0, 1e-3, CONFINEMENT, 40).unwrap();
    assert!((axial - 21_786.327_949_540_8).abs() < 1e-8 * CONFINEMENT, "{axial}");
}

#[test]
fn both_meridians_are_met_for_random_parameters() {
    let mut random = Random::new(7);
    for n in 0..60 {
        let young = 10f64.powf(random.between(6.0, 9.0));
        let phi: f64 = random.between(2.0, 50.0);
        let (sin, cos) = phi.to_radians().sin_cos();
        let (cohesion, confinement) = (random.between(0.0, 20e3), random.between(10e3, 500e3));
        let named = [
            ("youngs_modulus", young),
            ("poissons_ratio", random.between(0.0, 0.45)),
            ("friction_angle", phi),
            ("cohesion", cohesion),
            ("dilation_angle", random.between(0.0, 1.0) * phi),
            ("tension_cutoff", cohesion * cos / sin),
        ];
        let slope = (1.0 + sin) / (1.0 - sin);
        let root = 2.0 * cohesion * slope.sqrt();
        for (sign, expected) in
            [(-1.0, slope * confinement + root), (1.0, (confinement - root) / slope)]
        {
            let mut d = driver(&named, 1).confined(confinement);
            let yield_strain = (expected - confinement).abs() / young;
            let (axial, _) =
                d.triaxial_test(0, sign * 0.13 * yield_strain, confinement, 16).unwrap();
            let error = (axial - expected).abs() / expected.abs().max(confinement);
            assert!(error < 1e-8, "{n}: {named:?}: {axial} instead of {expected}");
        }
    }
}

#[test]
fn associated_plane_strain_strength_is_the_closed_form_and_above_mohr_coulomb() {
    // With flow along the normal the strain along z is zero where σ_z is the geometric mean, hence
    // sqrt(K) + 1 + 1 / sqrt(K) = sqrt(9 + 8 tan² φ) for the ratio K of the stresses in the plane.
    for phi in [10.0, 20.0, 30.0, 40.0_f64] {
        let sum = (9.0 + 8.0 * phi.to_radians().tan().powi(2)).sqrt() - 1.0;
        let root = 0.5 * (sum + (sum * sum - 4.0).sqrt());
        let ratio = biaxial(phi, phi);
        assert!((ratio / (root * root) - 1.0).abs() < 1e-8, "phi = {phi}: {ratio}");
        let sin = phi.to_radians().sin();
        let mohr_coulomb = (1.0 + sin) / (1.0 - sin);
        for psi in [0.0, 0.5 * phi, phi] {
            assert!(biaxial(phi, psi) > 1.02 * mohr_coulomb, "phi = {phi}, psi = {psi}");
        }
        // Negative control: without dilation the middle stress is another, and so is the strength.
        assert!((biaxial(phi, 0.0) / ratio - 1.0).abs() > 1e-5);
    }
}

#[test]
fn dilation_ratio_in_triaxial_compression_and_extension() {
    // dε_v over the plastic shear strain is M_ψ in compression and M_ψ / Γ in extension, where Γ = (3 + sin φ) / (3 - sin φ);
    // with dε_q = |dε_1 - dε_3| 2/3. In compression this is the ratio of Mohr-Coulomb.
    for psi in [0.0, 10.0, 15.0, 30.0_f64] {
        let sin = psi.to_radians().sin();
        let mut d = driver(&[("dilation_angle", psi)], 1).confined(CONFINEMENT);
        let (_, last) = d.triaxial_test(0, -1e-3, CONFINEMENT, 40).unwrap();
        let ratio = trace(last) / last[2];
        assert!((ratio + 2.0 * sin / (1.0 - sin)).abs() < 1e-8, "psi = {psi}: {ratio}");
        let mut d = driver(&[("dilation_angle", psi)], 1).confined(CONFINEMENT);
        let (_, last) = d.triaxial_test(0, 1e-3, CONFINEMENT, 40).unwrap();
        let ratio = trace(last) / (2.0 / 3.0 * (last[2] - last[0]));
        let expected = 6.0 * sin / (3.0 - sin) * (3.0 - 0.5) / (3.0 + 0.5);
        assert!((ratio - expected).abs() < 1e-8, "psi = {psi}: {ratio} {expected}");
    }
}

#[test]
fn without_friction_the_surface_is_that_of_von_mises() {
    let named = [("friction_angle", 0.0), ("tension_cutoff", 1e6)];
    for axial in [-1e-3, 1e-3] {
        let mut d = driver(&named, 1).confined(CONFINEMENT);
        let (stress, _) = d.triaxial_test(0, axial, CONFINEMENT, 40).unwrap();
        assert!(((stress - CONFINEMENT).abs() - 20.0e3).abs() < 1e-8 * CONFINEMENT);
    }
    let mut d = driver(&named, 1).confined(CONFINEMENT);
    for _ in 0..300 {
        d.biaxial_step(0, -1e-3, -CONFINEMENT, 1.0).unwrap();
    }
    let s = d.stress0(0);
    assert!((s[0] - s[1] - 40.0e3 / 3.0_f64.sqrt()).abs() < 1e-8 * CONFINEMENT);
    // Neither friction nor cohesion: no deviator at all, and no division by zero.
    let named = [("friction_angle", 0.0), ("cohesion", 0.0)];
    let mut d = driver(&named, 1).confined(CONFINEMENT);
    d.set_strain_increment(0, [1e-3, -1e-3, 0.0, 1e-3, 0.0, 0.0]);
    d.update(1.0).unwrap();
    let s = d.stress1(0);
    assert!((0..3).all(|c| (s[c] + CONFINEMENT).abs() < 1e-6) && s[3].abs() < 1e-6);
}

#[test]
fn beyond_the_cut_off_the_gap_is_remembered() {
    let apex = 10.0e3 / 30.0_f64.to_radians().tan();
    for (cohesion, cutoff) in [(0.0, 0.0), (10e3, 0.0), (10e3, 4.0e3), (10e3, apex)] {
        let mut d = driver(&[("cohesion", cohesion), ("tension_cutoff", cutoff)], 1);
        d.set_stress(0, [-1e3, -1e3, -1e3, 0.0, 0.0, 0.0]);
        let mut total = 0.0;
        let mut step = |d: &mut Driver, e: f64| {
            total += e;
            d.set_strain_increment(0, [e / 3.0, e / 3.0, e / 3.0, 0.0, 0.0, 0.0]);
            d.update(1.0).unwrap();
            assert_eq!(d.status_of(0), LAHAR_POINT_OK);
            d.commit();
            // Stress and gap are functions of the total strain: no volume was created or lost.
            let expected = (BULK * total - 1e3).min(cutoff);
            let stress = d.stress0(0);
            assert!((0..3).all(|c| (stress[c] - expected).abs() < 1e-11 * BULK), "{stress:?}");
            let gap = (total - (cutoff + 1e3) / BULK).max(0.0);
            assert!((d.state0(0, 1) - gap).abs() < 1e-14, "{} {gap}", d.state0(0, 1));
        };
        for e in [0.01, 0.02, -0.015, -0.01, -0.004, -0.002, 0.003, 0.01, -0.013] {
            step(&mut d, e);
        }
        for _ in 0..100 {
            step(&mut d, 0.02);
            step(&mut d, -0.02);
        }
        assert_eq!(d.state0(0, 1), 0.0);
    }
}

#[test]
fn an_open_point_has_the_strength_that_is_left_at_the_cut_off() {
    // Nothing without cohesion, where the cut-off is the apex; with it, q Γ = k - M p_t.
    for (cohesion, cutoff) in [(0.0, 0.0), (10e3, 0.0), (10e3, 5e3)] {
        let mut d = driver(&[("cohesion", cohesion), ("tension_cutoff", cutoff)], 1);
        d.set_strain_increment(0, [0.01, 0.0, 0.0, 0.0, 0.0, 0.0]);
        d.update(1.0).unwrap();
        d.commit();
        for _ in 0..50 {
            d.set_strain_increment(0, [0.0, 0.0, -2e-3, 0.0, 0.0, 0.0]);
            d.set_state(0, 1, 0.05);
            d.update(1.0).unwrap();
            d.commit();
        }
        let s = d.stress0(0);
        let (q, p) = ((1.5 * contract(deviator(s), deviator(s))).sqrt(), -trace(s) / 3.0);
        let expected = 1.2 * (cohesion * 3.0_f64.sqrt() - cutoff);
        assert!((p + cutoff).abs() < 1e-9 && (q - expected).abs() < 1e-7, "{q} {expected}");
        assert!((d.state0(0, 1) - 0.048).abs() < 1e-15);
    }
}

#[test]
fn values_that_do_not_go_together_are_refused() {
    let refused = |named: &[(&str, f64)]| try_driver(named, 1).err().unwrap();
    assert!(refused(&[("dilation_angle", 31.0)]).contains("must not exceed friction_angle"));
    assert!(refused(&[("tension_cutoff", 17.4e3)]).contains("c cot(phi)"));
    assert!(refused(&[("cohesion", 0.0), ("tension_cutoff", 1.0)]).contains("c cot(phi)"));
    assert!(try_driver(&[("tension_cutoff", 17.3e3)], 1).is_ok());
}

#[test]
fn a_point_that_is_not_a_number_or_too_large_fails_alone() {
    let mut d = driver(&[], 12);
    d.set_strain_increment(1, [f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0]);
    d.set_strain_increment(2, [0.0, 0.0, 0.0, f64::INFINITY, 0.0, 0.0]);
    d.set_stress(3, [0.0, 0.0, f64::NAN, 0.0, 0.0, 0.0]);
    d.set_state(4, 1, f64::NAN);
    d.set_state(5, 0, f64::INFINITY);
    d.set_strain_increment(6, [1e300, -1e300, 1e300, 1e300, 0.0, 0.0]);
    d.set_strain_increment(7, [1e160, 0.0, 0.0, -1e160, 0.0, 0.0]);
    d.set_stress(8, [-1e200, 0.0, 0.0, 0.0, 0.0, 0.0]);
    d.update(1.0).unwrap();
    assert_eq!(d.failed_points().unwrap(), (1..9).collect::<Vec<_>>());
}

#[test]
fn no_strain_leaves_a_returned_stress_as_it_is() {
    let mut random = Random::new(3);
    let mut d = driver(&[("dilation_angle", 10.0), ("tension_cutoff", 2e3)], 64);
    for _ in 0..50 {
        for k in 0..64 {
            d.set_strain_increment(k, random.symmetric(3e-3));
        }
        d.update(1.0).unwrap();
        d.commit();
        for k in 0..64 {
            d.set_strain_increment(k, [0.0; 6]);
        }
        d.update(1.0).unwrap();
        assert_eq!(d.changed_points(2), []);
    }
}

#[test]
fn principal_axes_turn_with_the_strain() {
    let mut d = driver(&[], 1).confined(CONFINEMENT);
    for _ in 0..100 {
        d.set_strain_increment(0, [0.0, 0.0, 0.0, 1e-3, 0.0, 0.0]);
        d.update(1.0).unwrap();
        d.commit();
    }
    let shift = 10e3 / 30.0_f64.to_radians().tan();
    let s = principal_axes(d.stress0(0)).0.map(|s| shift - s);
    let invariant = s.iter().sum::<f64>() * s.iter().map(|s| 1.0 / s).sum::<f64>();
    assert!((invariant / (9.0 + 8.0 / 3.0) - 1.0).abs() < 1e-10, "{invariant}");
}

#[test]
fn extreme_values_give_finite_stresses_or_a_failed_point() {
    let mut random = Random::new(23);
    let table = ModelTable::of::<MatsuokaNakai>().desc();
    let (mut ran, mut failed) = (0, 0);
    for _ in 0..400 {
        let mut pick = |values: [f64; 4]| values[random.between(0.0, 3.999) as usize];
        let (friction, poisson) = (pick([0.0, 1e-9, 45.0, 85.0]), pick([-0.999, 0.0, 0.3, 0.4999]));
        let mut power = |low: f64, high: f64| 10f64.powf(random.between(low, high));
        let cohesion = power(-3.0, 12.0);
        let named = [
            ("youngs_modulus", power(-3.0, 15.0)),
            ("poissons_ratio", poisson),
            ("friction_angle", friction),
            ("cohesion", cohesion),
            ("dilation_angle", random.between(0.0, 1.0) * friction),
            ("tension_cutoff", (cohesion / friction.to_radians().tan()).min(1e30)),
        ];
        let mut d = Driver::new(table, &named, 8).unwrap();
        for _ in 0..10 {
            let size = 10f64.powf(random.between(-9.0, 4.0));
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

#[test]
fn wave_speed_is_elastic() {
    let mut d = driver(&[], 1);
    d.wave_speed().unwrap();
    let m: f64 = E * (1.0 - NU) / ((1.0 + NU) * (1.0 - 2.0 * NU));
    assert!((d.wave_speed_of(0) / (m / 1000.0).sqrt() - 1.0).abs() < 1e-14);
}
