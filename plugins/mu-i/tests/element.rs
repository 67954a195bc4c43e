//! Element tests through the plugin table: the steady law, rest, the implicit step, separation.
#![forbid(unsafe_code)]

use lahar_model_mu_i::MuI;
use lahar_plugin::abi::LAHAR_POINT_OK;
use lahar_plugin::nalgebra::{Matrix3, Rotation3};
use lahar_plugin::tensor::{contract, deviator, from_matrix, to_matrix, trace};
use lahar_plugin::testing::{Random, with};
use lahar_plugin::{Driver, ModelTable};

const E: f64 = 1.0e6;
const NU: f64 = 0.3;
const BULK: f64 = E / (3.0 * (1.0 - 2.0 * NU));
const G: f64 = E / (2.0 * (1.0 + NU));
const SLOW: f64 = 0.3819;
const FAST: f64 = 0.6435;
const I0: f64 = 0.279;
const DIAMETER: f64 = 0.53e-3;
const GRAIN_DENSITY: f64 = 2450.0;
const P: f64 = 1.0e3;

fn try_driver(named: &[(&str, f64)], n: usize) -> Result<Driver, String> {
    let usual = [
        ("youngs_modulus", E),
        ("poissons_ratio", NU),
        ("static_friction", SLOW),
        ("limiting_friction", FAST),
        ("reference_inertial_number", I0),
        ("grain_diameter", DIAMETER),
        ("grain_density", GRAIN_DENSITY),
    ];
    Driver::new(ModelTable::of::<MuI>().desc(), &with(&usual, named), n)
}

/// All points under the pressure `P`.
fn driver(n: usize) -> Driver {
    let mut d = try_driver(&[], n).unwrap();
    (0..n).for_each(|k| d.set_stress(k, [-P, -P, -P, 0.0, 0.0, 0.0]));
    d
}

/// The law of Jop, Forterre and Pouliquen.
fn friction(inertial: f64) -> f64 {
    SLOW + (FAST - SLOW) / (I0 / inertial + 1.0)
}

fn tau(stress: [f64; 6]) -> f64 {
    let s = deviator(stress);
    (0.5 * contract(s, s)).sqrt()
}

fn pressure(stress: [f64; 6]) -> f64 {
    -trace(stress) / 3.0
}

fn shear(d: &mut Driver, rate: f64, dt: f64, steps: usize) -> Vec<f64> {
    d.set_strain_increment(0, [0.0, 0.0, 0.0, 0.5 * rate * dt, 0.0, 0.0]);
    let step = |_| {
        d.update(dt).unwrap();
        assert_eq!(d.status_of(0), LAHAR_POINT_OK);
        d.commit();
        d.stress0(0)[3]
    };
    (0..steps).map(step).collect()
}

#[test]
fn steady_shear_has_the_friction_of_its_inertial_number() {
    for pressure in [10.0, 1.0e3, 1.0e5] {
        for inertial in [1e-5, 1e-3, 0.03, 0.1, 0.279, 1.0, 3.0] {
            let rate = inertial / DIAMETER * (pressure / GRAIN_DENSITY).sqrt();
            let mut d = try_driver(&[], 1).unwrap();
            d.set_stress(0, [-pressure, -pressure, -pressure, 0.0, 0.0, 0.0]);
            for dt in [1e-3 * FAST * pressure / G / rate, 1.0] {
                shear(&mut d, rate, dt, 20_000);
                let mu = d.stress0(0)[3] / pressure;
                let expected = friction(inertial);
                assert!((mu / expected - 1.0).abs() < 1e-8, "{inertial} {dt}: {mu} {expected}");
                assert!((d.state0(0, 2) / inertial - 1.0).abs() < 1e-6);
            }
            // Negative controls: the friction of twice the rate, and of grains of twice the size.
            let wrong = friction(2.0 * inertial) / friction(inertial) - 1.0;
            assert!(wrong > 1e-5);
        }
    }
}

#[test]
fn below_the_static_friction_nothing_flows() {
    let mut d = driver(1);
    let rate = 0.1;
    let dt = 0.9 * SLOW * P / G / rate / 100.0;
    let loaded = shear(&mut d, rate, dt, 100);
    for (k, stress) in loaded.iter().enumerate() {
        assert!((stress / (G * rate * dt * (k as f64 + 1.0)) - 1.0).abs() < 1e-12);
    }
    let held = shear(&mut d, 0.0, 1.0, 1000);
    assert!(held.iter().all(|stress| *stress == loaded[99]));
    assert_eq!((d.state0(0, 0), d.state0(0, 2)), (0.0, 0.0));
    let back = shear(&mut d, -rate, dt, 100);
    assert!(back[99].abs() < 1e-12 * P);
}

