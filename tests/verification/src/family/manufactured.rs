//! Manufactured solutions: bodies under the force that makes them move as was chosen.

use lahar::boundary::WallKind;
use lahar::error::Result;
use lahar::shape::ShapeKind;
use lahar::world::World;
use lahar::world::host_arrays::{ParticleArrays, Strided};
use serde::Deserialize;
use std::f64::consts::{PI, TAU};

use crate::motion::{Exact, Motion};
use crate::run::Outcome;
use crate::world::{Method, material, read, wall, write};

/// A neo-Hookean body under the body force of a motion.
///
/// The velocities start half a step early, so that with the order USL the steps are those of the leapfrog scheme, of second order in
/// time. The body fills a unit length along its axes, or a ring.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setup {
    method: Method,
    /// The motion.
    motion: Motion,
    /// Axes along which an axis-aligned motion goes: 1 (a row of cells in the plane), 2 or 3.
    #[serde(default = "plane")]
    axes: usize,
    /// A of the motion.
    amplitude: f64,
    /// Cells along 1 m.
    cells: f64,
    /// Particles a cell along each axis.
    particles_per_cell: usize,
    /// End, in units of 1 m / c, c = √(E / ρ).
    end: f64,
    /// Factor on the body force; with another than 1 the motion is not the chosen one.
    #[serde(default = "whole")]
    force: f64,
}

fn plane() -> usize {
    2
}

fn whole() -> f64 {
    1.0
}

impl Setup {
    fn dimension(&self) -> usize {
        self.axes.max(2)
    }

    fn exact(&self, at: [f64; 3], time: f64) -> Exact {
        self.motion.exact(self.axes, self.amplitude, at, time)
    }
}

/// Particles at rest: positions, volumes, edges.
struct Rest {
    position: Vec<[f64; 3]>,
    volume: Vec<f64>,
    edge: f64,
}

/// Gives `displacement_error` (L2 over the body, over A), `largest_error` (of any particle at any time, over A), `stress_error` (L2 of
/// the normal stresses along the axes of the motion, relative), `volume_error` (largest |J / J_exact − 1| at the end), and the curve
/// `error` (L2 of the displacements over A) over c t.
pub fn run(setup: &Setup) -> Result<Outcome> {
    let material_of = setup.motion.material();
    let speed = material_of.bar_speed();
    let h = 1.0 / setup.cells;
    let end = setup.end / speed;
    let fastest = material_of.wave_speed() + setup.amplitude * PI * speed;
    let steps = (end * fastest / (setup.method.cfl * h)).ceil();
    let dt = end / steps;
    let rest = rest(setup, h);
    let (mut world, body) = body(setup, &rest, dt)?;
    let (d, whole) = (setup.dimension(), rest.volume.iter().sum::<f64>());
    let (mut largest, mut errors) = (0.0, Vec::new());
    for step in 0..=steps as usize {
        let exact = exact(setup, &rest, step as f64 * dt);
        let x = read(&world, body, "position")?;
        let mut sum = 0.0;
        for (k, exact) in exact.iter().enumerate() {
            let square: f64 =
                (0..d).map(|axis| (x[d * k + axis] - exact.position[axis]).powi(2)).sum();
            largest = f64::max(largest, square.sqrt());
            sum += rest.volume[k] * square;
        }
        errors.push([step as f64 / steps * setup.end, (sum / whole).sqrt() / setup.amplitude]);
        if step == steps as usize {
            break;
        }
        let force = columns(exact.len(), d, |k, c| setup.force * exact[k].body_force[c]);
        write(&mut world, body, "body_force", &force)?;
        world.step(Some(dt))?;
    }
    let mut out = Outcome::new();
    out.set("displacement_error", errors[errors.len() - 1][1]);
    out.set("largest_error", largest / setup.amplitude);
    let every = errors.len().div_ceil(200);
    out.curve("error", errors.into_iter().skip(1).step_by(every).collect());
    set_errors_at_end(setup, &rest, (&world, body), &mut out)?;
    Ok(out)
}

/// Sets the errors of stress and volume.
fn set_errors_at_end(
    setup: &Setup,
    rest: &Rest,
    (world, body): (&World, i64),
    out: &mut Outcome,
) -> Result<()> {
    let exact = exact(setup, rest, world.time());
    let (stress, volume) = (read(world, body, "stress")?, read(world, body, "volume")?);
    let (mut away, mut scale, mut growth) = (0.0, 0.0, 0.0);
    for (k, exact) in exact.iter().enumerate() {
        for axis in 0..setup.axes {
            away += rest.volume[k] * (stress[6 * k + axis] - exact.stress[(axis, axis)]).powi(2);
            scale += rest.volume[k] * exact.stress[(axis, axis)].powi(2);
        }
        let j = volume[k] / rest.volume[k] / exact.gradient.determinant();
        growth = f64::max(growth, (j - 1.0).abs());
    }
    if setup.motion != Motion::Vortex {
        out.set("stress_error", f64::sqrt(away / scale)); // the vortex ends without stress
    }
    out.set("volume_error", growth);
    Ok(())
}

