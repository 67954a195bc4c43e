//! Element tests through the plugin table.
#![forbid(unsafe_code)]

use lahar_model_newtonian::Newtonian;
use lahar_plugin::{Driver, ModelTable};

const K: f64 = 1.0e6;

fn driver(named: &[(&str, f64)], n: usize) -> Driver {
    let mut all = vec![("bulk_modulus", K)];
    all.extend_from_slice(named);
    Driver::new(ModelTable::of::<Newtonian>().desc(), &all, n).unwrap()
}

fn volumetric(e: f64) -> [f64; 6] {
    [e / 3.0, e / 3.0, e / 3.0, 0.0, 0.0, 0.0]
}

fn pressure(stress: [f64; 6]) -> f64 {
    -(stress[0] + stress[1] + stress[2]) / 3.0
}

#[test]
fn pressure_follows_the_equation_of_state_in_many_steps_as_in_one() {
    let j: f64 = 0.97;
    for (choice, expected) in [(0.0, K / 7.0 * (j.powi(-7) - 1.0)), (1.0, K * (1.0 / j - 1.0))] {
        for steps in [1, 1000] {
            let mut d = driver(&[("equation_of_state", choice)], 1);
            for _ in 0..steps {
                d.set_strain_increment(0, volumetric(j.ln() / f64::from(steps)));
                d.update(1e-3).unwrap();
                d.commit();
            }
            // Round-off of a thousand multiplications.
            assert!((pressure(d.stress0(0)) / expected - 1.0).abs() < 1e-10);
            assert!((d.state0(0, 0) - j).abs() < 1e-12);
        }
    }
    // Negative control: the two equations differ by much more at this volume.
    assert!(((K / 7.0 * (j.powi(-7) - 1.0)) / (K * (1.0 / j - 1.0)) - 1.0).abs() > 0.05);
}

#[test]
fn a_start_stress_is_kept_by_the_first_step_without_strain() {
    for choice in [0.0, 1.0] {
        for p in [-1.0e3, 0.0, 1.0e-6, 1.0e3, 1.0e5] {
            let mut d = driver(&[("equation_of_state", choice)], 1);
            d.set_stress(0, [-p, -p, -p, 0.0, 0.0, 0.0]);
            d.init_state().unwrap();
            d.update(1e-3).unwrap();
            // J is 1 to within round-off, hence the absolute error of K times the machine epsilon.
            assert!((pressure(d.stress1(0)) - p).abs() < 1e-15 * K * 4.0, "p = {p}");
        }
    }
}

#[test]
fn a_pressure_that_the_fluid_never_reaches_is_refused() {
    let mut d = driver(&[], 1);
    d.set_stress(0, volumetric(3.0 * K));
    assert!(d.init_state().unwrap_err().contains("equation of state"));
}

#[test]
fn shear_stress_is_viscosity_times_rate_and_the_trace_has_no_part() {
    let mut d = driver(&[("viscosity", 0.5)], 1);
    let dt = 1e-3;
    d.set_strain_increment(0, [2e-3, -1e-3, -1e-3, 1e-3, 0.0, 5e-4]);
    d.update(dt).unwrap();
    let s = d.stress1(0);
    let expected = [2.0, -1.0, -1.0, 1.0, 0.0, 0.5];
    for c in 0..6 {
        assert!((s[c] - expected[c]).abs() < 1e-9);
    }
    assert!((d.diffusivity_of(0) - 4.0 / 3.0 * 0.5 / 1000.0).abs() < 1e-18);
}

#[test]
fn zero_tension_gives_no_pressure_until_the_volume_has_closed() {
    for (zero_tension, opened) in [(0.0, true), (1.0, false)] {
        let mut d = driver(&[("zero_tension", zero_tension)], 1);
        let mut pressures = Vec::new();
        for e in [0.02, -0.01, -0.01, -0.01] {
            d.set_strain_increment(0, volumetric(e));
            d.update(1e-3).unwrap();
            d.commit();
            pressures.push(pressure(d.stress0(0)));
        }
        assert_eq!(pressures[0] < 0.0, opened);
        assert_eq!(pressures[1] < 0.0, opened);
        assert!(pressures[2].abs() < 1e-9 * K);
        assert!((pressures[3] / (K / 7.0 * (0.07_f64.exp() - 1.0)) - 1.0).abs() < 1e-10);
    }
}

#[test]
fn sound_speed_is_the_slope_of_pressure_over_density() {
    let mut d = driver(&[], 1);
    d.set_state(0, 0, 0.95);
    d.set_input(0, 0, 1000.0 / 0.95);
    d.wave_speed().unwrap();
    let p = |j: f64| K / 7.0 * (j.powi(-7) - 1.0);
    let slope =
        (p(0.95 - 1e-6) - p(0.95 + 1e-6)) / (1000.0 / (0.95 - 1e-6) - 1000.0 / (0.95 + 1e-6));
    assert!((d.wave_speed_of(0) / slope.sqrt() - 1.0).abs() < 1e-7);
}

#[test]
fn a_point_that_is_not_a_number_fails_alone() {
    let mut d = driver(&[("viscosity", 1.0)], 5);
    d.set_strain_increment(1, [0.0, 0.0, 0.0, f64::NAN, 0.0, 0.0]);
    d.set_strain_increment(2, volumetric(-2000.0));
    d.set_state(3, 0, f64::NAN);
    d.update(1e-3).unwrap();
    assert_eq!(d.failed_points().unwrap(), (1..4).collect::<Vec<_>>());
}

/// Derivative of the end stress of point 0 by its strain increment `strain`, from central differences.
fn differences(d: &mut Driver, strain: [f64; 6], dt: f64) -> [[f64; 6]; 6] {
    let mut out = [[0.0; 6]; 6];
    for j in 0..6 {
        let mut end = |h: f64| {
            let mut moved = strain;
            moved[j] += h;
            d.set_strain_increment(0, moved);
            d.update(dt).unwrap();
            d.stress1(0)
        };
        let (h, ahead, behind) = (1e-6, end(1e-6), end(-1e-6));
        for i in 0..6 {
            out[i][j] = (ahead[i] - behind[i]) / (2.0 * h);
        }
    }
    d.set_strain_increment(0, strain);
    out
}

#[test]
fn the_tangent_is_the_derivative_of_the_stress() {
    let strain = [2e-3, -5e-3, 1e-3, 3e-3, -2e-3, 1e-3];
    for (choice, zero_tension, j) in
        [(0.0, 0.0, 0.98), (1.0, 0.0, 0.98), (0.0, 1.0, 1.05), (1.0, 1.0, 1.05)]
    {
        let named =
            [("equation_of_state", choice), ("zero_tension", zero_tension), ("viscosity", 20.0)];
        let mut d = driver(&named, 1);
        d.set_state(0, 0, j);
        let expected = differences(&mut d, strain, 1e-3);
        let tangent = d.tangent(0, 1e-3).unwrap();
        for i in 0..6 {
            for j in 0..6 {
                let error = (tangent[i][j] - expected[i][j]).abs();
                assert!(error < 1e-7 * K, "{i} {j}: {} {}", tangent[i][j], expected[i][j]);
            }
        }
        assert_eq!(tangent[0][1] + tangent[1][0] > K, zero_tension == 0.0);
    }
}
