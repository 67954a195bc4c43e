//! Element tests through the plugin table: strengths, dilation, apex, tension cut-off with memory.
#![forbid(unsafe_code)]

use lahar_model_drucker_prager::DruckerPrager;
use lahar_plugin::abi::LAHAR_POINT_OK;
use lahar_plugin::tensor::trace;
use lahar_plugin::testing::{Random, with};
use lahar_plugin::{Driver, ModelTable};

const E: f64 = 20.0e6;
const NU: f64 = 0.3;
const BULK: f64 = E / (3.0 * (1.0 - 2.0 * NU));
const CONFINEMENT: f64 = 100.0e3;
const COMPRESSION: f64 = 0.0;
const EXTENSION: f64 = 1.0;
const PLANE_STRAIN: f64 = 2.0;

fn try_driver(named: &[(&str, f64)], n: usize) -> Result<Driver, String> {
    let usual = [
        ("youngs_modulus", E),
        ("poissons_ratio", NU),
        ("friction_angle", 30.0),
        ("cohesion", 10.0e3),
        ("cone", COMPRESSION),
    ];
    Driver::new(ModelTable::of::<DruckerPrager>().desc(), &with(&usual, named), n)
}

fn driver(named: &[(&str, f64)], n: usize) -> Driver {
    try_driver(named, n).unwrap()
}

/// Triaxial test: returns σ_xx - σ_zz, positive in compression, and the last strain increment.
fn triaxial(d: &mut Driver, axial: f64, steps: usize) -> (f64, [f64; 6]) {
    let (stress, last) = d.triaxial_test(0, axial, CONFINEMENT, steps).unwrap();
    (stress - CONFINEMENT, last)
}

fn strength(cone: f64, axial: f64) -> f64 {
    let mut d = driver(&[("cone", cone), ("dilation_angle", 0.0)], 1).confined(CONFINEMENT);
    triaxial(&mut d, axial, 60).0
}

#[test]
fn triaxial_strengths_are_those_of_each_cone() {
    // φ = 30 deg, c = 10 kPa, σ3 = 100 kPa; q = (M σ3 + k) / (1 - M/3) in compression, / (1 + M/3) in extension.
    let values = [(COMPRESSION, 234.641016, 100.560435), (EXTENSION, 140.784610, 78.213672)];
    for (cone, in_compression, in_extension) in values {
        assert!((strength(cone, -5e-4) / (1e3 * in_compression) - 1.0).abs() < 1e-6);
        assert!((-strength(cone, 5e-4) / (1e3 * in_extension) - 1.0).abs() < 1e-6);
    }
    let (m, k) = (3.0_f64.sqrt() * 0.5, 3.0_f64.sqrt() * 10.0e3 * 30.0_f64.to_radians().cos());
    let expected = (m * CONFINEMENT + k) / (1.0 - m / 3.0);
    assert!((strength(PLANE_STRAIN, -5e-4) / expected - 1.0).abs() < 1e-6);
    let expected = (m * CONFINEMENT + k) / (1.0 + m / 3.0);
    assert!((-strength(PLANE_STRAIN, 5e-4) / expected - 1.0).abs() < 1e-6);
}

#[test]
fn a_wrong_cone_misses_the_mohr_coulomb_strength() {
    let (compression, extension) = (234.641016e3, 78.213672e3);
    for cone in [EXTENSION, PLANE_STRAIN] {
        assert!(strength(cone, -5e-4) < 0.7 * compression);
    }
    assert!(-strength(COMPRESSION, 5e-4) > 1.2 * extension);
}

#[test]
fn plane_strain_cone_has_the_mohr_coulomb_strength_for_every_dilation() {
    let biaxial = |cone: f64, dilation: f64| {
        let mut d =
            driver(&[("cone", cone), ("dilation_angle", dilation)], 1).confined(CONFINEMENT);
        let mut last = [0.0; 6];
        for _ in 0..200 {
            last = d.biaxial_step(0, -2e-3, -CONFINEMENT, 1.0).unwrap();
        }
        let s = d.stress0(0);
        let (radius, mean) = (0.5 * (s[0] - s[1]), -0.5 * (s[0] + s[1]));
        let strength = 0.5 * mean + 10.0e3 * 30.0_f64.to_radians().cos();
        (radius / strength, (last[0] + last[1]) / (last[0] - last[1]))
    };
    for dilation in [0.0, 10.0, 20.0, 30.0_f64] {
        let (ratio, sin_psi) = biaxial(PLANE_STRAIN, dilation);
        assert!((ratio - 1.0).abs() < 1e-6, "psi = {dilation}: {ratio}");
        assert!((sin_psi - dilation.to_radians().sin()).abs() < 1e-6, "psi = {dilation}");
    }
    // Negative control: the compression cone is much too strong in plane strain.
    assert!(biaxial(COMPRESSION, 0.0).0 > 1.2);
}

