//! Taylor–Green vortices decay.

use lahar::boundary::WallKind;
use lahar::error::Result;
use lahar::world::World;
use serde::Deserialize;
use std::f64::consts::PI;

use crate::run::Outcome;
use crate::world::{Cloud, Method, Transfer, advance, material, positions, read, wall, write};

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
    /// Eddies along each axis, an odd number; the one in the middle is measured.
    eddies: usize,
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

/// Gives `kinetic` (energy of the eddy over that at the start), `speed` (its root), `exact`, and the curves `kinetic`, `exact`
/// over time and `density` (root mean square of ρ / ρ0 − 1).
pub fn run(setup: &Setup) -> Result<Outcome> {
    let (mut world, body) = vortices(setup)?;
    let low = EDDY * (setup.eddies / 2) as f64;
    let energy = |world: &World| -> Result<f64> {
        let (x, v) = (positions(world, body)?, read(world, body, "velocity")?);
        let inside = |x: &[f64; 2]| x.iter().all(|x| (low..low + EDDY).contains(x));
        let square = x.iter().zip(v.chunks(2)).filter(|(x, _)| inside(x));
        Ok(square.map(|(_, v)| v[0] * v[0] + v[1] * v[1]).sum())
    };
    let start = energy(&world)?;
    let decay = |t: f64| (-4.0 * VISCOSITY * WAVE_NUMBER * WAVE_NUMBER * t).exp();
    let (mut kinetic, mut exact) = (vec![[0.0, 1.0]], vec![[0.0, 1.0]]);
    for part in 1..=50 {
        let t = setup.end * f64::from(part) / 50.0;
        advance(&mut world, t)?;
        kinetic.push([t, energy(&world)? / start]);
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

fn vortices(setup: &Setup) -> Result<(World, i64)> {
    let bulk = setup.sound_speed * setup.sound_speed;
    let values = [("bulk_modulus", bulk), ("viscosity", VISCOSITY), ("equation_of_state", 1.0)];
    let (context, water) = material("newtonian", &values)?;
    let h = 1.0 / setup.cells as f64;
    let mut options = setup.method.options(h);
    options.origin = [setup.method.wall_shift() * h; 3];
    let mut world = World::new(&context, &options)?;
    let length = EDDY * setup.eddies as f64;
    for axis in [0, 1] {
        wall(&mut world, WallKind::Slip, axis, 1, 0.0)?;
        wall(&mut world, WallKind::Slip, axis, -1, length)?;
    }
    let per_cell = setup.particles_per_cell;
    let count = [setup.cells / 2 * setup.eddies * per_cell; 2];
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
    let (v, gradient): (Vec<[f64; 2]>, Vec<[f64; 4]>) = cloud.position.iter().map(flow).unzip();
    write(&mut world, body, "velocity", v.as_flattened())?;
    if setup.method.transfer == Transfer::Apic {
        write(&mut world, body, "affine", gradient.as_flattened())?;
    }
    Ok((world, body))
}
