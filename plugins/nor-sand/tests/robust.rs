//! Any strain, from any start: the model stays on or inside its yield surface, without tension and finite.
#![forbid(unsafe_code)]

mod support;

use support::*;

use lahar_plugin::Driver;
use lahar_plugin::abi::{LAHAR_POINT_FAILED, LAHAR_POINT_UNRELIABLE};
use lahar_plugin::nalgebra::{Matrix3, Vector3};
use lahar_plugin::tensor::trace;
use lahar_plugin::testing::Random;

/// What became of the points of a long random motion.
#[derive(Debug, Default)]
struct Count {
    plastic: usize,
    opened: usize,
    unreliable: usize,
}

const POINTS: usize = 32;

/// Runs random strains of many sizes and checks every end.
fn endure(mut d: Driver, seed: u64) -> Count {
    let (mut random, mut count) = (Random::new(seed), Count::default());
    for step in 0..1000 {
        for k in 0..POINTS {
            // Sizes from 1e-8 to 0.01; a drift of compression and extension in turns.
            let size = 10f64.powf(-5.0 + 6.0 * random.between(-0.5, 0.5));
            let drift = 0.3 * size * f64::sin(0.02 * step as f64 + k as f64);
            let e = random.symmetric(0.5 * size);
            let e = std::array::from_fn(|c| e[c] + if c < 3 { drift } else { 0.0 });
            d.set_strain_increment(k, e);
        }
        d.update(1.0).unwrap();
        for k in 0..POINTS {
            assert_ne!(d.status_of(k), LAHAR_POINT_FAILED, "step {step}, point {k}");
            let stress = d.stress1(k);
            assert!(stress.iter().all(|s| s.is_finite()) && trace(stress) <= 0.0);
            let f = yield_residual(stress, d.state1(k, 0), d.state1(k, 1));
            // Beside it round-off of the start stress.
            let noise = 1e-14 * trace(d.stress0(k)).abs() / d.state1(k, 1);
            assert!(f < 1e-9 + noise, "step {step}, point {k}: {f:e}");
            assert!(d.state1(k, 3) >= 0.0 && d.wave_speed_of(k) > 0.0);
            assert!(d.state1(k, 3) == 0.0 || stress == [0.0; 6]);
            count.plastic += usize::from(f > -1e-10);
            count.opened += usize::from(d.state1(k, 3) > 0.0);
            count.unreliable += usize::from(d.status_of(k) == LAHAR_POINT_UNRELIABLE);
        }
        d.commit();
    }
    count
}

#[test]
fn random_strains_with_tension_leave_no_point_outside_the_yield_surface() {
    for (psi, p0) in [(-0.2, 1e5), (0.1, 1e5), (-0.05, 0.0), (0.3, 0.0)] {
        let count = endure(consolidated(&[], p0, psi, POINTS), 1);
        assert!(count.plastic > 5_000 && count.opened > 300, "{count:?}");
        assert_eq!(count.unreliable, 0, "{count:?}");
    }
}

#[test]
fn extreme_parameters_stay_on_the_yield_surface() {
    for (seed, named) in [
        [("shear_modulus", 1e9), ("elastic_exponent", 1.0), ("minimum_pressure", 5.0)],
        [("shear_modulus", 5e5), ("elastic_exponent", 0.0), ("minimum_pressure", 2e4)],
        [("hardening_modulus", 2000.0), ("poissons_ratio", 0.49), ("minimum_pressure", 1e3)],
        [("hardening_modulus", 10.0), ("poissons_ratio", 0.0), ("minimum_pressure", 1e3)],
    ]
    .iter()
    .enumerate()
    {
        for psi in [-0.6, 0.4] {
            let count = endure(consolidated(named, 0.0, psi, POINTS), seed as u64);
            assert!(count.plastic > 5_000 && count.unreliable < 10, "{named:?} {psi} {count:?}");
        }
    }
}

