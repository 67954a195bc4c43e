//! Instances and their parameter values.

use crate::check::probe::{DT, Outcome, Probe, show};
use crate::check::report::Verdict;
use crate::info::number;
use crate::plugin::Values;
use lahar::material::{Parameter, ParameterKind};
use lahar::tensor::Mat3;
use lahar_plugin_abi::{LAHAR_OUTPUT_STATUS, LAHAR_POINT_FAILED};
use std::fs;

const CYCLES: usize = 1000;
const ROUNDS: usize = 5;
/// Above this many bytes per instance a leak is reported: what the system's allocator does not give
/// back is less.
const LEAK: usize = 128;

/// Creates and destroys instances: none may fail, and memory must not grow from round to round.
pub fn instances(probe: &Probe<'_>) -> Outcome {
    let mut memory = Vec::new();
    for round in 0..ROUNDS {
        for i in 0..CYCLES {
            if i % 100 == 0 {
                probe.at(|| format!("create and destroy, for the {}th time", round * CYCLES + i));
            }
            if let Err(e) = probe.library.material(probe.model, &probe.values) {
                let text = format!("instance number {} is refused: {e}", round * CYCLES + i + 1);
                return Err(Verdict::failed(text));
            }
        }
        memory.push(resident_bytes());
    }
    // The first rounds fill the allocator's stores.
    let grown = memory[ROUNDS - 1].saturating_sub(memory[1]);
    let each = grown / ((ROUNDS - 2) * CYCLES);
    if each > LEAK {
        return Err(Verdict::failed(format!(
            "every instance leaves about {each} bytes behind when it is freed; `destroy` must free what `create` took"
        )));
    }
    Ok(Verdict::Ok(format!("{} instances", ROUNDS * CYCLES)))
}

/// Memory of this process that is in use; 0 if the system does not say.
fn resident_bytes() -> usize {
    let text = fs::read_to_string("/proc/self/statm").unwrap_or_default();
    let pages = text.split(' ').nth(1).and_then(|t| t.parse::<usize>().ok()).unwrap_or(0);
    pages * 4096
}

fn with(values: &Values, key: &str, value: f64) -> Values {
    values.iter().map(|(k, v)| (*k, if *k == key { value } else { *v })).collect()
}

/// Values beyond a hard bound are refused by the engine; those at hard and advised bounds by the
/// model, with a reason, or taken; and what is advised must work.
pub fn bounds(probe: &Probe<'_>) -> Outcome {
    let (mut taken, mut refused) = (0, 0);
    for p in &probe.model.parameters {
        for (value, wanted) in beyond(p).into_iter().map(|v| (v, false)).chain(allowed(p)) {
            let values = with(&probe.values, p.key, value);
            probe.at(|| format!("create with {}", show(&values)));
            match probe.library.material(probe.model, &values) {
                Err(e) if e.contains("without saying why") => {
                    return Err(failed(
                        format!("{e}; `check` must write a sentence, or set_error be called"),
                        &values,
                    ));
                }
                Err(_) => refused += 1,
                Ok(_) if !wanted_at_all(p, value) => {
                    let text = format!(
                        "`{}` = {} is taken, and its bounds do not allow it",
                        p.key,
                        number(value)
                    );
                    return Err(failed(text, &values));
                }
                Ok(_) => {
                    taken += 1;
                    run_with(probe, &values, wanted)?;
                }
            }
        }
    }
    Ok(Verdict::Ok(format!("{taken} values taken, {refused} refused with a reason")))
}

fn failed(sentence: String, values: &Values) -> Verdict {
    Verdict::Failed { sentence, input: Some(show(values)) }
}

fn wanted_at_all(p: &Parameter, value: f64) -> bool {
    let whole = p.kind == ParameterKind::Real || value.fract() == 0.0;
    let choice = p.kind != ParameterKind::Choice || value < p.choices.len() as f64;
    value >= p.hard_min && value <= p.hard_max && whole && choice && value >= smallest(p)
}

fn smallest(p: &Parameter) -> f64 {
    if p.kind == ParameterKind::Choice { 0.0 } else { f64::NEG_INFINITY }
}

/// Values that the bounds forbid.
fn beyond(p: &Parameter) -> Vec<f64> {
    if p.kind == ParameterKind::Choice {
        return vec![-1.0, 0.5, p.choices.len() as f64];
    }
    let step = |v: f64| (1e-6 * v.abs()).max(1e-6);
    let mut values = vec![p.hard_min - step(p.hard_min), p.hard_max + step(p.hard_max)];
    if p.kind == ParameterKind::Integer {
        values.push(p.default + 0.5);
    }
    values.retain(|v| v.is_finite());
    values
}

/// Values that the bounds allow, and whether the model has to work with them: those that are
/// advised.
fn allowed(p: &Parameter) -> Vec<(f64, bool)> {
    if p.kind == ParameterKind::Choice {
        return (0..p.choices.len()).map(|i| (i as f64, true)).collect();
    }
    let advised = [p.advised_min.max(p.hard_min), p.advised_max.min(p.hard_max)];
    let mut values: Vec<(f64, bool)> = [p.hard_min, p.hard_max].map(|v| (v, false)).into();
    if p.advised_min.is_finite() && p.advised_max.is_finite() {
        values.extend(advised.map(|v| (v, true)));
    }
    values.retain(|(v, _)| v.is_finite());
    values
}

/// Some steps with other values: they must come back, and be finite where the values are advised.
fn run_with(probe: &Probe<'_>, values: &Values, wanted: bool) -> Outcome<()> {
    let other = Probe::new(probe.library, probe.report, probe.model, values.clone())?;
    let Ok(starts) = other.starts() else { return Ok(()) };
    for start in starts {
        for (i, scale) in [1e-6, 1e-4, -1e-4, 1e-3].into_iter().enumerate() {
            let l = Mat3::new(1.0, 0.3, 0.0, -0.2, -0.6, 0.1, 0.4, 0.0, -0.5) * (scale / DT);
            let l = probe.in_plane(l);
            let given = start.point.given(probe.model, &l, DT);
            let Ok(got) = other.try_update(&other.material, std::slice::from_ref(&given)) else {
                continue;
            };
            let flagged = probe.model.gives(LAHAR_OUTPUT_STATUS);
            if wanted
                && i < 3
                && flagged
                && got[0].status < LAHAR_POINT_FAILED
                && !got[0].is_finite()
            {
                return Err(other.failed(
                    "a value that the bounds advise gives numbers that are not finite",
                    &given,
                ));
            }
        }
    }
    Ok(())
}

/// Counts the open files of the process around the life of some instances.
pub fn files(probe: &Probe<'_>) -> Outcome {
    let count = || fs::read_dir("/proc/self/fd").map_or(0, Iterator::count);
    let before = count();
    for _ in 0..3 {
        let material = probe
            .library
            .material(probe.model, &probe.values)
            .map_err(|e| Verdict::failed(e.to_string()))?;
        for start in probe.starts()? {
            let given = start.point.at_rest(probe.model);
            let _ = probe.try_update(&material, std::slice::from_ref(&given));
        }
    }
    match count() {
        after if after > before => Err(Verdict::failed(format!(
            "{} files are open that were not before three instances were made, run and freed; \
             close what `create` or `update` opens",
            after - before
        ))),
        _ => Ok(Verdict::Ok(format!("{before} open before and after"))),
    }
}
