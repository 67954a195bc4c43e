//! Water sloshes in a tank in its first mode, a little.

use lahar::boundary::WallKind;
use lahar::error::Result;
use lahar::world::World;
use serde::Deserialize;
use std::f64::consts::PI;

use crate::judge::slope;
use crate::run::Outcome;
use crate::world::{Cloud, Method, material, wall, write_flow};

/// L = 1 m, depth 0.5 m, ρ = 1000 kg/m³, g = 9.81 m/s², no viscosity, sound at ten times √(g × 0.5 m), flat surface, and the velocity
/// of the first mode: u = −A k sin(k x) cosh(k y), v = A k cos(k x) sinh(k y), k = π / L.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setup {
    method: Method,
    /// Cells along the tank.
    cells: usize,
    /// Largest elevation of the surface [m].
    amplitude: f64,
    /// Periods that are computed.
    periods: f64,
}

const DENSITY: f64 = 1000.0;
const GRAVITY: f64 = 9.81;
const DEPTH: f64 = 0.5;

/// Gives `period` [s], `period_error` (relative), `loss` (of the amplitude of the momentum in the last period, of that of the first), and the curve `velocity`
/// of the centre of mass.
pub fn run(setup: &Setup) -> Result<Outcome> {
    let omega = (GRAVITY * PI * (PI * DEPTH).tanh()).sqrt();
    let period = 2.0 * PI / omega;
    let mut world = tank(setup, omega)?;
    let mass = world.totals(None)?.mass;
    let (mut crossings, mut velocity) = (Vec::new(), Vec::new());
    let mut before = [0.0, world.totals(None)?.momentum[0] / mass];
    let end = setup.periods * period;
    while world.time() < end {
        world.advance(end, 1).1?;
        let now = [world.time(), world.totals(None)?.momentum[0] / mass];
        if before[1] * now[1] < 0.0 {
            let share = before[1] / (before[1] - now[1]);
            let crossing = before[0] + share * (now[0] - before[0]);
            crossings.push([crossings.len() as f64, crossing]);
        }
        velocity.push(now);
        before = now;
    }
    let largest = |from: f64| {
        let within = velocity.iter().filter(|p| (from..from + period).contains(&p[0]));
        within.map(|p| p[1].abs()).fold(0.0, f64::max)
    };
    let mut out = Outcome::new();
    let measured = 2.0 * slope(&crossings);
    out.set("period", measured);
    out.set("period_error", (measured / period - 1.0).abs());
    out.set("loss", 1.0 - largest(end - period) / largest(0.0));
    out.curve("velocity", velocity);
    Ok(out)
}

fn tank(setup: &Setup, omega: f64) -> Result<World> {
    let bulk = DENSITY * 100.0 * GRAVITY * DEPTH;
    let values = [("bulk_modulus", bulk), ("viscosity", 0.0), ("equation_of_state", 1.0)];
    let (context, water) = material("newtonian", &values)?;
    let h = 1.0 / setup.cells as f64;
    let mut options = setup.method.options(h);
    options.origin = [setup.method.wall_shift() * h; 3];
    options.gravity = [0.0, -GRAVITY, 0.0];
    let mut world = World::new(&context, &options)?;
    for (axis, side, position) in [(0, 1, 0.0), (0, -1, 1.0), (1, 1, 0.0)] {
        wall(&mut world, WallKind::Slip, axis, side, position)?;
    }
    let pressure = |y: f64| DENSITY * GRAVITY * (DEPTH - y);
    let count = [2 * setup.cells, setup.cells];
    let cloud = Cloud::fluid_at_rest([0.0; 2], count, 0.5 * h, (DENSITY, bulk), pressure);
    let body = cloud.add(&mut world, &water)?;
    // the surface moves by v(H) / ω
    let a = setup.amplitude * omega / (PI * (PI * DEPTH).sinh());
    let flow = |x: &[f64; 2]| {
        let ((s, c), (sh, ch)) = ((PI * x[0]).sin_cos(), ((PI * x[1]).sinh(), (PI * x[1]).cosh()));
        let (k, k2) = (a * PI, a * PI * PI);
        ([-k * s * ch, k * c * sh], [-k2 * c * ch, -k2 * s * sh, -k2 * s * sh, k2 * c * ch])
    };
    write_flow(&mut world, body, flow)?;
    Ok(world)
}
