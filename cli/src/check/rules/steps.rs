//! Steps: at rest, at random, tiny, and with garbage.

use crate::check::probe::{DT, Lcg, Outcome, Probe, Starts, distance, size};
use crate::check::report::Verdict;
use crate::point::{Given, Got, Point};
use lahar::error::Status;
use lahar::material::ParameterKind;
use lahar::tensor::Mat3;
use lahar_plugin_abi::{
    LAHAR_CAPABILITY_POINTWISE, LAHAR_OUTPUT_DIFFUSIVITY, LAHAR_OUTPUT_DT_FACTOR,
    LAHAR_OUTPUT_ENERGY, LAHAR_OUTPUT_STATUS, LAHAR_POINT_FAILED,
};
use std::slice::from_ref;

/// The model must go on from one of the usual starts, and refuse others with a reason.
pub fn starts(probe: &Probe<'_>) -> Outcome {
    let Starts { good: starts, reasons, breach } = probe.tried_starts();
    if let Some(breach) = breach {
        return Err(breach.clone());
    }
    let grouped_reasons = grouped(reasons);
    if let Some(mute) = grouped_reasons.iter().find(|r| r.contains("without saying why")) {
        return Err(Verdict::failed(format!("{mute}; set_error must be called")));
    }
    if starts.is_empty() {
        return Err(Verdict::failed(format!(
            "{}the model goes on from none of the starts that were tried: {}",
            without_values(probe),
            grouped_reasons.join("; ")
        )));
    }
    // Starts that a host may ask for by mistake: they come back, taken or refused.
    for stress in [[1e5; 6], [-1e7, 0.0, 0.0, 2e6, 0.0, 0.0], [f64::NAN; 6], [-1e300; 6]] {
        let given = Given { stress, ..starts[0].point.at_rest(probe.model) };
        if let Err(e) = probe.try_init_state(&given)
            && e.message.contains("without saying why")
        {
            return Err(probe.failed(format!("{e}; set_error must be called"), &given));
        }
    }
    let names: Vec<&str> = starts.iter().map(|s| s.name.as_str()).collect();
    let mut text = names.join(", ");
    if probe.plane() {
        text += "; the model refuses shear out of the plane: all rules use plane motions, turned about z only";
    }
    Ok(Verdict::Ok(text))
}

/// A reason once, with all starts that it holds for.
fn grouped(reasons: &[(String, String)]) -> Vec<String> {
    let mut all: Vec<(Vec<&str>, &str)> = Vec::new();
    for (start, why) in reasons {
        match all.iter_mut().find(|(_, known)| known == why) {
            Some((starts, _)) => starts.push(start),
            None => all.push((vec![start], why)),
        }
    }
    all.iter().map(|(starts, why)| format!("{}: {why}", starts.join(", "))).collect()
}