#[test]
fn slope_is_youngs_modulus_until_the_strength_is_reached() {
    let mut d = driver(&[], 1).confined(CONFINEMENT);
    let yield_strain = 234.641016e3 / E;
    let (q, _) = triaxial(&mut d, -yield_strain / 100.0, 99);
    assert!((q / (0.99 * yield_strain * E) - 1.0).abs() < 1e-8);
    assert_eq!(d.state0(0, 0), 0.0);
    triaxial(&mut d, -yield_strain / 100.0, 2);
    assert!(d.state0(0, 0) > 0.0);
}

#[test]
fn dilation_ratio_in_triaxial_compression() {
    // dε_v / dε_1 = -2 sin ψ / (1 - sin ψ), compression positive.
    for (psi, expected) in [(0.0, 0.0), (10.0, -0.420277), (15.0, -0.698396), (30.0, -2.0)] {
        let mut d = driver(&[("dilation_angle", psi)], 1).confined(CONFINEMENT);
        let (_, last) = triaxial(&mut d, -5e-4, 60);
        let ratio = trace(last) / last[2];
        assert!((ratio - expected).abs() < 1e-6, "psi = {psi}: {ratio}");
    }
    // Negative control: the dilation of the extension cone is another one.
    let mut d = driver(&[("dilation_angle", 30.0), ("cone", EXTENSION)], 1).confined(CONFINEMENT);
    let (_, last) = triaxial(&mut d, -5e-4, 60);
    assert!((trace(last) / last[2] + 2.0).abs() > 0.1);
}

#[test]
fn plastic_strain_is_that_of_the_deviator() {
    let mut d = driver(&[], 1).confined(CONFINEMENT);
    let (_, last) = triaxial(&mut d, -5e-4, 60);
    let before = d.state0(0, 0);
    triaxial(&mut d, -5e-4, 1);
    // At the limit all strain is plastic and isochoric: sqrt(2/3 e : e) = |ε_zz|.
    assert!((trace(last)).abs() < 1e-10);
    assert!(((d.state0(0, 0) - before) / 5e-4 - 1.0).abs() < 1e-6);
}

#[test]
fn beyond_the_apex_a_point_opens_and_carries_nothing() {
    let apex = 10.0e3 / 30.0_f64.to_radians().tan();
    for cutoff in [0.0, 5.0e3, apex] {
        for shear in [0.0, 1e-3, 0.1] {
            for psi in [0.0, 20.0] {
                let named = [("tension_cutoff", cutoff), ("dilation_angle", psi)];
                let mut d = driver(&named, 1);
                let e = 0.1;
                d.set_strain_increment(0, [e, e, e, shear, 0.0, 0.0]);
                d.update(1.0).unwrap();
                assert_eq!(d.stress1(0), [0.0; 6]);
                assert!((d.state1(0, 1) - 3.0 * e).abs() < 1e-15);
                let expected = shear * (4.0_f64 / 3.0).sqrt();
                assert!((d.state1(0, 0) - expected).abs() < 1e-12);
                assert_eq!(d.status_of(0), LAHAR_POINT_OK);
            }
        }
        // Just below the cut-off the point is elastic and keeps its tension.
        let mut d = driver(&[("tension_cutoff", cutoff)], 1);
        let e = 0.999 * cutoff / BULK / 3.0;
        d.set_strain_increment(0, [e, e, e, 0.0, 0.0, 0.0]);
        d.update(1.0).unwrap();
        assert!((trace(d.stress1(0)) / 3.0 - 0.999 * cutoff).abs() < 1e-9 * BULK);
        assert_eq!(d.state1(0, 1), 0.0);
    }
}

#[test]
fn no_sequence_of_strains_leaves_the_cone_or_the_cut_off() {
    let cutoff = 4.0e3;
    for (cone, m, k) in
        [(COMPRESSION, 1.2, 20.784609690826528e3), (EXTENSION, 6.0 / 7.0, 14.846149779161806e3)]
    {
        let mut d =
            driver(&[("cone", cone), ("dilation_angle", 12.0), ("tension_cutoff", cutoff)], 64);
        let mut random = Random::new(1);
        let mut closed = 0;
        for _ in 0..200 {
            for p in 0..64 {
                d.set_strain_increment(p, random.symmetric(2e-3));
            }
            d.update(1.0).unwrap();
            for p in 0..64 {
                let s = d.stress1(p);
                let mean = trace(s) / 3.0;
                let dev = [s[0] - mean, s[1] - mean, s[2] - mean, s[3], s[4], s[5]];
                let q = (1.5 * lahar_plugin::tensor::contract(dev, dev)).sqrt();
                // Round-off of stresses as large as K times the strain.
                assert!(q + m * mean - k < 1e-10 * BULK && mean < cutoff + 1e-10 * BULK);
                assert!(d.state1(p, 1) >= 0.0 && d.state1(p, 0) >= d.state0(p, 0));
                assert!(d.state1(p, 1) == 0.0 || s == [0.0; 6]);
                closed += i32::from(mean < 0.0);
            }
            d.commit();
        }
        assert!(closed > 1000);
    }
}

