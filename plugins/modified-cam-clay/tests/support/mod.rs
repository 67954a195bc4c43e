//! Drivers and measures that the element tests share.
#![allow(dead_code)]

use lahar_model_modified_cam_clay::ModifiedCamClay;
use lahar_plugin::abi::LAHAR_POINT_FAILED;
pub use lahar_plugin::testing::invariants;
use lahar_plugin::testing::with;
use lahar_plugin::{Driver, ModelTable};

/// Slope of the critical state line of the tests [-].
pub const M: f64 = 1.2;

/// λ = 0.2, κ = 0.04, M = 1.2, e_N at 1 kPa, which is p_min too; other values as named.
pub fn try_driver(named: &[(&str, f64)], n: usize) -> Result<Driver, String> {
    let usual = [
        ("critical_stress_ratio", M),
        ("compression_index", 0.2),
        ("swelling_index", 0.04),
        ("poissons_ratio", 0.3),
        ("reference_void_ratio", 2.0),
        ("reference_pressure", 1e3),
        ("minimum_pressure", 1e3),
    ];
    Driver::new(ModelTable::of::<ModifiedCamClay>().desc(), &with(&usual, named), n)
}

/// The same.
pub fn driver(named: &[(&str, f64)], n: usize) -> Driver {
    try_driver(named, n).unwrap()
}

/// Points under the isotropic pressure `p0` [Pa].
pub fn consolidated(named: &[(&str, f64)], p0: f64, n: usize) -> Driver {
    let mut d = driver(named, n).confined(p0);
    d.init_state().unwrap();
    d
}

/// The yield function over p_c².
pub fn yield_residual(stress: [f64; 6], preconsolidation: f64, slope: f64) -> f64 {
    let (p, q) = invariants(stress);
    ((q / slope).powi(2) + p * (p - preconsolidation)) / (preconsolidation * preconsolidation)
}

/// One step of point 0, which must succeed.
pub fn one_step(d: &mut Driver, strain: [f64; 6]) {
    d.set_strain_increment(0, strain);
    d.update(1.0).unwrap();
    assert_ne!(d.status_of(0), LAHAR_POINT_FAILED);
    d.commit();
}

/// One step of a triaxial test of point 0 with the model's tangent, which must succeed.
pub fn confined_step(d: &mut Driver, axial: f64, confinement: f64) {
    d.triaxial_step_by_tangent(0, axial, confinement).unwrap();
}
