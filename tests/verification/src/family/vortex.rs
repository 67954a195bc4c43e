//! Taylor–Green vortices decay.

use lahar::boundary::WallKind;
use lahar::error::Result;
use lahar::world::World;
use serde::Deserialize;
use std::f64::consts::PI;

use crate::run::Outcome;
use crate::world::{Cloud, Method, advance, material, wall, write_flow};

/// u = U sin(k x) cos(k y), v = −U cos(k x) sin(k y), k = 2 π / 1 m, U = 1 m/s, ρ = 1 kg/m³, ν = 0.01 m²/s. One eddy fills the square
/// from 0 to 1/2 m; slip walls are planes of symmetry of the flow.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setup {
    method: Method,
    /// Cells along the wavelength, a multiple of 2.
    cells: usize,
    /// Particles a cell along each axis.
    particles_per_cell: usize,
    /// Speed of sound over U.
    sound_speed: f64,
    /// Pressure that is added everywhere [ρ U²], against tension.
    #[serde(default)]
    background: f64,
    /// End [s].
    end: f64,
}

const VISCOSITY: f64 = 0.01;
const WAVE_NUMBER: f64 = 2.0 * PI;
const EDDY: f64 = 0.5;

/// Gives `kinetic` (energy over that at the start), `kinetic_error` (relative), `speed` (the root of `kinetic`), and the curves `kinetic` and
/// `exact` over time.
pub fn run(setup: &Setup) -> Result<Outcome> {
    let mut world = vortices(setup)?;
    let start = world.totals(None)?.kinetic_energy;
    let decay = |t: f64| (-4.0 * VISCOSITY * WAVE_NUMBER * WAVE_NUMBER * t).exp();
    let (mut kinetic, mut exact) = (vec![[0.0, 1.0]], vec![[0.0, 1.0]]);
    for part in 1..=50 {
        let t = setup.end * f64::from(part) / 50.0;
        advance(&mut world, t)?;
        kinetic.push([t, world.totals(None)?.kinetic_energy / start]);
        exact.push([t, decay(t)]);
    }
    let last = kinetic[kinetic.len() - 1][1];
    let mut out = Outcome::new();
    out.set("kinetic", last);
    out.set("kinetic_error", (last / decay(setup.end) - 1.0).abs());
    out.set("speed", last.sqrt());
    out.curve("kinetic", kinetic);
    out.curve("exact", exact);
    Ok(out)
}

fn vortices(setup: &Setup) -> Result<World> {
    let bulk = setup.sound_speed * setup.sound_speed;
    let values = [("bulk_modulus", bulk), ("viscosity", VISCOSITY), ("equation_of_state", 1.0)];
    let (context, water) = material("newtonian", &values)?;
    let h = 1.0 / setup.cells as f64;
    let mut options = setup.method.options(h);
    options.origin = [setup.method.wall_shift() * h; 3];
    let mut world = World::new(&context, &options)?;
    for axis in [0, 1] {
        wall(&mut world, WallKind::Slip, axis, 1, 0.0)?;
        wall(&mut world, WallKind::Slip, axis, -1, EDDY)?;
    }
    let per_cell = setup.particles_per_cell;
    let count = [setup.cells / 2 * per_cell; 2];
    let pitch = h / per_cell as f64;
    let mut cloud = Cloud::fluid_at_rest([0.0; 2], count, pitch, (1.0, bulk), |_| 0.0);
    let k = WAVE_NUMBER;
    for (n, x) in cloud.position.iter().enumerate() {
        // p = ρ U² / 4 (cos 2 k x + cos 2 k y)
        let p = setup.background + 0.25 * ((2.0 * k * x[0]).cos() + (2.0 * k * x[1]).cos());
        cloud.volume[n] = pitch * pitch / (1.0 + p / bulk);
        cloud.stress[n] = [-p, -p, -p, 0.0, 0.0, 0.0];
    }
    let body = cloud.add(&mut world, &water)?;
    let flow = |x: &[f64; 2]| {
        let [(sx, cx), (sy, cy)] = x.map(|x| (k * x).sin_cos());
        ([sx * cy, -cx * sy], [k * cx * cy, -k * sx * sy, k * sx * sy, -k * cx * cy])
    };
    write_flow(&mut world, body, flow)?;
    Ok(world)
}
