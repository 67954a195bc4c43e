//! Cases as data.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::family::{self, Prepared};
use crate::known::{Known, KnownOrder};

/// A verification case, the content of one file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// Id, `D2` for example; the file has its name in small letters.
    pub case: String,
    /// Title.
    pub title: String,
    /// Where the reference comes from: text, DOI.
    pub source: String,
    /// The set-up in words.
    pub setup: String,
    /// Name of the driver, see [`family`].
    pub family: String,
    /// Set-up that all runs share; a run's own values stand above it.
    #[serde(default)]
    pub common: Map<String, Value>,
    /// The runs.
    pub runs: Vec<Run>,
    /// Values that are gated.
    #[serde(default)]
    pub checks: Vec<Check>,
    /// Orders of convergence that are gated.
    #[serde(default)]
    pub orders: Vec<Order>,
    /// What is drawn.
    #[serde(default)]
    pub plots: Vec<Plot>,
    /// What a reader must know beside the numbers: a gate that is not reached, for example, and why.
    #[serde(default)]
    pub remarks: Vec<String>,
}

/// One run of the driver.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Run {
    /// Name, unique in the case.
    pub name: String,
    /// Whether it belongs to the test suite or only to the full report.
    #[serde(default)]
    pub size: Size,
    /// Parameters of the family.
    #[serde(default)]
    pub setup: Map<String, Value>,
}

/// Where a run belongs.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Size {
    /// To the test suite and to the report.
    #[default]
    Ci,
    /// To the full report.
    Full,
}

/// A quantity of a run and its gate.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Check {
    /// Name of the run.
    pub run: String,
    /// Name of the quantity. `failed` is 1 if the engine refused to go on, else 0.
    pub quantity: String,
    /// What it should be; gates of an error need it.
    pub reference: Option<f64>,
    /// What is accepted.
    pub gate: Gate,
    /// What the run is known to give if its method misses the gate: then it must give that.
    pub known: Option<Known>,
    /// A word on it; the reason of a known miss.
    #[serde(default)]
    pub note: String,
}

/// What is accepted of a value.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(rename_all = "snake_case")]
pub enum Gate {
    /// |value / reference − 1| is at most this.
    Relative(f64),
    /// |value − reference| is at most this.
    Absolute(f64),
    /// The value is at most this.
    AtMost(f64),
    /// The value is at least this.
    AtLeast(f64),
    /// The value lies between these.
    Between(f64, f64),
}

/// An observed order of convergence: the slope of log error over log h, where h is 1 / `cells` of the set-up, or 1 / `steps`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Order {
    /// What it is called in the table.
    pub name: String,
    /// Runs from coarse to fine.
    pub runs: Vec<String>,
    /// The error, a quantity of each run.
    pub quantity: String,
    /// How the order is taken.
    #[serde(default)]
    pub fit: Fit,
    /// What is accepted.
    pub gate: Gate,
    /// What the runs are known to give if their method misses the gate: then they must give that.
    pub known: Option<KnownOrder>,
    /// A word on it; the reason of a known miss.
    #[serde(default)]
    pub note: String,
}

/// How an order is taken from the errors.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Fit {
    /// From the last two runs.
    #[default]
    LastPair,
    /// A line through all, by least squares.
    LeastSquares,
}

/// A plot of the report.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Plot {
    /// Caption.
    pub title: String,
    /// Label of the axis, with its unit.
    pub x: String,
    /// Label of the axis, with its unit.
    pub y: String,
    /// Both axes logarithmic.
    #[serde(default)]
    pub log: bool,
    /// The curves.
    pub curves: Vec<Curve>,
}

/// A curve of a plot: a series of one run, or a quantity of several runs over their `cells`.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Curve {
    /// Label; the name of the run if there is none.
    #[serde(default)]
    pub label: String,
    /// The run of a series.
    #[serde(default)]
    pub run: String,
    /// Name of the series.
    #[serde(default)]
    pub series: String,
    /// The runs of a quantity.
    #[serde(default)]
    pub runs: Vec<String>,
    /// Name of the quantity.
    #[serde(default)]
    pub quantity: String,
    /// Dots instead of a line.
    #[serde(default)]
    pub dots: bool,
}

impl Case {
    /// Reads a case and checks that it is whole: known keys, known runs, set-ups that the family takes.
    pub fn read(path: &Path) -> Result<Case, String> {
        let text = std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
        Case::parse(&text).map_err(|e| format!("{}: {e}", path.display()))
    }

    /// The same from text.
    pub fn parse(text: &str) -> Result<Case, String> {
        let mut source = serde_json::Deserializer::from_str(text);
        let case: Case = serde_path_to_error::deserialize(&mut source).map_err(located)?;
        source.end().map_err(|e| e.to_string())?;
        case.check().map_err(|e| format!("case {}: {e}", case.case))?;
        Ok(case)
    }

    /// The set-up of a run: what is common to all, and above it what is its own.
    pub fn setup_of(&self, run: &Run) -> Value {
        let mut all = Value::Object(self.common.clone());
        merge(&mut all, &Value::Object(run.setup.clone()));
        all
    }

    /// A run, ready to go.
    pub fn prepare(&self, run: &Run) -> Result<Prepared, String> {
        family::prepare(&self.family, &self.setup_of(run))
            .map_err(|e| format!("run \"{}\": {e}", run.name))
    }

    /// The run of this name.
    pub fn run(&self, name: &str) -> Result<&Run, String> {
        self.runs.iter().find(|run| run.name == name).ok_or_else(|| {
            let nearest = nearest(name, self.runs.iter().map(|run| run.name.as_str()));
            format!("there is no run \"{name}\"; did you mean \"{nearest}\"?")
        })
    }

