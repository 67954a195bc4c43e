//! Element tests through the plugin table: flow curves, start and rest, the implicit step.
#![forbid(unsafe_code)]

use lahar_model_viscoplastic_fluids::{Bingham, HerschelBulkley};
use lahar_plugin::abi::LAHAR_POINT_OK;
use lahar_plugin::nalgebra::{Matrix3, Rotation3};
use lahar_plugin::tensor::{contract, deviator, from_matrix, to_matrix, trace};
use lahar_plugin::testing::{Random, with};
use lahar_plugin::{Driver, ModelTable};

const BULK: f64 = 2.0e6;
const G: f64 = 1.0e4;
const YIELD: f64 = 50.0;

/// A flow curve τ = τ_y + K γ̇^n: a Bingham fluid if n is 1.
#[derive(Clone, Copy, Debug)]
struct Curve {
    consistency: f64,
    index: f64,
}

const BINGHAM: Curve = Curve { consistency: 20.0, index: 1.0 };
const THINNING: Curve = Curve { consistency: 20.0, index: 0.4 };
const THICKENING: Curve = Curve { consistency: 5.0, index: 1.8 };
const CURVES: [Curve; 3] = [BINGHAM, THINNING, THICKENING];

impl Curve {
    fn driver(self, named: &[(&str, f64)], n: usize) -> Driver {
        let mut all = vec![("bulk_modulus", BULK), ("shear_modulus", G), ("yield_stress", YIELD)];
        let desc = if self.index == 1.0 {
            all.push(("viscosity", self.consistency));
            ModelTable::of::<Bingham>().desc()
        } else {
            all.extend([("consistency", self.consistency), ("flow_index", self.index)]);
            ModelTable::of::<HerschelBulkley>().desc()
        };
        Driver::new(desc, &with(&all, named), n).unwrap()
    }

    fn shear_stress(self, rate: f64) -> f64 {
        YIELD + self.consistency * rate.powf(self.index)
    }
}

fn tau(stress: [f64; 6]) -> f64 {
    let s = deviator(stress);
    (0.5 * contract(s, s)).sqrt()
}

/// Simple shear at a rate [1/s]; returns the shear stress after each step.
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
fn steady_shear_has_the_stress_of_the_flow_curve() {
    for curve in CURVES {
        for rate in [0.01, 1.0, 30.0, 1000.0_f64] {
            // Fifty times the time of relaxation of a viscosity that is the slope of the curve, or the time to yield.
            let apparent = curve.consistency * rate.powf(curve.index - 1.0) * curve.index.max(1.0);
            let steps = 2000;
            let dt = (50.0 * apparent + 2.0 * YIELD / rate) / G / steps as f64;
            let expected = curve.shear_stress(rate);
            let mut d = curve.driver(&[], 1);
            let last = *shear(&mut d, rate, dt, steps).last().unwrap();
            assert!((last / expected - 1.0).abs() < 1e-8, "{curve:?} {rate}: {last} {expected}");
            // A step a thousand times as long keeps it: no viscosity bounds the step.
            let last = *shear(&mut d, rate, 1e3 * dt, 50).last().unwrap();
            assert!((last / expected - 1.0).abs() < 1e-8, "{curve:?} {rate}: {last} {expected}");
            // Negative control: the stress is another without that of yield.
            assert!((last / (expected - YIELD) - 1.0).abs() > 1e-5);
        }
    }
}

#[test]
fn below_the_yield_stress_nothing_flows() {
    for curve in CURVES {
        let mut d = curve.driver(&[], 1);
        let rate = 0.1;
        let dt = 0.9 * YIELD / G / rate / 100.0;
        let stresses = shear(&mut d, rate, dt, 100);
        for (k, stress) in stresses.iter().enumerate() {
            let elastic = G * rate * dt * (k as f64 + 1.0);
            assert!((stress / elastic - 1.0).abs() < 1e-12);
        }
        // At rest the stress stays, bit for bit; all of the strain comes back.
        let held = shear(&mut d, 0.0, 10.0, 1000);
        assert!(held.iter().all(|stress| *stress == stresses[99]));
        let back = shear(&mut d, -rate, dt, 100);
        assert!(back[99].abs() < 1e-12 * YIELD);
    }
}