#[test]
fn a_flow_that_stops_keeps_its_static_friction() {
    let mut d = driver(1);
    shear(&mut d, 400.0, 1e-5, 2000);
    let moving = d.stress0(0)[3] / P;
    assert!(moving > 1.3 * SLOW && moving < FAST);
    let stopped = shear(&mut d, 0.0, 1e-5, 2000);
    assert!(stopped.windows(2).all(|pair| pair[1] <= pair[0]));
    assert!((stopped[1999] / (SLOW * P) - 1.0).abs() < 1e-10, "{}", stopped[1999] / P);
    // No rate passes the limiting friction.
    let fast = shear(&mut d, 1e9, 1e-3, 100);
    assert!(fast.iter().all(|stress| *stress <= FAST * P * (1.0 + 1e-14)));
    assert!(fast[99] > 0.9999 * FAST * P);
}

#[test]
fn every_step_obeys_the_law_with_its_own_plastic_rate() {
    const N: usize = 64;
    let mut d = driver(N);
    let (mut random, mut flowing, mut opened) = (Random::new(1), 0, 0);
    for step in 0..400 {
        let dt = 10.0_f64.powf(-6.0 + f64::from(step % 50) / 10.0);
        let size = 10.0_f64.powf(-4.0 + f64::from(step % 5) / 2.0);
        for k in 0..N {
            let compression = 0.1 * size * random.between(-0.5, 0.5).abs();
            let strain = random.symmetric(0.5 * size);
            let strain = std::array::from_fn(|c| strain[c] - if c < 3 { compression } else { 0.0 });
            d.set_strain_increment(k, strain);
        }
        d.update(dt).unwrap();
        for k in 0..N {
            assert_eq!(d.status_of(k), LAHAR_POINT_OK);
            let stress = d.stress1(k);
            let (p, tau) = (pressure(stress), tau(stress));
            assert!(d.state1(k, 0) >= d.state0(k, 0));
            if d.state1(k, 1) > 0.0 {
                assert_eq!((stress, d.state1(k, 2)), ([0.0; 6], 0.0));
                opened += 1;
                continue;
            }
            let inertial = d.state1(k, 2);
            // Round-off of the trial stress, over the pressure.
            let noise = 1e-14 * BULK * size / p;
            if inertial > 0.0 {
                flowing += 1;
                assert!((tau / p - friction(inertial)).abs() < 1e-9 + 10.0 * noise);
                let rate = (d.state1(k, 0) - d.state0(k, 0)) / dt;
                let expected = rate * DIAMETER * (GRAIN_DENSITY / p).sqrt();
                // Beside I, the sum has the shear of the part in which the point was open.
                assert!(inertial < expected * 1.000001 + 1e-6 || d.state0(k, 1) > 0.0);
            } else {
                assert!(tau / p <= SLOW + noise);
            }
        }
        d.commit();
    }
    assert!(flowing > 5000 && opened > 1000, "{flowing} {opened}");
}

#[test]
fn an_opened_point_carries_no_stress_until_compression_has_closed_it() {
    let mut d = driver(1);
    let mut total = 0.0;
    for cycle in 0..60 {
        for e in [0.01, 0.02, -0.015, -0.014, 0.003, -0.004] {
            total += e;
            d.set_strain_increment(0, [e / 3.0, e / 3.0, e / 3.0, 0.0, 0.0, 0.0]);
            d.update(1e-3).unwrap();
            d.commit();
            // The strain at which there is no stress has not moved.
            let expected = (P - BULK * total).max(0.0);
            let p = pressure(d.stress0(0));
            assert!((p - expected).abs() < 1e-10 * BULK, "cycle {cycle}: {p} {expected}");
            assert_eq!(d.state0(0, 1) > 0.0, p == 0.0);
        }
    }
    // Sheared while open it carries nothing either.
    d.set_strain_increment(0, [0.02, 0.0, 0.0, 0.01, 0.0, 0.0]);
    d.update(1e-3).unwrap();
    assert_eq!(d.stress1(0), [0.0; 6]);
    let e = deviator([0.02, 0.0, 0.0, 0.01, 0.0, 0.0]);
    assert!(d.state1(0, 0) <= (2.0 * contract(e, e)).sqrt() * (1.0 + 1e-12));
}

#[test]
fn shear_without_pressure_meets_no_resistance() {
    let mut d = try_driver(&[], 1).unwrap();
    d.set_strain_increment(0, [0.0, 0.0, 0.0, 0.01, 0.0, 0.0]);
    d.update(1e-3).unwrap();
    assert_eq!(d.status_of(0), LAHAR_POINT_OK);
    assert!(d.stress1(0).iter().all(|s| *s == 0.0));
    assert!((d.state1(0, 0) / 0.02 - 1.0).abs() < 1e-14);
}

