//! Element tests through the plugin table: uniaxial stress, shear, unloading, softening, residuals, tangents.
#![forbid(unsafe_code)]

use lahar_model_von_mises::VonMises;
use lahar_plugin::abi::LAHAR_POINT_OK;
use lahar_plugin::tensor::{contract, trace};
use lahar_plugin::testing::{Random, invariants, with};
use lahar_plugin::{Driver, ModelTable, elastic};

const E: f64 = 200.0e9;
const NU: f64 = 0.3;
const G: f64 = E / (2.0 * (1.0 + NU));
const YIELD: f64 = 250.0e6;
const LINEAR: &[(&str, f64)] = &[("hardening_modulus", 2.0e9)];
const VOCE: &[(&str, f64)] =
    &[("hardening_modulus", 1.0e9), ("voce_stress", 150.0e6), ("voce_rate", 25.0)];
const SOFTENING: &[(&str, f64)] =
    &[("voce_stress", -200.0e6), ("voce_rate", 40.0), ("residual_ratio", 0.3)];

fn try_driver(named: &[(&str, f64)], n: usize) -> Result<Driver, String> {
    let usual = [("youngs_modulus", E), ("poissons_ratio", NU), ("yield_stress", YIELD)];
    Driver::new(ModelTable::of::<VonMises>().desc(), &with(&usual, named), n)
}

fn driver(named: &[(&str, f64)], n: usize) -> Driver {
    try_driver(named, n).unwrap()
}

/// The formula of the model for a set of parameters, written anew.
fn yield_stress(named: &[(&str, f64)], kappa: f64) -> f64 {
    let of = |key: &str, otherwise: f64| {
        named.iter().find(|(name, _)| *name == key).map_or(otherwise, |(_, value)| *value)
    };
    let (h, q) = (of("hardening_modulus", 0.0), of("voce_stress", 0.0));
    let sigma_0 = of("yield_stress", YIELD);
    let curve = sigma_0 + h * kappa + q * (1.0 - (-of("voce_rate", 10.0) * kappa).exp());
    curve.max(of("residual_ratio", 0.0) * sigma_0)
}

fn equivalent(stress: [f64; 6]) -> f64 {
    invariants(stress).1
}

/// One step of uniaxial stress along x with the axial strain `axial`: Newton's method with the model's own tangent
/// for the lateral strain. Returns the number of steps that it took.
fn uniaxial(d: &mut Driver, axial: f64) -> usize {
    let mut lateral = 0.0;
    for step in 0..25 {
        d.set_strain_increment(0, [axial, lateral, lateral, 0.0, 0.0, 0.0]);
        d.update(1.0).unwrap();
        let stress = d.stress1(0);
        if stress[1].abs() < 1e-12 * YIELD * (E * axial / YIELD).abs().max(1.0) {
            assert_eq!(d.status_of(0), LAHAR_POINT_OK);
            d.commit();
            return step;
        }
        let c = d.tangent(0, 1.0).unwrap();
        lateral -= stress[1] / (c[1][1] + c[1][2]);
    }
    panic!("no lateral strain for {axial}: {:?}", d.stress1(0));
}

#[test]
fn uniaxial_stress_follows_the_hardening_curve() {
    for named in [LINEAR, VOCE, SOFTENING, &[]] {
        let mut d = driver(named, 1);
        let mut strain = 0.0;
        for kappa in [1e-4, 1e-3, 2e-3, 0.01, 0.03, 0.1, 0.3] {
            // With the stress along one axis ε = σ / E + κ, however the steps are chosen: they are radial.
            let stress = yield_stress(named, kappa);
            let end = stress / E + kappa;
            uniaxial(&mut d, end - strain);
            strain = end;
            assert!((d.stress0(0)[0] / stress - 1.0).abs() < 1e-9, "{named:?} {kappa}");
            assert!((d.state0(0, 0) / kappa - 1.0).abs() < 1e-9, "{named:?} {kappa}");
        }
        // Negative control: the curve of another modulus is missed.
        let other = yield_stress(&[("hardening_modulus", 3.0e9)], 0.3);
        assert!((d.stress0(0)[0] / other - 1.0).abs() > 0.1);
    }
}

