//! A column of each shipped model stands under its weight, with typical parameters and far outside
//! those that are advised.

use crate::setup::{a_box, context_of, fill, read, world, write};
use crate::support::shipped;
use lahar::boundary::{Wall, WallKind};
use lahar::context::Context;
use lahar::error::Status;
use lahar::material::{Input, Material, Model, Parameter, ParameterKind};
use lahar::world::World;
use lahar::world::options::Options;
use std::sync::Arc;
use std::thread;

const HEIGHT: f64 = 0.8;
const SPACING: f64 = 0.1;
const GRAVITY: f64 = 9.81;
/// Steps of a run: waves cross the column some forty times, whatever its stiffness.
const STEPS: i64 = 1000;
/// Of the gas [Pa].
const GAS_PRESSURE: f64 = 1e5;

fn density(model: &Model) -> f64 {
    if model.input(Input::InternalEnergy).is_some() { 1.2 } else { 1800.0 }
}

/// A column between slip walls; an error of the material, of its parameters or of the run.
fn column(
    context: &Arc<Context>,
    model: &Model,
    values: &[(&str, f64)],
) -> Result<World, (Status, String)> {
    let failed = |e: lahar::error::Error| (e.status, e.message);
    let options = Options {
        dimension: 2,
        spacing: SPACING,
        gravity: [0.0, -GRAVITY, 0.0],
        damping: 0.2,
        ..Options::default()
    };
    let material = Material::new(context, model.name, values).map_err(failed)?;
    let mut world = world(context, &options);
    // The gas fills its box; a free surface would let it expand into nothing.
    let gas = model.input(Input::InternalEnergy).is_some();
    let top = if gas { HEIGHT } else { 4.0 * HEIGHT };
    for (axis, side, position) in [(0, 1, 0.0), (0, -1, 0.2), (1, 1, 0.0), (1, -1, top)] {
        world
            .add_wall(&Wall { axis, side, position, kind: WallKind::Slip, friction: 0.0 })
            .map_err(failed)?;
    }
    let body =
        fill(&mut world, &material, &a_box([0.0; 3], [0.2, HEIGHT, 0.0]), density(model), [0.0; 3]);
    if gas {
        let per_volume = GAS_PRESSURE / 0.4; // e = p / ((gamma - 1) rho)
        let energies: Vec<f64> =
            read(&world, body, "volume").iter().map(|v| v * per_volume).collect();
        write(&mut world, body, "strain_energy", &energies);
    }
    let (steps, result) = world.advance(1e9, STEPS);
    result.map_err(|e| (e.status, format!("after {steps} steps: {}", e.message)))?;
    Ok(world)
}

/// Every required parameter at its typical value.
fn typical(model: &Model) -> Vec<(&'static str, f64)> {
    model.parameters.iter().filter(|p| p.required).map(|p| (p.key, p.default)).collect()
}

/// A parameter as far outside its advised bounds as these are from 0; one without bounds, since it
/// has a dimension, at a hundred times its typical value and at a hundredth; both inside the hard
/// bounds.
fn beyond(p: &Parameter) -> Vec<f64> {
    if p.kind != ParameterKind::Real {
        return Vec::new();
    }
    let low = if p.advised_min > 0.0 { 0.5 * p.advised_min } else { 2.0 * p.advised_min };
    let high = if p.advised_max > 0.0 { 2.0 * p.advised_max } else { 0.5 * p.advised_max };
    let unbounded = p.required && low.is_infinite() && high.is_infinite();
    let values = if unbounded { [0.01 * p.default, 100.0 * p.default] } else { [low, high] };
    values.into_iter().filter(|v| v.is_finite()).map(|v| v.clamp(p.hard_min, p.hard_max)).collect()
}

/// Runs `work` for each shipped model at once, each in a context of its own.
fn for_each_model(work: impl Fn(&Arc<Context>, &'static Model) + Sync) {
    let work = &work;
    thread::scope(|scope| {
        for name in shipped() {
            scope.spawn(move || {
                let context = context_of(&name);
                for model in context.models() {
                    work(&context, model);
                }
            });
        }
    });
}

#[test]
fn a_column_of_each_model_comes_to_rest_under_its_weight() {
    for_each_model(|context, model| {
        let world = column(context, model, &typical(model))
            .unwrap_or_else(|(_, text)| panic!("{}: {text}", model.name));
        let (stress, volume) = (read(&world, 0, "stress"), read(&world, 0, "volume"));
        let total: f64 = volume.iter().sum();
        let vertical = stress.chunks(6).zip(&volume).map(|(s, v)| s[1] * v).sum::<f64>() / total;
        let totals = world.totals(None).unwrap();
        let fall = totals.mass * GRAVITY * HEIGHT;
        println!(
            "{}: mean vertical stress {vertical:.4e} Pa, kinetic energy {:.1e} of the weight's",
            model.name,
            totals.kinetic_energy / fall
        );
        // The mean over the volume is half the weight over the area, by the balance of moments, for
        // any material at rest; a gas has the pressure of its box beside it.
        let weight = 0.5 * totals.mass * GRAVITY / 0.2;
        let gas = model.input(Input::InternalEnergy).is_some();
        let expected = if gas { -GAS_PRESSURE } else { -weight };
        assert!(
            (vertical / expected - 1.0).abs() < 0.05,
            "{}: {vertical} of {expected}",
            model.name
        );
        assert!(totals.kinetic_energy < 1e-3 * fall, "{}: does not come to rest", model.name);
    });
}

#[test]
fn a_column_of_each_model_stays_finite_far_outside_what_is_advised_or_typical() {
    for_each_model(|context, model| {
        let (mut runs, mut refused) = (0, 0);
        for parameter in &model.parameters {
            for value in beyond(parameter) {
                let mut values = typical(model);
                values.retain(|(key, _)| *key != parameter.key);
                values.push((parameter.key, value));
                match column(context, model, &values) {
                    Ok(_) => runs += 1,
                    // Values that do not go together are refused before anything runs, with a
                    // reason.
                    Err((Status::OutOfBounds, text)) if !text.is_empty() => {
                        println!("{}: {} = {value}: {text}", model.name, parameter.key);
                        refused += 1;
                    }
                    Err((_, text)) => panic!("{}: {} = {value}: {text}", model.name, parameter.key),
                }
            }
        }
        println!("{}: {runs} columns stay finite, {refused} are refused", model.name);
        assert!(runs > 2 * refused && runs > 1, "{}: {runs} runs, {refused} refused", model.name);
    });
}
