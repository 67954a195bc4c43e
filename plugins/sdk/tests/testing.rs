//! The tools for tests find what is wrong with a model that has every fault.
#![forbid(unsafe_code)]

use lahar_plugin::elastic::stiffness;
use lahar_plugin::nalgebra::Matrix3;
use lahar_plugin::tensor::to_matrix;
use lahar_plugin::testing::principal_axes;
use lahar_plugin::{
    Batch, Driver, Kinematics, Model, ModelTable, Output, Parameter, PointStatus, State,
};
use std::ffi::CStr;

const SHEAR: f64 = 1.0e6;
const STRENGTH: f64 = 1.0e3;

/// Components that are elastic up to a strength, with a tangent that is elastic always. Fails strains beyond 1 alone, and counts its
/// steps.
struct Faulty;

impl Model for Faulty {
    const NAME: &'static CStr = c"faulty";
    const SUMMARY: &'static CStr = c"A model for tests";
    const REFERENCE: &'static CStr = c"";
    const KINEMATICS: Kinematics = Kinematics::StrainIncrement;
    const PARAMETERS: &'static [Parameter] = &[];
    const STATES: &'static [State] = &[State::scalar(c"steps", c"-", c"")];
    const OUTPUTS: Output = Output::WAVE_SPEED.and(Output::STATUS);
    const HAS_TANGENT: bool = true;

    fn new(_values: &[f64]) -> Result<Self, String> {
        Ok(Self)
    }

    fn update(&self, batch: &mut Batch<'_>) {
        for k in 0..batch.n() {
            let (start, strain) = (batch.stress0(k), batch.strain_increment(k));
            let end = |c: usize| {
                let trial = start[c] + 2.0 * SHEAR * strain[c];
                if trial > STRENGTH { STRENGTH } else { trial }
            };
            batch.set_stress1(k, std::array::from_fn(end));
            let [steps] = batch.state0(k);
            batch.set_state1(k, [steps + 1.0]);
            batch.set_wave_speed(k, 1.0);
            let huge = strain.iter().any(|e| e.abs() > 1.0);
            batch.set_status(k, if huge { PointStatus::Failed } else { PointStatus::Ok });
        }
    }

    fn wave_speed(&self, _batch: &mut Batch<'_>) {}

    fn tangent(&self, _batch: &Batch<'_>, _k: usize) -> [[f64; 6]; 6] {
        stiffness([0.0, SHEAR])
    }
}

fn driver(n: usize) -> Driver {
    Driver::new(ModelTable::of::<Faulty>().desc(), &[], n).unwrap()
}

#[test]
fn a_right_tangent_a_wrong_one_and_a_kink_are_told_apart() {
    let mut d = driver(1);
    let yielding = 0.5 * STRENGTH / SHEAR;
    let mut at = |xy: f64| {
        let strain = [0.1 * yielding, 0.0, 0.0, xy, 0.0, 0.0];
        let found = d.compare_tangent(0, strain, 1e-5 * yielding, 1.0).unwrap();
        // The end is that of the strain itself.
        assert_eq!(d.stress1(0)[3], (2.0 * SHEAR * xy).min(STRENGTH));
        found
    };
    let right = at(0.5 * yielding);
    assert!(right.error() < 1e-8 * SHEAR && right.bend() < 1e-8 * SHEAR, "{right:?}");
    assert_eq!(right.size(), 2.0 * SHEAR);
    // Beyond the strength nothing changes any more: the elastic tangent is wrong by all of its 2 G, in this column alone.
    let wrong = at(2.0 * yielding);
    assert!((wrong.errors[3] / (2.0 * SHEAR) - 1.0).abs() < 1e-8 && wrong.bend() < 1e-8 * SHEAR);
    assert!((0..6).all(|j| j == 3 || wrong.errors[j] < 1e-8 * SHEAR), "{wrong:?}");
    let kink = at(yielding);
    assert!((kink.bends[3] / (2.0 * SHEAR) - 1.0).abs() < 1e-8, "{kink:?}");
}

#[test]
fn points_that_change_fail_or_keep_silent_are_named() {
    let mut d = driver(5);
    d.set_strain_increment(1, [f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0]);
    d.set_strain_increment(3, [2.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    d.update(1.0).unwrap();
    assert_eq!(d.failed_points().unwrap(), [3]);
    assert_eq!(d.silent_point(), Some(1));
    assert_eq!(d.changed_points(0), [1, 3]);
    assert_eq!(d.changed_points(1), [0, 1, 2, 3, 4]);
    d.set_strain_increment(1, [0.0; 6]);
    d.update(1.0).unwrap();
    assert_eq!((d.silent_point(), d.changed_points(0)), (None, vec![3]));
}

#[test]
fn principal_axes_put_the_tensor_together_again() {
    let tensor = [1.0, -2.0, 0.5, 0.3, -0.7, 1.1];
    let (values, axes) = principal_axes(tensor);
    assert!(values[0] > values[1] && values[1] > values[2]);
    let again = axes * diagonal(values) * axes.transpose();
    assert!((again - to_matrix(tensor)).norm() < 1e-14);
}

fn diagonal(values: [f64; 3]) -> Matrix3<f64> {
    Matrix3::from_diagonal(&values.into())
}

#[test]
fn triaxial_tests_keep_the_confining_pressure_by_differences_and_by_the_tangent() {
    let (p, axial) = (5.0e2, -1e-5);
    let mut d = driver(2).confined(p);
    let (stress, last) = d.triaxial_test(1, axial, p, 3).unwrap();
    // Lateral strains of this model have no stress along the axis.
    assert!((stress - p + 3.0 * 2.0 * SHEAR * axial).abs() < 1e-9 * p, "{stress}");
    assert_eq!((last[2], d.state0(1, 0), d.state0(0, 0)), (axial, 3.0, 0.0));
    let strain = d.triaxial_step_by_tangent(1, axial, p).unwrap();
    assert!((0..2).all(|c| strain[c].abs() < 1e-12) && d.state0(1, 0) == 4.0, "{strain:?}");
    // A pressure beyond the strength in tension is one to which the tangent never leads.
    let error = d.triaxial_step_by_tangent(1, axial, -2.0 * STRENGTH).unwrap_err();
    assert!(error.contains("tangent") || error.contains("status"), "{error}");
}
