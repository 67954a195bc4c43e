//! Mixed control on von Mises perfect plasticity, whose paths have closed forms.
#![forbid(unsafe_code)]

use lahar_plugin::elastic::lame;
use lahar_plugin::tensor::{contract, deviator, trace};
use lahar_plugin::{
    Batch, Control, Driver, Kinematics, Model, ModelTable, Output, Parameter, PointStatus, State,
};
use std::ffi::CStr;

const E: f64 = 1.0e7;
const NU: f64 = 0.3;
const YIELD: f64 = 1.0e5;

/// Elastic, perfectly plastic; strains beyond 1 fail.
struct Mises;

impl Model for Mises {
    const NAME: &'static CStr = c"mises";
    const SUMMARY: &'static CStr = c"A model for tests";
    const REFERENCE: &'static CStr = c"";
    const KINEMATICS: Kinematics = Kinematics::StrainIncrement;
    const PARAMETERS: &'static [Parameter] = &[];
    const STATES: &'static [State] = &[State::scalar(c"plastic", c"-", c"")];
    const OUTPUTS: Output = Output::WAVE_SPEED.and(Output::STATUS);

    fn new(_values: &[f64]) -> Result<Self, String> {
        Ok(Self)
    }

    fn update(&self, batch: &mut Batch<'_>) {
        let [lambda, mu] = lame(E, NU).unwrap();
        for k in 0..batch.n() {
            let (stress, strain) = (batch.stress0(k), batch.strain_increment(k));
            let volume = lambda * trace(strain);
            let trial: [f64; 6] = std::array::from_fn(|c| {
                stress[c] + 2.0 * mu * strain[c] + if c < 3 { volume } else { 0.0 }
            });
            let (mean, s) = (trace(trial) / 3.0, deviator(trial));
            let q = (1.5 * contract(s, s)).sqrt();
            let scale = if q > YIELD { YIELD / q } else { 1.0 };
            let end = std::array::from_fn(|c| scale * s[c] + if c < 3 { mean } else { 0.0 });
            let [plastic] = batch.state0(k);
            batch.set_stress1(k, end);
            batch.set_state1(k, [plastic + (1.0 - scale) * q / (3.0 * mu)]);
            batch.set_wave_speed(k, 1.0);
            if strain.iter().any(|e| e.abs() > 1.0) {
                batch.set_status(k, PointStatus::Failed);
            }
        }
    }

    fn wave_speed(&self, _batch: &mut Batch<'_>) {}
}

fn driver(n: usize) -> Driver {
    Driver::new(ModelTable::of::<Mises>().desc(), &[], n).unwrap()
}

fn close(a: f64, b: f64, scale: f64) -> bool {
    (a - b).abs() <= 1e-10 * scale
}

#[test]
fn uniaxial_stress_has_the_slope_of_young_and_ends_at_the_yield_stress() {
    for sign in [1.0, -1.0] {
        let mut d = driver(1);
        let mut axial = 0.0;
        for _ in 0..30 {
            let step = sign * 5e-4;
            let strain = d.triaxial_step(0, step, 0.0, 1.0).unwrap();
            axial += step;
            let stress = d.stress0(0);
            let elastic = (axial * E).abs() < YIELD;
            assert!(close(stress[2], sign * (axial * E).abs().min(YIELD), YIELD), "{stress:?}");
            assert!(stress[..2].iter().all(|s| s.abs() < 1e-9 * YIELD));
            if elastic {
                assert!(close(strain[0], -NU * step, 5e-4) && close(strain[1], -NU * step, 5e-4));
            }
        }
        // At the limit flow is isochoric and the same on both sides.
        let strain = d.triaxial_step(0, sign * 5e-4, 0.0, 1.0).unwrap();
        assert!(close(strain[0], strain[1], 5e-4) && close(trace(strain), 0.0, 5e-4));
        assert!(d.state0(0, 0) > 5e-3);
    }
}

#[test]
fn plane_strain_ends_at_two_over_root_three_of_the_yield_stress() {
    let mut d = driver(1);
    for _ in 0..300 {
        d.biaxial_step(0, -1e-3, -2e5, 1.0).unwrap();
    }
    let s = d.stress0(0);
    assert!(close(s[0], -2e5, 2e5) && close(s[0] - s[1], YIELD * 2.0 / 3.0_f64.sqrt(), YIELD));
}

#[test]
fn every_component_may_be_a_stress_and_other_points_stay() {
    let mut d = driver(3);
    d.set_strain_increment(0, [1e-3; 6]);
    let wanted = [1e4, -2e4, 5e3, 2e3, -3e3, 1e3];
    let strain = d.mixed_step(1, &wanted.map(Control::Stress), 1.0).unwrap();
    let [lambda, mu] = lame(E, NU).unwrap();
    for c in 0..6 {
        assert!(close(d.stress0(1)[c], wanted[c], 2e4));
        let mean = if c < 3 { trace(wanted) * lambda / (3.0 * lambda + 2.0 * mu) } else { 0.0 };
        assert!(close(strain[c], (wanted[c] - mean) / (2.0 * mu), 1e-3));
    }
    assert_eq!((d.stress0(0), d.stress0(2)), ([0.0; 6], [0.0; 6]));
}

#[test]
fn a_step_that_cannot_be_made_is_an_error_and_changes_nothing() {
    let mut d = driver(1);
    let before = d.triaxial_step(0, 1e-3, 0.0, 1.0).map(|_| d.stress0(0)).unwrap();
    // A deviator beyond the yield stress.
    let beyond = [2.0 * YIELD, 0.0, 0.0, 0.0, 0.0, 0.0].map(Control::Stress);
    let message = d.mixed_step(0, &beyond, 1.0).unwrap_err();
    assert!(message.contains("are missing; take smaller steps"), "{message}");
    assert!(d.mixed_step(0, &[Control::Strain(2.0); 6], 1.0).is_err());
    assert!(d.triaxial_step(0, f64::NAN, 0.0, 1.0).is_err());
    assert_eq!(d.stress0(0), before);
}
