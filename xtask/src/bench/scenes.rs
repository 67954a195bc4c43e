//! The scenes: a closed box with slip walls, full of one material that is stirred by an eddy.
//!
//! The eddy v = A (sin pi x/L cos pi y/L, -cos pi x/L sin pi y/L) keeps the volume and does not cross the walls, shears
//! everywhere, and moves particles from cell to cell, so that sorting is part of the measured step. Sand starts at a
//! pressure that the walls keep up, and is in plastic flow after the first few steps.

use lahar::boundary::{Wall, WallKind};
use lahar::context::Context;
use lahar::error::Result;
use lahar::material::Material;
use lahar::particles::seeding::{Fill, Region};
use lahar::shape::ShapeKind;
use lahar::step::StepOrder;
use lahar::transfer::TransferKind;
use lahar::world::World;
use lahar::world::host_arrays::{Strided, StridedMut, Strides};
use lahar::world::options::Options;
use std::path::Path;
use std::sync::Arc;

/// One scene of the bench.
pub struct Scene {
    /// Name on the command line and in the tables.
    pub name: &'static str,
    dimension: usize,
    shape: ShapeKind,
    transfer: TransferKind,
    plugin: &'static str,
    model: &'static str,
    parameters: &'static [(&'static str, f64)],
    density: f64,  // [kg/m^3]
    pressure: f64, // at the start [Pa]
    speed: f64,    // A [m/s]
}

const ELASTIC: &[(&str, f64)] = &[("youngs_modulus", 1e7), ("poissons_ratio", 0.3)];
const SAND: &[(&str, f64)] = &[
    ("youngs_modulus", 1e7),
    ("poissons_ratio", 0.3),
    ("friction_angle", 30.0),
    ("cohesion", 0.0),
];
const WATER: &[(&str, f64)] = &[("bulk_modulus", 1e7), ("viscosity", 1.0)];

const APIC_ELASTIC: Scene = Scene {
    name: "3d-quadratic-apic-elastic",
    dimension: 3,
    shape: ShapeKind::QuadraticBspline,
    transfer: TransferKind::Apic,
    plugin: "lahar_linear_elastic",
    model: "linear_elastic",
    parameters: ELASTIC,
    density: 1600.0,
    pressure: 0.0,
    speed: 2.0,
};

/// All scenes, in the order of the tables.
pub static SCENES: [Scene; 5] = [
    APIC_ELASTIC,
    Scene {
        name: "3d-quadratic-apic-drucker-prager",
        plugin: "lahar_drucker_prager",
        model: "drucker_prager",
        parameters: SAND,
        pressure: 1e4,
        ..APIC_ELASTIC
    },
    Scene {
        name: "3d-quadratic-apic-newtonian",
        plugin: "lahar_newtonian",
        model: "newtonian",
        parameters: WATER,
        density: 1000.0,
        ..APIC_ELASTIC
    },
    Scene {
        name: "3d-linear-flip-elastic",
        shape: ShapeKind::Linear,
        transfer: TransferKind::PicFlip,
        ..APIC_ELASTIC
    },
    Scene { name: "2d-quadratic-apic-elastic", dimension: 2, ..APIC_ELASTIC },
];

const EDGE: f64 = 1.0; // of the box [m]
const PER_CELL: i32 = 2; // particles per cell and axis

impl Scene {
    /// The world at time 0 with about `particles` particles; the plugin comes from `folder`.
    pub fn build(&self, context: &Arc<Context>, folder: &Path, particles: usize) -> Result<World> {
        let file = folder.join(format!("lib{}.so", self.plugin));
        context.load_plugin(&file.to_string_lossy())?;
        let material = Material::new(context, self.model, self.parameters)?;
        let per_axis = (particles as f64).powf(1.0 / self.dimension as f64);
        let cells = (per_axis / f64::from(PER_CELL)).round().max(4.0);
        let spacing = EDGE / cells;
        let mut world = World::new(context, &self.options(spacing))?;
        let mut corner = [EDGE; 3];
        corner[self.dimension..].fill(0.0);
        let fill = Fill {
            particles_per_cell: PER_CELL,
            density: self.density,
            stress: [-self.pressure, -self.pressure, -self.pressure, 0.0, 0.0, 0.0],
            ..Fill::default()
        };
        let region = Region::Box { min: [0.0; 3], max: corner };
        let body = world.add_shape(&material, &region, &fill)?;
        for axis in 0..self.dimension {
            for (side, position) in [(1, 0.0), (-1, EDGE)] {
                let kind = WallKind::Slip;
                world.add_wall(&Wall { axis, side, position, kind, friction: 0.0 })?;
            }
        }
        self.stir(&mut world, body)?;
        Ok(world)
    }

    /// Walls stand on node planes for linear and on half-cell planes for quadratic functions.
    fn options(&self, spacing: f64) -> Options {
        let shift = match self.shape {
            ShapeKind::Linear => 0.0,
            ShapeKind::QuadraticBspline => 0.5 * spacing,
        };
        Options {
            dimension: self.dimension,
            spacing,
            origin: [shift; 3],
            shape: self.shape,
            transfer: self.transfer,
            order: StepOrder::Usl,
            ..Options::default()
        }
    }

    fn stir(&self, world: &mut World, body: i64) -> Result<()> {
        let count = world.particle_count(body)?;
        let dimension = self.dimension;
        let mut position = vec![0.0; count * dimension];
        let strides = Strides::new(count, dimension, 0, 0)?; // point after point
        world.read_field(body, "position", &mut StridedMut::new(&mut position, strides)?)?;
        let k = std::f64::consts::PI / EDGE;
        let mut velocity = vec![0.0; count * dimension];
        for (v, x) in velocity.chunks_mut(dimension).zip(position.chunks(dimension)) {
            let ((sin_x, cos_x), (sin_y, cos_y)) = ((k * x[0]).sin_cos(), (k * x[1]).sin_cos());
            v[0] = self.speed * sin_x * cos_y;
            v[1] = -self.speed * cos_x * sin_y;
        }
        world.write_field(body, "velocity", &Strided::new(&velocity, strides)?)
    }
}