/// What all particles should be.
fn exact(setup: &Setup, rest: &Rest, time: f64) -> Vec<Exact> {
    rest.position.iter().map(|at| setup.exact(*at, time)).collect()
}

/// Where particles rest: on a lattice, or on circles if the body is a ring.
fn rest(setup: &Setup, h: f64) -> Rest {
    let pitch = h / setup.particles_per_cell as f64;
    let at = |n: usize, from: f64| from + (n as f64 + 0.5) * pitch;
    let (mut position, mut volume) = (Vec::new(), Vec::new());
    match setup.motion.radii() {
        Some([inner, outer]) => {
            let circles = ((outer - inner) / pitch).round() as usize;
            let around = 4 * (TAU / 4.0 * 0.5 * (inner + outer) / pitch).round() as usize;
            let (width, angle) = ((outer - inner) / circles as f64, TAU / around as f64);
            for n in 0..circles * around {
                let r = inner + ((n / around) as f64 + 0.5) * width;
                let (s, c) = (((n % around) as f64 + 0.5) * angle).sin_cos();
                position.push([r * c, r * s, 0.0]);
                volume.push(r * width * angle);
            }
        }
        None => {
            let count: [usize; 3] = std::array::from_fn(|axis| {
                let cells = if axis < setup.axes { setup.cells.round() as usize } else { 1 };
                if axis < setup.dimension() { cells * setup.particles_per_cell } else { 1 }
            });
            for n in 0..count.iter().product() {
                let [i, j, k] = [n % count[0], n / count[0] % count[1], n / count[0] / count[1]];
                position.push([at(i, 0.0), at(j, 0.0), at(k, 0.0)]);
            }
        }
    }
    if volume.is_empty() {
        volume = vec![pitch.powi(setup.dimension() as i32); position.len()];
    }
    Rest { position, volume, edge: pitch }
}

/// The world with the body as it is at t = 0, with the velocities of half a step before.
fn body(setup: &Setup, rest: &Rest, dt: f64) -> Result<(World, i64)> {
    let (constants, d) = (setup.motion.material(), setup.dimension());
    let values = [
        ("youngs_modulus", constants.youngs_modulus),
        ("poissons_ratio", constants.poissons_ratio),
    ];
    let (context, material) = material("neo_hookean", &values)?;
    let h = 1.0 / setup.cells;
    let mut options = setup.method.options(h);
    options.dimension = d;
    options.cfl = 1.0; // the step is chosen by the run
    options.body_force = true;
    options.origin = [setup.method.wall_shift() * h; 3];
    let mut world = World::new(&context, &options)?;
    if setup.motion == Motion::AxisAligned {
        for axis in 0..d {
            wall(&mut world, WallKind::Slip, axis, 1, 0.0)?;
            let length = if axis < setup.axes { 1.0 } else { h };
            wall(&mut world, WallKind::Slip, axis, -1, length)?;
        }
    }
    let (now, early) = (exact(setup, rest, 0.0), exact(setup, rest, -0.5 * dt));
    let n = now.len();
    let position = columns(n, d, |k, c| now[k].position[c]);
    let volume = columns(n, 1, |k, _| rest.volume[k] * now[k].gradient.determinant());
    let mass = columns(n, 1, |k, _| rest.volume[k] * constants.density);
    let velocity = columns(n, d, |k, c| early[k].velocity[c]);
    let pairs = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];
    let stress = columns(n, 6, |k, c| now[k].stress[pairs[c]]);
    let keeps = options.shape == ShapeKind::UniformGimp;
    let size = columns(n, d, |k, c| if keeps { 1.0 } else { now[k].gradient[(c, c)] } * rest.edge);
    let arrays = ParticleArrays {
        position: Strided::interleaved(&position, d)?,
        volume: Strided::interleaved(&volume, 1)?,
        mass: Some(Strided::interleaved(&mass, 1)?),
        density: 0.0,
        velocity: Some(Strided::interleaved(&velocity, d)?),
        stress: Some(Strided::interleaved(&stress, 6)?),
        size: Some(Strided::interleaved(&size, d)?),
    };
    let body = world.add_particles(&material, &arrays)?;
    let f = columns(n, 9, |k, c| now[k].gradient[(c / 3, c % 3)]);
    write(&mut world, body, "deformation_gradient", &f)?;
    if options.transfer.is_affine() {
        let affine = columns(n, d * d, |k, c| early[k].velocity_gradient[(c / d, c % d)]);
        write(&mut world, body, "affine", &affine)?;
    }
    Ok((world, body))
}

/// Values of points, point after point.
fn columns(points: usize, components: usize, value: impl Fn(usize, usize) -> f64) -> Vec<f64> {
    (0..points * components).map(|n| value(n / components, n % components)).collect()
}
