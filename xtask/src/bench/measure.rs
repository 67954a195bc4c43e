//! The process that holds one world and steps it when it is told to.
//!
//! It reads a command a line from standard input and answers each with a line: `steps N` with the seconds they took,
//! `forget` after setting the peak of memory back, `stages N` with the share of each stage, `end` with what the world
//! is now. So several worlds can be timed in turns, and each has its own peak of memory.

use super::scenes::Scene;
use super::stages;
use lahar::context::Context;
use lahar::world::World;
use serde_json::json;
use std::io::{BufRead, Write};
use std::time::Instant;
use xtask_front::process;

/// Builds the scene and obeys until the end of the input. `dt` [s] is the length of the steps, the stable one if not given.
pub fn serve(
    scene: &Scene,
    particles: usize,
    threads: usize,
    dt: Option<f64>,
) -> Result<(), String> {
    let folder = process::release_folder()?;
    let text = |e: lahar::error::Error| format!("{}: {e}", scene.name);
    let context = Context::new(Some(threads)).map_err(text)?;
    let before = resident("VmRSS")?;
    let mut world = scene.build(&context, &folder, particles).map_err(text)?;
    let count = world.totals(None).map_err(text)?.particles;
    answer(&json!({ "particles": count, "simd": context.isa().name() }).to_string())?;
    for line in std::io::stdin().lock().lines() {
        let line = line.map_err(|e| e.to_string())?;
        let (command, number) = line.split_once(' ').unwrap_or((&line, "0"));
        let steps: u64 = number.parse().map_err(|e| format!("`{line}`: {e}"))?;
        match command {
            "steps" => {
                let start = Instant::now();
                for _ in 0..steps {
                    world.step(dt).map_err(text)?;
                }
                answer(&start.elapsed().as_secs_f64().to_string())?;
            }
            "forget" => {
                forget_peak()?;
                answer("")?;
            }
            "stages" => answer(&stages::shares(&mut world, steps).map_err(text)?.to_string())?,
            "end" => {
                let bytes = resident("VmHWM")? - before;
                return answer(&state(&world, bytes).map_err(text)?);
            }
            _ => return Err(format!("no command is named `{command}`")),
        }
    }
    Ok(())
}

fn state(world: &World, bytes: f64) -> lahar::error::Result<String> {
    let totals = world.totals(None)?;
    let state = json!({
        "bytes": bytes,
        "center_of_mass": totals.center_of_mass,
        "kinetic_energy": totals.kinetic_energy,
        "steps": world.step_count(),
    });
    Ok(state.to_string())
}

fn answer(line: &str) -> Result<(), String> {
    let mut out = std::io::stdout().lock();
    writeln!(out, "{line}").and_then(|()| out.flush()).map_err(|e| e.to_string())
}

/// A line of /proc/self/status [bytes].
fn resident(key: &str) -> Result<f64, String> {
    let text = std::fs::read_to_string("/proc/self/status").map_err(|e| e.to_string())?;
    let line = text.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(':'));
    let kilobytes = line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<f64>().ok());
    kilobytes.map(|kb| kb * 1024.0).ok_or_else(|| format!("/proc/self/status has no {key}"))
}

/// Sets the peak of the resident memory back to what is resident now.
fn forget_peak() -> Result<(), String> {
    std::fs::write("/proc/self/clear_refs", "5").map_err(|e| format!("/proc/self/clear_refs: {e}"))
}
