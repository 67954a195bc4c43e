//! What the tests of the model share.
#![allow(dead_code)] // each test uses a part

use lahar_model_matsuoka_nakai::MatsuokaNakai;
use lahar_plugin::nalgebra::{Matrix3, SymmetricEigen};
use lahar_plugin::tensor::to_matrix;
use lahar_plugin::{Driver, ModelTable};

pub const E: f64 = 20.0e6;
pub const NU: f64 = 0.3;
pub const BULK: f64 = E / (3.0 * (1.0 - 2.0 * NU));
pub const SHEAR: f64 = E / (2.0 * (1.0 + NU));

pub fn try_driver(named: &[(&str, f64)], n: usize) -> Result<Driver, String> {
    let mut all = vec![
        ("youngs_modulus", E),
        ("poissons_ratio", NU),
        ("friction_angle", 30.0),
        ("cohesion", 10.0e3),
    ];
    for (name, value) in named {
        all.retain(|(known, _)| known != name);
        all.push((name, *value));
    }
    Driver::new(ModelTable::of::<MatsuokaNakai>().desc(), &all, n)
}

pub fn driver(named: &[(&str, f64)], n: usize) -> Driver {
    try_driver(named, n).unwrap()
}

/// A linear congruential generator.
pub struct Random(pub u64);

impl Random {
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        low + (high - low) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }

    pub fn strain(&mut self, size: f64) -> [f64; 6] {
        std::array::from_fn(|_| self.between(-size, size))
    }
}

/// Eigenvalues, the largest first, and eigenvectors in columns, by an algorithm other than the model's.
pub fn axes_of(stress: [f64; 6]) -> ([f64; 3], Matrix3<f64>) {
    let eigen = SymmetricEigen::new(to_matrix(stress));
    let mut order = [0, 1, 2];
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    let axes = Matrix3::from_columns(&order.map(|i| eigen.eigenvectors.column(i).into_owned()));
    (order.map(|i| eigen.eigenvalues[i]), axes)
}

/// The elastic trial stress.
pub fn trial(stress: [f64; 6], strain: [f64; 6]) -> [f64; 6] {
    let volumetric = (BULK - 2.0 / 3.0 * SHEAR) * (strain[0] + strain[1] + strain[2]);
    std::array::from_fn(|c| {
        stress[c] + 2.0 * SHEAR * strain[c] + if c < 3 { volumetric } else { 0.0 }
    })
}
