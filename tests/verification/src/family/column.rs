//! A column of dry sand collapses on a rough floor.

use lahar::boundary::{Wall, WallKind};
use lahar::error::Result;
use lahar::world::World;
use serde::Deserialize;

use crate::run::Outcome;
use crate::world::{Cloud, Method, lattice, material, positions, read, wall};

/// Width d0 = 1 m, height a d0, ρ = 1600 kg/m³, φ = 30°, c = 0, ψ = 0, ν = 0.3; waves ten times as fast as a fall from h0 / 2.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setup {
    method: Method,
    /// Cells along d0.
    cells: usize,
    /// Aspect ratio a.
    ratio: f64,
    /// Which Mohr-Coulomb strength the cone has: 0 triaxial compression, 2 plane strain.
    #[serde(default = "plane_strain")]
    cone: f64,
    /// Friction of the floor; without it the sand sticks.
    floor_friction: Option<f64>,
}

fn plane_strain() -> f64 {
    2.0
}

const GRAVITY: f64 = 9.81;
const DENSITY: f64 = 1600.0;
const POISSON: f64 = 0.3;
/// PIC is blended in at this rate, in wave speeds over 0.35 h.
const PIC: f64 = 0.01;

/// Gives `run_out_99` and `run_out_999` ((x − d0) / d0 of the quantiles of the mass), `height` at the wall over d0,
/// `kinetic` (over the potential energy at the start), `volume` (over that at the start), and the curves `surface` and `front`.
pub fn run(setup: &Setup) -> Result<Outcome> {
    let h0 = setup.ratio;
    let h = 1.0 / setup.cells as f64;
    let wave_speed = 10.0 * (GRAVITY * h0).sqrt();
    let (mut world, body) = column(setup, h, wave_speed)?;
    let start = world.totals(None)?;
    let longest = setup.method.cfl * h / (wave_speed + (2.0 * GRAVITY * h0).sqrt());
    let end = 5.0 * (h0 / GRAVITY).sqrt();
    let mut front = Vec::new();
    while world.time() < end {
        if world.step_count() % 100 == 0 {
            let x = quantile(&positions(&world, body)?, 0.99);
            front.push([world.time() / (h0 / GRAVITY).sqrt(), x - 1.0]);
        }
        let stable = world.stable_dt()?;
        world.step(Some(stable.min(longest)))?;
    }
    let (x, volume) = (positions(&world, body)?, read(&world, body, "volume")?);
    let volume0 = 0.25 * h * h;
    let near = x.iter().filter(|x| x[0] < 2.0 * h).count() as f64;
    let mut out = Outcome::new();
    out.set("run_out_99", quantile(&x, 0.99) - 1.0);
    out.set("run_out_999", quantile(&x, 0.999) - 1.0);
    out.set("height", near * volume0 / (2.0 * h));
    out.set("kinetic", world.totals(None)?.kinetic_energy / start.potential_energy);
    out.set("volume", volume.iter().sum::<f64>() / (volume0 * x.len() as f64));
    out.curve("surface", surface(&x, 4.0 * h, volume0));
    out.curve("front", front);
    Ok(out)
}

fn column(setup: &Setup, h: f64, wave_speed: f64) -> Result<(World, i64)> {
    let (nu, modulus) = (POISSON, DENSITY * wave_speed * wave_speed);
    let values = [
        ("youngs_modulus", modulus * (1.0 + nu) * (1.0 - 2.0 * nu) / (1.0 - nu)),
        ("poissons_ratio", nu),
        ("friction_angle", 30.0),
        ("cohesion", 0.0),
        ("dilation_angle", 0.0),
        ("cone", setup.cone),
    ];
    let (context, sand) = material("drucker_prager", &values)?;
    let mut method = setup.method;
    method.pic_rate = PIC * wave_speed / (0.35 * h);
    let mut options = method.options(h);
    options.origin = [setup.method.wall_shift() * h; 3];
    options.gravity = [0.0, -GRAVITY, 0.0];
    let mut world = World::new(&context, &options)?;
    wall(&mut world, WallKind::Slip, 0, 1, 0.0)?;
    let (kind, friction) = match setup.floor_friction {
        None => (WallKind::Sticky, 0.0),
        Some(friction) => (WallKind::Friction, friction),
    };
    world.add_wall(&Wall { axis: 1, side: 1, position: 0.0, kind, friction })?;
    let rows = (2.0 * setup.cells as f64 * setup.ratio).round() as usize;
    let position = lattice([0.0; 2], [2 * setup.cells, rows], 0.5 * h);
    let k0 = nu / (1.0 - nu);
    let stress_at = |y: f64| {
        let s = -DENSITY * GRAVITY * (setup.ratio - y);
        [k0 * s, s, k0 * s, 0.0, 0.0, 0.0]
    };
    let cloud = Cloud {
        volume: vec![0.25 * h * h; position.len()],
        mass: vec![0.25 * h * h * DENSITY; position.len()],
        stress: position.iter().map(|x| stress_at(x[1])).collect(),
        position,
    };
    let body = cloud.add(&mut world, &sand)?;
    Ok((world, body))
}

/// Coordinate left of which the share `q` of the particles stands.
fn quantile(x: &[[f64; 2]], q: f64) -> f64 {
    let mut x: Vec<f64> = x.iter().map(|x| x[0]).collect();
    x.sort_by(f64::total_cmp);
    x[(q * x.len() as f64).ceil() as usize - 1]
}

/// Height of the sand in strips of a width.
fn surface(x: &[[f64; 2]], width: f64, volume: f64) -> Vec<[f64; 2]> {
    let strip = |x: f64| (x.max(0.0) / width) as usize;
    let strips = x.iter().map(|x| strip(x[0])).max().map_or(0, |last| last + 1);
    let mut heights: Vec<[f64; 2]> = (0..strips).map(|k| [(k as f64 + 0.5) * width, 0.0]).collect();
    x.iter().for_each(|x| heights[strip(x[0])][1] += volume / width);
    heights
}
