//! The engine beside programs that anyone can install: the same particles, material, spacing and steps, in turns.
//!
//! A peer is a script of benches/peers in a virtual environment under the target folder. All begin with the particles
//! that the engine's scene has at time 0 and take the same steps of the same length, so that they must end in the same
//! place with the same energy. The peer's grid is dense and has a margin for the flight.

use super::rounds::{ROUNDS, median, number, paired};
use super::scenes::{FLIGHT, read_points};
use super::targets::{Check, Verdict, at_least, at_most};
use super::worker::Worker;
use super::{Arguments, Machine, report};
use lahar::context::Context;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use xtask_front::process;

/// Programs that the engine can be compared with.
#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Peer {
    /// MLS-MPM in Taichi, as shipped and with the atomics taken out
    Taichi,
    /// MLS-MPM in Warp, which has one thread on a CPU
    Warp,
}

/// A program that takes part, and what the engine is expected to be over it.
struct Entry {
    name: &'static str,
    script: &'static str,
    threads: usize,
    variant: &'static str, // an argument of the script
    expected: f64,         // peer over engine on as many threads
}

const TAICHI: [Entry; 3] = [
    Entry {
        name: "Taichi, as shipped",
        script: "taichi_mpm.py",
        threads: 1,
        variant: "atomic",
        expected: 8.0,
    },
    Entry {
        name: "Taichi, without atomics",
        script: "taichi_mpm.py",
        threads: 1,
        variant: "plain",
        expected: 1.4,
    },
    Entry {
        name: "Taichi, as shipped",
        script: "taichi_mpm.py",
        threads: 2,
        variant: "atomic",
        expected: 8.0,
    },
];
const WARP: [Entry; 1] =
    [Entry { name: "Warp", script: "warp_mpm.py", threads: 1, variant: "", expected: 1.6 }];

const WARM_UP: u64 = 10; // steps; the peers compile their kernels in the first
const STEPS: u64 = 20; // of a sample
const MARGIN: f64 = 8.0; // cells around the block
const SAFE: f64 = 0.8; // of the stable step at time 0, so that no later step is too long
const SAME: f64 = 0.01; // results of the same physics differ by no more

/// Figures of a program that took part.
struct Outcome {
    name: String,
    threads: usize,
    samples: Vec<f64>,
    end: Value,
}

/// Times the engine and the peer in turns and compares where they end.
pub fn run(peer: Peer, machine: &Machine, arguments: &Arguments) -> Result<(), String> {
    let (packages, entries): (&[&str], &[Entry]) = match peer {
        Peer::Taichi => (&["taichi==1.7.4", "numpy==2.4.6"], &TAICHI),
        Peer::Warp => (&["warp-lang==1.19.0", "numpy==2.4.6"], &WARP),
    };
    let wanted = |threads: usize| arguments.threads.is_none_or(|only| only == threads);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let entries: Vec<&Entry> =
        entries.iter().filter(|e| wanted(e.threads) && e.threads <= cores).collect();
    if entries.is_empty() {
        return Err("the peer has no variant with this number of threads".to_string());
    }
    let folder = process::release_folder()?.join("peers");
    let python = environment(&folder.join("venv"), packages)?;
    let start = write_scene(&folder, arguments.particles)?;
    let outcomes = in_turns(&entries, &python, &folder, (&start, arguments))?;
    let (checks, same) = judge(&entries, &outcomes, &start);
    let tables = tables(&outcomes, &start, &checks);
    print!("{}", if arguments.json { json_lines(&outcomes, &start) } else { tables.clone() });
    if !same {
        return Err(format!("the programs did not compute the same physics:\n{tables}"));
    }
    if arguments.dry_run { Ok(()) } else { report::append("peers.md", machine, &tables) }
}

