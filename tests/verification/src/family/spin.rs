//! A free disc turns once about its centre.

use lahar::error::Result;
use lahar::world::World;
use serde::Deserialize;
use std::f64::consts::TAU;

use crate::run::Outcome;
use crate::world::{Elastic, Method, advance, disc, fill, positions, write_flow};

/// r = 0.25 m at (0.5, 0.5), E = 1000 Pa, ν = 0.3, ρ = 1000 kg/m³, ω = 0.2 rad/s, 2 × 2 particles a cell, one turn.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setup {
    method: Method,
    /// Cells along 1 m.
    cells: usize,
    /// Model.
    #[serde(default)]
    model: Elastic,
}

const CENTER: f64 = 0.5;
const RADIUS: f64 = 0.25;
const SPIN: f64 = 0.2;

/// Gives `angular_momentum` and `kinetic` (after the turn, over those at the start), `angular_momentum_error` (|ratio − 1|),
/// `position_error` (largest distance from where a rigid disc would be, over h), and the curve `angular_momentum` over turns.
pub fn run(setup: &Setup) -> Result<Outcome> {
    let (context, material) = setup.model.material(1000.0, 0.3)?;
    let h = 1.0 / setup.cells as f64;
    let mut world = World::new(&context, &setup.method.options(h))?;
    let body = fill(&mut world, &material, &disc([CENTER; 2], RADIUS), 1000.0, 2)?;
    let start = positions(&world, body)?;
    write_flow(&mut world, body, |x| {
        let v = [-SPIN * (x[1] - CENTER), SPIN * (x[0] - CENTER)];
        (v, [0.0, -SPIN, SPIN, 0.0])
    })?;
    let begin = world.totals(None)?;
    let end = TAU / SPIN;
    let mut curve = vec![[0.0, 1.0]];
    for part in 1..=100 {
        let turns = f64::from(part) / 100.0;
        advance(&mut world, turns * end)?;
        let ratio = world.totals(None)?.angular_momentum[2] / begin.angular_momentum[2];
        curve.push([turns, ratio]);
    }
    let totals = world.totals(None)?;
    let momentum = totals.angular_momentum[2] / begin.angular_momentum[2];
    let moved = positions(&world, body)?;
    let distance = |(a, b): (&[f64; 2], &[f64; 2])| (a[0] - b[0]).hypot(a[1] - b[1]) / h;
    let mut out = Outcome::new();
    out.set("angular_momentum", momentum);
    out.set("angular_momentum_error", (momentum - 1.0).abs());
    out.set("kinetic", totals.kinetic_energy / begin.kinetic_energy);
    out.set("position_error", start.iter().zip(&moved).map(distance).fold(0.0, f64::max));
    out.curve("angular_momentum", curve);
    Ok(out)
}
