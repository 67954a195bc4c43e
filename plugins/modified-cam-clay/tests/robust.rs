//! Any strain, from any start: the model stays on or inside its ellipse, without tension and finite.
#![forbid(unsafe_code)]

mod support;

use support::*;

use lahar_plugin::Driver;
use lahar_plugin::abi::LAHAR_POINT_FAILED;
use lahar_plugin::nalgebra::{Matrix3, Vector3};
use lahar_plugin::tensor::trace;
use lahar_plugin::testing::Random;

/// Runs random strains of many sizes and checks every end.
fn endure(mut d: Driver, slope: f64, least: f64, seed: u64) -> usize {
    let (mut random, mut plastic) = (Random::new(seed), 0);
    let n = 64;
    for step in 0..1500 {
        for k in 0..n {
            // Sizes from 1e-8 to 0.1; a drift of compression and extension in turns.
            let size = 10f64.powf(-4.5 + 7.0 * random.between(-0.5, 0.5));
            let drift = 0.3 * size * f64::sin(0.02 * step as f64 + k as f64);
            let e = random.symmetric(0.5 * size);
            let e = std::array::from_fn(|c| e[c] + if c < 3 { drift } else { 0.0 });
            d.set_strain_increment(k, e);
        }
        d.update(1.0).unwrap();
        for k in 0..n {
            assert_ne!(d.status_of(k), LAHAR_POINT_FAILED, "step {step}, point {k}");
            let (stress, pc) = (d.stress1(k), d.state1(k, 1));
            let f = yield_residual(stress, pc, slope);
            assert!(f < 1e-9, "step {step}, point {k}: {f:e}");
            assert!(trace(stress) <= 1e-9 * pc, "no tension: {stress:?}");
            assert!(pc >= least && d.wave_speed_of(k) > 0.0);
            plastic += usize::from(f > -1e-11);
        }
        d.commit();
    }
    plastic
}

#[test]
fn random_strains_with_tension_leave_no_point_outside_the_ellipse() {
    assert!(endure(consolidated(&[], 100.0e3, 64), M, 1e3, 1) > 10_000);
    assert!(
        endure(consolidated(&[("overconsolidation_ratio", 20.0)], 5.0e3, 64), M, 1e3, 2) > 10_000
    );
}

#[test]
fn random_strains_from_zero_stress_leave_no_point_outside_the_ellipse() {
    assert!(endure(consolidated(&[], 0.0, 64), M, 1e3, 3) > 10_000);
    let named =
        [("critical_stress_ratio", 0.2), ("minimum_pressure", 5.0), ("swelling_index", 5e-4)];
    assert!(endure(consolidated(&named, 0.0, 64), 0.2, 5.0, 4) > 10_000);
    let named =
        [("critical_stress_ratio", 3.0), ("minimum_pressure", 2e4), ("swelling_index", 0.18)];
    assert!(endure(consolidated(&named, 0.0, 64), 3.0, 2e4, 5) > 10_000);
    let named = [("compression_index", 1.0), ("poissons_ratio", 0.4999)];
    assert!(endure(consolidated(&named, 0.0, 64), M, 1e3, 6) > 10_000);
}

#[test]
fn opening_and_closing_create_no_volume() {
    let mut d = consolidated(&[], 0.0, 1);
    let volumetric = |e: f64| [e / 3.0, e / 3.0, e / 3.0, 0.0, 0.0, 0.0];
    one_step(&mut d, volumetric(-0.2));
    let (e, stress) = (d.state0(0, 0), d.stress0(0));
    assert!(invariants(stress).0 > 2e3);
    for cycle in 0..50 {
        let size = 0.01 * (1 + cycle) as f64;
        for _ in 0..10 {
            one_step(&mut d, volumetric(size));
        }
        assert!(invariants(d.stress0(0)).0 <= 1.0, "an opened point carries nothing");
        for n in 0..10 {
            one_step(&mut d, volumetric(-size));
            // No more than the minimum pressure on the way back, until the void ratio is that of its compression line.
            let left = (9 - n) as f64 * size;
            let loose = left > (3.0 / (1.0 + e)).ln(); // v = 3 on the line at the minimum pressure
            assert!(!loose || invariants(d.stress0(0)).0 <= 1.0e3 * (1.0 + 1e-12));
        }
        assert!((d.state0(0, 0) - e).abs() < 1e-12 * f64::exp(10.0 * size));
    }
    // On the normal compression line the void ratio alone decides.
    assert!((invariants(d.stress0(0)).0 / invariants(stress).0 - 1.0).abs() < 1e-8);
}

#[test]
fn an_opened_point_does_not_stiffen_as_it_flies_apart() {
    let mut d = consolidated(&[], 0.0, 1);
    d.wave_speed().unwrap();
    let before = d.wave_speed_of(0);
    for _ in 0..100 {
        one_step(&mut d, [0.05, 0.0, 0.0, 0.02, 0.0, 0.0]);
    }
    assert!(d.state0(0, 0) > 100.0);
    d.wave_speed().unwrap();
    assert!(d.wave_speed_of(0) <= before * (1.0 + 1e-12));
    assert!(invariants(d.stress0(0)).1 <= 0.5 * M * 1e3 * (1.0 + 1e-9));
}

