//! A cantilever bent by large rotations.

use lahar::boundary::WallKind;
use lahar::error::Result;
use lahar::world::World;
use serde::Deserialize;
use std::f64::consts::TAU;

use crate::run::Outcome;
use crate::statics::{at_zero, pull, ramp, settle};
use crate::world::{Method, fill, material, positions, rectangle, wall};

/// L = 10 m, plane strain, Hencky's law with E = 12 MPa, ν = 0.2, ρ = 1000 kg/m³; the load grows over a period of the first
/// mode.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setup {
    method: Method,
    /// Depth d [m].
    depth: f64,
    /// Cells across the depth.
    cells: usize,
    /// Particles a cell along each axis.
    particles_per_cell: i32,
    /// The load.
    load: Load,
    /// Its size over E' I / L²: the force on the end face or the whole weight.
    factor: f64,
    /// Local damping.
    damping: f64,
    /// Periods of the first mode after which it must be at rest.
    periods: f64,
}

#[derive(Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
enum Load {
    /// A dead force on the end face.
    End,
    /// The beam's own weight.
    Weight,
}

const LENGTH: f64 = 10.0;
const YOUNG: f64 = 12e6;
const POISSON: f64 = 0.2;
const DENSITY: f64 = 1000.0;
/// (β L)² of the first mode of a cantilever.
const FIRST_MODE: f64 = 3.516_015;

/// Gives `deflection` and `shortening` of the middle of the end face over L, `settled`, `unbalanced`, `kinetic` (energy over the strain
/// energy), and the curve `axis`, the middle line over L.
pub fn run(setup: &Setup) -> Result<Outcome> {
    let h = setup.depth / setup.cells as f64;
    let (mut world, body) = beam(setup, h)?;
    let start = positions(&world, body)?;
    let bending = YOUNG / (1.0 - POISSON * POISSON) * setup.depth.powi(3) / 12.0;
    let period = TAU / FIRST_MODE * (DENSITY * setup.depth * LENGTH.powi(4) / bending).sqrt();
    let force = setup.factor * bending / LENGTH.powi(2);
    let until = period;
    if setup.load == Load::End {
        let depth = h / f64::from(setup.particles_per_cell);
        let traction = ramp(until, [0.0, -force / setup.depth, 0.0])?;
        pull(&mut world, body, (0, 1), (LENGTH, depth), traction)?;
    } else {
        let gravity = force / (DENSITY * setup.depth * LENGTH);
        world.set_gravity_table(Some(ramp(until, [0.0, -gravity, 0.0])?))?;
    }
    let mut out = Outcome::new();
    settle(&mut world, setup.periods * period, &mut out)?;
    let totals = world.totals(None)?;
    out.set("kinetic", totals.kinetic_energy / totals.strain_energy);
    let axis = middle_line(&start, &positions(&world, body)?);
    // the line through the last sections, continued to the end face
    let last = &axis[axis.len() - 3..];
    let at_end = |c: usize| {
        at_zero(&last.iter().map(|p| [p[0] - LENGTH, p[c]]).collect::<Vec<_>>()) / LENGTH
    };
    out.set("shortening", 1.0 - at_end(1));
    out.set("deflection", -at_end(2));
    out.curve("axis", axis.iter().map(|p| [p[1] / LENGTH, p[2] / LENGTH]).collect());
    Ok(out)
}

fn beam(setup: &Setup, h: f64) -> Result<(World, i64)> {
    let values = [("youngs_modulus", YOUNG), ("poissons_ratio", POISSON)];
    let (context, material) = material("hencky", &values)?;
    let mut options = setup.method.options(h);
    options.origin = [setup.method.wall_shift() * h, 0.0, 0.0];
    options.damping = setup.damping;
    let mut world = World::new(&context, &options)?;
    wall(&mut world, WallKind::Sticky, 0, 1, 0.0)?;
    let region = rectangle([0.0, -0.5 * setup.depth], [LENGTH, 0.5 * setup.depth]);
    let body = fill(&mut world, &material, &region, DENSITY, setup.particles_per_cell)?;
    Ok((world, body))
}

/// Mean position of the particles of each section: X at the start, x and y now, from the clamp to the end.
fn middle_line(start: &[[f64; 2]], end: &[[f64; 2]]) -> Vec<[f64; 3]> {
    let mut pairs: Vec<_> = start.iter().zip(end).collect();
    pairs.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
    let sections = pairs.chunk_by(|a, b| (a.0[0] - b.0[0]).abs() < 1e-9);
    let mean = |section: &[(&[f64; 2], &[f64; 2])]| {
        let n = section.len() as f64;
        let sum = |c: usize| section.iter().map(|pair| pair.1[c]).sum::<f64>();
        [section[0].0[0], sum(0) / n, sum(1) / n]
    };
    sections.map(mean).collect()
}
