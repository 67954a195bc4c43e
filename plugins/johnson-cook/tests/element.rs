//! Element tests through the plugin table: flow stress, heating, jumps of the rate, melting, residuals, tangents.
#![forbid(unsafe_code)]

use lahar_model_johnson_cook::JohnsonCook;
use lahar_plugin::abi::{LAHAR_POINT_FAILED, LAHAR_POINT_OK};
use lahar_plugin::tensor::{contract, deviator, trace};
use lahar_plugin::testing::{Random, invariants};
use lahar_plugin::{Driver, ModelTable, elastic};

/// Inputs and states by their places.
const DENSITY: usize = 0;
const TEMPERATURE: usize = 1;
const STRAIN: usize = 0;
const RISE: usize = 1;

// Copper of Johnson and Cook (1983).
const E: f64 = 124.0e9;
const NU: f64 = 0.34;
const G: f64 = E / (2.0 * (1.0 + NU));
const RHO: f64 = 8960.0;
const CAPACITY: f64 = 383.0;
const T_REF: f64 = 293.15;
const T_MELT: f64 = 1356.0;
/// Without softening: the reference is above every temperature of the tests.
const COLD: [(&str, f64); 2] = [("reference_temperature", 1.0e5), ("melting_temperature", 2.0e5)];
/// Strains of equivalent size 1.
const TENSION: [f64; 6] = [1.0, -0.5, -0.5, 0.0, 0.0, 0.0];
const MIXED: [f64; 6] = [0.5, 0.0, -0.5, 0.577_350_269_189_625_8, 0.0, 0.408_248_290_463_863];

fn try_driver(named: &[(&str, f64)], n: usize) -> Result<Driver, String> {
    let mut d = Driver::typical(ModelTable::of::<JohnsonCook>().desc(), named, n)?;
    (0..n).for_each(|k| d.set_input(DENSITY, k, RHO));
    Ok(d)
}

fn driver(named: &[(&str, f64)], n: usize) -> Driver {
    try_driver(named, n).unwrap()
}

/// The formula of the model for copper with some parameters changed, written anew.
fn flow_stress(named: &[(&str, f64)], [strain, rate, temperature]: [f64; 3]) -> f64 {
    let of = |key: &str, otherwise: f64| {
        named.iter().find(|(name, _)| *name == key).map_or(otherwise, |(_, value)| *value)
    };
    let (a, b) = (of("yield_stress", 90.0e6), of("hardening_modulus", 292.0e6));
    let (n, m) = (of("hardening_exponent", 0.31), of("softening_exponent", 1.09));
    let (t_ref, t_melt) = (of("reference_temperature", T_REF), of("melting_temperature", T_MELT));
    let quick = (rate / of("reference_rate", 1.0)).max(1.0).ln();
    let homologous = ((temperature - t_ref) / (t_melt - t_ref)).clamp(0.0, 1.0);
    (a + b * strain.powf(n)) * (1.0 + of("rate_factor", 0.025) * quick) * (1.0 - homologous.powf(m))
}

fn equivalent(stress: [f64; 6]) -> f64 {
    invariants(stress).1
}

/// A step with an equivalent strain increment along `direction`.
fn strain(d: &mut Driver, direction: [f64; 6], size: f64, dt: f64) {
    d.set_strain_increment(0, direction.map(|e| size * e));
    d.update(dt).unwrap();
    assert_eq!(d.status_of(0), LAHAR_POINT_OK);
    d.commit();
}

