//! Time of a material's `update` per point, for every level of vector instructions that this processor has:
//! `cargo bench --bench materials`. The batches are those of the engine, 256 points.
#![allow(clippy::print_stdout)] // figures are what a bench is for

use lahar_plugin::Driver;
use lahar_plugin::simd::{self, Level};

const POINTS: usize = 256;
const DT: f64 = 1e-4;

fn main() -> Result<(), String> {
    let only = std::env::args().skip(1).find(|a| !a.starts_with("--")).unwrap_or_default();
    let samples: [(&str, Driver); 4] = [
        ("linear_elastic", lahar_model_linear_elastic::sample(POINTS)?),
        ("drucker_prager, plastic", lahar_model_drucker_prager::sample(POINTS)?),
        ("newtonian, exponent 7", lahar_model_newtonian::sample(7.0, POINTS)?),
        ("newtonian, exponent 7.15", lahar_model_newtonian::sample(7.15, POINTS)?),
    ];
    println!("{:26} {:8} ns/point", "model", "level");
    for (name, mut driver) in samples.into_iter().filter(|s| s.0.contains(&only)) {
        for level in Level::ALL.into_iter().filter(|level| simd::force(*level)) {
            println!("{name:26} {:8} {:.2}", level.name(), driver.nanoseconds_per_point(DT)?);
        }
    }
    Ok(())
}