#[test]
fn the_lateral_strain_is_found_in_a_few_steps_with_the_consistent_tangent() {
    for named in [LINEAR, VOCE] {
        let steps = uniaxial(&mut driver(named, 1), 0.05);
        assert!(steps <= 8, "{steps}");
    }
}

#[test]
fn pure_shear_yields_at_the_yield_stress_over_the_root_of_three() {
    let strength = YIELD / 3.0_f64.sqrt();
    let mut d = driver(&[], 1);
    d.set_strain_increment(0, [0.0, 0.0, 0.0, 0.999_999 * strength / (2.0 * G), 0.0, 0.0]);
    d.update(1.0).unwrap();
    assert!((d.stress1(0)[3] / strength - 0.999_999).abs() < 1e-12);
    assert_eq!(d.state1(0, 0), 0.0);
    d.set_strain_increment(0, [0.0, 0.0, 0.0, 1.5 * strength / (2.0 * G), 0.0, 0.0]);
    d.update(1.0).unwrap();
    assert!((d.stress1(0)[3] / strength - 1.0).abs() < 1e-12);
    // dκ = 2/√3 of the plastic tensor shear.
    let plastic = 0.5 * strength / (2.0 * G) * 2.0 / 3.0_f64.sqrt();
    assert!((d.state1(0, 0) / plastic - 1.0).abs() < 1e-12);
    // Negative control: the shear strength of Tresca, half the yield stress, is another one.
    assert!((d.stress1(0)[3] / (0.5 * YIELD) - 1.0).abs() > 0.15);
}

#[test]
fn radial_loading_is_exact_in_one_step_as_in_many() {
    let direction = [1.0, -0.7, -0.3, 0.4, -0.2, 0.6];
    for named in [LINEAR, VOCE, SOFTENING] {
        let run = |steps: usize| {
            let mut d = driver(named, 1);
            for _ in 0..steps {
                d.set_strain_increment(0, direction.map(|e| 0.02 * e / steps as f64));
                d.update(1.0).unwrap();
                d.commit();
            }
            (d.stress0(0), d.state0(0, 0))
        };
        let ((one, kappa), (many, kappa_many)) = (run(1), run(100));
        assert!((kappa_many / kappa - 1.0).abs() < 1e-11, "{kappa} {kappa_many}");
        assert!((0..6).all(|c| (one[c] - many[c]).abs() < 1e-11 * G * 0.02));
        // And it is the closed form: 2 G e - 3 G κ along the direction.
        let q = (1.5 * contract(direction, direction)).sqrt() * 2.0 * G * 0.02;
        let expected = yield_stress(named, kappa);
        assert!((equivalent(one) / expected - 1.0).abs() < 1e-12);
        assert!((q - 3.0 * G * kappa - expected).abs() < 1e-12 * q);
    }
}

#[test]
fn a_turn_of_the_path_needs_small_steps() {
    // Negative control of the test above: tension, then shear, is not radial, and one step of shear differs from many.
    let run = |steps: usize| {
        let mut d = driver(LINEAR, 1);
        d.set_strain_increment(0, [2e-3, -1e-3, -1e-3, 0.0, 0.0, 0.0]);
        d.update(1.0).unwrap();
        d.commit();
        for _ in 0..steps {
            d.set_strain_increment(0, [0.0, 0.0, 0.0, 2e-3 / steps as f64, 0.0, 0.0]);
            d.update(1.0).unwrap();
            d.commit();
        }
        d.stress0(0)[0]
    };
    let errors = [1, 10, 100].map(|steps| (run(steps) / run(10_000) - 1.0).abs());
    assert!(errors[0] > 0.05, "{errors:?}");
    // First order: a tenth of the error with a tenth of the step.
    assert!((errors[1] / errors[2] - 10.0).abs() < 1.5, "{errors:?}");
}

