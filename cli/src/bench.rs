//! `lahar plugin bench`: nanoseconds per point.

use crate::plugin::{Choice, Library, json, values};
use crate::point::{Given, Point, Points};
use crate::say;
use clap::Args;
use lahar::material::{Input, Material, Model};
use lahar::tensor::Mat3;
use serde::Serialize;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};

const SIZES: [usize; 3] = [1, 64, 1024];
/// The fastest of so many runs counts.
const RUNS: usize = 15;
/// Length of a run.
const RUN: Duration = Duration::from_millis(20);

/// Arguments of `lahar plugin bench`.
#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    choice: Choice,
    /// Prints JSON
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Timed {
    model: &'static str,
    function: &'static str,
    n: usize,
    ns_per_point: f64,
}

/// Times every chosen model.
pub fn run(arguments: &Arguments) -> Result<ExitCode, String> {
    let library = Library::open(&arguments.choice.library).map_err(|e| e.to_string())?;
    let mut all = Vec::new();
    for model in library.models(arguments.choice.model.as_deref())? {
        let values = values(model, &arguments.choice.set)?;
        let material = library.material(model, &values)?;
        for n in SIZES {
            let mut points = points(model, &material, n)?;
            let update = fastest(n, || points.update(&material))?;
            let wave_speed = fastest(n, || points.wave_speed(&material))?;
            for (function, ns_per_point) in [("update", update), ("wave_speed", wave_speed)] {
                all.push(Timed { model: model.name, function, n, ns_per_point });
            }
        }
    }
    if arguments.json {
        say(&json(&all)?);
    } else {
        say(&table(&all));
    }
    Ok(ExitCode::SUCCESS)
}

fn table(all: &[Timed]) -> String {
    let mut text = format!("{:<28} {:<11}", "ns per point", "");
    for n in SIZES {
        text += &format!(" {:>9}", format!("n = {n}"));
    }
    text.push('\n');
    let models: Vec<&str> = all.iter().map(|t| t.model).collect();
    for (i, model) in models.iter().enumerate() {
        if models[..i].contains(model) {
            continue;
        }
        for function in ["update", "wave_speed"] {
            text += &format!("{model:<28} {function:<11}");
            for t in all.iter().filter(|t| t.model == *model && t.function == function) {
                text += &format!(" {:>9.1}", t.ns_per_point);
            }
            text.push('\n');
        }
    }
    text
}

/// Points in a small shear under pressure, different in each point.
fn points(model: &'static Model, material: &Arc<Material>, n: usize) -> Result<Points, String> {
    let energy = if model.input(Input::InternalEnergy).is_some() { 2e5 } else { 0.0 };
    let given = |k: usize| -> Result<Given, String> {
        let mut point = Point::new(model, 1e4, 1000.0, energy);
        let first = point.at_rest(model);
        let mut one = Points::new(model, std::slice::from_ref(&first));
        match one.init_state(material) {
            Ok(()) => point.state = one.got(0).state,
            Err(_) => point = Point::new(model, 0.0, 1000.0, energy),
        }
        let e = 0.01 * (1.0 + (k % 7) as f64);
        let l = Mat3::new(-2.0 * e, 3.0 * e, 0.0, e, e, -e, 0.0, e, -2.0 * e);
        Ok(point.given(model, &l, 1e-4))
    };
    let given: Vec<Given> = (0..n).map(given).collect::<Result<_, _>>()?;
    Ok(Points::new(model, &given))
}

/// Nanoseconds per point of the fastest run.
fn fastest(n: usize, mut call: impl FnMut() -> lahar::error::Result<()>) -> Result<f64, String> {
    let mut calls = 1;
    let mut best = f64::INFINITY;
    for _ in 0..RUNS {
        loop {
            let start = Instant::now();
            for _ in 0..calls {
                call().map_err(|e| e.to_string())?;
            }
            let time = start.elapsed();
            best = best.min(time.as_secs_f64() * 1e9 / (calls * n) as f64);
            if time >= RUN {
                break;
            }
            calls *= 2;
        }
    }
    Ok(best)
}
