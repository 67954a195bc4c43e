//! A plate with a hole that is pulled.

use lahar::boundary::WallKind;
use lahar::error::Result;
use lahar::world::World;
use lahar::world::host_arrays::{ParticleArrays, Strided};
use serde::Deserialize;

use super::Setup;
use crate::run::Outcome;
use crate::statics::{pull, ramp, settle};
use crate::world::{Elastic, lattice, positions, read, wall};

/// 5 m × 8 m with a hole of r = 0.5 m in its middle, E = 1 MPa, ν = 0, ρ = 2000 kg/m³; a traction of 1 Pa at both short edges grows
/// over twice 16 m / c. A quarter is computed.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plate {
    /// Cells in the radius of the hole.
    cells: usize,
    /// Particles a cell along each axis.
    particles_per_cell: i32,
}

const RADIUS: f64 = 0.5;
const HALF: [f64; 2] = [2.5, 4.0];
const YOUNG: f64 = 1e6;
const DENSITY: f64 = 2000.0;

impl Plate {
    /// Gives `side` and `crown`, the hoop stress over the traction at the hole's edge beside the load and in line with it: the function
    /// c0 + c1 / ρ² + c2 / ρ⁴, the form of Kirsch's solution, fitted to the particles next to the axis up to 2 r, at ρ = r;
    /// `side_raw` and `crown_raw`, those of the particles nearest to the edge; `settled`, `unbalanced`, and the curve `hoop` over x / r.
    pub fn run(&self, setup: &Setup) -> Result<Outcome> {
        let h = RADIUS / self.cells as f64;
        let pitch = h / f64::from(self.particles_per_cell);
        let (context, material) = Elastic::LinearElastic.material(YOUNG, 0.0)?;
        let mut options = setup.method.options(h);
        options.origin = [setup.method.wall_shift() * h; 3];
        options.damping = setup.damping;
        let mut world = World::new(&context, &options)?;
        for axis in 0..2 {
            wall(&mut world, WallKind::Slip, axis, 1, 0.0)?;
        }
        let points = points(pitch);
        let position: Vec<f64> = points.iter().flat_map(|point| [point[0], point[1]]).collect();
        let volume: Vec<f64> = points.iter().map(|point| point[2]).collect();
        let size = vec![pitch; position.len()];
        let body = world.add_particles(
            &material,
            &ParticleArrays {
                position: Strided::interleaved(&position, 2)?,
                volume: Strided::interleaved(&volume, 1)?,
                mass: None,
                density: DENSITY,
                velocity: None,
                stress: None,
                size: Some(Strided::interleaved(&size, 2)?),
            },
        )?;
        let start = positions(&world, body)?;
        let period = 4.0 * HALF[1] / (YOUNG / DENSITY).sqrt();
        pull(&mut world, body, (1, 1), (HALF[1], pitch), ramp(2.0 * period, [0.0, 1.0, 0.0])?)?;
        let mut out = Outcome::new();
        settle(&mut world, 12.0 * period, &mut out)?;
        let stress = read(&world, body, "stress")?;
        for (name, axis) in [("side", 0), ("crown", 1)] {
            let near = start.iter().zip(stress.chunks(6)).filter(|(x, _)| x[1 - axis] < pitch);
            let hoop = near.map(|(x, s)| [x[axis] / RADIUS, s[1 - axis]]);
            let mut hoop: Vec<[f64; 2]> = hoop.filter(|p| p[0] < 2.0).collect();
            hoop.sort_by(|a, b| a[0].total_cmp(&b[0]));
            out.set(name, at_edge(&hoop));
            out.set(&format!("{name}_raw"), hoop[0][1]);
            out.curve(name, hoop);
        }
        Ok(out)
    }
}

/// Places and volumes: the parts of the squares of a lattice that lie outside the hole, each at its centre of gravity.
fn points(pitch: f64) -> Vec<[f64; 3]> {
    let count = HALF.map(|length| (length / pitch).round() as usize);
    let parts = 16;
    let part = |x: [f64; 2]| {
        let corner = x.map(|x| x - 0.5 * pitch);
        let mut sum = [0.0; 3];
        for p in lattice(corner, [parts; 2], pitch / parts as f64) {
            if p[0].hypot(p[1]) > RADIUS {
                sum = [sum[0] + p[0], sum[1] + p[1], sum[2] + 1.0];
            }
        }
        let volume = sum[2] * (pitch / parts as f64).powi(2);
        [sum[0] / sum[2], sum[1] / sum[2], volume]
    };
    let all = lattice([0.0; 2], count, pitch).into_iter().map(part);
    all.filter(|point| point[2] > 0.0).collect()
}

/// c0 + c1 / ρ² + c2 / ρ⁴ by least squares, at ρ = 1.
fn at_edge(points: &[[f64; 2]]) -> f64 {
    let mut a = [[0.0; 4]; 3];
    for [rho, value] in points {
        let base = [1.0, rho.powi(-2), rho.powi(-4)];
        for i in 0..3 {
            (0..3).for_each(|j| a[i][j] += base[i] * base[j]);
            a[i][3] += base[i] * value;
        }
    }
    for i in 0..3 {
        for k in i + 1..3 {
            let factor = a[k][i] / a[i][i];
            (i..4).for_each(|j| a[k][j] -= factor * a[i][j]);
        }
    }
    let c2 = a[2][3] / a[2][2];
    let c1 = (a[1][3] - a[1][2] * c2) / a[1][1];
    let c0 = (a[0][3] - a[0][1] * c1 - a[0][2] * c2) / a[0][0];
    c0 + c1 + c2
}