#[test]
fn a_turned_step_gives_the_turned_stress() {
    let turn = *Rotation3::from_euler_angles(0.3, -1.1, 2.0).matrix();
    let turned = |a: [f64; 6]| -> [f64; 6] {
        let m: Matrix3<f64> = turn * to_matrix(a) * turn.transpose();
        from_matrix(&m)
    };
    let (stress, strain) =
        ([-900.0, -1100.0, -1000.0, 40.0, -20.0, 30.0], [2e-3, -1e-3, -2e-3, 4e-3, -1e-3, 2e-3]);
    let mut d = driver(2);
    d.set_stress(0, stress);
    d.set_strain_increment(0, strain);
    d.set_stress(1, turned(stress));
    d.set_strain_increment(1, turned(strain));
    d.update(1e-4).unwrap();
    let expected = turned(d.stress1(0));
    assert!(d.state1(0, 2) > 0.0);
    for c in 0..6 {
        assert!((d.stress1(1)[c] - expected[c]).abs() < 1e-14 * BULK);
    }
}

#[test]
fn the_tangent_is_the_derivative_of_the_stress() {
    let strain = [2e-3, -1e-3, -2e-3, 4e-3, -1e-3, 2e-3];
    // Factor on the strain, opened before, whether it flows.
    for (part, opened, flows) in [(1.0, 0.0, true), (0.02, 0.0, false), (1.0, 4e-4, true)] {
        for dt in [1e-6, 1e-4, 1.0] {
            let mut d = driver(1);
            d.set_state(0, 1, opened);
            let strain = strain.map(|e| part * e);
            d.set_strain_increment(0, strain);
            d.update(dt).unwrap();
            assert_eq!(d.state1(0, 2) > 0.0, flows);
            let most = d.compare_tangent(0, strain, 1e-8, dt).unwrap().error();
            // Round-off of stresses of 1e3 Pa over h.
            assert!(most < 3e-6 * E, "{part} {opened} {dt}: {most}");
        }
    }
    // An open point has none.
    let mut d = driver(1);
    d.set_strain_increment(0, [1e-2, 0.0, 0.0, 1e-3, 0.0, 0.0]);
    assert_eq!(d.tangent(0, 1e-3).unwrap(), [[0.0; 6]; 6]);
}

#[test]
fn the_stored_energy_is_the_work_of_an_elastic_path() {
    let mut d = try_driver(&[], 1).unwrap();
    let strain = [-1e-6, -2e-6, -1e-6, 2e-7, 0.0, -1e-7];
    d.set_strain_increment(0, strain);
    let mut work = 0.0;
    for _ in 0..100 {
        d.update(1e-3).unwrap();
        let mean: [f64; 6] = std::array::from_fn(|c| 0.5 * (d.stress0(0)[c] + d.stress1(0)[c]));
        work += contract(mean, strain);
        d.commit();
    }
    assert!((d.stored_energy(0).unwrap() / work - 1.0).abs() < 1e-12);
}

#[test]
fn wave_speed_is_elastic() {
    let mut d = driver(1);
    d.wave_speed().unwrap();
    let expected = ((BULK + 4.0 / 3.0 * G) / 1000.0).sqrt();
    assert!((d.wave_speed_of(0) / expected - 1.0).abs() < 1e-14);
}

#[test]
fn a_limiting_friction_below_the_static_one_is_refused() {
    let error = try_driver(&[("limiting_friction", 0.3)], 1).err().unwrap();
    assert!(error.contains("at least static_friction"), "{error}");
    // Equal ones make a Drucker-Prager cone.
    let mut d = try_driver(&[("limiting_friction", SLOW)], 1).unwrap();
    d.set_stress(0, [-P, -P, -P, 0.0, 0.0, 0.0]);
    let last = shear(&mut d, 100.0, 1e-3, 5);
    assert!((last[4] / (SLOW * P) - 1.0).abs() < 1e-14);
}

#[test]
fn a_point_that_is_not_a_number_fails_alone() {
    let mut d = driver(10);
    for k in 0..10 {
        d.set_strain_increment(k, [0.0, 0.0, 0.0, 0.01, 0.0, 0.0]);
    }
    d.set_strain_increment(1, [0.0, 0.0, 0.0, f64::NAN, 0.0, 0.0]);
    d.set_strain_increment(2, [f64::INFINITY, 0.0, 0.0, 0.0, 0.0, 0.0]);
    d.set_strain_increment(3, [0.0, 0.0, 0.0, 1e200, 0.0, 0.0]);
    d.set_stress(4, [f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0]);
    d.set_state(5, 1, f64::NAN);
    d.set_state(6, 1, -1e-3);
    d.set_state(7, 0, f64::INFINITY);
    d.set_input(0, 8, 0.0);
    d.update(1e-3).unwrap();
    assert_eq!(d.failed_points().unwrap(), (1..9).collect::<Vec<_>>());
}
