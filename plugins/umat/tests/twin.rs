//! The von Mises UMAT of `tests/fortran` and the plugin of the same law give equal results.

mod support;

use lahar_plugin::{Driver, ModelTable};
use lahar_plugin_abi::LAHAR_POINT_OK;
use support::{Material, Numbers, adapt, close, library};

#[test]
fn the_von_mises_umat_and_the_plugin_give_equal_results() {
    let sidecar = r#"{"states": [{"key": "equivalent_plastic_strain"}], "parameters": 4}"#;
    let model = adapt(&library("von_mises.f90", Some(sidecar))).expect("a model");
    let (constants, n) = ([2e11, 0.3, 2.5e8, 1e9], 64);
    let names = ["youngs_modulus", "poissons_ratio", "yield_stress", "hardening_modulus"];
    let named: Vec<_> = names.into_iter().zip(constants).collect();
    let table = ModelTable::of::<lahar_model_von_mises::VonMises>();
    let mut plugin = Driver::new(table.desc(), &named, n).expect("the plugin");
    let mut umat = Material::new(model, &constants, n).expect("the UMAT");
    let mut numbers = Numbers(11);
    let mut yielded = 0;
    for _ in 0..40 {
        for k in 0..n {
            let strain @ [xx, yy, zz, xy, yz, zx] = numbers.array(6e-4);
            umat.set_gradient(k, [xx, xy, zx, xy, yy, yz, zx, yz, zz]);
            plugin.set_strain_increment(k, strain);
        }
        umat.update().expect("the UMAT");
        plugin.update(1.0).expect("the plugin");
        for k in 0..n {
            let (a, b) = (umat.stress1(k), plugin.stress1(k));
            assert!(close(&a, &b, 1e-12), "{a:?} {b:?}");
            let (a, b) = (umat.state1::<1>(k, 0)[0], plugin.state1(k, 0));
            assert!((a - b).abs() <= 1e-12 * b.abs(), "{a} {b}");
            assert_eq!((umat.status[k], plugin.status_of(k)), (LAHAR_POINT_OK, LAHAR_POINT_OK));
            yielded += u32::from(b > plugin.state0(k, 0));
        }
        umat.commit();
        plugin.commit();
    }
    assert!((500..2500).contains(&yielded), "{yielded} of 2560 steps yield");
}