/// A virtual environment with the packages; gives its interpreter.
fn environment(folder: &Path, packages: &[&str]) -> Result<PathBuf, String> {
    let python = folder.join("bin/python");
    let list = packages.join(" ");
    let stamp = folder.join(format!("has-{}", packages[0]));
    if stamp.exists() {
        return Ok(python);
    }
    let make = Command::new("python3").args(["-m", "venv"]).arg(folder).status();
    if !make.is_ok_and(|status| status.success()) {
        return Err(
            "cannot make a virtual environment with `python3 -m venv`: install Python 3.9 to 3.13 \
                    (Debian: sudo apt-get install -y python3-venv)"
                .to_string(),
        );
    }
    let mut pip = Command::new(&python);
    pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]).args(packages);
    process::run_command(&mut pip).map_err(|e| {
        format!("{e}; `{list}` must come from PyPI: is the network there, and is there a wheel for this Python?")
    })?;
    std::fs::write(&stamp, "").map_err(|e| format!("{}: {e}", stamp.display()))?;
    Ok(python)
}

/// Writes the engine's particles at time 0 and the numbers of the scene; gives the numbers.
fn write_scene(folder: &Path, particles: usize) -> Result<Value, String> {
    let text = |e: lahar::error::Error| e.to_string();
    let context = Context::new(Some(1)).map_err(text)?;
    let world = FLIGHT.build(&context, &process::release_folder()?, particles).map_err(text)?;
    let totals = world.totals(None).map_err(text)?;
    for field in ["position", "velocity"] {
        let points = read_points(&world, 0, field, 3).map_err(text)?;
        let bytes: Vec<u8> = points.iter().flat_map(|x| x.to_ne_bytes()).collect();
        let file = folder.join(format!("{field}.bin"));
        std::fs::write(&file, bytes).map_err(|e| format!("{}: {e}", file.display()))?;
    }
    let [young, poisson, density] = FLIGHT.elastic();
    let (h, count) = (FLIGHT.spacing(particles), totals.particles as f64);
    let mass = totals.mass / count;
    let scene = json!({
        "particles": count,
        "spacing": h,
        "dt": SAFE * world.stable_dt().map_err(text)?,
        "lambda": young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)),
        "shear_modulus": young / (2.0 * (1.0 + poisson)),
        "mass": mass,
        "volume": mass / density,
        "nodes": (FLIGHT.edge() / h + 2.0 * MARGIN).round() as u64,
        "corner": (0.5 - MARGIN) * h, // node 0; the engine's grid is shifted by half a cell
        "kinetic_energy": totals.kinetic_energy,
        "center_of_mass": totals.center_of_mass,
    });
    let file = folder.join("scene.json");
    std::fs::write(&file, scene.to_string()).map_err(|e| format!("{}: {e}", file.display()))?;
    Ok(scene)
}

/// Steps the engine, once for each number of threads, and the peers in turns: the engine's outcomes come first.
fn in_turns(
    entries: &[&Entry],
    python: &Path,
    folder: &Path,
    (start, arguments): (&Value, &Arguments),
) -> Result<Vec<Outcome>, String> {
    let (dt, count) = (number(start, "dt")?, number(start, "particles")?);
    let mut threads: Vec<usize> = entries.iter().map(|entry| entry.threads).collect();
    threads.dedup();
    let mut workers = Vec::new();
    for &threads in &threads {
        let size = (arguments.particles, threads);
        let worker = Worker::lahar(&FLIGHT, size, arguments.simd.as_deref(), Some(dt))?;
        workers.push(("lahar", threads, worker));
    }
    let scripts = process::root().join("benches/peers");
    for entry in entries {
        let script = scripts.join(entry.script);
        let threads = entry.threads.to_string();
        let paths = [script.to_string_lossy(), folder.to_string_lossy()];
        let line = [&*paths[0], &*paths[1], &threads, entry.variant];
        workers.push((entry.name, entry.threads, Worker::python(entry.name, python, &line)?));
    }
    let mut samples = vec![Vec::new(); workers.len()];
    for (name, threads, worker) in &mut workers {
        eprintln!("{name}, {threads} threads ...");
        worker.steps(WARM_UP)?;
    }
    for _ in 0..ROUNDS {
        for (k, (_, _, worker)) in workers.iter_mut().enumerate() {
            samples[k].push(worker.steps(STEPS)? * 1e9 / (STEPS as f64 * count));
        }
    }
    workers
        .into_iter()
        .zip(samples)
        .map(|((name, threads, worker), samples)| {
            Ok(Outcome { name: name.to_string(), threads, samples, end: worker.end()? })
        })
        .collect()
}

