//! Whether the loops of the models vectorise: the time of an update per point with every level of vector instructions.

use super::targets::{Check, at_least};
use lahar_model_viscoplastic_fluids::{Bingham, HerschelBulkley};
use lahar_plugin::Driver;
use lahar_plugin::simd::{self, Level};
use std::fmt::Write as _;

const POINTS: usize = 512; // a batch of the engine
const DT: f64 = 1e-4; // [s]
const FASTER: f64 = 1.5; // the best level over the baseline, whose vectors have two lanes
/// Models whose points iterate on their own: their loops do not vectorise.
const ITERATE: [&str; 5] =
    ["johnson_cook", "mohr_coulomb", "matsuoka_nakai", "modified_cam_clay", "nor_sand"];

/// A table of times, and for each model how much faster the best level is than the baseline.
pub fn measure() -> Result<(String, Vec<Check>), String> {
    let samples: [(&str, Driver); 17] = [
        ("linear_elastic", lahar_model_linear_elastic::sample(POINTS)?),
        ("drucker_prager, all points plastic", lahar_model_drucker_prager::sample(POINTS)?),
        ("newtonian, exponent 7", lahar_model_newtonian::sample(7.0, POINTS)?),
        ("newtonian, exponent 7.15", lahar_model_newtonian::sample(7.15, POINTS)?),
        ("neo_hookean", lahar_model_neo_hookean::sample(POINTS)?),
        ("hencky", lahar_model_hencky::sample(POINTS)?),
        ("von_mises, linear hardening", lahar_model_von_mises::sample(0.0, POINTS)?),
        ("von_mises, Voce", lahar_model_von_mises::sample(1e8, POINTS)?),
        ("bingham", lahar_model_viscoplastic_fluids::sample::<Bingham>(POINTS)?),
        ("herschel_bulkley", lahar_model_viscoplastic_fluids::sample::<HerschelBulkley>(POINTS)?),
        ("mu_i", lahar_model_mu_i::sample(POINTS)?),
        ("ideal_gas", lahar_model_ideal_gas::sample(POINTS)?),
        ("johnson_cook", lahar_model_johnson_cook::sample(POINTS)?),
        ("mohr_coulomb", lahar_model_mohr_coulomb::sample(POINTS)?),
        ("matsuoka_nakai", lahar_model_matsuoka_nakai::sample(POINTS)?),
        ("modified_cam_clay", lahar_model_modified_cam_clay::sample(POINTS)?),
        ("nor_sand", lahar_model_nor_sand::sample(POINTS)?),
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
        if let [first, .., last] = times[..]
            && !ITERATE.contains(&name)
        {
            let what = format!("{name}: best vector instructions over the baseline");
            checks.push(at_least(what, first / last, FASTER));
        }
    }
    Ok((text, checks))
}
