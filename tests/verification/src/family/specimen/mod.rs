//! Specimens of linear elasticity under plain loads: a cube that is pressed, a bar and a plate with a hole that are pulled.

mod plate;

use lahar::boundary::{BoxRegion, PrescribedVelocity, Table, WallKind};
use lahar::error::Result;
use lahar::particles::seeding::Region;
use lahar::world::World;
use serde::Deserialize;

use crate::run::Outcome;
use crate::statics::{pull, ramp, settle};
use crate::world::{Elastic, Method, fill, positions, read, rectangle, wall, write};

/// A specimen and how it is computed.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setup {
    method: Method,
    specimen: Specimen,
    /// Local damping.
    #[serde(default)]
    damping: f64,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum Specimen {
    Cube(Cube),
    Bar(Bar),
    Plate(plate::Plate),
}

/// See the specimens.
pub fn run(setup: &Setup) -> Result<Outcome> {
    match &setup.specimen {
        Specimen::Cube(cube) => cube.run(setup),
        Specimen::Bar(bar) => bar.run(setup),
        Specimen::Plate(plate) => plate.run(setup),
    }
}

/// A cube of 1 m, E = 1 kPa, in three dimensions on smooth walls at x, y, z = 0. The nodes at z = 1 m go down at 0.01 m/s for 0.1 s.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Cube {
    /// Cells along an edge.
    cells: usize,
    /// Poisson's ratio.
    poissons_ratio: f64,
    /// Density [kg/m³].
    density: f64,
    /// Steps that the 0.1 s take.
    steps: usize,
    /// Whether the top is then held until all is at rest.
    settle: bool,
}

impl Cube {
    /// Gives `stress` (mean σ_zz [Pa]), `stress_error` (largest |σ_zz + 1 Pa|), `side_stress` (largest of |σ_xx| and |σ_yy| [Pa]) and
    /// `lateral`, the mean strain along x and y.
    fn run(&self, setup: &Setup) -> Result<Outcome> {
        let (context, material) = Elastic::LinearElastic.material(1000.0, self.poissons_ratio)?;
        let mut options = setup.method.options(1.0 / self.cells as f64);
        (options.dimension, options.damping) = (3, setup.damping);
        let mut world = World::new(&context, &options)?;
        for axis in 0..3 {
            wall(&mut world, WallKind::Slip, axis, 1, 0.0)?;
        }
        let region = Region::Box { min: [0.0; 3], max: [1.0; 3] };
        let body = fill(&mut world, &material, &region, self.density, 2)?;
        let start = read(&world, body, "position")?;
        let top = BoxRegion { min: [-9.0, -9.0, 1.0], max: [9.0; 3] };
        let press = |speed: f64| PrescribedVelocity {
            region: top,
            components: lahar::boundary::prescribed_velocity::Z,
            velocity: Table::constant([0.0, 0.0, -speed]),
        };
        let id = world.add_prescribed_velocity(press(0.01))?;
        for _ in 0..self.steps {
            world.step(Some(0.1 / self.steps as f64))?;
        }
        let mut out = Outcome::new();
        if self.settle {
            world.remove_prescribed_velocity(id)?;
            world.add_prescribed_velocity(press(0.0))?;
            settle(&mut world, 100.0, &mut out)?;
        }
        let (end, stress) = (read(&world, body, "position")?, read(&world, body, "stress")?);
        let n = (stress.len() / 6) as f64;
        let largest = |f: &dyn Fn(&[f64]) -> f64| stress.chunks(6).map(f).fold(0.0, f64::max);
        out.set("stress", stress.chunks(6).map(|s| s[2]).sum::<f64>() / n);
        out.set("stress_error", largest(&|s| (s[2] + 1.0).abs()));
        out.set("side_stress", largest(&|s| s[0].abs().max(s[1].abs())));
        let strains = end.chunks(3).zip(start.chunks(3));
        let strain = |(x, x0): (&[f64], &[f64])| 0.5 * (x[0] / x0[0] + x[1] / x0[1]) - 1.0;
        out.set("lateral", strains.map(strain).sum::<f64>() / n);
        Ok(out)
    }
}

/// A bar of 1 m, one cell high, E = 1 MPa, ν = 0, ρ = 1000 kg/m³, held at x = 0. A traction of 1 Pa at the other end grows for 500 of
/// 1000 steps of 1 ms.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Bar {
    /// Cells along the bar.
    cells: usize,
    /// Negative control: the force acts at the centres of the last particles.
    #[serde(default)]
    at_centres: bool,
}

impl Bar {
    /// Gives `worst` (largest |σ_xx − 1 Pa| of a particle), `last_cell` (mean σ_xx of the last cell), and the curve `stress` over x.
    fn run(&self, setup: &Setup) -> Result<Outcome> {
        let (dt, ramped, steps) = (1e-3, 500, 1000);
        let h = 1.0 / self.cells as f64;
        let (context, material) = Elastic::LinearElastic.material(1e6, 0.0)?;
        let mut options = setup.method.options(h);
        options.origin = [setup.method.wall_shift() * h, 0.0, 0.0];
        (options.damping, options.body_force) = (setup.damping, self.at_centres);
        let mut world = World::new(&context, &options)?;
        wall(&mut world, WallKind::Slip, 0, 1, 0.0)?;
        let body = fill(&mut world, &material, &rectangle([0.0; 2], [1.0, h]), 1000.0, 2)?;
        let start = positions(&world, body)?;
        let (size, end) = (0.5 * h, f64::from(ramped) * dt);
        if !self.at_centres {
            pull(&mut world, body, (0, 1), (1.0, size), ramp(end, [1.0, 0.0, 0.0])?)?;
        }
        for _ in 0..steps {
            if self.at_centres {
                let share = ((world.time() + 0.5 * dt) / end).min(1.0) / (1000.0 * size);
                let force = |x: &[f64; 2]| [if x[0] > 1.0 - size { share } else { 0.0 }, 0.0];
                let forces: Vec<[f64; 2]> = start.iter().map(force).collect();
                write(&mut world, body, "body_force", forces.as_flattened())?;
            }
            world.step(Some(dt))?;
        }
        let stress = read(&world, body, "stress")?;
        let points = start.iter().zip(stress.chunks(6)).map(|(x, s)| [x[0], s[0]]);
        let mut points: Vec<[f64; 2]> = points.collect();
        let last: Vec<f64> = points.iter().filter(|p| p[0] > 1.0 - h).map(|p| p[1]).collect();
        let mut out = Outcome::new();
        out.set("worst", points.iter().map(|p| (p[1] - 1.0).abs()).fold(0.0, f64::max));
        out.set("last_cell", last.iter().sum::<f64>() / last.len() as f64);
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        out.curve("stress", points);
        Ok(out)
    }
}
