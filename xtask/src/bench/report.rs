//! The tables of a run.

use super::machine::Machine;
use super::rounds::Row;
use super::stages::STAGES;
use super::targets::{Check, Verdict};
use std::fmt::Write as _;
use xtask_front::process;

/// The figures of every row, and the shares of the stages below.
pub fn rows(rows: &[Row]) -> String {
    let mut text = String::from(
        "| scene | particles | threads | simd | ns/particle/step | bytes/particle | copy GB/s | times memory limit |\n\
         |---|---:|---:|---|---:|---:|---:|---:|\n",
    );
    for row in rows {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {:.1} | {:.0} | {:.1} | {:.1} |",
            row.scene,
            row.particles,
            row.threads,
            row.simd,
            row.nanoseconds(),
            row.bytes,
            row.copy() / 1e9,
            row.ratio()
        );
    }
    text.push('\n');
    text.push_str(&shares(rows));
    text
}

/// A line a row, a column a stage.
fn shares(rows: &[Row]) -> String {
    let mut text = String::from("| share of a step [%] | particles | threads |");
    STAGES.iter().for_each(|stage| _ = write!(text, " {stage} |"));
    text.push_str("\n|---|---:|---:|");
    STAGES.iter().for_each(|_| text.push_str("---:|"));
    text.push('\n');
    for row in rows {
        let _ = write!(text, "| {} | {} | {} |", row.scene, row.particles, row.threads);
        for stage in STAGES {
            let share = row.stages[stage].as_f64();
            let _ = write!(text, " {:.1} |", 100.0 * share.unwrap_or(f64::NAN));
        }
        text.push('\n');
    }
    text
}

/// The targets with what holds, and the figures that inform.
pub fn checks(checks: &[Check]) -> String {
    let mut text = String::from("| target | figure | bound | |\n|---|---:|---:|---|\n");
    for check in checks {
        let verdict = match check.verdict {
            Verdict::Holds => "holds",
            Verdict::Missed => "missed",
            Verdict::Informs => "for information",
        };
        let figure = match check.figure {
            small if small < 0.001 => format!("{small:.1e}"),
            middle if middle < 10.0 => format!("{middle:.3}"),
            large => format!("{large:.1}"),
        };
        let _ = writeln!(text, "| {} | {figure} | {} | {verdict} |", check.what, check.bound);
    }
    text
}

/// One object a line.
pub fn json(rows: &[Row]) -> String {
    rows.iter().map(|row| format!("{}\n", row.to_json())).collect()
}

/// Appends tables to a file of docs/perf, under a heading that says when and on what they were measured.
pub fn append(file: &str, machine: &Machine, tables: &str) -> Result<(), String> {
    let path = process::root().join("docs/perf").join(file);
    let before = std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    let text = format!("{}\n\n## {machine}\n\n{tables}", before.trim_end());
    std::fs::write(&path, text).map_err(|e| format!("{}: {e}", path.display()))?;
    eprintln!("appended to docs/perf/{file}");
    Ok(())
}
