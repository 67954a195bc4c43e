//! Fluid at rest in a tank.

use lahar::boundary::WallKind;
use lahar::error::Result;
use lahar::world::World;
use serde::Deserialize;

use crate::run::Outcome;
use crate::world::{Cloud, Method, advance, material, positions, read, wall};

/// Depth 0.1 m, width 0.2 m, ρ = 1800 kg/m³, K = 1 MPa, no viscosity, g = 9.81 m/s², 2 × 2 particles a cell.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setup {
    method: Method,
    /// Cells along the depth.
    cells: usize,
    /// How the fluid comes under its weight.
    start: Start,
    /// First periods of the depth, 4 H / c, that are computed.
    periods: f64,
    /// Local damping.
    #[serde(default)]
    damping: f64,
}

#[derive(Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
enum Start {
    /// Gravity grows over five periods.
    Ramp,
    /// Gravity acts at once.
    Step,
    /// The stresses are those of the depth from the start.
    Equilibrium,
}

const DEPTH: f64 = 0.1;
const WIDTH: f64 = 0.2;
const DENSITY: f64 = 1800.0;
const BULK: f64 = 1e6;
const GRAVITY: f64 = 9.81;
const SCALE: f64 = DENSITY * GRAVITY * DEPTH;

/// Gives, over ρ g H, `cell_mean_error` (largest of the rows of cells), `inner_error` (largest of the particles two cells and more
/// from walls and surface), `anisotropy` (largest difference of horizontal and vertical stress), and `kinetic` (energy over
/// ρ g H times the volume), and the curve `pressure` over depth of the rows.
pub fn run(setup: &Setup) -> Result<Outcome> {
    let (mut world, body) = tank(setup)?;
    let period = 4.0 * DEPTH / (BULK / DENSITY).sqrt();
    let end = setup.periods * period;
    while setup.start == Start::Ramp && world.time() < 5.0 * period {
        let share = (world.time() / (5.0 * period)).min(1.0);
        world.set_gravity([0.0, -share * GRAVITY, 0.0])?;
        world.advance(end, 1).1?;
    }
    world.set_gravity([0.0, -GRAVITY, 0.0])?;
    advance(&mut world, end)?;
    let mut out = Outcome::new();
    let totals = world.totals(None)?;
    out.set("kinetic", totals.kinetic_energy / (SCALE * DEPTH * WIDTH));
    measure(&mut out, setup.cells, &positions(&world, body)?, &read(&world, body, "stress")?);
    Ok(out)
}

fn pressure(y: f64) -> f64 {
    DENSITY * GRAVITY * (DEPTH - y)
}

fn tank(setup: &Setup) -> Result<(World, i64)> {
    let values = [("bulk_modulus", BULK), ("viscosity", 0.0), ("equation_of_state", 1.0)];
    let (context, water) = material("newtonian", &values)?;
    let h = DEPTH / setup.cells as f64;
    let mut options = setup.method.options(h);
    options.origin = [setup.method.wall_shift() * h; 3];
    options.damping = setup.damping;
    let mut world = World::new(&context, &options)?;
    for (axis, side, position) in [(0, 1, 0.0), (0, -1, WIDTH), (1, 1, 0.0)] {
        wall(&mut world, WallKind::Slip, axis, side, position)?;
    }
    let weight = if setup.start == Start::Equilibrium { 1.0 } else { 0.0 };
    let count = [4 * setup.cells, 2 * setup.cells];
    let at_rest = |y: f64| weight * pressure(y);
    let cloud = Cloud::fluid_at_rest([0.0; 2], count, 0.5 * h, (DENSITY, BULK), at_rest);
    let body = cloud.add(&mut world, &water)?;
    Ok((world, body))
}

fn measure(out: &mut Outcome, cells: usize, x: &[[f64; 2]], stress: &[f64]) {
    let h = DEPTH / cells as f64;
    let mut rows = vec![[0.0; 3]; cells]; // pressure, depth, particles
    let (mut inner, mut anisotropy) = (0.0_f64, 0.0_f64);
    let far = |x: f64, length: f64| x > 2.0 * h && x < length - 2.0 * h;
    for (x, s) in x.iter().zip(stress.chunks(6)) {
        let row = &mut rows[((x[1] / h) as usize).min(cells - 1)];
        *row = [row[0] - s[1], row[1] + (DEPTH - x[1]), row[2] + 1.0];
        anisotropy = anisotropy.max((s[0] - s[1]).abs());
        if far(x[0], WIDTH) && far(x[1], DEPTH) {
            inner = inner.max((-s[1] - pressure(x[1])).abs());
        }
    }
    let rows: Vec<[f64; 2]> = rows.iter().map(|row| [row[1] / row[2], row[0] / row[2]]).collect();
    let error = |row: &[f64; 2]| (row[1] - DENSITY * GRAVITY * row[0]).abs();
    out.set("cell_mean_error", rows.iter().map(error).fold(0.0, f64::max) / SCALE);
    out.set("inner_error", inner / SCALE);
    out.set("anisotropy", anisotropy / SCALE);
    out.curve("pressure", rows.iter().map(|row| [row[0] / DEPTH, row[1] / SCALE]).collect());
}
