//! Drivers and measures that the element tests share.
#![allow(dead_code)]

use lahar_model_nor_sand::NorSand;
use lahar_plugin::abi::LAHAR_POINT_OK;
use lahar_plugin::tensor::deviator;
pub use lahar_plugin::testing::invariants;
use lahar_plugin::testing::with;
use lahar_plugin::{Driver, ModelTable};

/// Constants of the tests.
pub const M: f64 = 1.25;
pub const GAMMA: f64 = 0.9;
pub const LAMBDA: f64 = 0.03;
pub const N: f64 = 0.3;
pub const CHI: f64 = 3.5;
pub const H: f64 = 150.0;

/// The typical sand; other values as named.
pub fn try_driver(named: &[(&str, f64)], n: usize) -> Result<Driver, String> {
    let usual = [
        ("critical_stress_ratio", M),
        ("critical_void_ratio", GAMMA),
        ("critical_state_slope", LAMBDA),
        ("volumetric_coupling", N),
        ("dilatancy_slope", CHI),
        ("hardening_modulus", H),
    ];
    Driver::typical(ModelTable::of::<NorSand>().desc(), &with(&usual, named), n)
}

/// The same.
pub fn driver(named: &[(&str, f64)], n: usize) -> Driver {
    try_driver(named, n).unwrap()
}

/// Points under the isotropic pressure `p0` [Pa] with the state parameter `psi`.
pub fn consolidated(named: &[(&str, f64)], p0: f64, psi: f64, n: usize) -> Driver {
    let mut all = vec![("initial_state_parameter", psi)];
    all.extend(named);
    let mut d = driver(&all, n).confined(p0);
    d.init_state().unwrap();
    d
}

/// Void ratio of the critical state.
pub fn critical_void_ratio(p: f64) -> f64 {
    GAMMA - LAMBDA * (p / 1e3).ln()
}

/// The state parameter at the image pressure.
pub fn state_parameter(d: &Driver) -> f64 {
    d.state0(0, 0) - critical_void_ratio(d.state0(0, 1))
}

/// Stress ratio of the critical state at the Lode angle of a stress, after Sheng, Sloan and Yu.
pub fn critical_ratio(stress: [f64; 6]) -> f64 {
    let [xx, yy, zz, xy, yz, zx] = deviator(stress);
    let (_, q) = invariants(stress);
    let determinant =
        xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * zx) + zx * (xy * yz - yy * zx);
    let sine = if q > 0.0 { -13.5 * determinant / q.powi(3) } else { 1.0 };
    let a = (3.0 / (3.0 + M)).powi(4);
    M * (2.0 * a / (1.0 + a - (1.0 - a) * sine)).powf(0.25)
}

/// M_i of the end of the last update.
pub fn image_ratio(stress: [f64; 6], void_ratio: f64, image_pressure: f64) -> f64 {
    let psi = void_ratio - critical_void_ratio(image_pressure);
    critical_ratio(stress) * (1.0 - N * CHI * psi.abs() / M).max(0.5)
}

/// The yield function over the image pressure.
pub fn yield_residual(stress: [f64; 6], void_ratio: f64, image_pressure: f64) -> f64 {
    let (p, q) = invariants(stress);
    if p <= 0.0 {
        return q / image_pressure;
    }
    let mi = image_ratio(stress, void_ratio, image_pressure);
    (q - mi * p * (1.0 - (p / image_pressure).ln())) / image_pressure
}

/// One step of point 0, which must succeed.
pub fn one_step(d: &mut Driver, strain: [f64; 6]) {
    d.set_strain_increment(0, strain);
    d.update(1.0).unwrap();
    assert_eq!(d.status_of(0), LAHAR_POINT_OK);
    d.commit();
}

/// One step of a triaxial test of point 0 with the model's tangent, which must succeed. Returns
/// the strain.
pub fn confined_step(d: &mut Driver, axial: f64, confinement: f64) -> [f64; 6] {
    d.triaxial_step_by_tangent(0, axial, confinement).unwrap()
}
