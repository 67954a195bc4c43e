//! A nearly incompressible block between plates to which it is bonded.

use lahar::boundary::prescribed_velocity::{X, Y};
use lahar::boundary::{BoxRegion, PrescribedVelocity, Table, WallKind};
use lahar::error::Result;
use lahar::world::World;
use serde::Deserialize;

use crate::run::Outcome;
use crate::statics::settle;
use crate::world::{Elastic, Method, advance, fill, positions, read, rectangle, wall};

/// Width 4 m, height 1 m, plane strain, E = 1 MPa, ρ = 1000 kg/m³; the plates approach by 1 mm in the time in which a shear wave crosses the
/// width eight times, and stay. A quarter is computed.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setup {
    method: Method,
    /// Cells over half the height.
    cells: usize,
    /// Particles a cell along each axis.
    particles_per_cell: i32,
    /// Poisson's ratio.
    poissons_ratio: f64,
    /// Whether dilations are averaged.
    f_bar: bool,
    /// Local damping.
    damping: f64,
    /// Times in which a shear wave crosses the width, after which it must be at rest.
    crossings: f64,
}

const HALF_WIDTH: f64 = 2.0;
const HALF_HEIGHT: f64 = 0.5;
const YOUNG: f64 = 1e6;
const DENSITY: f64 = 1000.0;
/// How far a plate moves [m].
const WAY: f64 = 5e-4;

/// Gives `modulus`, the mean stress on the plates over the strain and over E, `reaction`, the same from the force of the plate,
/// `noise`, the root of the mean square of p less the mean p of the particles within a cell around over that of p, both of particles
/// two cells and more from the edges, `settled`, `unbalanced`, and the curve `pressure` over x / half the width of the middle row.
pub fn run(setup: &Setup) -> Result<Outcome> {
    let h = HALF_HEIGHT / setup.cells as f64;
    let (mut world, body, top) = block(setup, h)?;
    let start = positions(&world, body)?;
    let shear_speed = (YOUNG / (2.0 * (1.0 + setup.poissons_ratio) * DENSITY)).sqrt();
    let crossing = 2.0 * HALF_WIDTH / shear_speed;
    let end = 8.0 * crossing;
    let squeeze = |speed: f64| PrescribedVelocity {
        region: BoxRegion { min: [-9.0, HALF_HEIGHT, -9.0], max: [9.0; 3] },
        components: X | Y,
        velocity: Table::constant([0.0, -speed, 0.0]),
    };
    let id = world.add_prescribed_velocity(squeeze(WAY / end))?;
    advance(&mut world, end)?;
    world.remove_prescribed_velocity(id)?;
    let id = world.add_prescribed_velocity(squeeze(0.0))?;
    let mut out = Outcome::new();
    settle(&mut world, setup.crossings * crossing, &mut out)?;
    let strain = WAY / HALF_HEIGHT * world.time().min(end) / end;
    let stress = read(&world, body, "stress")?;
    let n = start.len() as f64;
    let mean = stress.chunks(6).map(|s| s[1]).sum::<f64>() / n;
    let force = world.prescribed_velocity_reaction(id)?[1] + world.wall_reaction(top)?[1];
    out.set("modulus", -mean / (strain * YOUNG));
    out.set("reaction", -force / (HALF_WIDTH * strain * YOUNG));
    let pressure: Vec<f64> = stress.chunks(6).map(|s| -(s[0] + s[1] + s[2]) / 3.0).collect();
    out.set("noise", noise(&start, &pressure, h));
    let row =
        start.iter().zip(&pressure).filter(|(x, _)| x[1] < h / f64::from(setup.particles_per_cell));
    let mut row: Vec<[f64; 2]> =
        row.map(|(x, p)| [x[0] / HALF_WIDTH, p / (strain * YOUNG)]).collect();
    row.sort_by(|a, b| a[0].total_cmp(&b[0]));
    out.curve("pressure", row);
    Ok(out)
}

/// A quarter of the block: world, body, and the wall where the plate is.
fn block(setup: &Setup, h: f64) -> Result<(World, i64, i64)> {
    let (context, rubber) = Elastic::LinearElastic.material(YOUNG, setup.poissons_ratio)?;
    let mut options = setup.method.options(h);
    options.damping = setup.damping;
    let mut world = World::new(&context, &options)?;
    for axis in 0..2 {
        wall(&mut world, WallKind::Slip, axis, 1, 0.0)?;
    }
    // the plate moves the nodes on this wall, which is there for the shape functions
    let top = wall(&mut world, WallKind::Slip, 1, -1, HALF_HEIGHT)?;
    let region = rectangle([0.0; 2], [HALF_WIDTH, HALF_HEIGHT]);
    let body = fill(&mut world, &rubber, &region, DENSITY, setup.particles_per_cell)?;
    world.set_f_bar(body, setup.f_bar)?;
    Ok((world, body, top))
}

/// See [`run`].
fn noise(x: &[[f64; 2]], pressure: &[f64], h: f64) -> f64 {
    let inside = |x: &[f64; 2]| {
        x[0] > 2.0 * h
            && x[0] < HALF_WIDTH - 2.0 * h
            && x[1] > 1.5 * h
            && x[1] < HALF_HEIGHT - 1.5 * h
    };
    let reach = 1.05 * h;
    let near = |a: &[f64; 2], b: &[f64; 2]| (0..2).all(|d| (a[d] - b[d]).abs() < reach);
    let (mut rough, mut all) = (0.0, 0.0);
    for (a, p) in x.iter().zip(pressure).filter(|(a, _)| inside(a)) {
        let around = x.iter().zip(pressure).filter(|(b, _)| near(a, b));
        let (sum, count) = around.fold((0.0, 0.0), |(sum, n), (_, p)| (sum + p, n + 1.0));
        rough += (p - sum / count).powi(2);
        all += p * p;
    }
    f64::sqrt(rough / all)
}
