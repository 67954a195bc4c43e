//! Free vibration of an elastic bar, fixed at one end.

use lahar::boundary::WallKind;
use lahar::error::Result;
use lahar::world::World;
use serde::Deserialize;
use std::f64::consts::PI;

use crate::judge::slope;
use crate::run::Outcome;
use crate::world::{Elastic, Method, fill, rectangle, wall, write_flow};

/// L = 25 m, E = 100 Pa, ρ = 1 kg/m³, ν = 0; v = 0.1 sin(β x) with β = (2 mode − 1) π / 50.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setup {
    method: Method,
    /// Cells along the bar.
    cells: usize,
    /// Number of the mode, from 1.
    mode: usize,
    /// Particles a cell along each axis.
    particles_per_cell: i32,
    /// Periods that are computed.
    periods: usize,
}

const LENGTH: f64 = 25.0;
const WAVE_SPEED: f64 = 10.0;
const SPEED: f64 = 0.1;

/// Gives `period` [s], `period_error` (relative), `drift` (mean energy of the last period over the first, less 1), and the
/// curve `velocity` of the centre of mass.
pub fn run(setup: &Setup) -> Result<Outcome> {
    let beta = (2 * setup.mode - 1) as f64 * PI / (2.0 * LENGTH);
    let period = 2.0 * PI / (beta * WAVE_SPEED);
    let (mut world, body) = bar(setup)?;
    write_flow(&mut world, body, |x| {
        let (s, c) = (beta * x[0]).sin_cos();
        ([SPEED * s, 0.0], [SPEED * beta * c, 0.0, 0.0, 0.0])
    })?;
    let h = LENGTH / setup.cells as f64;
    let dt = setup.method.cfl * h / (1.02 * WAVE_SPEED);
    let mass = world.totals(None)?.mass;
    let (mut crossings, mut velocity) = (Vec::new(), Vec::new());
    let mut energy = vec![(0.0, 0.0); setup.periods];
    let mut before = world.totals(None)?.momentum[0];
    while world.time() < setup.periods as f64 * period {
        world.step(Some(dt))?;
        let (totals, t) = (world.totals(None)?, world.time());
        let now = totals.momentum[0];
        if before * now < 0.0 {
            let crossing = t - dt * now.abs() / (now - before).abs();
            crossings.push([crossings.len() as f64, crossing]);
        }
        before = now;
        velocity.push([t, now / mass]);
        if let Some((sum, count)) = energy.get_mut((t / period) as usize) {
            *sum += totals.kinetic_energy + totals.strain_energy;
            *count += 1.0;
        }
    }
    let mean = |(sum, count): (f64, f64)| sum / count;
    let measured = 2.0 * slope(&crossings);
    let mut out = Outcome::new();
    out.set("period", measured);
    out.set("period_error", (measured / period - 1.0).abs());
    out.set("drift", mean(energy[setup.periods - 1]) / mean(energy[0]) - 1.0);
    out.curve("velocity", velocity);
    Ok(out)
}

/// One row of cells between walls that keep its height.
fn bar(setup: &Setup) -> Result<(World, i64)> {
    let (context, material) = Elastic::LinearElastic.material(100.0, 0.0)?;
    let h = LENGTH / setup.cells as f64;
    let mut options = setup.method.options(h);
    options.origin = [setup.method.wall_shift() * h; 3];
    let mut world = World::new(&context, &options)?;
    for (axis, side, position) in [(0, 1, 0.0), (1, 1, 0.0), (1, -1, h)] {
        wall(&mut world, WallKind::Slip, axis, side, position)?;
    }
    let region = rectangle([0.0; 2], [LENGTH, h]);
    let body = fill(&mut world, &material, &region, 1.0, setup.particles_per_cell)?;
    Ok((world, body))
}