#[test]
fn flow_stress_is_the_closed_form_at_a_strain_a_rate_and_a_temperature() {
    let isothermal = [("taylor_quinney", 0.0)];
    let mut d = driver(&isothermal, 1);
    let mut checked = 0;
    for kappa in [1e-3, 0.05, 0.3, 1.0] {
        for rate in [1e-3, 1.0, 1e2, 1e4, 1e6] {
            for temperature in [200.0, T_REF, 500.0, 900.0, 1300.0] {
                for direction in [TENSION, MIXED] {
                    // The step from no stress whose elastic part is the expected stress and whose plastic part is 1e-3.
                    let expected = flow_stress(&[], [kappa, rate, temperature]);
                    let growth = 1e-3;
                    d.set_state(0, STRAIN, kappa - growth);
                    d.set_input(TEMPERATURE, 0, temperature);
                    let size = expected / (3.0 * G) + growth;
                    d.set_strain_increment(0, direction.map(|e| size * e));
                    d.update(growth / rate).unwrap();
                    let q = equivalent(d.stress1(0));
                    assert!((q / expected - 1.0).abs() < 1e-8, "{kappa} {rate} {temperature}: {q}");
                    assert!((d.state1(0, STRAIN) / kappa - 1.0).abs() < 1e-8);
                    assert_eq!(d.state1(0, RISE), 0.0);
                    checked += 1;
                }
            }
        }
    }
    assert_eq!(checked, 200);
    // Negative controls: neither rate nor temperature could be left out.
    let full = flow_stress(&[], [0.3, 1e4, 500.0]);
    assert!((flow_stress(&[], [0.3, 1.0, 500.0]) / full - 1.0).abs() > 0.1);
    assert!((flow_stress(&[], [0.3, 1e4, T_REF]) / full - 1.0).abs() > 0.1);
}

#[test]
fn copper_has_the_stress_that_the_constants_give_by_hand() {
    // 90 + 292 * 0.1^0.31 = 233.015 MPa; at 1e4 1/s 1.2302585 times that; at 700 K 0.6489015 of that.
    let by_hand = 186.020e6;
    let mut d = driver(&[("taylor_quinney", 0.0)], 1);
    d.set_input(TEMPERATURE, 0, 700.0);
    d.set_state(0, STRAIN, 0.1 - 1e-5);
    d.set_stress(0, TENSION.map(|e| by_hand * e / 1.5));
    strain(&mut d, TENSION, 1e-5, 1e-9);
    assert!((equivalent(d.stress0(0)) / by_hand - 1.0).abs() < 1e-6);
}

#[test]
fn plastic_work_heats_by_the_closed_form() {
    // 0.9 * 400 MPa * 1 / (8930 * 385) = 104.7 K.
    let named = [
        ("yield_stress", 400.0e6),
        ("hardening_modulus", 0.0),
        ("rate_factor", 0.0),
        ("heat_capacity", 385.0),
        COLD[0],
        COLD[1],
    ];
    for part in [0.9, 0.45, 0.0] {
        let mut d = driver(&[&named[..], &[("taylor_quinney", part)]].concat(), 1);
        d.set_input(DENSITY, 0, 8930.0);
        let steps = 200;
        for _ in 0..steps {
            let size = (1.0 + 400.0e6 / (3.0 * G)) / f64::from(steps);
            strain(&mut d, MIXED, size, 1e-6);
        }
        assert!((d.state0(0, STRAIN) - 1.0).abs() < 1e-10);
        let expected = part * 400.0e6 / (8930.0 * 385.0);
        assert!((d.state0(0, RISE) - expected).abs() < 1e-9 * 104.7, "{}", d.state0(0, RISE));
        assert!(part != 0.9 || (d.state0(0, RISE) - 104.7).abs() < 0.05);
    }
}

#[test]
fn adiabatic_softening_tends_to_the_exponential_with_the_first_order_of_the_step() {
    // m = 1, no hardening: dT*/dκ = χ A (1 - T*) / (ρ c ΔT), hence σ = A exp(-χ A κ / (ρ c ΔT)).
    let named = [
        ("yield_stress", 400.0e6),
        ("hardening_modulus", 0.0),
        ("rate_factor", 0.0),
        ("softening_exponent", 1.0),
    ];
    let error = |steps: i32| {
        let mut d = driver(&named, 1);
        for _ in 0..steps {
            strain(&mut d, TENSION, 5.0 / f64::from(steps), 1e-6);
        }
        let exponent = 0.9 * 400.0e6 / (RHO * CAPACITY * (T_MELT - T_REF)) * d.state0(0, STRAIN);
        let left = (-exponent).exp();
        assert!(left < 0.7);
        let warmed = (T_MELT - T_REF) * (1.0 - left);
        assert!((d.state0(0, RISE) / warmed - 1.0).abs() < 1.0 / f64::from(steps));
        equivalent(d.stress0(0)) / (400.0e6 * left) - 1.0
    };
    let errors = [50, 100, 200].map(error);
    assert!(errors[2].abs() < 1e-3, "{errors:?}");
    for pair in errors.windows(2) {
        assert!((pair[0] / pair[1] - 2.0).abs() < 0.05, "{errors:?}");
    }
}

