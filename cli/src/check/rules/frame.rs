//! Turned frames.

use crate::check::probe::{DT, Lcg, Outcome, Probe, distance, size};
use crate::check::report::Verdict;
use crate::point::framed_state;
use lahar::material::{Kinematics, Rotation};
use lahar::tensor::{Mat3, rotate, step_rotation};
use nalgebra::{Rotation3, Vector3};

/// Two local iterations may stop at results that differ by their tolerance.
const TOLERANCE: f64 = 1e-6;

/// Frames that the engine might see the same step in.
fn frames() -> [Mat3; 3] {
    let turn = |axis: Vector3<f64>, angle: f64| {
        Rotation3::from_scaled_axis(axis.normalize() * angle).into_inner()
    };
    [
        turn(Vector3::new(1.0, 2.0, 3.0), 0.7),
        turn(Vector3::new(-2.0, 1.0, 0.5), 2.5),
        turn(Vector3::z(), std::f64::consts::FRAC_PI_2),
    ]
}

/// The same step seen in a turned frame must give the same stress turned.
pub fn objectivity(probe: &Probe<'_>) -> Outcome {
    let model = probe.model;
    let mut lcg = Lcg::new(11);
    let mut count = 0;
    for steps in [0, 15] {
        for point in probe.loaded(5, 1e-4, steps)? {
            let modulus = probe.modulus(&point)?;
            for scale in [1e-6, 1e-4, 1e-3] {
                let l = lcg.gradient(scale / DT);
                let given = point.given(model, &l, DT);
                let got = probe.one(&given)?;
                for r in frames() {
                    let turned = given.turned(model, &r);
                    let there = probe.one(&turned)?;
                    if !got.is_done() || !there.is_done() {
                        continue;
                    }
                    count += 1;
                    let expected = rotate(&r, got.stress);
                    let off = distance(&expected, &there.stress);
                    let allowed = TOLERANCE * (size(&expected) + modulus * scale);
                    if off > allowed {
                        let text = format!(
                            "in a turned frame the stress is {:?} where the turned stress is {expected:?}{}",
                            there.stress,
                            hint(probe)
                        );
                        return Err(probe.failed(text, &turned));
                    }
                    let expected = framed_state(model, &got.state, &r);
                    if let Some(c) = first_off(&expected, &there.state, &given.state) {
                        let text = format!(
                            "in a turned frame the state variable {} is {:?} and not {:?}; declare \
                             LAHAR_ROTATION_OBJECTIVE if it is a vector or tensor in space",
                            state_name(probe, c),
                            there.state[c],
                            expected[c]
                        );
                        return Err(probe.failed(text, &turned));
                    }
                }
            }
        }
    }
    match count {
        0 => Ok(Verdict::Skipped("no step succeeded in both frames".into())),
        _ => Ok(Verdict::Ok(format!("{count} steps in turned frames"))),
    }
}

fn hint(probe: &Probe<'_>) -> &'static str {
    let still =
        |s: &lahar::material::StateVariable| s.components() > 1 && s.rotation == Rotation::None;
    match probe.model.states.iter().any(still) {
        true => {
            "; a vector or tensor among the state variables does not turn: LAHAR_ROTATION_OBJECTIVE?"
        }
        false => "",
    }
}

fn first_off(expected: &[f64], there: &[f64], before: &[f64]) -> Option<usize> {
    (0..expected.len()).find(|c| {
        let scale = expected[*c].abs().max((expected[*c] - before[*c]).abs());
        !((expected[*c] - there[*c]).abs() <= TOLERANCE * scale + 1e-12 * (1.0 + size(expected)))
    })
}

fn state_name(probe: &Probe<'_>, component: usize) -> String {
    let mut first = 0;
    for s in &probe.model.states {
        if component < first + s.components() {
            return format!("`{}` [{}]", s.key, component - first);
        }
        first += s.components();
    }
    component.to_string()
}

/// A step of rigid spin must turn the stress with the material. Where the engine turns it, the model sees nothing of the spin.
pub fn spin(probe: &Probe<'_>) -> Outcome {
    let model = probe.model;
    if model.kinematics.takes_strain_increment() {
        return Ok(Verdict::Skipped("the engine turns stress and state for the model".into()));
    }
    let w = Mat3::new(0.0, -0.6, 0.3, 0.6, 0.0, -0.7, -0.3, 0.7, 0.0) * (0.01 / DT);
    let angle = 0.01_f64;
    let mut count = 0;
    for point in probe.loaded(6, 1e-4, 15)? {
        let rest = point.at_rest(model);
        let got = probe.one(&rest)?;
        if !got.is_done() || !got.is_finite() {
            continue;
        }
        let point = point.moved(model, &Mat3::zeros(), &rest, &got);
        let r = step_rotation(&w, DT);
        let mut given = point.given(model, &w, DT);
        if model.kinematics == Kinematics::DeformationGradient {
            let f = r * point.deformation; // a rigid turn, not (I + W dt) F, which swells
            given.deformation = std::array::from_fn(|c| f[(c / 3, c % 3)]);
        }
        let got = probe.one(&given)?;
        if !got.is_done() {
            continue;
        }
        count += 1;
        let expected = rotate(&r, point.stress);
        let deviator = size(&expected) + size(&point.stress);
        let off = distance(&expected, &got.stress);
        // A rotation of first order errs by the square of the angle; one that is left out by the angle.
        let allowed = (angle * angle) * deviator + 1e-9 * probe.modulus(&point)?;
        if off > allowed {
            let text = format!(
                "after a rigid spin by {angle} rad a step the stress is {:?} and not the turned {expected:?}; a model that \
                 takes the velocity or deformation gradient must turn the stress itself",
                got.stress
            );
            return Err(probe.failed(text, &given));
        }
    }
    match count {
        0 => Ok(Verdict::Skipped("no spin succeeded".into())),
        _ => Ok(Verdict::Ok(format!("{count} spins"))),
    }
}
