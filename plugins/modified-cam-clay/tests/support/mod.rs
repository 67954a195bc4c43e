//! Drivers and measures that the element tests share.
#![allow(dead_code)]

use lahar_model_modified_cam_clay::ModifiedCamClay;
use lahar_plugin::abi::{LAHAR_POINT_FAILED, LAHAR_POINT_OK};
pub use lahar_plugin::testing::invariants;
use lahar_plugin::testing::with;
use lahar_plugin::{Driver, ModelTable};

/// Slope of the critical state line of the tests [-].
pub const M: f64 = 1.2;

/// λ = 0.2, κ = 0.04, M = 1.2; other values as named.
pub fn try_driver(named: &[(&str, f64)], n: usize) -> Result<Driver, String> {
    let usual = [
        ("critical_stress_ratio", M),
        ("compression_index", 0.2),
        ("swelling_index", 0.04),
        ("poissons_ratio", 0.3),
        ("reference_void_ratio", 2.0),
    ];
    Driver::new(ModelTable::of::<ModifiedCamClay>().desc(), &with(&usual, named), n)
}

/// The same.
pub fn driver(named: &[(&str, f64)], n: usize) -> Driver {
    try_driver(named, n).unwrap()
}

/// Points under the isotropic pressure `p0` [Pa].
pub fn consolidated(named: &[(&str, f64)], p0: f64, n: usize) -> Driver {
    let mut d = driver(named, n);
    for k in 0..n {
        d.set_stress(k, [-p0, -p0, -p0, 0.0, 0.0, 0.0]);
    }
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

/// One step with an axial strain along z and the lateral stress kept, by Newton's method with the model's tangent.
pub fn confined_step(d: &mut Driver, axial: f64, confinement: f64) {
    let mut lateral = -0.3 * axial;
    for _ in 0..30 {
        d.set_strain_increment(0, [lateral, lateral, axial, 0.0, 0.0, 0.0]);
        d.update(1.0).unwrap();
        assert_eq!(d.status_of(0), LAHAR_POINT_OK);
        let residual = d.stress1(0)[0] + confinement;
        if residual.abs() < 1e-10 * confinement {
            d.commit();
            return;
        }
        let tangent = d.tangent(0, 1.0).unwrap();
        lateral -= residual / (tangent[0][0] + tangent[0][1]);
    }
    panic!("the lateral stress is not reached");
}