#[test]
fn all_work_is_stored_or_becomes_heat() {
    let lost = |steps: i32| {
        let mut d = driver(&[("taylor_quinney", 1.0)], 1);
        let mut work = 0.0;
        for _ in 0..steps {
            let before = d.stress0(0);
            let size = 0.5 / f64::from(steps);
            strain(&mut d, MIXED, size, 1e-4 / f64::from(steps));
            let mean: [f64; 6] = std::array::from_fn(|c| 0.5 * (before[c] + d.stress0(0)[c]));
            work += contract(mean, MIXED.map(|e| size * e));
        }
        let heat = d.state0(0, RISE) * RHO * CAPACITY;
        assert!(work > 1e8);
        (heat + d.stored_energy(0).unwrap()) / work - 1.0
    };
    // The heat is that of the end stress of a step: of first order.
    let (coarse, fine) = (lost(1000), lost(2000));
    assert!(fine.abs() < 1e-3 && (coarse / fine - 2.0).abs() < 0.1, "{coarse} {fine}");
}

#[test]
fn a_jump_of_the_rate_raises_the_stress_by_its_logarithm() {
    let named = [("hardening_modulus", 0.0), ("taylor_quinney", 0.0)];
    let mut d = driver(&named, 1);
    let mut at_rate = |rate: f64| {
        for _ in 0..30 {
            strain(&mut d, TENSION, 1e-4, 1e-4 / rate);
        }
        equivalent(d.stress0(0))
    };
    let (slow, fast, back) = (at_rate(10.0), at_rate(1.0e4), at_rate(10.0));
    let step = 0.025 * 90.0e6 * 1000.0_f64.ln();
    assert!(((fast - slow) / step - 1.0).abs() < 1e-8, "{slow} {fast}");
    assert!((slow / (90.0e6 * (1.0 + 0.025 * 10.0_f64.ln())) - 1.0).abs() < 1e-8);
    // The law has no memory of the rate.
    assert!((back / slow - 1.0).abs() < 1e-8);
    // Below the reference rate the time plays no part.
    assert!((at_rate(0.5) / 90.0e6 - 1.0).abs() < 1e-12);
    assert!((at_rate(1e-6) / 90.0e6 - 1.0).abs() < 1e-12);
}

#[test]
fn temperature_is_what_the_host_gives_and_what_the_work_has_added() {
    let run = |given: f64, rise: f64| {
        let mut d = driver(&[], 1);
        d.set_input(TEMPERATURE, 0, given);
        d.set_state(0, RISE, rise);
        strain(&mut d, TENSION, 0.02, 1e-5);
        (equivalent(d.stress0(0)), d.state0(0, RISE) - rise)
    };
    let (hot, same, cold) = (run(600.0, 0.0), run(400.0, 200.0), run(400.0, 0.0));
    assert!((same.0 / hot.0 - 1.0).abs() < 1e-12 && (same.1 / hot.1 - 1.0).abs() < 1e-10);
    assert!(cold.0 > 1.1 * hot.0);
}

#[test]
fn molten_metal_carries_pressure_and_no_shear() {
    let mut d = driver(&[], 1);
    let bulk = E / (3.0 * (1.0 - 2.0 * NU));
    d.set_stress(0, [1e7, -1e7, 0.0, 3e7, 0.0, 0.0]);
    d.set_input(TEMPERATURE, 0, T_MELT);
    d.set_strain_increment(0, [-1e-3, -1e-3, -1e-3, 0.01, 2e-3, 0.0]);
    d.update(1e-6).unwrap();
    let s = d.stress1(0);
    assert!((0..3).all(|c| (s[c] / (-3e-3 * bulk) - 1.0).abs() < 1e-14) && s[3..] == [0.0; 3]);
    assert_eq!(d.state1(0, RISE), 0.0);
    // Negative control: a kelvin below it is solid, and weak.
    d.set_input(TEMPERATURE, 0, T_MELT - 1.0);
    d.update(1e-6).unwrap();
    assert!(equivalent(d.stress1(0)) > 1e4 && equivalent(d.stress1(0)) < 1e6);
}

