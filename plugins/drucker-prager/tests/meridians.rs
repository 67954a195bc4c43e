//! Both meridians of every cone for random parameters, and the tangent against differences.
#![forbid(unsafe_code)]

use lahar_model_drucker_prager::DruckerPrager;
use lahar_plugin::elastic::{energy, lame};
use lahar_plugin::tensor::{contract, deviator, trace};
use lahar_plugin::testing::Random;
use lahar_plugin::{Driver, ModelTable};

fn driver(named: &[(&str, f64)]) -> Driver {
    Driver::new(ModelTable::of::<DruckerPrager>().desc(), named, 1).unwrap()
}

/// Slope and strength of the cones in the order of the parameter's choices, written down apart from the model.
fn cone(kind: usize, phi: f64, cohesion: f64, psi: f64) -> [f64; 2] {
    let (sin, cos) = phi.to_radians().sin_cos();
    let d = psi.to_radians().sin();
    let factor = match kind {
        0 => 6.0 / (3.0 - sin),
        1 => 6.0 / (3.0 + sin),
        _ => 3.0 * (3.0 + d * d).sqrt() / (3.0 + sin * d),
    };
    [factor * sin, factor * cohesion * cos]
}

#[test]
fn both_meridians_of_every_cone_are_met_for_random_parameters() {
    let mut random = Random::new(3);
    for kind in 0..3 {
        let (mut compressed, mut extended) = (0, 0);
        for n in 0..60 {
            let young = 10f64.powf(random.between(6.0, 9.0));
            let (phi, cohesion) = (random.between(1.0, 45.0), random.between(0.0, 20e3));
            let psi = random.between(0.0, 1.0) * phi;
            let confinement = random.between(10e3, 500e3);
            let [m, k] = cone(kind, phi, cohesion, psi);
            let named = [
                ("youngs_modulus", young),
                ("poissons_ratio", random.between(0.0, 0.45)),
                ("friction_angle", phi),
                ("cohesion", cohesion),
                ("dilation_angle", psi),
                ("cone", kind as f64),
                ("tension_cutoff", cohesion / phi.to_radians().tan()),
            ];
            // q = (M σ3 + k) / (1 - M / 3) in compression, if the slope of the path is not that of the cone; / (1 + M / 3) in
            // extension.
            for (sign, denominator) in [(-1.0, 1.0 - m / 3.0), (1.0, 1.0 + m / 3.0)] {
                if denominator < 0.2 {
                    continue;
                }
                let expected = (m * confinement + k) / denominator;
                let mut d = driver(&named);
                d.set_stress(0, [-confinement, -confinement, -confinement, 0.0, 0.0, 0.0]);
                for _ in 0..16 {
                    let axial = sign * 0.13 * expected / young;
                    d.triaxial_step(0, axial, -confinement, 1.0).unwrap();
                }
                let stress = d.stress0(0);
                let q = (stress[0] - stress[2]) * -sign;
                let error = (q - expected).abs() / expected.max(confinement);
                assert!(error < 1e-8, "{n}: {named:?}: {q} instead of {expected}");
                let s = deviator(stress);
                let residual = (1.5 * contract(s, s)).sqrt() + m * trace(stress) / 3.0 - k;
                assert!(residual.abs() < 1e-9 * expected.max(confinement), "{residual}");
                compressed += i32::from(sign < 0.0);
                extended += i32::from(sign > 0.0);
            }
        }
        assert!(compressed > 40 && extended == 60, "{compressed} {extended}");
    }
}

#[test]
fn tangents_are_those_of_differences_elastic_plastic_opened_and_closing() {
    let (young, mut random) = (20e6, Random::new(9));
    let mut seen = [0; 4];
    for n in 0..3000 {
        let (phi, cohesion) = (random.between(0.0, 45.0), random.between(0.0, 20e3));
        let cutoff = (cohesion / phi.to_radians().tan()).min(1e5) * random.between(0.0, 1.0);
        let mut d = driver(&[
            ("youngs_modulus", young),
            ("poissons_ratio", 0.3),
            ("friction_angle", phi),
            ("cohesion", cohesion),
            ("dilation_angle", random.between(0.0, 1.0) * phi),
            ("cone", f64::from(n % 3)),
            ("tension_cutoff", cutoff),
        ]);
        let size = 10f64.powf(random.between(-4.0, -2.0));
        let mean = random.between(-1.0, 0.5) * size;
        let strain: [f64; 6] =
            std::array::from_fn(|c| random.between(-size, size) + if c < 3 { mean } else { 0.0 });
        let p = random.between(0.0, 50e3);
        let opened = n % 4 == 0;
        if opened {
            d.set_state(0, 1, random.between(0.1, 2.0) * size);
        } else {
            d.set_stress(0, [-p, -p, -p, 0.0, 0.0, 0.0]);
        }
        let found = d.compare_tangent(0, strain, 1e-5 * size, 1.0).unwrap();
        let kind = match (opened, d.state1(0, 1) != 0.0) {
            (_, true) => 2,
            (true, false) => 3,
            (false, false) => usize::from(d.state1(0, 0) > 0.0),
        };
        if found.bend() <= 1e-3 * young {
            let worst = found.error() / young;
            seen[kind] += 1;
            assert!(worst < 1e-6, "{n}: {worst} in state {kind}");
            assert!(kind != 2 || found.tangent == [[0.0; 6]; 6]);
        }
    }
    assert!(seen.iter().all(|n| *n > 100), "{seen:?}");
}

#[test]
fn stored_energy_is_elastic() {
    let named = [("youngs_modulus", 2e7), ("poissons_ratio", 0.3), ("friction_angle", 30.0)];
    let mut d = Driver::typical(ModelTable::of::<DruckerPrager>().desc(), &named, 1).unwrap();
    let stress = [-1e4, -2e4, -5e3, 1e3, 2e3, -1e3];
    d.set_stress(0, stress);
    let expected = energy(lame(2e7, 0.3).unwrap(), stress);
    assert!((d.stored_energy(0).unwrap() / expected - 1.0).abs() < 1e-12);
}
