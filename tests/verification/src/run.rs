//! Running cases.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

use crate::case::{Case, Run, Size};

/// What a run gives.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Measured quantities by name; none if it is not a finite number.
    pub quantities: BTreeMap<String, Option<f64>>,
    /// Curves by name, points (x, y).
    pub series: BTreeMap<String, Vec<[f64; 2]>>,
    /// Why the engine did not go on, if so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
}

impl Outcome {
    /// Nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Notes a quantity.
    pub fn set(&mut self, name: &str, value: f64) {
        self.quantities.insert(name.to_string(), Some(value).filter(|value| value.is_finite()));
    }

    /// Notes a curve.
    pub fn curve(&mut self, name: &str, points: Vec<[f64; 2]>) {
        self.series.insert(name.to_string(), points);
    }
}

/// The outcome of a run of a case.
#[derive(Clone, Debug)]
pub struct Done<'a> {
    /// The case.
    pub case: &'a Case,
    /// The run.
    pub run: &'a Run,
    /// What came out.
    pub outcome: Outcome,
}

/// Runs the cases, each run on one thread, as many at once as there are cores. `told` hears of each run that is done.
///
/// An engine that does not go on is a result: the quantity `failed` is then 1 and the others are missing.
pub fn run_all<'a>(
    cases: &'a [Case],
    full: bool,
    told: impl Fn(&Case, &Run) + Sync,
) -> Result<Vec<Done<'a>>, String> {
    let wanted = |run: &&Run| full || run.size == Size::Ci;
    let runs: Vec<(&Case, &Run)> = cases
        .iter()
        .flat_map(|case| case.runs.iter().filter(wanted).map(move |run| (case, run)))
        .collect();
    runs.into_par_iter()
        .with_max_len(1)
        .map(|(case, run)| {
            let prepared = case.prepare(run)?;
            let (mut outcome, failed) = match prepared() {
                Ok(outcome) => (outcome, 0.0),
                Err(e) => (Outcome { failure: Some(e.to_string()), ..Outcome::default() }, 1.0),
            };
            outcome.set("failed", failed);
            told(case, run);
            Ok(Done { case, run, outcome })
        })
        .collect()
}