    /// Cells of a run, for an order; steps if it has none.
    pub fn cells_of(&self, name: &str) -> Result<f64, String> {
        let setup = self.setup_of(self.run(name)?);
        let cells = setup.get("cells").or_else(|| setup.get("steps")).and_then(Value::as_f64);
        cells.ok_or_else(|| {
            format!("run \"{name}\" has no `cells` or `steps`, which an order needs")
        })
    }

    /// Runs that a check, an order or a plot needs, by name, beside the runs that stand in several places.
    fn used_runs(&self) -> impl Iterator<Item = &str> {
        let checks = self.checks.iter().map(|check| check.run.as_str());
        let orders = self.orders.iter().flat_map(|order| &order.runs).map(String::as_str);
        checks.chain(orders)
    }

    fn curve_runs(&self) -> impl Iterator<Item = &str> {
        let curves = self.plots.iter().flat_map(|plot| &plot.curves);
        curves.flat_map(|curve| {
            let one = (!curve.run.is_empty()).then_some(curve.run.as_str());
            one.into_iter().chain(curve.runs.iter().map(String::as_str))
        })
    }

    fn check(&self) -> Result<(), String> {
        let mut names = BTreeSet::new();
        for run in &self.runs {
            if !names.insert(run.name.as_str()) {
                return Err(format!("two runs are called \"{}\"", run.name));
            }
            drop(self.prepare(run)?);
        }
        for name in self.used_runs().chain(self.curve_runs()) {
            self.run(name)?;
        }
        let used: BTreeSet<&str> = self.used_runs().collect();
        if let Some(name) = names.difference(&used).next() {
            return Err(format!("run \"{name}\" is not checked by anything"));
        }
        for check in &self.checks {
            check.check().map_err(|e| format!("run \"{}\", {}: {e}", check.run, check.quantity))?;
        }
        for order in &self.orders {
            order.check().map_err(|e| format!("order \"{}\": {e}", order.name))?;
            order.runs.iter().try_for_each(|name| self.cells_of(name).map(drop))?;
        }
        Ok(())
    }
}

impl Check {
    fn check(&self) -> Result<(), String> {
        let Some(accepted) = self.gate.accepted(self.reference) else {
            return Err("its gate needs a `reference`".to_string());
        };
        if self.quantity == "failed" && self.gate.accepts(1.0, self.reference) {
            return Err(
                "its gate accepts any error; give a known miss with `ends_with`".to_string()
            );
        }
        let Some(known) = &self.known else { return Ok(()) };
        match known {
            Known::Value(_) if self.quantity == "failed" => {
                return Err("a band of `failed` accepts any error; give `ends_with`".to_string());
            }
            Known::Value(band) => band.check(Some(accepted))?,
            Known::End(end) => end.check()?,
        }
        reason(&self.note)
    }
}

impl Order {
    fn check(&self) -> Result<(), String> {
        if self.runs.len() < 2 {
            return Err("it needs two runs or more".to_string());
        }
        let Some(accepted) = self.gate.accepted(None) else {
            return Err("an order has no reference, and its gate needs one".to_string());
        };
        let Some(known) = &self.known else { return Ok(()) };
        known.check(accepted)?;
        reason(&self.note)
    }
}

/// A known miss has its reason beside it.
fn reason(note: &str) -> Result<(), String> {
    if note.is_empty() {
        Err("a known miss needs its reason, a `note`".to_string())
    } else {
        Ok(())
    }
}

/// Puts the values of `above` over those of `below`, object by object.
fn merge(below: &mut Value, above: &Value) {
    match (below, above) {
        (Value::Object(below), Value::Object(above)) => {
            for (key, value) in above {
                merge(below.entry(key.clone()).or_insert(Value::Null), value);
            }
        }
        (below, above) => *below = above.clone(),
    }
}

/// A set-up from data; an error tells where it stands.
pub fn parse_setup<S: DeserializeOwned>(value: &Value) -> Result<S, String> {
    serde_path_to_error::deserialize(value).map_err(located)
}

fn located<E: std::fmt::Display>(error: serde_path_to_error::Error<E>) -> String {
    format!("at `{}`: {}", error.path(), error.inner())
}

/// The folder of the cases.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../cases")
}

/// The files of all cases, sorted by name.
pub fn files() -> Result<Vec<PathBuf>, String> {
    let folder = folder();
    let listing = std::fs::read_dir(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut files: Vec<PathBuf> = listing
        .filter_map(|entry| entry.ok().map(|entry| entry.path()))
        .filter(|path| path.extension().is_some_and(|extension| extension == "json"))
        .collect();
    files.sort();
    Ok(files)
}

/// All cases, or those with the given ids (capitals do not matter).
pub fn load(ids: &[String]) -> Result<Vec<Case>, String> {
    let all: Vec<Case> = files()?.iter().map(|path| Case::read(path)).collect::<Result<_, _>>()?;
    let known = |id: &str| all.iter().any(|case| case.case.eq_ignore_ascii_case(id));
    if let Some(id) = ids.iter().find(|id| !known(id)) {
        let nearest = nearest(id, all.iter().map(|case| case.case.as_str()));
        return Err(format!("there is no case \"{id}\"; did you mean {nearest}?"));
    }
    let wanted =
        |case: &Case| ids.is_empty() || ids.iter().any(|id| case.case.eq_ignore_ascii_case(id));
    Ok(all.into_iter().filter(wanted).collect())
}

/// The known name that is most like `name`.
pub fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> &'a str {
    let name = name.to_lowercase();
    let likeness = |other: &&str| strsim::jaro_winkler(&name, &other.to_lowercase());
    known.max_by(|a, b| likeness(a).total_cmp(&likeness(b))).unwrap_or("none")
}
