//! Comparing what runs gave with what the case asks for.

use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

use crate::case::{Case, Check, Fit, Gate, Order};
use crate::known::{Band, Known};
use crate::run::{Done, Failure, Outcome};

/// A line of the table; serialised, a line of `cargo xtask verify --json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Id of the case.
    pub case: String,
    /// Run and quantity, `run: quantity`.
    pub quantity: String,
    /// What was measured; none if the run failed.
    pub value: Option<f64>,
    /// What it should be.
    pub reference: Option<f64>,
    /// value / reference − 1 for a relative gate, else value − reference.
    pub error: Option<f64>,
    /// What is accepted.
    pub gate: String,
    /// Whether the value is accepted.
    pub holds: bool,
    /// What the run is known to give if its method misses the gate.
    pub known: Option<String>,
    /// What was seen beside the value: the error that ended the run, or the last error of an order
    /// that is a known miss.
    pub seen: Option<String>,
    /// What follows from gate and known miss.
    pub verdict: Verdict,
    /// A word on it.
    #[serde(skip)]
    pub note: String,
    /// Whether this is an order of convergence.
    #[serde(skip)]
    pub is_order: bool,
}

/// What follows for a check.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The gate holds.
    Holds,
    /// The gate is missed, and the value is what the run is known to give.
    KnownMiss,
    /// The run ended with the error that it is known to end with.
    KnownError,
    /// The gate is missed, which is not known.
    Misses,
    /// The gate is missed, but not as it is known: another value, none, or another error.
    MissesOtherwise,
    /// The gate holds though it is known to be missed.
    HoldsThoughKnown,
}

impl Verdict {
    /// Whether the check passes: a gate that must hold does, a known miss gives what it is known to
    /// give.
    pub fn passes(self) -> bool {
        matches!(self, Verdict::Holds | Verdict::KnownMiss | Verdict::KnownError)
    }

    /// From whether the gate holds and, of a known miss, what it is if all is as known and whether
    /// it is so.
    fn of(holds: bool, known: Option<(Verdict, bool)>) -> Self {
        match (holds, known) {
            (true, None) => Verdict::Holds,
            (false, None) => Verdict::Misses,
            (true, Some(_)) => Verdict::HoldsThoughKnown,
            (false, Some((as_known, true))) => as_known,
            (false, Some((_, false))) => Verdict::MissesOtherwise,
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Verdict::Holds => "holds",
            Verdict::KnownMiss => "known miss",
            Verdict::KnownError => "known error",
            Verdict::Misses => "misses",
            Verdict::MissesOtherwise => "misses, but not as known",
            Verdict::HoldsThoughKnown => "holds, though a known miss",
        })
    }
}

impl fmt::Display for Gate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Gate::Relative(x) => write!(f, "relative {}", number(*x)),
            Gate::Absolute(x) => write!(f, "absolute {}", number(*x)),
            Gate::AtMost(x) => write!(f, "at most {}", number(*x)),
            Gate::AtLeast(x) => write!(f, "at least {}", number(*x)),
            Gate::Between(low, high) => write!(f, "between {} and {}", number(*low), number(*high)),
        }
    }
}

/// A number as short as it can be read.
pub fn number(x: f64) -> String {
    if x == 0.0 || (1e-3..1e5).contains(&x.abs()) { format!("{x}") } else { format!("{x:e}") }
}

impl Gate {
    /// Whether a value is accepted; what is not a number is not.
    pub fn accepts(self, value: f64, reference: Option<f64>) -> bool {
        match self {
            Gate::Relative(_) | Gate::Absolute(_) => {
                let (Gate::Relative(bound) | Gate::Absolute(bound)) = self else { return false };
                self.error(value, reference).is_some_and(|error| error.abs() <= bound)
            }
            Gate::AtMost(bound) => value <= bound,
            Gate::AtLeast(bound) => value >= bound,
            Gate::Between(low, high) => (low..=high).contains(&value),
        }
    }

    /// The values that are accepted; none if a reference is missing.
    pub fn accepted(self, reference: Option<f64>) -> Option<Band> {
        let about = |r: f64, width: f64| Band(r - width, r + width);
        match self {
            Gate::Relative(bound) => reference.map(|r| about(r, bound * r.abs())),
            Gate::Absolute(bound) => reference.map(|r| about(r, bound)),
            Gate::AtMost(bound) => Some(Band(f64::NEG_INFINITY, bound)),
            Gate::AtLeast(bound) => Some(Band(bound, f64::INFINITY)),
            Gate::Between(low, high) => Some(Band(low, high)),
        }
    }

    fn error(self, value: f64, reference: Option<f64>) -> Option<f64> {
        match self {
            Gate::Relative(_) => reference.map(|r| value / r - 1.0),
            _ => reference.map(|r| value - r),
        }
    }
}

