//! Whether the loops of the models vectorise: the time of an update per point with every level of vector instructions.

use super::targets::{Check, at_least};
use lahar_plugin::Driver;
use lahar_plugin::simd::{self, Level};
use std::fmt::Write as _;

const POINTS: usize = 512; // a batch of the engine
const DT: f64 = 1e-4; // [s]
const FASTER: f64 = 1.5; // the best level over the baseline, whose vectors have two lanes

/// A table of times, and for each model how much faster the best level is than the baseline.
pub fn measure() -> Result<(String, Vec<Check>), String> {
    let samples: [(&str, Driver); 6] = [
        ("linear_elastic", lahar_model_linear_elastic::sample(POINTS)?),
        ("drucker_prager, all points plastic", lahar_model_drucker_prager::sample(POINTS)?),
        ("newtonian, exponent 7", lahar_model_newtonian::sample(7.0, POINTS)?),
        ("newtonian, exponent 7.15", lahar_model_newtonian::sample(7.15, POINTS)?),
        ("neo_hookean", lahar_model_neo_hookean::sample(POINTS)?),
        ("hencky", lahar_model_hencky::sample(POINTS)?),
    ];
    let mut text = String::from("| update of a model [ns/point] |");
    let levels: Vec<Level> = Level::ALL.into_iter().filter(|level| level.is_available()).collect();
    for level in &levels {
        let _ = write!(text, " {} |", level.name());
    }
    let _ = writeln!(text, "\n|---|{}", "---:|".repeat(levels.len()));
    let mut checks = Vec::new();
    for (name, mut driver) in samples {
        let mut times = Vec::new();
        for level in &levels {
            simd::force(*level);
            times.push(driver.nanoseconds_per_point(DT)?);
        }
        let shown: String = times.iter().map(|time| format!(" {time:.1} |")).collect();
        let _ = writeln!(text, "| {name} |{shown}");
        if let [first, .., last] = times[..] {
            let what = format!("{name}: best vector instructions over the baseline");
            checks.push(at_least(what, first / last, FASTER));
        }
    }
    Ok((text, checks))
}