#[test]
fn increments_of_any_size_are_answered() {
    for size in [1e-300, 1e-20, 1e-12, 1e-3, 0.5, 5.0, 100.0, 1e4, 1e300] {
        for sign in [1.0, -1.0] {
            for p0 in [0.0, 1e3, 1e5] {
                let mut d = consolidated(&[], p0, 2);
                d.set_strain_increment(0, [size * sign, size * sign, size * sign, 0.0, 0.0, 0.0]);
                d.set_strain_increment(1, [0.3 * size * sign, 0.0, 0.0, size, -size, 0.0]);
                d.update(1.0).unwrap();
                for k in 0..2 {
                    let finite = d.stress1(k).iter().all(|s| s.is_finite());
                    assert!(finite || d.status_of(k) == LAHAR_POINT_FAILED, "{size} {sign} {p0}");
                    assert!(size > 1.0 || finite, "{size} {sign} {p0}");
                }
            }
        }
    }
}

#[test]
fn no_strain_changes_nothing() {
    let mut d = consolidated(&[], 0.0, 3);
    d.set_stress(1, [-1.1e5, -2.03e5, -1.7e5, 3.3e4, 1e3, -7.0]);
    d.set_stress(2, [1.1e3, 2.03e3, 1.7e2, 3.3e3, 1e3, -7.0]);
    d.init_state().unwrap();
    d.update(1.0).unwrap();
    assert_eq!(d.changed_points(3), []);
    assert_eq!(d.failed_points().unwrap(), []);
}

#[test]
fn a_point_that_is_not_a_number_fails_alone() {
    let mut d = consolidated(&[], 1e5, 9);
    for k in 0..9 {
        d.set_strain_increment(k, [1e-4, 0.0, -2e-4, 1e-5, 0.0, 0.0]);
    }
    d.set_strain_increment(1, [f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0]);
    d.set_strain_increment(2, [0.0, 0.0, 0.0, f64::INFINITY, 0.0, 0.0]);
    d.set_stress(3, [0.0, 0.0, f64::NAN, 0.0, 0.0, 0.0]);
    d.set_state(4, 0, f64::NAN);
    d.set_state(5, 1, f64::INFINITY);
    d.set_input(0, 6, 0.0);
    d.set_state(7, 0, -1.5);
    d.update(1.0).unwrap();
    assert_eq!(d.failed_points().unwrap(), (1..8).collect::<Vec<_>>());
}

#[test]
fn points_of_a_batch_are_those_of_single_calls() {
    let run = |n: usize, first: usize| {
        let mut d = consolidated(&[], 5e4, n);
        for k in 0..n {
            let mut random = Random::new((first + k) as u64);
            d.set_strain_increment(k, random.symmetric(5e-3));
        }
        d.update(1.0).unwrap();
        (0..n).map(|k| (d.stress1(k), d.wave_speed_of(k))).collect::<Vec<_>>()
    };
    let batch = run(37, 0);
    for (k, answer) in batch.iter().enumerate() {
        assert_eq!(*answer, run(1, k)[0]);
    }
}

/// A point in the middle of random motions, with a strain for its next step.
fn somewhere(seed: u64) -> (Driver, [f64; 6]) {
    let mut random = Random::new(seed);
    let p0 = [0.0, 300.0, 5e3, 1e5][seed as usize % 4];
    let ratio = [1.0, 1.5, 8.0][seed as usize % 3];
    let mut d = consolidated(&[("overconsolidation_ratio", ratio)], p0, 1);
    let size = [1e-4, 3e-3, 3e-2][(seed / 12) as usize % 3];
    for _ in 0..5 {
        one_step(&mut d, random.symmetric(0.5 * size));
    }
    (d, random.symmetric(0.5 * size))
}

#[test]
fn the_tangent_is_that_of_differences() {
    let (mut compared, mut skipped) = (0, 0);
    for seed in 0..600 {
        let (mut d, strain) = somewhere(seed);
        let size = strain.iter().fold(0.0_f64, |m, e| m.max(e.abs()));
        let found = d.compare_tangent(0, strain, 1e-5 * size, 1.0).unwrap();
        let norm = found.size();
        for (error, bend) in found.errors.iter().zip(found.bends) {
            if bend > 1e-3 * norm {
                skipped += 1;
                continue;
            }
            assert!(error / norm < 1e-5, "seed {seed}: {found:?}");
            compared += 1;
        }
    }
    assert!(compared > 3000 && skipped < 300, "{compared} {skipped}");
}

#[test]
fn the_wave_speed_is_not_below_that_of_the_elastic_tangent() {
    for seed in 0..200 {
        let (mut d, _) = somewhere(seed);
        d.wave_speed().unwrap();
        let given = d.wave_speed_of(0);
        d.set_strain_increment(0, [0.0; 6]);
        let c = elastic(&mut d);
        let mut random = Random::new(seed + 1);
        for _ in 0..20 {
            let n = Vector3::from_fn(|_, _| random.between(-0.5, 0.5)).normalize();
            let at = [[0, 3, 5], [3, 1, 4], [5, 4, 2]];
            // dσ/dε counts both places of a shear strain: half of it each.
            let q = Matrix3::from_fn(|i, l| {
                let mut sum = 0.0;
                for j in 0..3 {
                    for m in 0..3 {
                        let half = if l == m { 1.0 } else { 0.5 };
                        sum += n[j] * n[m] * half * c[at[i][j]][at[l][m]];
                    }
                }
                sum
            });
            let fastest = (q.symmetric_eigen().eigenvalues.max() / 1000.0).sqrt();
            assert!(given >= fastest * (1.0 - 1e-9), "{given} {fastest}");
        }
    }
}

/// The elastic tangent at the start: that of no strain, inside the ellipse.
fn elastic(d: &mut Driver) -> [[f64; 6]; 6] {
    let preconsolidation = d.state0(0, 1);
    d.set_state(0, 1, 10.0 * preconsolidation);
    let tangent = d.tangent(0, 1.0).unwrap();
    d.set_state(0, 1, preconsolidation);
    tangent
}
