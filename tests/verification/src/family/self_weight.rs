//! A column that settles under its own weight, at finite strain.

use lahar::boundary::WallKind;
use lahar::error::Result;
use lahar::world::World;
use serde::Deserialize;

use crate::run::Outcome;
use crate::statics::{ramp, settle};
use crate::world::{Method, fill, material, positions, read, rectangle, wall};

/// One column of cells on a smooth floor between smooth walls, ν = 0; g = 10 m/s² grows over five first periods 4 l0 / c.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setup {
    method: Method,
    /// Cells along the column.
    cells: usize,
    /// Length at rest l0 [m].
    length: f64,
    /// Young's modulus E [Pa].
    youngs_modulus: f64,
    /// Weight in a volume at rest ρ0 g [N/m³].
    unit_weight: f64,
    /// Particles a cell along each axis.
    particles_per_cell: i32,
    /// The law, `hencky` or `linear_elastic`.
    model: String,
    /// Local damping.
    damping: f64,
    /// First periods after which it must be at rest.
    periods: f64,
}

const GRAVITY: f64 = 10.0;

/// Gives `height` and `settlement` of the top [m], `displacement_error` (root of the mean square over the settlement),
/// `stress_error` (that of σ + ρ0 g (l0 − Y) over ρ0 g l0), `settled`, `unbalanced`, and the curve `stress` over Y / l0.
pub fn run(setup: &Setup) -> Result<Outcome> {
    let h = setup.length / setup.cells as f64;
    let (mut world, body) = column(setup, h)?;
    let start = positions(&world, body)?;
    let density = setup.unit_weight / GRAVITY;
    let period = 4.0 * setup.length / (setup.youngs_modulus / density).sqrt();
    world.set_gravity_table(Some(ramp(5.0 * period, [0.0, -GRAVITY, 0.0])?))?;
    let mut out = Outcome::new();
    settle(&mut world, setup.periods * period, &mut out)?;
    measure(&mut out, setup, (&world, body), &start)?;
    Ok(out)
}

fn column(setup: &Setup, h: f64) -> Result<(World, i64)> {
    let values = [("youngs_modulus", setup.youngs_modulus), ("poissons_ratio", 0.0)];
    let (context, material) = material(&setup.model, &values)?;
    let mut options = setup.method.options(h);
    options.origin = [setup.method.wall_shift() * h; 3];
    options.damping = setup.damping;
    let mut world = World::new(&context, &options)?;
    for (axis, side, position) in [(0, 1, 0.0), (0, -1, h), (1, 1, 0.0)] {
        wall(&mut world, WallKind::Slip, axis, side, position)?;
    }
    let region = rectangle([0.0; 2], [h, setup.length]);
    let density = setup.unit_weight / GRAVITY;
    let body = fill(&mut world, &material, &region, density, setup.particles_per_cell)?;
    Ok((world, body))
}

fn measure(
    out: &mut Outcome,
    setup: &Setup,
    (world, body): (&World, i64),
    start: &[[f64; 2]],
) -> Result<()> {
    let (end, stress) = (positions(world, body)?, read(world, body, "stress")?);
    let volume = read(world, body, "volume")?;
    let (length, scale) = (setup.length, setup.unit_weight * setup.length);
    let width = length / setup.cells as f64 / f64::from(setup.particles_per_cell);
    let tops = end.iter().zip(&volume).map(|(x, volume)| x[1] + 0.5 * volume / width);
    let height = tops.fold(0.0, f64::max);
    out.set("height", height);
    out.set("settlement", length - height);
    let exact = |y: f64| setup.height_above(0.0) - setup.height_above(y);
    let settlement = length - exact(length);
    let (mut displacement, mut error, mut stresses) = (0.0, 0.0, Vec::new());
    for ((x, now), s) in start.iter().zip(&end).zip(stress.chunks(6)) {
        displacement += ((now[1] - exact(x[1])) / settlement).powi(2);
        error += ((s[1] + setup.unit_weight * (length - x[1])) / scale).powi(2);
        stresses.push([x[1] / length, s[1] / scale]);
    }
    let rms = |squares: f64| (squares / start.len() as f64).sqrt();
    out.set("displacement_error", rms(displacement));
    out.set("stress_error", rms(error));
    stresses.sort_by(|a, b| a[0].total_cmp(&b[0]));
    stresses.dedup_by(|a, b| a[0] == b[0]);
    out.curve("stress", stresses);
    Ok(())
}

impl Setup {
    /// Height at rest of what stood above Y: ∫ λ dY, s = ρ0 g (l0 − Y) / E.
    ///
    /// The stress is −ρ0 g (l0 − Y). With E ln λ / λ it follows that ln λ = −w, w exp(w) = s, dY = −(E / ρ0 g) (1 + w) exp(w) dw; with
    /// E ln λ, the law of strain rates, that ln λ = −s.
    fn height_above(&self, y: f64) -> f64 {
        let s = self.unit_weight * (self.length - y) / self.youngs_modulus;
        let scale = self.youngs_modulus / self.unit_weight;
        if self.model == "hencky" {
            let w = lambert_w(s);
            return scale * (w + 0.5 * w * w);
        }
        scale * (1.0 - (-s).exp())
    }
}

/// W(s) for s ≥ 0, w exp(w) = s, by Newton's method.
fn lambert_w(s: f64) -> f64 {
    let newton = |w: f64| w - (w - s * (-w).exp()) / (1.0 + w);
    (0..20).fold(s, |w, _| newton(w))
}
