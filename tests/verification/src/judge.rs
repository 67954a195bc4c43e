//! Comparing what runs gave with what the case asks for.

use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

use crate::case::{Case, Fit, Gate, Order};
use crate::run::{Done, Outcome};

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
    /// Whether the method is known not to reach the gate.
    pub expected_failure: bool,
    /// A word on it.
    #[serde(skip)]
    pub note: String,
    /// Whether this is an order of convergence.
    #[serde(skip)]
    pub is_order: bool,
}

impl Row {
    /// Whether the check passes: a gate that must hold does, a gate that a method is known to miss is missed.
    pub fn passes(&self) -> bool {
        self.holds != self.expected_failure
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
        let Some(outcome) = outcomes.get(&check.run) else { continue };
        let value = value_of(case, &check.run, outcome, &check.quantity)?;
        rows.push(Row {
            case: case.case.clone(),
            quantity: format!("{}: {}", check.run, check.quantity),
            value,
            reference: check.reference,
            error: value.and_then(|value| check.gate.error(value, check.reference)),
            gate: check.gate.to_string(),
            holds: value.is_some_and(|value| check.gate.accepts(value, check.reference)),
            expected_failure: check.expected_failure,
            note: check.note.clone(),
            is_order: false,
        });
    }
    for order in &case.orders {
        if order.runs.iter().all(|run| outcomes.contains_key(run)) {
            rows.push(order_row(case, order, outcomes)?);
        }
    }
    Ok(rows)
}

fn order_row(
    case: &Case,
    order: &Order,
    outcomes: &BTreeMap<String, &Outcome>,
) -> Result<Row, String> {
    let mut points = Vec::new();
    for run in &order.runs {
        if let Some(error) = value_of(case, run, outcomes[run], &order.quantity)? {
            points.push([-case.cells_of(run)?.ln(), error.abs().ln()]);
        }
    }
    let whole = points.len() == order.runs.len();
    let from = if order.fit == Fit::LastPair { points.len().saturating_sub(2) } else { 0 };
    let value = whole.then(|| slope(&points[from..])).filter(|value| value.is_finite());
    Ok(Row {
        case: case.case.clone(),
        quantity: order.name.clone(),
        value,
        reference: None,
        error: None,
        gate: order.gate.to_string(),
        holds: value.is_some_and(|value| order.gate.accepts(value, None)),
        expected_failure: order.expected_failure,
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