/// Advice where nobody has given the model numbers to work with.
fn without_values(probe: &Probe<'_>) -> &'static str {
    let real = |i: &usize| probe.model.parameters[*i].kind == ParameterKind::Real;
    let mut reals = (0..probe.values.len()).filter(real).peekable();
    match reals.peek().is_some() && reals.all(|i| probe.values[i].1 == 0.0) {
        true => "all parameters are 0: give values with --set key=value; ",
        false => "",
    }
}

/// Runs everything that the model offers under the engine's own checks.
pub fn contract(probe: &Probe<'_>) -> Outcome {
    let mut lcg = Lcg::new(2);
    let mut batch = Vec::new();
    for steps in [0, 8] {
        for point in probe.loaded(4, 1e-4, steps)? {
            for scale in [0.0, 1e-6, 1e-4, 1e-3, 1e-2] {
                batch.push(point.given(probe.model, &probe.gradient(&mut lcg, scale / DT), DT));
            }
        }
    }
    let sizes = [1, 2, 3, 5, 8, 9, batch.len().min(17)];
    for n in sizes {
        probe.update(&batch[..n.min(batch.len())])?;
    }
    for given in &batch {
        // A state may be refused; a broken contract is not a refusal.
        let refused = probe.try_init_state(given).err();
        let broken = refused.filter(|e| e.status == Status::PluginBroken);
        let speed = probe.try_wave_speed(given).err();
        if let Some(e) = broken.or(speed) {
            return Err(probe.failed(e.to_string(), given));
        }
        probe.tangent(given)?;
        probe.stored_energy(given)?;
    }
    Ok(Verdict::Ok(format!("batches of {sizes:?} points")))
}

/// A step at rest from a point that a step at rest has settled must change nothing; and stress that
/// does not depend on the rate must stay at once.
pub fn zero_increment(probe: &Probe<'_>) -> Outcome {
    let model = probe.model;
    let mut count = 0;
    for steps in [0, 3, 20] {
        for point in probe.loaded(1, 1e-4, steps)? {
            let modulus = probe.modulus(&point)?;
            let by_rate = rate_dependent(probe, &point, modulus)?;
            let settled = match by_rate {
                false => point,
                true => {
                    let rest = point.given(model, &Mat3::zeros(), DT);
                    let got = probe.one(&rest)?;
                    if !got.is_done() {
                        continue;
                    }
                    point.moved(model, &Mat3::zeros(), &rest, &got)
                }
            };
            // What relaxes does so over times far longer than this.
            let given = settled.given(model, &Mat3::zeros(), if steps == 0 { DT } else { 1e-12 });
            let got = probe.one(&given)?;
            count += 1;
            if !got.is_done() {
                let text = format!("a step without strain fails with status {}", got.status);
                return Err(probe.failed(text, &given));
            }
            let allowed = 1e-8 * size(&given.stress) + 1e-12 * modulus;
            let off = distance(&got.stress, &given.stress);
            if off > allowed {
                let text = format!(
                    "a step without strain changes the stress by {off:e} Pa, to {:?}",
                    got.stress
                );
                return Err(probe.failed(text, &given));
            }
            // A state variable of a law in rates may be a rate.
            let off = distance(&got.state, &given.state);
            if (steps == 0 || !by_rate) && off > 1e-8 * size(&given.state) + 1e-12 {
                let text = format!(
                    "a step without strain changes the state by {off:e}, to {:?}",
                    got.state
                );
                return Err(probe.failed(text, &given));
            }
        }
    }
    Ok(Verdict::Ok(format!("{count} steps at rest")))
}

/// Whether the same strain in a longer step gives another stress.
fn rate_dependent(probe: &Probe<'_>, point: &Point, modulus: f64) -> Outcome<bool> {
    let l = probe.in_plane(Mat3::new(0.5, 0.2, 0.0, 0.1, -0.4, 0.0, 0.0, 0.3, -0.2) * (1e-5 / DT));
    for l in [l, -l, Mat3::zeros()] {
        let fast = probe.one(&point.given(probe.model, &l, DT))?;
        let slow = probe.one(&point.given(probe.model, &(0.01 * l), 100.0 * DT))?;
        let allowed = 1e-9 * (size(&fast.stress) + modulus * 1e-5);
        if !(distance(&fast.stress, &slow.stress) <= allowed) {
            return Ok(true);
        }
    }
    Ok(false)
}

/// Random paths with strains of 1e-6 to 1e-2 a step.
pub fn loading(probe: &Probe<'_>) -> Outcome {
    let mut steps = 0;
    for scale in [1e-6, 1e-5, 1e-4, 1e-3, 1e-2] {
        let mut failures = 0;
        let mut tried = 0;
        for (seed, start) in probe.starts()?.into_iter().cycle().take(8).enumerate() {
            let mut lcg = Lcg::new(100 + seed as u64);
            let mut point = start.point.clone();
            let mut l = probe.gradient(&mut lcg, scale / DT);
            for step in 0..40 {
                l = match step % 8 {
                    4 => -l,
                    0 => probe.gradient(&mut lcg, scale / DT),
                    _ => l,
                };
                let given = point.given(probe.model, &l, DT);
                let got = probe.one(&given)?;
                tried += 1;
                sane(probe, &given, &got)?;
                point = match got.is_done() {
                    true => point.moved(probe.model, &l, &given, &got),
                    false => {
                        failures += 1;
                        start.point.clone()
                    }
                };
            }
        }
        if scale <= 1e-5 && 4 * failures > tried {
            return Err(Verdict::failed(format!(
                "{failures} of {tried} steps with strains of {scale:e} fail"
            )));
        }
        steps += tried - failures;
    }
    Ok(Verdict::Ok(format!("{steps} steps")))
}

/// What a point that has not failed must give.
fn sane(probe: &Probe<'_>, given: &Given, got: &Got) -> Outcome<()> {
    if !(0..=LAHAR_POINT_FAILED).contains(&got.status) {
        let text = format!("the status is {}, and not one of LAHAR_POINT_*, 0 to 3", got.status);
        return Err(probe.failed(text, given));
    }
    if !got.is_done() {
        return Ok(());
    }
    if !got.is_finite() {
        let text = format!(
            "a step of finite numbers gives stress {:?}, state {:?}, wave speed {:?}{} and does not say that it failed",
            got.stress,
            got.state,
            got.wave_speed,
            if got.others.is_empty() {
                String::new()
            } else {
                format!(", outputs {:?}", got.others)
            },
        );
        return Err(probe.failed(text, given));
    }
    if !(got.wave_speed > 0.0) {
        return Err(probe.failed(format!("the wave speed is {:?} m/s", got.wave_speed), given));
    }
    let mut others = got.others.iter();
    for (mask, name, low, high) in [
        (LAHAR_OUTPUT_DIFFUSIVITY, "diffusivity", 0.0, f64::MAX),
        (LAHAR_OUTPUT_ENERGY, "energy", f64::MIN, f64::MAX),
        (LAHAR_OUTPUT_DT_FACTOR, "dt_factor", f64::MIN_POSITIVE, 1.0),
    ] {
        if probe.model.gives(mask)
            && let Some(value) = others.next()
            && !(low..=high).contains(value)
        {
            let text = format!("`{name}` is {value:?}, and must be from {low:e} to {high:e}");
            return Err(probe.failed(text, given));
        }
    }
    Ok(())
}

/// Steps whose length goes to zero at a given velocity gradient: the stress must go to that of the
/// start.
pub fn small_steps(probe: &Probe<'_>) -> Outcome {
    let l = probe.in_plane(Mat3::new(0.1, 0.03, 0.0, -0.02, -0.06, 0.01, 0.04, 0.0, -0.05));
    let mut count = 0;
    for point in probe.loaded(15, 1e-5, 5)? {
        for dt in [1e-6, 1e-12, 1e-30, 1e-200] {
            let given = point.given(probe.model, &l, dt);
            let got = probe.one(&given)?;
            sane(probe, &given, &got)?;
            if !got.is_done() {
                let text = format!("a step of {dt:e} s fails with status {}", got.status);
                return Err(probe.failed(text, &given));
            }
            count += 1;
        }
    }
    Ok(Verdict::Ok(format!("{count} steps down to 1e-200 s")))
}

type Set = fn(&mut Given, usize, f64);

/// Invalid numbers, one at a time in every input component of one point among four.
pub fn garbage(probe: &Probe<'_>) -> Outcome {
    let model = probe.model;
    let start = &probe.starts()?[0];
    let l = probe.in_plane(Mat3::new(0.5, 0.2, 0.0, 0.1, -0.4, 0.0, 0.0, 0.3, -0.2) * (1e-5 / DT));
    let clean = vec![start.point.given(model, &l, DT); 4];
    let expected = probe.update(&clean)?;
    let slots: [(&str, usize, Set); 6] = [
        ("strain increment", 6, |g, c, v| g.strain[c] = v),
        ("velocity gradient", 9, |g, c, v| g.gradient[c] = v),
        ("deformation gradient", 9, |g, c, v| g.deformation[c] = v),
        ("stress", 6, |g, c, v| g.stress[c] = v),
        ("state", model.state_components(), |g, c, v| g.state[c] = v),
        ("input", model.inputs.len(), |g, c, v| g.inputs[c] = v),
    ];
    let mut count = 0;
    for (name, components, set) in slots {
        for c in 0..components {
            for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300, 0.0, -1.0] {
                let mut given = clean.clone();
                set(&mut given[1], c, value);
                count += 1;
                let what = format!("{value:?} in component {c} of the {name}");
                let Ok(got) = probe.try_update(&probe.material, &given) else { continue };
                judge(probe, &what, (&given, &got), &expected)?;
                let _ = probe.try_wave_speed(&given[1]);
                let _ = probe.try_init_state(&given[1]);
            }
        }
    }
    for dt in [0.0, -1e-3, f64::NAN, f64::INFINITY] {
        let given = Given { dt, ..clean[0].clone() };
        if let Ok(got) = probe.try_update(&probe.material, from_ref(&given)) {
            visible(probe, &format!("dt = {dt:?}"), &given, &got[0])?;
        }
    }
    Ok(Verdict::Ok(format!("{count} batches with one bad number")))
}

fn judge(
    probe: &Probe<'_>,
    what: &str,
    (given, got): (&[Given], &[Got]),
    expected: &[Got],
) -> Outcome<()> {
    visible(probe, what, &given[1], &got[1])?;
    let pointwise = probe.model.capabilities & LAHAR_CAPABILITY_POINTWISE != 0;
    for k in [0, 2, 3] {
        if pointwise && got[k].bits() != expected[k].bits() {
            let text = format!("{what} of a point changes its neighbour in the batch");
            return Err(probe.failed(text, &given[1]));
        }
    }
    Ok(())
}

/// A model that gives a status must not call a result good that is not finite.
fn visible(probe: &Probe<'_>, what: &str, given: &Given, got: &Got) -> Outcome<()> {
    let flagged = probe.model.gives(LAHAR_OUTPUT_STATUS);
    if flagged && got.is_done() && !got.is_finite() {
        let text = format!(
            "{what} gives stress {:?} and wave speed {:?} with status {}; the status of a result that is not finite is \
             LAHAR_POINT_FAILED",
            got.stress, got.wave_speed, got.status
        );
        return Err(probe.failed(text, given));
    }
    Ok(())
}