#[test]
fn unloading_is_elastic_and_reloading_yields_where_it_stopped() {
    let mut d = driver(VOCE, 1);
    uniaxial(&mut d, 0.02);
    let (stress, kappa) = (d.stress0(0)[0], d.state0(0, 0));
    uniaxial(&mut d, -1.5 * stress / E);
    assert!((d.stress0(0)[0] / (-0.5 * stress) - 1.0).abs() < 1e-10);
    assert_eq!(d.state0(0, 0), kappa);
    uniaxial(&mut d, 1.5 * stress / E * (1.0 - 1e-9));
    assert!((d.stress0(0)[0] / stress - 1.0).abs() < 1e-8);
    assert_eq!(d.state0(0, 0), kappa);
    // Isotropic hardening: compression yields at the same stress.
    uniaxial(&mut d, -2.1 * stress / E);
    assert!(d.state0(0, 0) > kappa && d.stress0(0)[0] < -0.999 * stress);
}

#[test]
fn a_step_below_yield_is_that_of_elasticity_and_no_step_changes_nothing() {
    let mut d = driver(VOCE, 2);
    let start = [1e7, -3e7, 2e7, 4e7, -1e7, 5e6];
    let strain = [1e-5, 2e-5, -4e-5, 3e-5, 1e-5, -2e-5];
    for k in 0..2 {
        d.set_stress(k, start);
        d.set_state(k, 0, 0.01);
    }
    d.set_strain_increment(0, strain);
    d.update(1.0).unwrap();
    let c = elastic::stiffness(elastic::lame(E, NU).unwrap());
    for i in 0..6 {
        let expected = start[i] + (0..6).map(|j| c[i][j] * strain[j]).sum::<f64>();
        assert!((d.stress1(0)[i] - expected).abs() < 1e-13 * 1e8);
    }
    assert_eq!(d.stress1(1), start);
    assert_eq!((d.state1(0, 0), d.state1(1, 0)), (0.01, 0.01));
}

#[test]
fn pressure_never_yields() {
    let mut d = driver(&[], 1);
    d.set_strain_increment(0, [-0.1, -0.1, -0.1, 0.01, 0.0, 0.0]);
    d.update(1.0).unwrap();
    let bulk = E / (3.0 * (1.0 - 2.0 * NU));
    assert!((trace(d.stress1(0)) / 3.0 / (-0.3 * bulk) - 1.0).abs() < 1e-14);
    assert!((d.stress1(0)[3] / (YIELD / 3.0_f64.sqrt()) - 1.0).abs() < 1e-12);
}

/// Random parameters with all kinds of hardening, the softening ones included.
fn random_parameters(random: &mut Random) -> Vec<(&'static str, f64)> {
    let e = 10.0_f64.powf(random.between(4.0, 12.0));
    let nu = random.between(-0.2, 0.49);
    let three_g = 1.5 * e / (1.0 + nu);
    let sigma_0 = three_g * 10.0_f64.powf(random.between(-4.0, -1.0));
    let rate = 10.0_f64.powf(random.between(-1.0, 3.0));
    let (linear, voce) = (random.between(-0.4, 1.0), random.between(-0.4, 2.0));
    vec![
        ("youngs_modulus", e),
        ("poissons_ratio", nu),
        ("yield_stress", sigma_0),
        ("hardening_modulus", linear * three_g),
        ("voce_stress", if random.unit() < 0.3 { 0.0 } else { voce * three_g / rate }),
        ("voce_rate", rate),
        ("residual_ratio", random.unit()),
    ]
}