/// Ratios against what is expected, and whether every peer ended where the engine did.
fn judge(entries: &[&Entry], outcomes: &[Outcome], start: &Value) -> (Vec<Check>, bool) {
    let (ours, theirs) = outcomes.split_at(outcomes.len() - entries.len());
    let mut checks = Vec::new();
    let mut same = true;
    for (entry, peer) in entries.iter().zip(theirs) {
        let threads = entry.threads;
        let Some(engine) = ours.iter().find(|outcome| outcome.threads == threads) else { continue };
        let ratio = paired(&peer.samples, &engine.samples);
        let what = format!("{} over lahar, threads: {threads}", entry.name);
        checks.push(at_least(what, ratio, entry.expected));
        let (center, energy) = differences(&engine.end, &peer.end, start);
        for (what, figure) in [("centre of mass", center), ("kinetic energy", energy)] {
            let what = format!("{}, threads: {threads}, difference of {what}", entry.name);
            let check = at_most(what, figure, SAME);
            same &= check.verdict == Verdict::Holds;
            checks.push(check);
        }
    }
    (checks, same)
}

/// Distance of the centres of mass over the way that the engine's has made, and relative difference of kinetic energies.
fn differences(engine: &Value, peer: &Value, start: &Value) -> (f64, f64) {
    let center = |of: &Value| -> [f64; 3] {
        std::array::from_fn(|d| of["center_of_mass"][d].as_f64().unwrap_or(f64::NAN))
    };
    let distance = |a: [f64; 3], b: [f64; 3]| {
        a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    };
    let energy = |of: &Value| of["kinetic_energy"].as_f64().unwrap_or(f64::NAN);
    let way = distance(center(engine), center(start));
    let apart = distance(center(engine), center(peer)) / way;
    (apart, (energy(peer) / energy(engine) - 1.0).abs())
}

fn tables(outcomes: &[Outcome], start: &Value, checks: &[Check]) -> String {
    let mut text = format!(
        "A flying block of {:.0} particles, {} steps.\n\n\
         | program | threads | ns/particle/step | kinetic energy at the end over the start |\n|---|---:|---:|---:|\n",
        start["particles"].as_f64().unwrap_or(f64::NAN),
        WARM_UP + STEPS * ROUNDS as u64
    );
    for outcome in outcomes {
        let kept = energy_kept(outcome, start);
        let _ = writeln!(
            text,
            "| {} | {} | {:.1} | {kept:.4} |",
            outcome.name,
            outcome.threads,
            median(&outcome.samples)
        );
    }
    format!("{text}\n{}", report::checks(checks))
}

fn energy_kept(outcome: &Outcome, start: &Value) -> f64 {
    let energy = |of: &Value| of["kinetic_energy"].as_f64().unwrap_or(f64::NAN);
    energy(&outcome.end) / energy(start)
}

fn json_lines(outcomes: &[Outcome], start: &Value) -> String {
    let line = |outcome: &Outcome| {
        json!({
            "program": outcome.name,
            "particles": start["particles"],
            "threads": outcome.threads,
            "ns_per_particle_step": median(&outcome.samples),
            "kinetic_energy": outcome.end["kinetic_energy"],
            "center_of_mass": outcome.end["center_of_mass"],
        })
    };
    outcomes.iter().map(|outcome| format!("{}\n", line(outcome))).collect()
}
