//! Time of a material's `update` per point, for every level of vector instructions that this processor has:
//! `cargo bench --bench materials`. The batches are those of the engine, 256 points.
#![allow(clippy::print_stdout)] // figures are what a bench is for

use lahar::context::Context;
use lahar::material::{Material, StressBatch};
use lahar_plugin::Driver;
use lahar_plugin::simd::{self, Level};
use std::error::Error;
use std::time::Instant;

const POINTS: usize = 256;
const DT: f64 = 1e-4;

fn main() -> Result<(), Box<dyn Error>> {
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
    let through_table = 8.0 * lahar_model_linear_elastic::sample(8)?.nanoseconds_per_point(DT)?;
    println!("linear_elastic, call of 8 points: {through_table:.0} ns through the table");
    println!("the same through the engine: {:.0} ns", engine_call()?);
    Ok(())
}

/// Time of `Material::update` for 8 points of linear elasticity, linked statically [ns]; the fastest of several runs.
fn engine_call() -> Result<f64, Box<dyn Error>> {
    const CALLS: u32 = 10_000;
    let context = Context::new(Some(1))?;
    context.register_plugin(lahar_model_linear_elastic::plugin())?;
    let values = [("youngs_modulus", 1.0e7), ("poissons_ratio", 0.3)];
    let material = Material::new(&context, "linear_elastic", &values)?;
    let (strain, stress0, density) = ([1e-6; 48], [0.0; 48], [1000.0; 8]);
    let (mut stress1, mut wave_speed, mut status) = ([0.0; 48], [0.0; 8], [0; 8]);
    let mut fastest = f64::INFINITY;
    // As in a step, where the context is entered once for many calls.
    context.install(|| -> lahar::error::Result<()> {
        for _ in 0..20 {
            let start = Instant::now();
            for _ in 0..CALLS {
                material.update(&mut StressBatch {
                    n: 8,
                    stride: 8,
                    dt: DT,
                    time: 0.0,
                    strain_increment: &strain,
                    velocity_gradient: &[],
                    deformation_gradient: &[],
                    stress0: &stress0,
                    state0: &[],
                    stress1: &mut stress1,
                    state1: &mut [],
                    density: &density,
                    element_length: &[],
                    wave_speed: &mut wave_speed,
                    diffusivity: &mut [],
                    energy: &mut [],
                    dt_factor: &mut [],
                    status: &mut status,
                })?;
            }
            fastest = fastest.min(start.elapsed().as_secs_f64() * 1e9 / f64::from(CALLS));
        }
        Ok(())
    })?;
    Ok(fastest)
}