#[test]
fn every_step_ends_on_the_yield_stress_with_the_flow_of_the_trial() {
    let mut random = Random::new(7);
    let mut plastic = 0;
    for _ in 0..300 {
        let named = random_parameters(&mut random);
        let (e, nu, sigma_0) = (named[0].1, named[1].1, named[2].1);
        let g = e / (2.0 * (1.0 + nu));
        let mut d = driver(&named, 8);
        for _ in 0..40 {
            for k in 0..8 {
                let size = sigma_0 / g * 10.0_f64.powf(random.between(-2.0, 1.0));
                d.set_strain_increment(k, random.symmetric(size));
            }
            let start: Vec<[f64; 6]> = (0..8).map(|k| d.stress0(k)).collect();
            d.update(1.0).unwrap();
            for k in 0..8 {
                assert_eq!(d.status_of(k), LAHAR_POINT_OK);
                let (q, kappa) = (equivalent(d.stress1(k)), d.state1(k, 0));
                let bound = yield_stress(&named, kappa);
                let growth = kappa - d.state0(k, 0);
                assert!(growth >= 0.0 && q <= bound * (1.0 + 1e-9), "{named:?}: {q} {bound}");
                if growth > 0.0 {
                    plastic += 1;
                    // Round-off of the mean stress, which the deviator is taken from.
                    let large = trace(d.stress1(k)).abs().max(trace(start[k]).abs());
                    assert!((q - bound).abs() <= 1e-9 * bound + 1e-14 * large, "{named:?}");
                }
            }
            d.commit();
        }
    }
    assert!(plastic > 20_000, "{plastic}");
}

#[test]
fn the_plastic_strain_is_what_the_stress_lacks_of_the_trial() {
    let mut random = Random::new(11);
    for _ in 0..2000 {
        let named = random_parameters(&mut random);
        let (e, nu, sigma_0) = (named[0].1, named[1].1, named[2].1);
        let g = e / (2.0 * (1.0 + nu));
        let mut d = driver(&named, 1);
        let strain = random.symmetric(5.0 * sigma_0 / g);
        d.set_state(0, 0, random.between(0.0, 0.1));
        d.set_strain_increment(0, strain);
        d.update(1.0).unwrap();
        let trial = 2.0 * g * equivalent(strain);
        let lacks = trial - equivalent(d.stress1(0));
        let growth = d.state1(0, 0) - d.state0(0, 0);
        assert!((lacks - 3.0 * g * growth).abs() < 1e-9 * trial, "{named:?}");
    }
}

/// Largest difference of the tangent of point 0 from central differences of the stress, over the largest component.
fn tangent_error(d: &mut Driver, strain: [f64; 6], size: f64) -> f64 {
    let found = d.compare_tangent(0, strain, size, 1.0).unwrap();
    found.error() / found.size()
}

#[test]
fn tangents_are_the_differences_of_the_stress() {
    let mut random = Random::new(3);
    for named in [&[], LINEAR, VOCE, SOFTENING] {
        for _ in 0..50 {
            let mut d = driver(named, 1);
            d.set_stress(0, random.symmetric(1e8));
            d.set_state(0, 0, random.between(0.0, 0.05));
            for size in [1e-4, 5e-3] {
                // Differences of second order: (1e-5 of the strain)², and round-off over it.
                let error = tangent_error(&mut d, random.symmetric(size), 1e-5 * size);
                assert!(error < 1e-7, "{named:?}, strain {size}: {error:e}");
            }
        }
    }
}

#[test]
fn the_tangent_of_the_continuum_is_not_that_of_a_step() {
    // Negative control of the test above: θ = 1 leaves the 2 G of the continuum across the direction of flow.
    let mut d = driver(LINEAR, 1);
    d.set_strain_increment(0, [0.0, 0.0, 0.0, 5e-3, 0.0, 0.0]);
    let tangent = d.tangent(0, 1.0).unwrap();
    d.update(1.0).unwrap();
    let ratio = equivalent(d.stress1(0)) / (2.0 * G * 5e-3 * 3.0_f64.sqrt());
    assert!((tangent[4][4] / (2.0 * G * ratio) - 1.0).abs() < 1e-12 && ratio < 0.3);
}

#[test]
fn softening_ends_at_the_residual_stress() {
    for named in [
        SOFTENING,
        &[("hardening_modulus", -5.0e9), ("residual_ratio", 0.3)],
        &[("hardening_modulus", -1.0e11), ("residual_ratio", 0.0)],
    ] {
        let mut d = driver(named, 1);
        for _ in 0..20 {
            d.set_strain_increment(0, [0.0, 0.0, 0.0, 5e-3, 0.0, 0.0]);
            d.update(1.0).unwrap();
            d.commit();
        }
        let floor = named.iter().find(|(name, _)| *name == "residual_ratio").unwrap().1 * YIELD;
        let expected = yield_stress(named, d.state0(0, 0));
        assert!((equivalent(d.stress0(0)) - expected).abs() < 1e-9 * YIELD, "{named:?}");
        assert!(expected - floor < 1e-3 * YIELD, "{named:?}");
    }
}

