//! A thick cylinder under pressure from inside.

use lahar::boundary::WallKind;
use lahar::error::Result;
use lahar::world::World;
use serde::Deserialize;

use crate::run::Outcome;
use crate::statics::{pull, ramp, settle};
use crate::world::{Elastic, Method, fill, positions, read, rectangle, wall};

/// Radii a = 1 m and b = 2 m, p = 1 Pa, E = 1 MPa, ν = 0.3, ρ = 1000 kg/m³; axially symmetric, one row of cells between smooth plates. The
/// pressure grows over five times 4 b / c.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setup {
    method: Method,
    /// Cells through the wall of the cylinder.
    cells: usize,
    /// Particles a cell along each axis.
    particles_per_cell: i32,
    /// Local damping.
    damping: f64,
    /// Negative control: the hoop stress is left out of the balance, as in a plane world.
    #[serde(default)]
    plane: bool,
}

const YOUNG: f64 = 1e6;
const POISSON: f64 = 0.3;
const DENSITY: f64 = 1000.0;
const INNER: f64 = 1.0;
const OUTER: f64 = 2.0;

/// Gives `hoop_inner`, `hoop_middle`, `hoop_outer`, `radial_inner`, `radial_middle`, `radial_outer` (stresses over p at 1, 1.5 and
/// 2 m, from the parabola through the means of the three nearest cells), `worst` (largest error of a cell over p), `displacement_inner` (relative
/// error of the displacement at the inner surface), `settled`, `unbalanced`, and the curves `hoop` and `radial` over r.
pub fn run(setup: &Setup) -> Result<Outcome> {
    let h = (OUTER - INNER) / setup.cells as f64;
    let (mut world, body) = cylinder(setup, h)?;
    let start = positions(&world, body)?;
    let period = 4.0 * OUTER / (YOUNG / DENSITY).sqrt();
    let depth = h / f64::from(setup.particles_per_cell);
    pull(&mut world, body, (0, -1), (INNER, depth), ramp(5.0 * period, [1.0, 0.0, 0.0])?)?;
    let mut out = Outcome::new();
    settle(&mut world, 20.0 * period, &mut out)?;
    let (end, stress) = (positions(&world, body)?, read(&world, body, "stress")?);
    let radius: Vec<f64> = start.iter().map(|x| x[0]).collect();
    let mean = |value: &dyn Fn(usize) -> f64| means(&radius, h, setup.cells, value);
    let radial = mean(&|k| stress[6 * k]);
    let hoop = mean(&|k| stress[6 * k + 2]);
    let moved = mean(&|k| end[k][0] - start[k][0]);
    for (name, r) in [("inner", INNER), ("middle", 1.5), ("outer", OUTER)] {
        out.set(&format!("radial_{name}"), near(&radial, r));
        out.set(&format!("hoop_{name}"), near(&hoop, r));
    }
    let error = |curve: &[[f64; 2]], sign: f64| {
        curve.iter().map(|p| (p[1] - lame(p[0], sign)).abs()).fold(0.0, f64::max)
    };
    out.set("worst", error(&radial, -1.0).max(error(&hoop, 1.0)));
    out.set("displacement_inner", near(&moved, INNER) / displacement(INNER) - 1.0);
    out.curve("radial", radial);
    out.curve("hoop", hoop);
    Ok(out)
}

/// Lamé: p a² / (b² − a²) (1 ∓ b² / r²).
fn lame(r: f64, sign: f64) -> f64 {
    INNER.powi(2) / (OUTER.powi(2) - INNER.powi(2)) * (1.0 + sign * (OUTER / r).powi(2))
}

/// Lamé's displacement in plane strain [m].
fn displacement(r: f64) -> f64 {
    let (radial, hoop) = (lame(r, -1.0), lame(r, 1.0));
    (1.0 + POISSON) / YOUNG * ((1.0 - POISSON) * hoop - POISSON * radial) * r
}

fn cylinder(setup: &Setup, h: f64) -> Result<(World, i64)> {
    let (context, material) = Elastic::LinearElastic.material(YOUNG, POISSON)?;
    let mut options = setup.method.options(h);
    options.origin = [0.0, setup.method.wall_shift() * h, 0.0];
    options.damping = setup.damping;
    options.axisymmetric = !setup.plane;
    let mut world = World::new(&context, &options)?;
    for (side, position) in [(1, 0.0), (-1, h)] {
        wall(&mut world, WallKind::Slip, 1, side, position)?;
    }
    let region = rectangle([INNER, 0.0], [OUTER, h]);
    let body = fill(&mut world, &material, &region, DENSITY, setup.particles_per_cell)?;
    Ok((world, body))
}

/// Means over each cell of r and a value of the particles.
fn means(r: &[f64], h: f64, cells: usize, value: &dyn Fn(usize) -> f64) -> Vec<[f64; 2]> {
    let mut sums = vec![[0.0; 3]; cells];
    for (k, r) in r.iter().enumerate() {
        let sum = &mut sums[((r - INNER) / h) as usize];
        *sum = [sum[0] + r, sum[1] + value(k), sum[2] + 1.0];
    }
    sums.iter().map(|sum| [sum[0] / sum[2], sum[1] / sum[2]]).collect()
}

/// The parabola through the three points nearest to r, at r.
fn near(curve: &[[f64; 2]], r: f64) -> f64 {
    let mut points = curve.to_vec();
    points.sort_by(|a, b| (a[0] - r).abs().total_cmp(&(b[0] - r).abs()));
    let points = &points[..3];
    let weight = |k: usize| {
        let others = (0..3).filter(|j| *j != k);
        others.map(|j| (r - points[j][0]) / (points[k][0] - points[j][0])).product::<f64>()
    };
    (0..3).map(|k| weight(k) * points[k][1]).sum()
}