#[test]
fn no_strain_heats_beyond_melting() {
    let mut d = driver(&[("taylor_quinney", 1.0)], 1);
    for _ in 0..400 {
        strain(&mut d, TENSION, 0.25, 1e-6);
    }
    let rise = d.state0(0, RISE);
    assert!(rise > 0.95 * (T_MELT - T_REF) && rise < T_MELT - T_REF, "{rise}");
    assert!(equivalent(d.stress0(0)) < 0.1 * flow_stress(&[], [100.0, 2.5e5, T_REF]));
}

#[test]
fn every_step_ends_on_the_flow_stress_of_its_end() {
    let mut random = Random::new(9);
    let mut plastic = 0;
    for _ in 0..300 {
        let named = [
            ("yield_stress", 10.0_f64.powf(random.between(7.0, 9.3))),
            ("hardening_modulus", 10.0_f64.powf(random.between(6.0, 9.3))),
            ("hardening_exponent", random.between(0.1, 1.2)),
            ("rate_factor", random.between(0.0, 0.1)),
            ("reference_rate", 10.0_f64.powf(random.between(-4.0, 2.0))),
            ("softening_exponent", random.between(0.7, 1.8)),
        ];
        let mut d = driver(&named, 8);
        let given = |k: usize| 200.0 + 150.0 * k as f64;
        (0..8).for_each(|k| d.set_input(TEMPERATURE, k, given(k)));
        for _ in 0..40 {
            let dt = 10.0_f64.powf(random.between(-9.0, -3.0));
            let strains: Vec<[f64; 6]> = (0..8)
                .map(|_| {
                    let size = named[0].1 / G * 10.0_f64.powf(random.between(-2.0, 1.5));
                    random.symmetric(size)
                })
                .collect();
            (0..8).for_each(|k| d.set_strain_increment(k, strains[k]));
            d.update(dt).unwrap();
            for k in 0..8 {
                assert_eq!(d.status_of(k), LAHAR_POINT_OK);
                let (q, kappa, rise) =
                    (equivalent(d.stress1(k)), d.state1(k, STRAIN), d.state1(k, RISE));
                let growth = kappa - d.state0(k, STRAIN);
                let bound = flow_stress(&named, [kappa, growth / dt, given(k) + rise]);
                // Round-off: of the mean stress, of which the deviator is cleared; of κ, from which the rate is read; of the
                // temperature, which near melting is that of a part of the cold stress.
                let large = 1e-14 * trace(d.stress1(k)).abs();
                let read = 1e-15 * kappa / growth.max(1e-15);
                let cold = 3e-14 * flow_stress(&named, [kappa, growth / dt, T_REF]);
                let close = (1e-9 + read) * bound + large + cold;
                assert!(growth >= 0.0 && q <= bound + close, "{named:?}: {q} {bound}");
                if growth > 0.0 {
                    plastic += 1;
                    assert!((q - bound).abs() <= close, "{named:?}: {q} {bound}");
                    let (s, de) = (deviator(d.stress0(k)), deviator(strains[k]));
                    let trial = equivalent(std::array::from_fn(|c| s[c] + 2.0 * G * de[c]));
                    let lacks = trial - q - 3.0 * G * growth;
                    assert!(lacks.abs() <= 1e-9 * trial + 3.0 * G * 1e-15 * kappa + large);
                    let per_q = 0.9 / (RHO * CAPACITY) * growth;
                    let warmed = rise - d.state0(k, RISE);
                    assert!((warmed - per_q * q).abs() <= per_q * close + 1e-12);
                }
            }
            d.commit();
        }
    }
    assert!(plastic > 20_000, "{plastic}");
}

/// Largest difference of the tangent of point 0 from central differences of the stress, over the largest component.
fn tangent_error(d: &mut Driver, strain: [f64; 6], size: f64, dt: f64) -> f64 {
    let found = d.compare_tangent(0, strain, size, dt).unwrap();
    found.error() / found.size()
}

