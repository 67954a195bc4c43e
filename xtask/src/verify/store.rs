//! What the runs gave, kept in `docs/verification/<case>.json`.

use lahar_verification::case::Case;
use lahar_verification::run::{Done, Outcome};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::path::PathBuf;
use xtask_front::process;

/// What is kept of a case.
#[derive(Clone, Default, Serialize, Deserialize)]
pub struct Kept {
    /// When and on what the case was last run.
    pub made: String,
    /// The runs in the order of the case.
    pub runs: Vec<KeptRun>,
}

/// What is kept of a run.
#[derive(Clone, Serialize, Deserialize)]
pub struct KeptRun {
    /// Its name.
    pub name: String,
    /// The set-up that gave this outcome.
    pub setup: Value,
    /// What came out, curves thinned.
    pub outcome: Outcome,
}

/// Most points that are kept of a curve.
const MOST_POINTS: usize = 300;

/// The folder of what is kept and of the plots.
pub fn folder() -> PathBuf {
    process::root().join("docs/verification")
}

/// What is kept of a case; nothing if it was never run. Runs whose set-up has changed since are
/// left out.
pub fn read(case: &Case) -> Result<Kept, String> {
    let file = file(case);
    if !file.is_file() {
        return Ok(Kept::default());
    }
    let text = std::fs::read_to_string(&file).map_err(|e| format!("{}: {e}", file.display()))?;
    let mut kept: Kept =
        serde_json::from_str(&text).map_err(|e| format!("{}: {e}", file.display()))?;
    kept.runs.retain(|kept| case.run(&kept.name).is_ok_and(|run| case.setup_of(run) == kept.setup));
    Ok(kept)
}

/// Replaces old outcomes by new ones.
pub fn keep(cases: &[Case], done: &[Done<'_>], made: &str) -> Result<(), String> {
    std::fs::create_dir_all(folder()).map_err(|e| format!("{}: {e}", folder().display()))?;
    for case in cases {
        let mut kept = read(case)?;
        let new = done.iter().filter(|done| done.case.case == case.case);
        for done in new {
            kept.runs.retain(|old| old.name != done.run.name);
            kept.runs.push(KeptRun {
                name: done.run.name.clone(),
                setup: case.setup_of(done.run),
                outcome: thinned(case, &done.outcome),
            });
        }
        kept.runs.sort_by_key(|kept| case.runs.iter().position(|run| run.name == kept.name));
        kept.made = made.to_string();
        let text = text_of(&kept).map_err(|e| e.to_string())?;
        let file = file(case);
        std::fs::write(&file, text).map_err(|e| format!("{}: {e}", file.display()))?;
    }
    Ok(())
}

/// JSON with a line for each run.
fn text_of(kept: &Kept) -> serde_json::Result<String> {
    let lines: Vec<String> =
        kept.runs.iter().map(serde_json::to_string).collect::<Result<_, _>>()?;
    let made = serde_json::to_string(&kept.made)?;
    Ok(format!("{{\"made\":{made},\"runs\":[\n{}\n]}}\n", lines.join(",\n")))
}

fn file(case: &Case) -> PathBuf {
    folder().join(format!("{}.json", case.case.to_lowercase()))
}

/// Curves that are drawn, of few points with few digits; quantities as they are.
fn thinned(case: &Case, outcome: &Outcome) -> Outcome {
    let mut outcome = outcome.clone();
    let drawn = |name: &str| case.plots.iter().flat_map(|p| &p.curves).any(|c| c.series == name);
    outcome.series.retain(|name, _| drawn(name));
    for points in outcome.series.values_mut() {
        let every = points.len().div_ceil(MOST_POINTS).max(1);
        let last = points.len().saturating_sub(1);
        let thin = points.iter().enumerate().filter(|(k, _)| k % every == 0 || *k == last);
        *points = thin.map(|(_, point)| point.map(rounded)).collect();
    }
    outcome
}

/// Five digits.
fn rounded(x: f64) -> f64 {
    format!("{x:.4e}").parse().unwrap_or(x)
}