#[test]
fn a_flow_that_stops_keeps_its_yield_stress_and_no_more() {
    for curve in CURVES {
        let mut d = curve.driver(&[], 1);
        shear(&mut d, 100.0, 1e-4, 2000);
        let moving = d.stress0(0)[3];
        let stopped = shear(&mut d, 0.0, 1e-3, 20_000);
        assert!(moving > 1.5 * YIELD && stopped[0] < moving);
        assert!(stopped.windows(2).all(|pair| pair[1] <= pair[0]), "{curve:?}");
        assert!(stopped.iter().all(|stress| *stress >= YIELD * (1.0 - 1e-14)));
        // The overstress y of a power falls with dy/dt = -G (y/K)^(1/n): exponentially for n = 1, as a power of time for n < 1, and to
        // nothing in a finite time for n > 1.
        let left = stopped[19_999] / YIELD - 1.0;
        let (m, t) = (1.0 / curve.index, 20.0);
        let bound = if curve.index < 1.0 {
            ((m - 1.0) * G * t / curve.consistency.powf(m)).powf(-1.0 / (m - 1.0)) / YIELD
        } else {
            1e-14
        };
        assert!(left <= bound * 1.001, "{curve:?}: {left} {bound}");
    }
}

#[test]
fn a_bingham_fluid_starts_as_a_maxwell_fluid_with_an_error_of_first_order() {
    let (rate, end) = (200.0, 2.0 * BINGHAM.consistency / G);
    let yielded = YIELD / G / rate;
    let error = |steps: usize| {
        let mut d = BINGHAM.driver(&[], 1);
        let dt = (end + yielded) / steps as f64;
        let last = *shear(&mut d, rate, dt, steps).last().unwrap();
        let viscous = BINGHAM.consistency * rate;
        last - (YIELD + viscous * (1.0 - (-end * G / BINGHAM.consistency).exp()))
    };
    let order = (error(200) / error(400)).log2();
    assert!((order - 1.0).abs() < 0.02, "{order}");
    assert!(error(20_000).abs() < 2e-4 * BINGHAM.consistency * rate);
}

#[test]
fn every_step_obeys_the_flow_curve_with_its_own_viscoplastic_rate() {
    const N: usize = 64;
    let mut random = Random::new(1);
    for curve in CURVES {
        let mut d = curve.driver(&[], N);
        let mut flowing = 0;
        for step in 0..200 {
            let dt = 10.0_f64.powf(-6.0 + f64::from(step % 50) / 10.0);
            let size = 10.0_f64.powf(-5.0 + f64::from(step % 7) / 2.0);
            let strains: [[f64; 6]; N] = std::array::from_fn(|_| random.symmetric(0.5 * size));
            for (k, strain) in strains.iter().enumerate() {
                d.set_strain_increment(k, *strain);
            }
            d.update(dt).unwrap();
            for (k, strain) in strains.iter().enumerate() {
                assert_eq!(d.status_of(k), LAHAR_POINT_OK);
                let (old, new) = (deviator(d.stress0(k)), deviator(d.stress1(k)));
                let strain = deviator(*strain);
                let plastic: [f64; 6] =
                    std::array::from_fn(|c| strain[c] - (new[c] - old[c]) / (2.0 * G));
                let rate = (2.0 * contract(plastic, plastic)).sqrt() / dt;
                let tau = tau(new);
                // Round-off of stresses with a pressure, over the moduli and the step.
                let noise = 1e-15 * (tau + trace(d.stress1(k)).abs()) / G / dt;
                if tau > YIELD * (1.0 + 1e-9) {
                    flowing += 1;
                    let (low, high) = (
                        curve.shear_stress((rate * (1.0 - 1e-9) - 10.0 * noise).max(0.0)),
                        curve.shear_stress(rate * (1.0 + 1e-9) + 10.0 * noise),
                    );
                    assert!(
                        tau > low * (1.0 - 1e-9) && tau < high * (1.0 + 1e-9),
                        "{curve:?} dt {dt}: {low} < {tau} < {high}"
                    );
                    // It flows along the stress.
                    let along = contract(plastic, new) / (plastic.map(f64::abs)[0]).max(1e-300);
                    assert!(along > 0.0 || rate < 100.0 * noise);
                } else {
                    let least = curve.shear_stress((rate - 100.0 * noise).max(0.0));
                    assert!(least < YIELD * (1.0 + 1e-8), "{curve:?}: {rate} {noise}");
                }
            }
            d.commit();
        }
        assert!(flowing > 2000, "{flowing}");
    }
}