#[test]
fn tangents_are_the_differences_of_the_stress() {
    let mut random = Random::new(3);
    let strong_heating = [("heat_capacity", 1.0), ("softening_exponent", 1.5)];
    let strong_rate = [("rate_factor", 0.3), ("hardening_modulus", 3.0e9)];
    for named in [&[][..], &strong_heating, &strong_rate] {
        for _ in 0..50 {
            let mut d = driver(named, 1);
            d.set_stress(0, random.symmetric(5e7));
            d.set_state(0, STRAIN, random.between(0.01, 0.5));
            d.set_input(TEMPERATURE, 0, random.between(300.0, 900.0));
            for size in [1e-5, 1e-3, 1e-2] {
                // Differences of second order: (1e-4 of the strain)², and the solution's 1e-12 over 1e-4.
                let error = tangent_error(&mut d, random.symmetric(size), 1e-4 * size, 1e-6);
                assert!(error < 3e-6, "{named:?}, strain {size}: {error:e}");
            }
        }
    }
}

#[test]
fn the_tangent_needs_the_terms_of_rate_and_heat() {
    // Negative control of the test above: along the flow the tangent is that of hardening, rate and heat, and without
    // one of the last two it would be another.
    let along = |named: &[(&str, f64)], dt: f64| {
        let mut d = driver(named, 1);
        d.set_state(0, STRAIN, 0.1);
        d.set_strain_increment(0, [0.0, 0.0, 0.0, 5e-3, 0.0, 0.0]);
        d.tangent(0, dt).unwrap()[3][3] / (2.0 * G)
    };
    let hot = ("heat_capacity", 1.0);
    let (all, isothermal) = (along(&[hot], 1e-6), along(&[hot, ("taylor_quinney", 0.0)], 1e-6));
    let rateless = along(&[hot, ("rate_factor", 0.0)], 1e-6);
    assert!((isothermal - all).abs() > 1e-3 && (rateless - all).abs() > 1e-3, "{all}");
}

#[test]
fn a_step_below_yield_is_that_of_elasticity_and_no_step_changes_nothing() {
    let mut d = driver(&[], 2);
    let start = [1e7, -1e7, 2e7, 1e7, -1e7, 5e6];
    let strain = [1e-5, 2e-5, -4e-5, 3e-5, 1e-5, -2e-5];
    for k in 0..2 {
        d.set_stress(k, start);
        d.set_state(k, STRAIN, 0.01);
        d.set_state(k, RISE, 3.0);
    }
    d.set_strain_increment(0, strain);
    d.update(1e-6).unwrap();
    let c = elastic::stiffness(elastic::lame(E, NU).unwrap());
    for i in 0..6 {
        let expected = start[i] + (0..6).map(|j| c[i][j] * strain[j]).sum::<f64>();
        assert!((d.stress1(0)[i] - expected).abs() < 1e-13 * 1e8);
    }
    assert_eq!(d.stress1(1), start);
    for k in 0..2 {
        assert_eq!((d.state1(k, STRAIN), d.state1(k, RISE)), (0.01, 3.0));
    }
    assert_eq!(d.tangent(0, 1e-6).unwrap(), c);
}

#[test]
fn the_first_yield_of_a_virgin_point_is_found_however_small() {
    // κ^n and T*^m with infinite slopes at the start.
    let mut d = driver(&[("hardening_exponent", 0.2), ("softening_exponent", 0.6)], 1);
    for beyond in [1e-12, 1e-9, 1e-6, 1e-3, 1.0] {
        let size = 90.0e6 / (3.0 * G) * (1.0 + beyond);
        d.set_strain_increment(0, TENSION.map(|e| size * e));
        d.update(1e-7).unwrap();
        assert_eq!(d.status_of(0), LAHAR_POINT_OK);
        let (q, kappa, rise) = (equivalent(d.stress1(0)), d.state1(0, STRAIN), d.state1(0, RISE));
        let expected = flow_stress(
            &[("hardening_exponent", 0.2), ("softening_exponent", 0.6)],
            [kappa, kappa / 1e-7, T_REF + rise],
        );
        assert!(kappa > 0.0 && (q / expected - 1.0).abs() < 1e-9, "{beyond}: {q} {expected}");
    }
    // Where the root, (0.09 / 2e10)^40, is below the smallest number, the whole step is elastic.
    let mut d = driver(&[("hardening_exponent", 0.025), ("hardening_modulus", 2.0e10)], 1);
    let q = 90.0e6 * (1.0 + 1e-9);
    strain(&mut d, TENSION, q / (3.0 * G), 1e-7);
    assert!((equivalent(d.stress0(0)) / q - 1.0).abs() < 1e-13 && d.state0(0, STRAIN) < 1e-300);
}

