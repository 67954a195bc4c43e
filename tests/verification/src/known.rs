//! Known misses: what a run is known to give where its method does not reach the gate.
//!
//! A known miss has a band of its own, so that a run that ends early, or gives a value of another
//! size, is amiss. The width is an argument. A run has one thread and is deterministic; another
//! processor or instruction set changes it by round-off.
//!
//! * Where round-off stays round-off (no particle crosses cells, quasi-static runs, closed forms)
//!   the band is about 1 % of the value to either side, less where the gate is near.
//! * Where particles cross cells or bodies touch, round-off can grow; the band is 2 % to 15 % to
//!   either side, several times what instruction sets differ; more if that is some per cent already.
//! * A quantity that is lost altogether, such as energy under PIC, has a band that is narrow
//!   beside what it was at the start.
//! * An order of convergence has about 0.1 to either side, less where the gate is near, and with
//!   it the error of its finest run: a factor that all errors share does not change the order.

use serde::Deserialize;
use std::fmt;

use crate::case::nearest;
use crate::judge::number;
use crate::run::{Failure, status_name};
use lahar::error::Status;

/// A closed interval in the unit of the quantity: `[low, high]` in a file.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
pub struct Band(pub f64, pub f64);

/// What the run of a check is known to give.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(
    untagged,
    expecting = "a band [low, high] or {\"ends_with\": a status, \"time\": [first, last]}"
)]
pub enum Known {
    /// A value in this band.
    Value(Band),
    /// No value: the engine ends the run.
    End(End),
}

/// How the engine is known to end a run.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct End {
    /// Name of the status, see [`status_name`].
    pub ends_with: String,
    /// When [s].
    pub time: Band,
}

/// What the runs of an order of convergence are known to give.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct KnownOrder {
    /// Band of the order.
    pub order: Band,
    /// Band of the error of the last run, in the unit of the quantity.
    pub last_error: Band,
}

impl Band {
    /// Whether a value lies in it; what is missing does not.
    pub fn contains(self, value: Option<f64>) -> bool {
        value.is_some_and(|value| (self.0..=self.1).contains(&value))
    }

    /// Refuses a band that is none, or that says little.
    ///
    /// It must lie beside what the gate accepts. Its width is at most two thirds of its larger end
    /// (a factor of three) or, if that is more, a fifth of the distance to the gate.
    pub fn check(self, accepted: Option<Band>) -> Result<(), String> {
        let Band(low, high) = self;
        if !(low < high && low.is_finite() && high.is_finite()) {
            return Err(format!(
                "the band {self} is empty: its first end must be less than its second"
            ));
        }
        let distance = match accepted {
            Some(Band(from, to)) => (low - to).max(from - high),
            None => 0.0,
        };
        if accepted.is_some() && distance <= 0.0 {
            return Err(format!("the band {self} reaches into what the gate accepts"));
        }
        let widest = (2.0 / 3.0 * low.abs().max(high.abs())).max(0.2 * distance);
        if high - low > widest * (1.0 + 1e-12) {
            return Err(format!(
                "the band {self} is too wide to say anything: at most {widest:.2e}"
            ));
        }
        Ok(())
    }
}

impl End {
    /// Whether a run ended so.
    pub fn is(&self, failure: Option<&Failure>) -> bool {
        failure.is_some_and(|f| f.status == self.ends_with && self.time.contains(f.time))
    }

    /// Refuses what is no status of an error.
    pub fn check(&self) -> Result<(), String> {
        let names: Vec<String> =
            Status::ALL[1..].iter().map(|status| status_name(*status)).collect();
        if !names.contains(&self.ends_with) {
            let nearest = nearest(&self.ends_with, names.iter().map(String::as_str));
            let name = &self.ends_with;
            return Err(format!("there is no status \"{name}\"; did you mean \"{nearest}\"?"));
        }
        self.time.check(None)
    }
}

impl KnownOrder {
    /// Refuses bands that are none or say little.
    pub fn check(&self, accepted: Band) -> Result<(), String> {
        self.order.check(Some(accepted))?;
        self.last_error.check(None)
    }
}

impl fmt::Display for Band {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} to {}", number(self.0), number(self.1))
    }
}

impl fmt::Display for End {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "error `{}` at {} s", self.ends_with, self.time)
    }
}

impl fmt::Display for Known {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Known::Value(band) => band.fmt(f),
            Known::End(end) => end.fmt(f),
        }
    }
}

impl fmt::Display for KnownOrder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, last error {}", self.order, self.last_error)
    }
}
