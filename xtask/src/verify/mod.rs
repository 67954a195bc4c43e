//! `cargo xtask verify`: runs the cases of `tests/cases` and writes `docs/verification.md`.
//!
//! What the runs gave is kept in `docs/verification/<case>.json`, so that some cases can be run
//! anew; table and plots are made from that.

mod plot;
mod report;
mod store;

use crate::bench::Machine;
use clap::Args;
use lahar_verification::case::{self, Case};
use lahar_verification::{judge, run};
use xtask_front::process;

/// Arguments of `verify`.
#[derive(Args)]
pub struct Arguments {
    /// Cases to run, by id; all if none is given
    cases: Vec<String>,
    /// Also the sizes that are too long for the test suite
    #[arg(long)]
    full: bool,
    /// Prints one object a line instead of a table
    #[arg(long)]
    json: bool,
    /// Writes no report
    #[arg(long)]
    dry_run: bool,
}

/// Runs cases and judges them; an error names the checks that do not pass.
pub fn run(arguments: &Arguments) -> Result<(), String> {
    let cases = case::load(&arguments.cases)?;
    process::cargo(&["build", "--release", "--workspace"])?; // the plugins
    let done = run::run_all(&cases, arguments.full, |case, run| {
        eprintln!("{}: {}", case.case, run.name);
    })?;
    let mut rows = Vec::new();
    for case in &cases {
        rows.extend(judge::judge(case, &judge::outcomes_of(case, &done))?);
    }
    for row in &rows {
        println!("{}", if arguments.json { line(row)? } else { report::plain(row) });
    }
    for done in &done {
        if let Some(failure) = &done.outcome.failure {
            let (case, run, message) = (&done.case.case, &done.run.name, &failure.message);
            eprintln!("{case}: {run}: ended with {}: {message}", failure.status);
        }
    }
    if !arguments.dry_run {
        store::keep(&cases, &done, &Machine::read().class())?;
        write_report()?;
    }
    let [all, hold, misses, errors, amiss] = report::counts(&rows);
    eprintln!(
        "{all} checks: {hold} hold, {misses} known misses, {errors} known errors, {amiss} amiss"
    );
    let wrong: Vec<String> =
        rows.iter().filter(|row| !row.verdict.passes()).map(report::plain).collect();
    if wrong.is_empty() {
        return Ok(());
    }
    Err(format!("{} checks do not pass:\n  {}", wrong.len(), wrong.join("\n  ")))
}

/// Makes the report of all that is kept.
fn write_report() -> Result<(), String> {
    let cases: Vec<Case> = case::load(&[])?;
    let mut parts = Vec::new();
    for case in &cases {
        let kept = store::read(case)?;
        let outcomes = kept.runs.iter().map(|run| (run.name.clone(), &run.outcome)).collect();
        let rows = judge::judge(case, &outcomes)?;
        let plots = plot::draw(case, &kept)?;
        parts.push(report::Part { case, kept, rows, plots });
    }
    let file = process::root().join("docs/verification.md");
    std::fs::write(&file, report::document(&parts)).map_err(|e| format!("{}: {e}", file.display()))
}

fn line(row: &judge::Row) -> Result<String, String> {
    serde_json::to_string(row).map_err(|e| e.to_string())
}