#[test]
fn softening_that_the_elastic_stiffness_cannot_follow_is_refused() {
    let refused = |named: &[(&str, f64)]| try_driver(named, 1).err().unwrap();
    assert!(refused(&[("hardening_modulus", -2.8 * G)]).contains("give a slower softening"));
    let voce = [("voce_stress", -2.8 * G), ("voce_rate", 1.0)];
    assert!(refused(&voce).contains("give a slower softening"));
    assert!(refused(&[("hardening_modulus", f64::NAN)]).contains("give a slower softening"));
    for good in [&[("hardening_modulus", -2.6 * G)], &[("voce_stress", 1e3 * G)]] {
        assert!(try_driver(good, 1).is_ok());
    }
    assert!(refused(&[("youngs_modulus", 1e308), ("poissons_ratio", 0.4999)]).contains("finite"));
}

#[test]
fn stored_energy_is_that_of_the_elastic_strain() {
    let mut d = driver(LINEAR, 1);
    uniaxial(&mut d, 0.01);
    let stress = d.stress0(0)[0];
    assert!((d.stored_energy(0).unwrap() / (0.5 * stress * stress / E) - 1.0).abs() < 1e-9);
}

#[test]
fn wave_speed_is_elastic() {
    let mut d = driver(LINEAR, 1);
    d.set_input(0, 0, 7800.0);
    let expected = (E * (1.0 - NU) / ((1.0 + NU) * (1.0 - 2.0 * NU)) / 7800.0).sqrt();
    d.wave_speed().unwrap();
    assert!((d.wave_speed_of(0) / expected - 1.0).abs() < 1e-14);
    d.set_strain_increment(0, [0.0, 0.0, 0.0, 5e-3, 0.0, 0.0]);
    d.update(1.0).unwrap();
    assert!((d.wave_speed_of(0) / expected - 1.0).abs() < 1e-14);
}

#[test]
fn a_point_that_is_not_a_number_or_huge_fails_alone() {
    for named in [LINEAR, VOCE, SOFTENING] {
        let mut d = driver(named, 9);
        for k in 0..9 {
            d.set_strain_increment(k, [0.0, 0.0, 0.0, 5e-3, 0.0, 0.0]);
        }
        d.set_strain_increment(1, [f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0]);
        d.set_strain_increment(2, [0.0, 0.0, 0.0, f64::INFINITY, 0.0, 0.0]);
        d.set_strain_increment(3, [0.0, 0.0, 1e290, 1e300, 0.0, 0.0]);
        d.set_stress(4, [0.0, 0.0, f64::NAN, 0.0, 0.0, 0.0]);
        d.set_stress(5, [0.0, 1e200, 0.0, 0.0, 0.0, 0.0]);
        d.set_state(6, 0, f64::NAN);
        d.set_input(0, 7, 0.0);
        d.update(1.0).unwrap();
        assert_eq!(d.failed_points().unwrap(), (1..8).collect::<Vec<_>>(), "{named:?}");
    }
}

#[test]
fn a_batch_gives_the_bits_of_single_points() {
    let mut random = Random::new(5);
    for named in [LINEAR, VOCE] {
        let mut d = driver(named, 21);
        let points: Vec<_> =
            (0..21).map(|_| (random.symmetric(3e8), random.symmetric(4e-3))).collect();
        for (k, (stress, strain)) in points.iter().enumerate() {
            d.set_stress(k, *stress);
            d.set_strain_increment(k, *strain);
        }
        d.update(1.0).unwrap();
        for (k, (stress, strain)) in points.iter().enumerate() {
            let mut single = driver(named, 1);
            single.set_stress(0, *stress);
            single.set_strain_increment(0, *strain);
            single.update(1.0).unwrap();
            assert_eq!(single.stress1(0), d.stress1(k));
            assert_eq!(single.state1(0, 0), d.state1(k, 0));
        }
    }
}
