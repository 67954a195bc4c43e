//! `cargo xtask bench`: nanoseconds per particle and step, beside the copy bandwidth of the same run.
//!
//! Each scene runs in a process of its own, so that its peak memory is its own. Only ratios taken in one run can be
//! compared on a shared machine; the rows are appended to `docs/perf/bench.md`.

mod machine;
mod measure;
mod scenes;

use crate::process;
use machine::Machine;
use measure::Row;
use scenes::{SCENES, Scene};
use std::fmt::Write as _;
use std::process::Command;

/// What `bench` takes.
#[derive(clap::Args)]
pub struct Arguments {
    /// One scene; all of them without it
    scene: Option<String>,
    /// Threads of the engine's pool
    #[arg(long, default_value_t = 1)]
    threads: usize,
    /// Prints JSON instead of a table
    #[arg(long)]
    json: bool,
    /// Particles of a scene, about
    #[arg(long, default_value_t = 1_000_000)]
    particles: usize,
    /// Prints only; appends nothing to docs/perf
    #[arg(long)]
    dry_run: bool,
    /// Measures in this process and prints one line of JSON
    #[arg(long, hide = true)]
    child: bool,
}

/// Measures the chosen scenes.
pub fn run(arguments: &Arguments) -> Result<(), String> {
    let chosen = chosen(arguments.scene.as_deref())?;
    if arguments.child {
        for scene in chosen {
            let row = measure::measure(scene, arguments.particles, arguments.threads)?;
            println!("{}", row.to_json());
        }
        return Ok(());
    }
    process::cargo(&["build", "--release", "--workspace"])?;
    let mut rows = Vec::new();
    for scene in chosen {
        eprintln!("{} ...", scene.name);
        rows.push(in_child(scene, arguments)?);
    }
    let machine = Machine::read();
    if arguments.json {
        let rows: Vec<_> = rows.iter().map(Row::to_json).collect();
        println!("{}", serde_json::json!({ "machine": machine.to_json(), "rows": rows }));
    } else {
        print!("{}", table(&rows));
    }
    if arguments.dry_run { Ok(()) } else { append(&machine, &rows) }
}

fn chosen(name: Option<&str>) -> Result<Vec<&'static Scene>, String> {
    let Some(name) = name else { return Ok(SCENES.iter().collect()) };
    let known: Vec<&str> = SCENES.iter().map(|scene| scene.name).collect();
    match SCENES.iter().find(|scene| scene.name == name) {
        Some(scene) => Ok(vec![scene]),
        None => Err(format!("no scene is named `{name}` (known: {})", known.join(", "))),
    }
}

fn in_child(scene: &Scene, arguments: &Arguments) -> Result<Row, String> {
    let exe = std::env::current_exe().map_err(|e| e.to_string())?;
    let mut child = Command::new(exe);
    child.args(["bench", scene.name, "--child"]);
    child.args(["--threads", &arguments.threads.to_string()]);
    child.args(["--particles", &arguments.particles.to_string()]);
    let printed = process::output_of(&mut child)?;
    Row::from_json(printed.trim()).ok_or_else(|| format!("no result in `{printed}`"))
}

fn table(rows: &[Row]) -> String {
    let mut text = String::from(
        "| scene | particles | threads | ns/particle/step | bytes/particle | copy GB/s | times memory limit |\n\
         |---|---:|---:|---:|---:|---:|---:|\n",
    );
    for row in rows {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {:.1} | {:.0} | {:.1} | {:.1} |",
            row.scene,
            row.particles,
            row.threads,
            row.nanoseconds,
            row.bytes,
            row.bandwidth / 1e9,
            row.ratio()
        );
    }
    text
}

fn append(machine: &Machine, rows: &[Row]) -> Result<(), String> {
    let file = process::root().join("docs/perf/bench.md");
    let before = std::fs::read_to_string(&file).map_err(|e| format!("{}: {e}", file.display()))?;
    let text = format!("{}\n\n## {machine}\n\n{}", before.trim_end(), table(rows));
    std::fs::write(&file, text).map_err(|e| format!("{}: {e}", file.display()))?;
    eprintln!("appended to docs/perf/bench.md");
    Ok(())
}
