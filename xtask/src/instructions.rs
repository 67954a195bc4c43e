//! `cargo xtask instructions`: how many instructions a particle costs in a step, against a
//! committed baseline.
//!
//! Seconds of a shared machine say little, instructions repeat to a fraction of a percent. Each
//! scene of the bench is built small and stepped on one thread under callgrind, twice with
//! different numbers of steps; the difference is that of the steps alone. Valgrind does not know
//! AVX-512, so that the paths are scalar and AVX2.
//!
//! The baseline holds the compiler that it was made with. Another compiler makes other
//! instructions: then the counts are shown, and nothing fails. After a change that is meant to cost
//! more, or that costs less, `--write` makes a new baseline.

use crate::bench::scenes::{SCENES, Scene};
use serde_json::{Value, json};
use std::io::Write;
use std::process::{Command, Stdio};
use xtask_front::{process, setup};

const BASELINE: &str = "benches/instructions.json";
const PATHS: [&str; 2] = ["scalar", "avx2"];
const PARTICLES: &str = "4000";
const STEPS: [u64; 2] = [3, 9]; // of the two runs
const MOST: f64 = 0.03; // growth that fails

/// Counts, and compares with the baseline or writes it.
pub fn run(write: bool) -> Result<(), String> {
    setup::run(setup::Need::Tests)?;
    process::cargo(&["build", "--release", "--workspace"])?;
    let toolchain = process::output_of(Command::new("rustc").arg("--version"))?.trim().to_string();
    let baseline = if write { Value::Null } else { read_baseline()? };
    let same_toolchain = baseline["toolchain"] == toolchain.as_str();
    let mut counts = json!({});
    let mut grown = Vec::new();
    println!("{:<40} {:>7} {:>22} {:>9}", "scene", "path", "per particle and step", "baseline");
    for scene in &SCENES {
        for path in PATHS {
            let count = count(scene, path)?;
            let before = baseline["counts"][scene.name][path].as_f64();
            let growth = before.map(|before| count / before - 1.0);
            let shown = growth.map_or(String::new(), |growth| format!("{:+.1} %", 100.0 * growth));
            println!("{:<40} {path:>7} {count:>22.1} {shown:>9}", scene.name);
            if !write && growth.is_none_or(|growth| growth > MOST) {
                grown.push(format!("{}, {path}", scene.name));
            }
            counts[scene.name][path] = ((count * 10.0).round() / 10.0).into();
        }
    }
    if write {
        return write_baseline(&json!({ "toolchain": toolchain, "counts": counts }));
    }
    if !same_toolchain {
        println!(
            "{BASELINE} was made with {}, this is {toolchain}: nothing is judged",
            baseline["toolchain"]
        );
        return Ok(());
    }
    if grown.is_empty() {
        return Ok(());
    }
    Err(format!(
        "more than {:.0} % over {BASELINE}, or not in it: {}; if that is meant, run `cargo xtask instructions --write`",
        100.0 * MOST,
        grown.join("; ")
    ))
}

/// Instructions per particle and step.
fn count(scene: &Scene, path: &str) -> Result<f64, String> {
    let (few, _) = collected(scene, path, STEPS[0])?;
    let (many, particles) = collected(scene, path, STEPS[1])?;
    Ok((many - few) / ((STEPS[1] - STEPS[0]) as f64 * particles))
}

/// Instructions of a whole run of some steps, and its number of particles.
fn collected(scene: &Scene, path: &str, steps: u64) -> Result<(f64, f64), String> {
    let exe = process::this_program()?;
    let name = format!("{} ({path}) under valgrind", scene.name);
    let text = |e: std::io::Error| format!("{name}: {e}");
    let mut child = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(exe)
        .args(["bench", scene.name, "--child", "--particles", PARTICLES, "--threads", "1"])
        .env("LAHAR_SIMD", path)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(text)?;
    if let Some(mut commands) = child.stdin.take() {
        write!(commands, "steps {steps}\nend\n").map_err(text)?;
    }
    let output = child.wait_with_output().map_err(text)?;
    let (printed, report) =
        (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    if !output.status.success() {
        return Err(format!("{name} ended with {}:\n{report}", output.status));
    }
    let ready: Option<Value> = printed.lines().next().and_then(|l| serde_json::from_str(l).ok());
    let ready = ready.ok_or_else(|| format!("{name} printed `{printed}`"))?;
    if ready["simd"] != path {
        return Err(format!("{name} ran the path {}", ready["simd"]));
    }
    let particles = ready["particles"].as_f64();
    let counted = instructions(&report);
    counted.zip(particles).ok_or_else(|| format!("{name} reported no count:\n{report}"))
}

/// The figure in valgrind's line `==1== Collected : 123`.
fn instructions(report: &str) -> Option<f64> {
    let line = report.lines().find(|line| line.contains("Collected :"))?;
    line.rsplit(':').next()?.trim().parse().ok()
}

fn read_baseline() -> Result<Value, String> {
    let text = std::fs::read_to_string(process::root().join(BASELINE))
        .map_err(|e| format!("{BASELINE}: {e}; make it with `cargo xtask instructions --write`"))?;
    serde_json::from_str(&text).map_err(|e| format!("{BASELINE}: {e}"))
}

fn write_baseline(baseline: &Value) -> Result<(), String> {
    let text = serde_json::to_string_pretty(baseline).map_err(|e| e.to_string())?;
    std::fs::write(process::root().join(BASELINE), text + "\n")
        .map_err(|e| format!("{BASELINE}: {e}"))?;
    println!("wrote {BASELINE}");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_count_of_callgrind_is_read() {
        let report = "==7== Events    : Ir\n==7== Collected : 31542151\n==7== \n";
        assert_eq!(instructions(report), Some(31_542_151.0));
        assert_eq!(instructions("==7== Events    : Ir\n"), None);
    }
}