#[test]
fn an_opened_point_carries_no_stress_until_compression_has_closed_it() {
    let mut d = consolidated(&[], 5e3, -0.1, 1);
    let volumetric = |e: f64| [e / 3.0, e / 3.0, e / 3.0, 0.0, 0.0, 0.0];
    one_step(&mut d, volumetric(0.01));
    assert_eq!(d.stress0(0), [0.0; 6]);
    let (gap, e) = (d.state0(0, 3), d.state0(0, 0));
    assert!(gap > 0.009 && gap < 0.01);
    for _ in 0..50 {
        one_step(&mut d, [0.01, 0.02, -0.01, 0.03, 0.0, 0.0]);
        one_step(&mut d, [-0.01, -0.02, 0.01, 0.01, 0.0, 0.0]);
    }
    assert_eq!(d.stress0(0), [0.0; 6]);
    assert!((d.state0(0, 3) - gap).abs() < 1e-12 && (d.state0(0, 0) - e).abs() < 1e-12);
    one_step(&mut d, volumetric(-0.99 * gap));
    assert_eq!(d.stress0(0), [0.0; 6]);
    one_step(&mut d, volumetric(-0.02 * gap));
    assert!(d.state0(0, 3) == 0.0 && invariants(d.stress0(0)).0 > 0.0);
}

#[test]
fn increments_of_any_size_are_answered() {
    for size in [1e-300, 1e-20, 1e-12, 1e-3, 0.1, 0.5, 5.0, 100.0, 1e4, 1e300] {
        for sign in [1.0, -1.0] {
            for p0 in [0.0, 1e3, 1e5] {
                let mut d = consolidated(&[], p0, -0.1, 2);
                d.set_strain_increment(0, [size * sign, size * sign, size * sign, 0.0, 0.0, 0.0]);
                d.set_strain_increment(1, [0.3 * size * sign, 0.0, 0.0, size, -size, 0.0]);
                d.update(1.0).unwrap();
                for k in 0..2 {
                    let finite = d.stress1(k).iter().all(|s| s.is_finite());
                    assert!(finite || d.status_of(k) == LAHAR_POINT_FAILED, "{size} {sign} {p0}");
                    assert!(size > 0.5 || finite, "{size} {sign} {p0}");
                }
            }
        }
    }
}

#[test]
fn no_strain_changes_nothing() {
    let mut d = consolidated(&[], 0.0, -0.1, 3);
    d.set_stress(1, [-1.1e5, -2.03e5, -1.7e5, 3.3e4, 1e3, -7.0]);
    d.set_stress(2, [1.1e3, 2.03e3, 1.7e2, 3.3e2, 1e2, -7.0]);
    d.init_state().unwrap();
    d.update(1.0).unwrap();
    assert_eq!(d.changed_points(4), []);
    assert_eq!(d.failed_points().unwrap(), []);
}

#[test]
fn a_point_that_is_not_a_number_fails_alone() {
    let mut d = consolidated(&[], 1e5, -0.1, 9);
    for k in 0..9 {
        d.set_strain_increment(k, [1e-4, 0.0, -2e-4, 1e-5, 0.0, 0.0]);
    }
    d.set_strain_increment(1, [f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0]);
    d.set_strain_increment(2, [0.0, 0.0, 0.0, f64::INFINITY, 0.0, 0.0]);
    d.set_stress(3, [0.0, 0.0, f64::NAN, 0.0, 0.0, 0.0]);
    d.set_state(4, 0, f64::NAN);
    d.set_state(5, 1, f64::INFINITY);
    d.set_input(0, 6, 0.0);
    d.set_state(7, 3, f64::NAN);
    d.update(1.0).unwrap();
    assert_eq!(d.failed_points().unwrap(), (1..8).collect::<Vec<_>>());
}

#[test]
fn points_of_a_batch_are_those_of_single_calls() {
    let run = |n: usize, first: usize| {
        let mut d = consolidated(&[], 5e4, -0.1, n);
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
    let psi = [-0.2, -0.05, 0.1][seed as usize % 3];
    let mut d = consolidated(&[], p0, psi, 1);
    let size = [1e-5, 3e-4, 3e-3][(seed / 12) as usize % 3];
    let mut strain = || {
        let e = random.symmetric(0.5 * size);
        std::array::from_fn(|c| e[c] - if c < 3 { 0.1 * size } else { 0.0 })
    };
    (0..5).for_each(|_| one_step(&mut d, strain()));
    (d, strain())
}

#[test]
fn the_tangent_is_that_of_differences() {
    let (mut compared, mut skipped) = (0, 0);
    for seed in 0..600 {
        let (mut d, strain) = somewhere(seed);
        let size = strain.iter().fold(0.0_f64, |m, e| m.max(e.abs()));
        let found = d.compare_tangent(0, strain, 1e-5 * size, 1.0).unwrap();
        let norm = found.size().max(1.0);
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
        d.set_state(0, 1, 1e9); // far inside the yield surface
        let c = d.tangent(0, 1.0).unwrap();
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