#[test]
fn a_turned_step_gives_the_turned_stress() {
    let turn = *Rotation3::from_euler_angles(0.3, -1.1, 2.0).matrix();
    let turned = |a: [f64; 6]| -> [f64; 6] {
        let m: Matrix3<f64> = turn * to_matrix(a) * turn.transpose();
        from_matrix(&m)
    };
    let (stress, strain) =
        ([-900.0, -1100.0, -1000.0, 40.0, -20.0, 30.0], [2e-3, -1e-3, 5e-4, 4e-3, -1e-3, 2e-3]);
    for curve in CURVES {
        let mut d = curve.driver(&[], 2);
        d.set_stress(0, stress);
        d.set_strain_increment(0, strain);
        d.set_stress(1, turned(stress));
        d.set_strain_increment(1, turned(strain));
        d.init_state().unwrap();
        d.update(1e-4).unwrap();
        let expected = turned(d.stress1(0));
        for c in 0..6 {
            assert!((d.stress1(1)[c] - expected[c]).abs() < 1e-14 * BULK);
        }
        assert!(tau(d.stress1(0)) > YIELD);
    }
}

#[test]
fn the_pressure_is_that_of_the_volume_alone() {
    for curve in CURVES {
        let mut d = curve.driver(&[("equation_of_state", 1.0)], 1);
        let e: f64 = -0.01;
        d.set_strain_increment(0, [e, 0.0, 0.0, 0.02, 0.0, 0.0]);
        d.update(1e-3).unwrap();
        let p = -trace(d.stress1(0)) / 3.0;
        assert!((p / (BULK * ((-e).exp() - 1.0)) - 1.0).abs() < 1e-11);
        let speed = ((BULK * (-e).exp() + 4.0 / 3.0 * G) / 1000.0).sqrt();
        assert!((d.wave_speed_of(0) / speed - 1.0).abs() < 1e-14);
    }
}

#[test]
fn the_tangent_is_the_derivative_of_the_stress() {
    let strain = [2e-3, -1e-3, 5e-4, 4e-3, -1e-3, 2e-3];
    for curve in CURVES {
        for (dt, part) in [(1e-5, 1.0), (1e-3, 1.0), (10.0, 1.0), (1e-3, 0.1)] {
            let mut d = curve.driver(&[], 1);
            d.set_stress(0, [-10.0, 10.0, 0.0, 20.0, -5.0, 10.0]);
            let strain = strain.map(|e| part * e);
            d.set_strain_increment(0, strain);
            d.update(dt).unwrap();
            assert_eq!(tau(d.stress1(0)) > YIELD, part == 1.0);
            // Third derivatives of a curve over strains of τ_y / G times 1e-6², and round-off of K over 1e-6.
            let found = d.compare_tangent(0, strain, 1e-6, dt).unwrap();
            assert!(found.error() < 1e-5 * G, "{curve:?}: {found:?}");
        }
    }
}

#[test]
fn without_viscosity_the_yield_stress_is_never_passed() {
    let mut d = Curve { consistency: 0.0, index: 1.0 }.driver(&[], 1);
    for dt in [0.0, 1e-6, 1.0] {
        d.set_strain_increment(0, [0.0, 0.0, 0.0, 0.1, 0.0, 0.0]);
        d.update(dt).unwrap();
        assert!((d.stress1(0)[3] / YIELD - 1.0).abs() < 1e-14);
    }
    // Without a yield stress it is a viscous fluid.
    let mut d = BINGHAM.driver(&[("yield_stress", 0.0)], 1);
    let last = *shear(&mut d, 3.0, 1e-3, 200).last().unwrap();
    assert!((last / (3.0 * BINGHAM.consistency) - 1.0).abs() < 1e-12);
    assert_eq!(d.status_of(0), LAHAR_POINT_OK);
}

#[test]
fn a_point_that_is_not_a_number_fails_alone() {
    for curve in CURVES {
        let mut d = curve.driver(&[], 9);
        for k in 0..9 {
            d.set_strain_increment(k, [0.0, 0.0, 0.0, 0.1, 0.0, 0.0]);
        }
        d.set_strain_increment(1, [0.0, 0.0, 0.0, f64::NAN, 0.0, 0.0]);
        d.set_strain_increment(2, [-2000.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        d.set_strain_increment(3, [0.0, 0.0, 0.0, 1e200, 0.0, 0.0]);
        d.set_stress(4, [f64::INFINITY, 0.0, 0.0, 0.0, 0.0, 0.0]);
        d.set_stress(5, [0.0, 0.0, 0.0, 1e300, 0.0, 0.0]);
        d.set_state(6, 0, f64::NAN);
        d.set_input(0, 7, 0.0);
        d.update(1e-3).unwrap();
        assert_eq!(d.failed_points().unwrap(), (1..8).collect::<Vec<_>>(), "{curve:?}");
    }
}
