//! Element tests of water through the plugin table.
#![forbid(unsafe_code)]

use lahar_model_newtonian::TaitWater;
use lahar_plugin::{Driver, ModelTable};

const K: f64 = 2.2e9;
const GAMMA: f64 = 7.0;
/// 0.9 MPa of tension, as degassed water bears it.
const CAVITATION: f64 = -0.9e6;

fn driver(named: &[(&str, f64)]) -> Driver {
    Driver::typical(ModelTable::of::<TaitWater>().desc(), named, 1).unwrap()
}

fn stretch(d: &mut Driver, e: f64) -> f64 {
    d.set_strain_increment(0, [e / 3.0, e / 3.0, e / 3.0, 0.0, 0.0, 0.0]);
    d.update(1e-3).unwrap();
    d.commit();
    pressure(d.stress0(0))
}

fn pressure(stress: [f64; 6]) -> f64 {
    -(stress[0] + stress[1] + stress[2]) / 3.0
}

fn tait(j: f64) -> f64 {
    K / GAMMA * (j.powf(-GAMMA) - 1.0)
}

#[test]
fn the_liquid_follows_tait_above_its_cavitation_pressure() {
    for background in [0.0, 101_325.0] {
        let mut d = driver(&[("background_pressure", background)]);
        let mut total: f64 = 0.0;
        for e in [-0.01, -0.02, 0.01, 0.015, 0.005, 2e-5] {
            total += e;
            let expected = background + tait(total.exp());
            let p = stretch(&mut d, e);
            assert!((p - expected).abs() < 1e-13 * K, "{p} {expected}");
        }
        assert!(total > 0.0, "the last states bear tension");
    }
}

#[test]
fn a_void_collapses_when_the_volume_has_returned() {
    let mut d = driver(&[("cavitation_pressure", CAVITATION)]);
    // The volume ratio at which it opens.
    let open = (1.0 + GAMMA * CAVITATION / K).powf(-1.0 / GAMMA);
    let mut j: f64 = 1.0;
    let (mut opened, mut closed) = (0, 0);
    for cycle in 0..50 {
        for e in [3e-4, 4e-4, 0.02, 0.3, -0.3, -0.02, -4e-4, -5e-4, 2e-4] {
            let p = stretch(&mut d, e);
            j *= e.exp();
            let expected = tait(j).max(CAVITATION);
            // The volume ratio is known to round-off of as many products.
            assert!((p - expected).abs() < 1e-12 * K, "cycle {cycle}: {p} {expected}");
            assert_eq!(j > open, p == CAVITATION, "cycle {cycle}");
            opened += i32::from(j > open);
            closed += i32::from(j < open);
        }
    }
    assert!(opened > 100 && closed > 100);
    // No volume was made: the state has the whole motion.
    assert!((d.state0(0, 0) / j - 1.0).abs() < 1e-13);
}

#[test]
fn without_cavitation_the_same_motion_would_tear_at_the_liquid() {
    // Negative control.
    let mut d = driver(&[("cavitation_pressure", -1.0e8)]);
    assert!(stretch(&mut d, 3e-3) < 5.0 * CAVITATION);
}

#[test]
fn a_start_stress_gives_the_volume_that_belongs_to_it() {
    for p in [-50.0e3, 0.0, 101_325.0, 50.0e6] {
        let mut d = driver(&[("background_pressure", 101_325.0)]);
        d.set_stress(0, [-p, -p, -p, 0.0, 0.0, 0.0]);
        d.init_state().unwrap();
        assert!((stretch(&mut d, 0.0) - p).abs() < 1e-15 * K, "{p}");
    }
    let mut d = driver(&[]);
    d.set_stress(0, [1e9, 1e9, 1e9, 0.0, 0.0, 0.0]);
    assert!(d.init_state().unwrap_err().contains("never reaches"));
}

#[test]
fn the_sound_speed_is_that_of_water_and_the_shear_stress_that_of_its_viscosity() {
    let mut d = driver(&[("viscosity", 2.0)]);
    d.set_input(0, 0, 998.0);
    d.set_strain_increment(0, [0.0, 0.0, 0.0, 1e-3, 0.0, 0.0]);
    d.update(1e-3).unwrap();
    assert!((d.wave_speed_of(0) / (K / 998.0).sqrt() - 1.0).abs() < 1e-14);
    assert!((d.stress1(0)[3] - 4.0).abs() < 1e-14);
    assert!((d.diffusivity_of(0) - 4.0 / 3.0 * 2.0 / 998.0).abs() < 1e-17);
    d.wave_speed().unwrap();
    assert!((d.wave_speed_of(0) / (K / 998.0).sqrt() - 1.0).abs() < 1e-14);
}

#[test]
fn a_cavitation_pressure_above_that_of_the_liquid_is_refused() {
    let table = ModelTable::of::<TaitWater>();
    let named = [("cavitation_pressure", 2339.0)];
    let error = Driver::typical(table.desc(), &named, 1).err().unwrap();
    assert!(error.contains("must not exceed background_pressure"), "{error}");
    let both = [named[0], ("background_pressure", 101_325.0)];
    assert!(Driver::typical(table.desc(), &both, 1).is_ok());
}
