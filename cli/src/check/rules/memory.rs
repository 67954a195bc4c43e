//! A model must store nothing between calls.

use crate::check::probe::{DT, Lcg, Outcome, Probe, distance, size};
use crate::check::report::Verdict;
use crate::point::{Given, Got, Points};
use lahar_plugin_abi::{
    LAHAR_CAPABILITY_DETERMINISTIC, LAHAR_CAPABILITY_POINTWISE, LAHAR_CAPABILITY_THREAD_SAFE,
};
use std::slice::from_ref;
use std::sync::Barrier;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// How long two threads run at the same time.
const TOGETHER: Duration = Duration::from_millis(150);
/// How many batches each of them does at least.
const BATCHES: usize = 200;

/// Steps of several sizes from every start and from loaded points.
fn tasks(probe: &Probe<'_>, seed: u64) -> Outcome<Vec<Given>> {
    let mut lcg = Lcg::new(seed);
    let mut tasks = Vec::new();
    for steps in [0, 10] {
        for point in probe.loaded(seed, 1e-4, steps)? {
            for scale in [1e-5, 1e-3, 1e-2] {
                tasks.push(point.given(probe.model, &probe.gradient(&mut lcg, scale / DT), DT));
            }
        }
    }
    Ok(tasks)
}

/// Whether two results are the same: bit for bit where the model says that it is deterministic.
fn same(probe: &Probe<'_>, a: &Got, b: &Got) -> bool {
    if probe.model.capabilities & LAHAR_CAPABILITY_DETERMINISTIC != 0 || !a.is_finite() {
        return a.bits() == b.bits() || !a.is_done() && !b.is_done();
    }
    let (a, b) = (a.values(), b.values());
    distance(&a, &b) <= 1e-12 * size(&a)
}

/// Repeats every step after others: another size, another point, a batch, another instance with
/// other values.
pub fn memory(probe: &Probe<'_>) -> Outcome {
    let tasks = tasks(probe, 3)?;
    let pointwise = probe.model.capabilities & LAHAR_CAPABILITY_POINTWISE != 0;
    for (i, task) in tasks.iter().enumerate() {
        let first = probe.one(task)?;
        let smaller =
            Given { dt: 0.5 * task.dt, strain: task.strain.map(|e| 0.5 * e), ..task.clone() };
        probe.one(&smaller)?;
        check(probe, task, &first, "when it is repeated after a smaller step from the same start")?;
        probe.one(&tasks[(i + 5) % tasks.len()])?;
        check(probe, task, &first, "after a step of another point")?;
        if let Ok(other) = probe.library.material(probe.model, &nearby(probe)) {
            let _ = probe.try_update(&other, from_ref(&tasks[(i + 1) % tasks.len()]));
            check(probe, task, &first, "after another instance with other parameters was made")?;
        }
        if pointwise {
            let batch = probe.update(&tasks)?;
            if !same(probe, &first, &batch[i]) {
                return Err(differs(probe, task, &first, &batch[i], "in a batch with others"));
            }
        }
    }
    Ok(Verdict::Ok(format!("{} steps repeated", tasks.len())))
}

fn check(probe: &Probe<'_>, task: &Given, first: &Got, when: &str) -> Outcome<()> {
    let again = probe.one(task)?;
    match same(probe, first, &again) {
        true => Ok(()),
        false => Err(differs(probe, task, first, &again, when)),
    }
}

fn differs(probe: &Probe<'_>, task: &Given, first: &Got, again: &Got, when: &str) -> Verdict {
    let (a, b) = (first.values(), again.values());
    let c = (0..a.len()).find(|c| a[*c].to_bits() != b[*c].to_bits()).unwrap_or(0);
    let what = match c {
        0..6 => "stress",
        c if c < 6 + first.state.len() => "state",
        c if c == 6 + first.state.len() => "wave speed",
        _ => "output",
    };
    let text = format!(
        "the same step gives another {what} {when}: {:?} at first, then {:?}; a model may remember nothing but its state \
         variables (static, SAVE and COMMON variables do)",
        a[c], b[c]
    );
    probe.failed(text, task)
}

/// Every real parameter a little off, inside its bounds.
fn nearby(probe: &Probe<'_>) -> Vec<(&'static str, f64)> {
    let parameters = probe.model.parameters.iter().zip(&probe.values);
    parameters
        .map(|(p, (key, value))| {
            let real = p.kind == lahar::material::ParameterKind::Real;
            (*key, if real { (0.97 * value).clamp(p.hard_min, p.hard_max) } else { *value })
        })
        .collect()
}

/// Two threads work at the same time on one instance.
pub fn threads(probe: &Probe<'_>) -> Outcome {
    if probe.model.capabilities & LAHAR_CAPABILITY_THREAD_SAFE == 0 {
        return Ok(Verdict::Skipped("not thread-safe: the engine calls it one at a time".into()));
    }
    let (material, model) = (&probe.material, probe.model);
    let batches = [tasks(probe, 21)?, tasks(probe, 22)?];
    let alone = [probe.update(&batches[0])?, probe.update(&batches[1])?];
    probe.at(|| "update on two threads at once".into());
    let barrier = Barrier::new(2);
    let done = [AtomicUsize::new(0), AtomicUsize::new(0)];
    let work = |i: usize| {
        let (batch, alone) = (&batches[i], &alone[i]);
        let mut points = Points::new(model, batch);
        barrier.wait();
        let begin = Instant::now();
        // A busy machine may let one thread wait: both go on until both have worked.
        while begin.elapsed() < TOGETHER || done.iter().any(|d| d.load(Ordering::Relaxed) < BATCHES)
        {
            let failed = points.update(material).is_err();
            let differs = |k: &usize| points.got(*k).bits() != alone[*k].bits();
            let off = (0..batch.len()).find(|k| failed || alone[*k].is_done() && differs(k));
            done[i].fetch_add(if off.is_some() { BATCHES } else { 1 }, Ordering::Relaxed);
            if off.is_some() {
                return off;
            }
        }
        None
    };
    let off = std::thread::scope(|scope| {
        let second = scope.spawn(|| work(1));
        let first = work(0).map(|k| (0, k));
        first.or(second.join().ok().flatten().map(|k| (1, k)))
    });
    match off {
        None => Ok(Verdict::Ok(format!("{} ms together", TOGETHER.as_millis()))),
        Some((b, k)) => Err(probe.failed(
            "while another thread works on the same instance a step gives another result; do not declare \
             LAHAR_CAPABILITY_THREAD_SAFE, or keep all work data in local variables",
            &batches[b][k],
        )),
    }
}