/// The table of a case from the outcomes of its runs by name. What needs a run that was not done is left out.
///
/// A quantity that a run does not know, though it went through, is an error of the case.
pub fn judge(case: &Case, outcomes: &BTreeMap<String, &Outcome>) -> Result<Vec<Row>, String> {
    let mut rows = Vec::new();
    for check in &case.checks {
        if let Some(outcome) = outcomes.get(&check.run) {
            rows.push(check_row(case, check, outcome)?);
        }
    }
    for order in &case.orders {
        if order.runs.iter().all(|run| outcomes.contains_key(run)) {
            rows.push(order_row(case, order, outcomes)?);
        }
    }
    Ok(rows)
}

fn check_row(case: &Case, check: &Check, outcome: &Outcome) -> Result<Row, String> {
    let value = value_of(case, &check.run, outcome, &check.quantity)?;
    let holds = value.is_some_and(|value| check.gate.accepts(value, check.reference));
    let known = check.known.as_ref().map(|known| match known {
        Known::Value(band) => (Verdict::KnownMiss, band.contains(value)),
        Known::End(end) => (Verdict::KnownError, end.is(outcome.failure.as_ref())),
    });
    Ok(Row {
        case: case.case.clone(),
        quantity: format!("{}: {}", check.run, check.quantity),
        value,
        reference: check.reference,
        error: value.and_then(|value| check.gate.error(value, check.reference)),
        gate: check.gate.to_string(),
        holds,
        known: check.known.as_ref().map(Known::to_string),
        seen: outcome.failure.as_ref().map(Failure::to_string),
        verdict: Verdict::of(holds, known),
        note: check.note.clone(),
        is_order: false,
    })
}

fn order_row(
    case: &Case,
    order: &Order,
    outcomes: &BTreeMap<String, &Outcome>,
) -> Result<Row, String> {
    let mut points = Vec::new();
    let mut last_error = None;
    for run in &order.runs {
        last_error = value_of(case, run, outcomes[run], &order.quantity)?.map(f64::abs);
        if let Some(error) = last_error {
            points.push([-case.cells_of(run)?.ln(), error.ln()]);
        }
    }
    let whole = points.len() == order.runs.len();
    let from = if order.fit == Fit::LastPair { points.len().saturating_sub(2) } else { 0 };
    let value = whole.then(|| slope(&points[from..])).filter(|value| value.is_finite());
    let holds = value.is_some_and(|value| order.gate.accepts(value, None));
    let known = order.known.map(|known| {
        let as_known = known.order.contains(value) && known.last_error.contains(last_error);
        (Verdict::KnownMiss, as_known)
    });
    let failure = order.runs.iter().find_map(|run| outcomes[run].failure.as_ref());
    let error_seen = last_error.filter(|_| order.known.is_some());
    Ok(Row {
        case: case.case.clone(),
        quantity: order.name.clone(),
        value,
        reference: None,
        error: None,
        gate: order.gate.to_string(),
        holds,
        known: order.known.map(|known| known.to_string()),
        seen: failure
            .map(Failure::to_string)
            .or_else(|| error_seen.map(|error| format!("last error {error:.3e}"))),
        verdict: Verdict::of(holds, known),
        note: order.note.clone(),
        is_order: true,
    })
}

fn value_of(
    case: &Case,
    run: &str,
    outcome: &Outcome,
    quantity: &str,
) -> Result<Option<f64>, String> {
    match outcome.quantities.get(quantity) {
        Some(value) => Ok(*value),
        None if outcome.failure.is_some() => Ok(None),
        None => {
            let known: Vec<&str> = outcome.quantities.keys().map(String::as_str).collect();
            let (id, known) = (&case.case, known.join(", "));
            Err(format!("{id}: run \"{run}\" does not give `{quantity}`; it gives {known}"))
        }
    }
}

/// Slope of the line through points by least squares.
pub fn slope(points: &[[f64; 2]]) -> f64 {
    let n = points.len() as f64;
    let mean = |axis: usize| points.iter().map(|p| p[axis]).sum::<f64>() / n;
    let (x, y) = (mean(0), mean(1));
    let covariance: f64 = points.iter().map(|p| (p[0] - x) * (p[1] - y)).sum();
    covariance / points.iter().map(|p| (p[0] - x).powi(2)).sum::<f64>()
}

/// The outcomes of one case by the names of the runs.
pub fn outcomes_of<'a>(case: &Case, done: &'a [Done<'_>]) -> BTreeMap<String, &'a Outcome> {
    done.iter()
        .filter(|done| done.case.case == case.case)
        .map(|done| (done.run.name.clone(), &done.outcome))
        .collect()
}
