//! The drivers: one file for each family of cases. A driver is a function from a set-up to an [`Outcome`].

mod bar;
mod cantilever;
mod column;
mod cylinder;
mod dam;
mod discs;
mod element;
mod homogeneous;
mod manufactured;
mod self_weight;
mod slosh;
mod specimen;
mod spin;
mod squeeze;
mod tank;
mod vortex;

use lahar::error::Error;
use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::case::{nearest, parse_setup};
use crate::run::Outcome;

/// A run that only has to be started. An error of the engine is a result.
pub type Prepared = Box<dyn FnOnce() -> Result<Outcome, Error>>;

/// How a set-up becomes a run.
type Prepare = fn(&Value) -> Result<Prepared, String>;

/// Every family under its name in the files of the cases.
const FAMILIES: &[(&str, Prepare)] = &[
    ("bar", |setup| with(setup, bar::run)),
    ("cantilever", |setup| with(setup, cantilever::run)),
    ("column", |setup| with(setup, column::run)),
    ("cylinder", |setup| with(setup, cylinder::run)),
    ("dam", |setup| with(setup, dam::run)),
    ("discs", |setup| with(setup, discs::run)),
    ("element", |setup| with(setup, element::run)),
    ("homogeneous", |setup| with(setup, homogeneous::run)),
    ("manufactured", |setup| with(setup, manufactured::run)),
    ("self_weight", |setup| with(setup, self_weight::run)),
    ("slosh", |setup| with(setup, slosh::run)),
    ("specimen", |setup| with(setup, specimen::run)),
    ("spin", |setup| with(setup, spin::run)),
    ("squeeze", |setup| with(setup, squeeze::run)),
    ("tank", |setup| with(setup, tank::run)),
    ("vortex", |setup| with(setup, vortex::run)),
];

/// A run of a family with a set-up; an error tells the nearest family, or where the set-up is wrong.
pub fn prepare(family: &str, setup: &Value) -> Result<Prepared, String> {
    match FAMILIES.iter().find(|(name, _)| *name == family) {
        Some((_, prepare)) => prepare(setup),
        None => {
            let nearest = nearest(family, FAMILIES.iter().map(|(name, _)| *name));
            Err(format!("there is no family \"{family}\"; did you mean \"{nearest}\"?"))
        }
    }
}

fn with<S: DeserializeOwned + 'static>(
    setup: &Value,
    run: fn(&S) -> Result<Outcome, Error>,
) -> Result<Prepared, String> {
    let setup: S = parse_setup(setup)?;
    Ok(Box::new(move || run(&setup)))
}
