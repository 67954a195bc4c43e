//! Element tests through the plugin table: strengths on both meridians and in plane strain, dilation, tension, opening, bad input.
#![forbid(unsafe_code)]

mod support;

use lahar_model_mohr_coulomb::MohrCoulomb;
use lahar_plugin::abi::LAHAR_POINT_OK;
use lahar_plugin::tensor::trace;
use lahar_plugin::testing::{Random, principal_axes};
use lahar_plugin::{Driver, ModelTable};
use support::{BULK, E, NU, driver, try_driver};

const CONFINEMENT: f64 = 100.0e3;

#[test]
fn triaxial_strengths_are_those_of_the_reference() {
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
        let apex = cohesion * cos / sin;
        let named = [
            ("youngs_modulus", young),
            ("poissons_ratio", random.between(0.0, 0.45)),
            ("friction_angle", phi),
            ("cohesion", cohesion),
            ("dilation_angle", random.between(0.0, 1.0) * phi),
            ("tension_cutoff", apex),
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
fn slope_is_youngs_modulus_until_the_strength_is_reached() {
    let mut d = driver(&[], 1).confined(CONFINEMENT);
    let yield_strain = 234.641016e3 / E;
    let (axial, _) = d.triaxial_test(0, -yield_strain / 100.0, CONFINEMENT, 99).unwrap();
    assert!(((axial - CONFINEMENT) / (0.99 * yield_strain * E) - 1.0).abs() < 1e-8);
    assert_eq!(d.state0(0, 0), 0.0);
    d.triaxial_test(0, -yield_strain / 100.0, CONFINEMENT, 2).unwrap();
    assert!(d.state0(0, 0) > 0.0);
}

#[test]
fn dilation_ratio_in_triaxial_compression_and_extension() {
    // Compression: dε_v / dε_1 = -2 sin ψ / (1 - sin ψ); extension, where two principal stresses are the larger ones:
    // dε_v / dε_3 = 2 sin ψ / (1 + sin ψ).
    for psi in [0.0, 10.0, 15.0, 30.0_f64] {
        let sin = psi.to_radians().sin();
        for (axial, expected) in
            [(-1e-3, -2.0 * sin / (1.0 - sin)), (1e-3, 2.0 * sin / (1.0 + sin))]
        {
            let mut d = driver(&[("dilation_angle", psi)], 1).confined(CONFINEMENT);
            let (_, last) = d.triaxial_test(0, axial, CONFINEMENT, 40).unwrap();
            let ratio = trace(last) / last[2];
            assert!((ratio - expected).abs() < 1e-8, "psi = {psi}: {ratio}");
        }
    }
}

#[test]
fn plane_strain_strength_and_dilation_are_those_of_the_plane() {
    for psi in [0.0, 10.0, 30.0_f64] {
        let mut d = driver(&[("dilation_angle", psi)], 1).confined(CONFINEMENT);
        let mut last = [0.0; 6];
        for _ in 0..200 {
            last = d.biaxial_step(0, -1e-3, -CONFINEMENT, 1.0).unwrap();
        }
        let s = d.stress0(0);
        assert!((s[1] + 334_641.016_151_377_5).abs() < 1e-8 * CONFINEMENT);
        assert!(s[2] < s[0] && s[2] > s[1]);
        let sin = (last[0] + last[1]) / (last[0] - last[1]);
        assert!((sin - psi.to_radians().sin()).abs() < 1e-8, "psi = {psi}: {sin}");
    }
}

#[test]
fn without_friction_the_strength_is_the_cohesion() {
    for axial in [-1e-3, 1e-3] {
        let named = [("friction_angle", 0.0), ("tension_cutoff", 1e6)];
        let mut d = driver(&named, 1).confined(CONFINEMENT);
        let (stress, _) = d.triaxial_test(0, axial, CONFINEMENT, 40).unwrap();
        assert!(((stress - CONFINEMENT).abs() - 20.0e3).abs() < 1e-8 * CONFINEMENT);
    }
    // Neither friction nor cohesion: no deviator at all, and no division by zero.
    let mut d = driver(&[("friction_angle", 0.0), ("cohesion", 0.0)], 1).confined(CONFINEMENT);
    d.set_strain_increment(0, [1e-3, -1e-3, 0.0, 1e-3, 0.0, 0.0]);
    d.update(1.0).unwrap();
    let s = d.stress1(0);
    assert!((0..3).all(|c| (s[c] + CONFINEMENT).abs() < 1e-6) && s[3].abs() < 1e-6);
}

#[test]
fn tension_ends_at_the_cut_off() {
    let cutoff = 4.0e3;
    let mut d = driver(&[("tension_cutoff", cutoff)], 1);
    for _ in 0..20 {
        d.triaxial_step(0, 1e-4, 0.0, 1.0).unwrap();
    }
    assert!((d.stress0(0)[2] - cutoff).abs() < 1e-9 * cutoff);
    // With the cut-off at the apex uniaxial tension ends at the shear planes: 2 c cos φ / (1 + sin φ).
    let apex = 10.0e3 / 30.0_f64.to_radians().tan();
    let mut d = driver(&[("tension_cutoff", apex)], 1);
    for _ in 0..40 {
        d.triaxial_step(0, 1e-4, 0.0, 1.0).unwrap();
    }
    let expected = 20.0e3 * 30.0_f64.to_radians().cos() / 1.5;
    assert!((d.stress0(0)[2] - expected).abs() < 1e-9 * expected);
}

#[test]
fn beyond_the_cut_off_in_all_directions_the_gap_is_remembered() {
    for (cohesion, cutoff) in [(0.0, 0.0), (10e3, 0.0), (10e3, 4.0e3)] {
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
fn shearing_an_opened_point_needs_no_stress_and_is_plastic() {
    let mut d = driver(&[("cohesion", 0.0)], 1);
    d.set_strain_increment(0, [0.01, 0.0, 0.0, 0.0, 0.0, 0.0]);
    d.update(1.0).unwrap();
    d.commit();
    let before = d.state0(0, 0);
    assert!((before - 0.02 / 3.0).abs() < 1e-14);
    d.set_strain_increment(0, [0.0, 0.0, 0.0, 0.02, 0.0, 0.0]);
    d.update(1.0).unwrap();
    assert_eq!(d.stress1(0), [0.0; 6]);
    assert!((d.state1(0, 1) - 0.01).abs() < 1e-14);
    assert!((d.state1(0, 0) - before - 0.02 * (4.0_f64 / 3.0).sqrt()).abs() < 1e-14);
}

#[test]
fn values_that_do_not_go_together_are_refused() {
    let refused = |named: &[(&str, f64)]| try_driver(named, 1).err().unwrap();
    assert!(refused(&[("dilation_angle", 31.0)]).contains("must not exceed friction_angle"));
    assert!(refused(&[("tension_cutoff", 17.4e3)]).contains("c cot(phi)"));
    assert!(refused(&[("cohesion", 0.0), ("tension_cutoff", 1.0)]).contains("c cot(phi)"));
    assert!(try_driver(&[("tension_cutoff", 17.3e3)], 1).is_ok());
    let softening = |name, value| {
        refused(&[("softening", 1.0), ("residual_friction_angle", 25.0), (name, value)])
    };
    let missing = refused(&[("softening", 1.0)]);
    assert!(missing.contains("give the angle that is left"), "{missing}");
    assert!(softening("residual_cohesion", 11e3).contains("residual_cohesion is 11000 Pa"));
    assert!(softening("residual_dilation_angle", 1.0).contains("must not exceed dilation_angle"));
    let more = refused(&[("softening", 2.0), ("residual_friction_angle", 31.0)]);
    assert!(more.contains("must not exceed friction_angle"), "{more}");
}

#[test]
fn a_point_that_is_not_a_number_or_too_large_fails_alone() {
    for softening in [0.0, 1.0, 2.0] {
        let mut d = driver(&[("softening", softening), ("residual_friction_angle", 20.0)], 12);
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
    // A sheared point under pressure: the stress deviator of simple shear is at the strength of the plane.
    let mut d = driver(&[], 1).confined(CONFINEMENT);
    for _ in 0..100 {
        d.set_strain_increment(0, [0.0, 0.0, 0.0, 1e-3, 0.0, 0.0]);
        d.update(1.0).unwrap();
        d.commit();
    }
    let ([high, _, low], _) = principal_axes(d.stress0(0));
    let strength = -0.5 * (high + low) * 0.5 + 10e3 * 30.0_f64.to_radians().cos();
    assert!((0.5 * (high - low) / strength - 1.0).abs() < 1e-10);
}

#[test]
fn wave_speed_is_elastic() {
    let mut d = Driver::typical(ModelTable::of::<MohrCoulomb>().desc(), &[], 1).unwrap();
    d.wave_speed().unwrap();
    let m: f64 = 1e7 * (1.0 - NU) / ((1.0 + NU) * (1.0 - 2.0 * NU));
    assert!((d.wave_speed_of(0) / (m / 1000.0).sqrt() - 1.0).abs() < 1e-14);
}