#[test]
fn values_that_do_not_go_together_are_refused() {
    let refused = |named: &[(&str, f64)]| try_driver(named, 1).err().unwrap();
    assert!(refused(&[("melting_temperature", T_REF)]).contains("must exceed"));
    assert!(refused(&[("melting_temperature", f64::NAN)]).contains("must exceed"));
    assert!(refused(&[("youngs_modulus", 1e308), ("poissons_ratio", 0.4999)]).contains("finite"));
}

#[test]
fn wave_speed_is_elastic_and_stored_energy_that_of_the_elastic_strain() {
    let mut d = driver(&[], 1);
    let expected = (E * (1.0 - NU) / ((1.0 + NU) * (1.0 - 2.0 * NU)) / RHO).sqrt();
    d.wave_speed().unwrap();
    assert!((d.wave_speed_of(0) / expected - 1.0).abs() < 1e-14);
    strain(&mut d, TENSION, 0.01, 1e-6);
    assert!((d.wave_speed_of(0) / expected - 1.0).abs() < 1e-14);
    let q = equivalent(d.stress0(0));
    assert!((d.stored_energy(0).unwrap() / (q * q / (6.0 * G)) - 1.0).abs() < 1e-12);
}

#[test]
fn a_point_that_is_not_a_number_or_huge_fails_alone() {
    let mut d = driver(&[], 14);
    for k in 0..14 {
        d.set_strain_increment(k, [0.0, 0.0, 0.0, 5e-3, 0.0, 0.0]);
    }
    d.set_strain_increment(1, [f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0]);
    d.set_strain_increment(2, [0.0, 0.0, 0.0, f64::INFINITY, 0.0, 0.0]);
    d.set_strain_increment(3, [0.0, 0.0, 1e290, 1e300, 0.0, 0.0]);
    d.set_stress(4, [0.0, 0.0, f64::NAN, 0.0, 0.0, 0.0]);
    d.set_stress(5, [0.0, 1e200, 0.0, 0.0, 0.0, 0.0]);
    d.set_state(6, STRAIN, f64::NAN);
    d.set_state(7, STRAIN, -0.1);
    d.set_state(8, RISE, f64::INFINITY);
    d.set_input(DENSITY, 9, 0.0);
    d.set_input(DENSITY, 10, -1.0);
    d.set_input(TEMPERATURE, 11, f64::NAN);
    d.set_input(TEMPERATURE, 12, f64::NEG_INFINITY);
    d.update(1e-6).unwrap();
    assert_eq!(d.failed_points().unwrap(), (1..13).collect::<Vec<_>>());
    // A plastic step without length has no rate.
    for dt in [0.0, f64::NAN] {
        d.update(dt).unwrap();
        assert_eq!(d.status_of(0), LAHAR_POINT_FAILED, "{dt}");
    }
}

#[test]
fn a_batch_gives_the_bits_of_single_points() {
    let mut random = Random::new(5);
    let mut d = driver(&[], 21);
    let points: Vec<_> = (0..21).map(|_| (random.symmetric(1e8), random.symmetric(4e-3))).collect();
    for (k, (stress, strain)) in points.iter().enumerate() {
        d.set_stress(k, *stress);
        d.set_strain_increment(k, *strain);
    }
    d.update(1e-6).unwrap();
    for (k, (stress, strain)) in points.iter().enumerate() {
        let mut single = driver(&[], 1);
        single.set_stress(0, *stress);
        single.set_strain_increment(0, *strain);
        single.update(1e-6).unwrap();
        assert_eq!(single.stress1(0), d.stress1(k));
        assert_eq!(single.state1(0, STRAIN), d.state1(k, STRAIN));
        assert_eq!(single.state1(0, RISE), d.state1(k, RISE));
    }
}
