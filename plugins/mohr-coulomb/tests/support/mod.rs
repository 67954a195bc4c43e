//! What the tests of the model share.
#![allow(dead_code)] // each test uses a part

use lahar_model_mohr_coulomb::MohrCoulomb;
use lahar_plugin::radial::Trial;
use lahar_plugin::testing::with;
use lahar_plugin::{Driver, ModelTable};

pub const E: f64 = 20.0e6;
pub const NU: f64 = 0.3;
pub const BULK: f64 = E / (3.0 * (1.0 - 2.0 * NU));
pub const SHEAR: f64 = E / (2.0 * (1.0 + NU));

pub fn try_driver(named: &[(&str, f64)], n: usize) -> Result<Driver, String> {
    let usual = [
        ("youngs_modulus", E),
        ("poissons_ratio", NU),
        ("friction_angle", 30.0),
        ("cohesion", 10.0e3),
    ];
    Driver::new(ModelTable::of::<MohrCoulomb>().desc(), &with(&usual, named), n)
}

pub fn driver(named: &[(&str, f64)], n: usize) -> Driver {
    try_driver(named, n).unwrap()
}

/// The elastic trial stress.
pub fn trial(stress: [f64; 6], strain: [f64; 6]) -> [f64; 6] {
    Trial::new([BULK - 2.0 / 3.0 * SHEAR, SHEAR], stress, strain).stress
}
