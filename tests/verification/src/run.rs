//! Running cases.

use lahar::error::{Error, Status};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;

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
    pub failure: Option<Failure>,
}

/// The error that ended a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Failure {
    /// Name of its status, see [`status_name`].
    pub status: String,
    /// Time at the start of the step that failed [s]; none if it was not a step that failed.
    pub time: Option<f64>,
    /// Its text.
    pub message: String,
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self { status: status_name(error.status), time: error.place.time, message: error.message }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.time {
            Some(time) => write!(f, "ended with `{}` at {time:.4} s", self.status),
            None => write!(f, "ended with `{}`", self.status),
        }
    }
}

/// Name of a status in the files of the cases: `material_failed` for `LAHAR_ERROR_MATERIAL_FAILED`.
pub fn status_name(status: Status) -> String {
    let mut name = String::new();
    for letter in format!("{status:?}").chars() {
        if letter.is_uppercase() && !name.is_empty() {
            name.push('_');
        }
        name.extend(letter.to_lowercase());
    }
    name
}

impl Outcome {
    /// Nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Of a run that the engine ended: `failed` is 1, the other quantities are missing.
    pub fn ended(error: Error) -> Self {
        let mut outcome = Self { failure: Some(error.into()), ..Self::default() };
        outcome.set("failed", 1.0);
        outcome
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
            let outcome = prepared().map_or_else(Outcome::ended, |mut outcome| {
                outcome.set("failed", 0.0);
                outcome
            });
            told(case, run);
            Ok(Done { case, run, outcome })
        })
        .collect()
}
