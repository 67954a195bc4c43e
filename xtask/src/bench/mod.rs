//! `cargo xtask bench`: nanoseconds per particle and step, beside the copy bandwidth of the same run.
//!
//! Each world lives in a process of its own, so that its peak memory is its own, and worlds whose times are compared are
//! stepped in turns. Only ratios taken in one run can be compared on a shared machine; the tables are appended to
//! `docs/perf/bench.md`, those of a peer to `docs/perf/peers.md`.

mod bandwidth;
mod machine;
mod materials;
mod measure;
mod peers;
mod report;
mod rounds;
pub mod scenes;
mod stages;
mod stick;
mod targets;
mod worker;

pub use machine::Machine;

use bandwidth::Bandwidth;
use rounds::{Case, Row};
use scenes::{APIC_ELASTIC, FAR, LINKED, SCENES, Scene};
use std::path::PathBuf;
use stick::Stick;
use xtask_front::process;

/// What `bench` takes.
#[derive(clap::Args)]
pub struct Arguments {
    /// One scene; all of them and the comparisons between them without it
    scene: Option<String>,
    /// Threads of the engine's pool; 1 and 2 without it
    #[arg(long)]
    threads: Option<usize>,
    /// Prints one object a line instead of tables
    #[arg(long)]
    json: bool,
    /// Particles of a scene, about
    #[arg(long, default_value_t = 1_000_000)]
    particles: usize,
    /// Prints only; appends nothing to docs/perf
    #[arg(long)]
    dry_run: bool,
    /// Seconds of a sample; the fifth part of the time that a row is timed
    #[arg(long, default_value_t = 1.0)]
    seconds: f64,
    /// Path of the kernels that the engine is to run: scalar, avx2 or avx512
    #[arg(long, value_name = "PATH")]
    simd: Option<String>,
    /// A cargo project that prints ns/particle/step, to be timed in turns with the first scene
    #[arg(long, value_name = "FOLDER")]
    stick: Option<PathBuf>,
    /// Steps a flying block in the engine and in this peer, in turns
    #[arg(long)]
    peer: Option<peers::Peer>,
    /// Holds a world in this process and obeys standard input
    #[arg(long, hide = true)]
    child: bool,
    /// Length of the steps of a child [s]
    #[arg(long, hide = true)]
    dt: Option<f64>,
}

/// Measures what is asked for.
pub fn run(arguments: &Arguments) -> Result<(), String> {
    if arguments.child {
        let scene = scenes::find(arguments.scene.as_deref().unwrap_or_default())?;
        let threads = arguments.threads.unwrap_or(1);
        return measure::serve(scene, arguments.particles, threads, arguments.dt);
    }
    let scene = arguments.scene.as_deref().map(scenes::find).transpose()?;
    let machine = Machine::read();
    process::cargo(&["build", "--release", "--workspace"])?;
    if let Some(peer) = arguments.peer {
        return peers::run(peer, &machine, arguments);
    }
    let mut stick = arguments.stick.as_deref().map(Stick::build).transpose()?;
    let mut rows = Vec::new();
    let groups = scene.map_or_else(|| all(arguments), |scene| vec![pair(arguments, scene)]);
    let most = threads(arguments).into_iter().max().unwrap_or(1);
    let mut bandwidth = Bandwidth::new(most);
    for group in groups {
        let with_stick = if is_first(&group) { stick.as_mut() } else { None };
        let how = (arguments.seconds, arguments.simd.as_deref());
        rows.extend(rounds::measure(&group, how, &mut bandwidth, with_stick)?);
    }
    show(arguments, &machine, &rows, stick.as_ref())
}

/// The groups of worlds that are timed in turns, for a run that shows everything.
fn all(arguments: &Arguments) -> Vec<Vec<Case>> {
    let n = arguments.particles;
    let least = threads(arguments)[0];
    let case = |scene, particles, threads| Case { scene, particles, threads };
    let mut first = pair(arguments, &APIC_ELASTIC);
    first.push(case(&APIC_ELASTIC, n / 10, least));
    first.push(case(&APIC_ELASTIC, 4 * n, least));
    first.push(case(&FAR, n, least));
    first.push(case(&LINKED, n, least));
    let mut groups = vec![first];
    groups.extend(SCENES[1..].iter().map(|scene| pair(arguments, scene)));
    let small = threads(arguments).into_iter();
    groups.push(small.map(|t| case(&APIC_ELASTIC, targets::SMALL, t)).collect());
    groups
}

/// One scene with each number of threads.
fn pair(arguments: &Arguments, scene: &'static Scene) -> Vec<Case> {
    let particles = arguments.particles;
    threads(arguments).into_iter().map(|threads| Case { scene, particles, threads }).collect()
}

fn threads(arguments: &Arguments) -> Vec<usize> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    match arguments.threads {
        Some(threads) => vec![threads],
        None if cores > 1 => vec![1, 2],
        None => vec![1],
    }
}

/// Whether a group is the one that a stick is compared with.
fn is_first(group: &[Case]) -> bool {
    group[0].scene.name == APIC_ELASTIC.name && group[0].particles != targets::SMALL
}

fn show(
    arguments: &Arguments,
    machine: &Machine,
    rows: &[Row],
    stick: Option<&Stick>,
) -> Result<(), String> {
    let whole = arguments.scene.is_none();
    let mut checks = targets::judge(rows, arguments.particles, stick);
    let mut tables = report::rows(rows);
    if whole && !arguments.json {
        let (table, of_models) = materials::measure()?;
        checks.extend(of_models);
        tables = format!("{tables}\n{table}");
    }
    let tables = format!("{tables}\n{}", report::checks(&checks));
    if arguments.json {
        print!("{}", report::json(rows));
    } else {
        print!("{tables}");
    }
    if arguments.dry_run { Ok(()) } else { report::append("bench.md", machine, &tables) }
}
