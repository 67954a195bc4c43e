//! Turned frames.

use crate::check::probe::{DT, Lcg, Outcome, Probe, distance, size};
use crate::check::report::Verdict;
use crate::point::{Given, Point, turned_state};
use lahar::material::{Rotation, StateVariable};
use lahar::tensor::{Mat3, rotate, step_rotation};
use nalgebra::{Rotation3, Vector3};

/// Two local iterations may stop at results that differ by their tolerance.
const TOLERANCE: f64 = 1e-6;

/// Frames that the engine might see the same step in.
fn frames(plane: bool) -> [Mat3; 3] {
    let turn = |axis: Vector3<f64>, angle: f64| {
        let axis = if plane { Vector3::z() } else { axis.normalize() };
        Rotation3::from_scaled_axis(axis * angle).into_inner()
    };
    [
        turn(Vector3::new(1.0, 2.0, 3.0), 0.7),
        turn(Vector3::new(-2.0, 1.0, 0.5), 2.5),
        turn(Vector3::z(), std::f64::consts::FRAC_PI_2),
    ]
}

/// A material that was turned, and is then strained in the turned directions, must give the same
/// stress, turned.
pub fn objectivity(probe: &Probe<'_>) -> Outcome {
    match probe.model.kinematics.takes_strain_increment() {
        true => turned_by_the_engine(probe),
        false => turned_by_the_model(probe),
    }
}

/// The engine has turned stress and state before the model sees them.
fn turned_by_the_engine(probe: &Probe<'_>) -> Outcome {
    let model = probe.model;
    let mut lcg = Lcg::new(11);
    let mut count = 0;
    for steps in [0, 15] {
        for point in probe.loaded(5, 1e-4, steps)? {
            let modulus = probe.modulus(&point)?;
            for scale in [1e-6, 1e-4, 1e-3] {
                let l = probe.gradient(&mut lcg, scale / DT);
                let given = point.given(model, &l, DT);
                let got = probe.one(&given)?;
                for r in frames(probe.plane()) {
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
                    let expected = turned_state(model, &got.state, &r);
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
    let still = |s: &StateVariable| s.components() > 1 && s.rotation == Rotation::None;
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

/// Steps of the spin that turns a material before it is strained, and their angle: together half a
/// right angle or so.
const SPINS: usize = 200;
const SPIN: f64 = 4e-3;

/// The model sees the material turn, step by step, before it is strained; beside it one that rests
/// for as long.
fn turned_by_the_model(probe: &Probe<'_>) -> Outcome {
    let model = probe.model;
    // A rotation of first order in each step errs by half the square of the angle.
    let accuracy = SPINS as f64 * SPIN * SPIN;
    let w = skew(SPIN / DT, probe.plane());
    let r = step_rotation(&w, SPINS as f64 * DT);
    let mut lcg = Lcg::new(12);
    let mut count = 0;
    for steps in [0, 15] {
        for point in probe.loaded(5, 1e-4, steps)? {
            let modulus = probe.modulus(&point)?;
            let rested = spun(probe, &point, &Mat3::zeros())?;
            let (Some(rested), Some(turned)) = (rested, spun(probe, &point, &w)?) else { continue };
            for scale in [1e-6, 1e-4, 1e-3] {
                let l = probe.gradient(&mut lcg, scale / DT);
                let got = probe.one(&rested.given(model, &l, DT))?;
                let given = turned.given(model, &(r * l * r.transpose()), DT);
                let there = probe.one(&given)?;
                if !got.is_done() || !there.is_done() {
                    continue;
                }
                count += 1;
                let expected = rotate(&r, got.stress);
                let allowed = accuracy * (size(&expected) + modulus * scale);
                if distance(&expected, &there.stress) > allowed {
                    let text = format!(
                        "a material that was turned by {:.1} rad in {SPINS} steps and then strained has the stress {:?}, where the \
                         turned stress of one that was not is {expected:?}{}",
                        SPIN * SPINS as f64,
                        there.stress,
                        hint(probe)
                    );
                    return Err(probe.failed(text, &given));
                }
            }
        }
    }
    match count {
        0 => Ok(Verdict::Skipped("no step succeeded before and after a turn".into())),
        _ => Ok(Verdict::Ok(format!("{count} steps of turned materials"))),
    }
}

/// A spin by `rate` [rad/s] about z for plane motions, else about an axis that is none of the
/// coordinates'.
fn skew(rate: f64, plane: bool) -> Mat3 {
    let axis = if plane { [0.0, 0.0, 1.0] } else { [2.0 / 3.0, 1.0 / 3.0, 2.0 / 3.0] };
    let [x, y, z] = axis.map(|a| a * rate);
    Mat3::new(0.0, -z, y, z, 0.0, -x, -y, x, 0.0)
}

/// What the model is given of a rigid turn: (I + W dt) F would swell.
fn turning(probe: &Probe<'_>, point: &Point, w: &Mat3) -> Given {
    let mut given = point.given(probe.model, w, DT);
    let f = step_rotation(w, DT) * point.deformation;
    given.deformation = std::array::from_fn(|c| f[(c / 3, c % 3)]);
    given.inputs = point.at_rest(probe.model).inputs;
    given
}

/// The point after so many steps of spin; None if one fails.
fn spun(probe: &Probe<'_>, point: &Point, w: &Mat3) -> Outcome<Option<Point>> {
    let mut point = point.clone();
    for _ in 0..SPINS {
        let given = turning(probe, &point, w);
        let got = probe.one(&given)?;
        if !got.is_done() || !got.is_finite() {
            return Ok(None);
        }
        let density = point.density;
        point = point.moved(probe.model, w, &given, &got);
        point.density = density;
    }
    Ok(Some(point))
}

/// A step of rigid spin must turn the stress with the material. Where the engine turns it, the
/// model sees nothing of the spin.
pub fn spin(probe: &Probe<'_>) -> Outcome {
    let model = probe.model;
    if model.kinematics.takes_strain_increment() {
        return Ok(Verdict::Skipped("the engine turns stress and state for the model".into()));
    }
    let angle = 0.01;
    let w = skew(angle / DT, probe.plane());
    let mut count = 0;
    for point in probe.loaded(6, 1e-4, 15)? {
        let rest = point.at_rest(model);
        let got = probe.one(&rest)?;
        if !got.is_done() || !got.is_finite() {
            continue;
        }
        let point = point.moved(model, &Mat3::zeros(), &rest, &got);
        let r = step_rotation(&w, DT);
        let given = turning(probe, &point, &w);
        let got = probe.one(&given)?;
        if !got.is_done() {
            continue;
        }
        count += 1;
        let expected = rotate(&r, point.stress);
        let deviator = size(&expected) + size(&point.stress);
        let off = distance(&expected, &got.stress);
        // A rotation of first order errs by the square of the angle; one that is left out by the
        // angle.
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