#[test]
fn an_opened_point_carries_no_stress_until_compression_has_closed_it() {
    let mut d = driver(&[("cohesion", 0.0)], 1);
    d.set_stress(0, [-1e3, -1e3, -1e3, 0.0, 0.0, 0.0]);
    let volumetric = |e: f64| [e / 3.0, e / 3.0, e / 3.0, 0.0, 0.0, 0.0];
    let mut total = 0.0;
    let mut step = |d: &mut Driver, e: f64| {
        total += e;
        d.set_strain_increment(0, volumetric(e));
        d.update(1.0).unwrap();
        d.commit();
        // The strain at which there is no stress has not moved: no volume was created or lost.
        let expected = (-BULK * (total - 1e3 / BULK)).max(0.0);
        let p = -trace(d.stress0(0)) / 3.0;
        assert!((p - expected).abs() < 1e-9 * BULK * 1e-2, "{p} {expected}");
    };
    for e in [0.01, 0.02, -0.015, -0.01, -0.004, -0.002, 0.003, 0.01, -0.013] {
        step(&mut d, e);
    }
    // Many more cycles, with closing inside a step each time.
    for _ in 0..100 {
        step(&mut d, 0.02);
        step(&mut d, -0.02);
    }
    let p = -trace(d.stress0(0)) / 3.0;
    assert!(p > 0.0 && d.state0(0, 1) == 0.0);
}

#[test]
fn shearing_an_opened_point_needs_no_stress() {
    let mut d = driver(&[("cohesion", 0.0)], 1);
    d.set_strain_increment(0, [0.01, 0.0, 0.0, 0.0, 0.0, 0.0]);
    d.update(1.0).unwrap();
    d.commit();
    let before = d.state0(0, 0);
    d.set_strain_increment(0, [0.0, 0.0, 0.0, 0.02, 0.0, 0.0]);
    d.update(1.0).unwrap();
    assert_eq!(d.stress1(0), [0.0; 6]);
    assert!((d.state1(0, 1) - 0.01).abs() < 1e-17);
    assert!((d.state1(0, 0) - before - 0.02 * (4.0_f64 / 3.0).sqrt()).abs() < 1e-15);
}

#[test]
fn without_friction_the_strength_is_the_cohesion() {
    // Tresca in triaxial compression: q = 2 c.
    let mut d = driver(&[("friction_angle", 0.0)], 1).confined(CONFINEMENT);
    let (q, _) = triaxial(&mut d, -5e-4, 60);
    assert!((q / 20.0e3 - 1.0).abs() < 1e-6);
    // Neither friction nor cohesion: no deviator at all, and no division by zero.
    let mut d = driver(&[("friction_angle", 0.0), ("cohesion", 0.0)], 1).confined(CONFINEMENT);
    d.set_strain_increment(0, [1e-3, -1e-3, 0.0, 1e-3, 0.0, 0.0]);
    d.update(1.0).unwrap();
    let s = d.stress1(0);
    assert!((0..3).all(|c| (s[c] + CONFINEMENT).abs() < 1e-6) && s[3].abs() < 1e-6);
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
fn a_point_that_is_not_a_number_fails_alone() {
    let mut d = driver(&[], 8);
    d.set_strain_increment(1, [f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0]);
    d.set_strain_increment(2, [0.0, 0.0, 0.0, f64::INFINITY, 0.0, 0.0]);
    d.set_stress(3, [0.0, 0.0, f64::NAN, 0.0, 0.0, 0.0]);
    d.set_state(4, 1, f64::NAN);
    d.set_state(5, 0, f64::INFINITY);
    d.set_input(0, 6, 0.0);
    d.update(1.0).unwrap();
    assert_eq!(d.failed_points().unwrap(), (1..7).collect::<Vec<_>>());
}

#[test]
fn wave_speed_is_elastic() {
    let mut d = driver(&[], 1);
    d.wave_speed().unwrap();
    let shear = E / (2.0 * (1.0 + NU));
    assert!(
        (d.wave_speed_of(0) / ((BULK + 4.0 / 3.0 * shear) / 1000.0).sqrt() - 1.0).abs() < 1e-14
    );
}
