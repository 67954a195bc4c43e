//! The scenes. All but the trough go in the order of the stages that updates stresses last (USL).
//!
//! * **Box**: closed, slip walls, full of one material that an eddy stirs. The eddy
//!   v = A (sin πx/L cos πy/L, −cos πx/L sin πy/L) keeps the volume and does not cross the walls, shears everywhere, and
//!   moves particles from cell to cell.
//! * **Column**: sand on a floor that it sticks to, twice as high as wide, in the middle of its collapse. It starts with the
//!   stresses of its weight and the velocities v = a (2xz/H, 2yz/H, −2z²/H), which keep the volume and vanish at the
//!   floor, so that its front moves on through new blocks from the first step. Particles are shaken off their lattice,
//!   otherwise whole layers would change cells in the same step.
//! * **Trough**: what people run. The options are the defaults of the engine, so that the order is MUSL. The same sand, as
//!   high, stands at the closed end of a trough with smooth sides and a floor with friction and runs along it, with the
//!   velocities v = a (2xz/H, 0, −z²/H). The planes of its walls lie half a cell from nodes and one cell outside of the
//!   sand, as in `examples-c/02_column_collapse.c`: the last nodes that a wall holds are those just outside of the sand.
//! * **Flight**: a block that turns, deforms and flies in empty space; what the peers compute too.

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
use std::f64::consts::PI;
use std::path::Path;
use std::sync::Arc;

/// One scene of the bench.
pub struct Scene {
    /// Name on the command line and in the tables.
    pub name: &'static str,
    setting: Setting,
    dimension: usize,
    shape: ShapeKind,
    transfer: TransferKind,
    plugin: &'static str,
    model: &'static str,
    parameters: &'static [(&'static str, f64)],
    density: f64, // [kg/m^3]
    speed: f64,   // A, or a H, with H the height of the sand [m/s]
    far: bool,    // one more particle, a thousand boxes away along every axis
    linked: bool, // the model is part of the program instead of a plugin
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Setting {
    Box,
    Column,
    Trough,
    Flight,
}

impl Setting {
    /// Whether it is a heap of sand under gravity.
    fn is_sand(self) -> bool {
        matches!(self, Self::Column | Self::Trough)
    }
}

const ELASTIC: &[(&str, f64)] = &[("youngs_modulus", 1e7), ("poissons_ratio", 0.3)];
const SAND: &[(&str, f64)] = &[
    ("youngs_modulus", 1e6), // loose, so that it moves far in a step
    ("poissons_ratio", 0.3),
    ("friction_angle", 30.0),
    ("cohesion", 0.0),
    ("cone", 0.0), // triaxial compression
];
const WATER: &[(&str, f64)] = &[("bulk_modulus", 1e7), ("viscosity", 1.0)];

/// The first scene of the tables, and the one that sizes, domain and peers are compared with.
pub static APIC_ELASTIC: Scene = ELASTIC_BOX;
const ELASTIC_BOX: Scene = Scene {
    name: "3d-quadratic-apic-elastic",
    setting: Setting::Box,
    dimension: 3,
    shape: ShapeKind::QuadraticBspline,
    transfer: TransferKind::Apic,
    plugin: "lahar_linear_elastic",
    model: "linear_elastic",
    parameters: ELASTIC,
    density: 1600.0,
    speed: 2.0,
    far: false,
    linked: false,
};

const SAND_COLUMN: Scene = Scene {
    name: "3d-quadratic-apic-drucker-prager-flow",
    setting: Setting::Column,
    plugin: "lahar_drucker_prager",
    model: "drucker_prager",
    parameters: SAND,
    ..ELASTIC_BOX
};

/// The scenes that each have a row of targets, in the order of the tables.
pub static SCENES: [Scene; 7] = [
    ELASTIC_BOX,
    SAND_COLUMN,
    Scene { name: "3d-defaults-drucker-prager-walls", setting: Setting::Trough, ..SAND_COLUMN },
    Scene {
        name: "3d-quadratic-apic-newtonian",
        plugin: "lahar_newtonian",
        model: "newtonian",
        parameters: WATER,
        density: 1000.0,
        ..ELASTIC_BOX
    },
    Scene {
        name: "3d-linear-flip-elastic",
        shape: ShapeKind::Linear,
        transfer: TransferKind::PicFlip,
        ..ELASTIC_BOX
    },
    Scene { name: "3d-cubic-apic-elastic", shape: ShapeKind::CubicBspline, ..ELASTIC_BOX },
    Scene { name: "2d-quadratic-apic-elastic", dimension: 2, ..ELASTIC_BOX },
];

/// The first scene in a domain that is a thousand times larger along every axis.
pub static FAR: Scene = Scene { name: "3d-quadratic-apic-elastic-far", far: true, ..ELASTIC_BOX };

/// The first scene with the model linked statically.
pub static LINKED: Scene =
    Scene { name: "3d-quadratic-apic-elastic-linked", linked: true, ..ELASTIC_BOX };

/// What the peers compute too.
pub static FLIGHT: Scene = Scene {
    name: "3d-quadratic-apic-elastic-flight",
    setting: Setting::Flight,
    speed: 6.0,
    ..ELASTIC_BOX
};

/// The scene with this name.
pub fn find(name: &str) -> std::result::Result<&'static Scene, String> {
    let all = || SCENES.iter().chain([&FAR, &LINKED, &FLIGHT]);
    all().find(|scene| scene.name == name).ok_or_else(|| {
        let known: Vec<&str> = all().map(|scene| scene.name).collect();
        format!("no scene is named `{name}` (known: {})", known.join(", "))
    })
}

const EDGE: f64 = 1.0; // of the box and the flying block, and of the sand in plan [m]
const PER_CELL: i32 = 2; // particles per cell and axis
const GRAVITY: f64 = 9.81; // on sand [m/s^2]
const HEIGHT: f64 = 2.0 * EDGE; // of the sand
const SIDE_PRESSURE: f64 = 0.5; // horizontal over vertical stress in the sand
const SHAKE: f64 = 0.2; // of the lattice pitch of the sand's particles
const LENGTH: f64 = 3.0 * EDGE; // of the trough
const FRICTION: f64 = 0.5; // coefficient of its floor
const FAR_AWAY: f64 = 1000.0 * EDGE;

impl Scene {
    /// The world at time 0 with about `particles` particles; the plugin comes from `folder`.
    pub fn build(&self, context: &Arc<Context>, folder: &Path, particles: usize) -> Result<World> {
        self.register(context, folder)?;
        let material = Material::new(context, self.model, self.parameters)?;
        let spacing = self.spacing(particles);
        let mut world = World::new(context, &self.options(spacing))?;
        self.add_walls(&mut world)?;
        match self.setting {
            Setting::Column | Setting::Trough => self.add_sand(&mut world, &material)?,
            Setting::Box | Setting::Flight => {
                let body = world.add_shape(&material, &self.region(), &self.fill())?;
                let position = read_points(&world, body, "position", self.dimension)?;
                write_points(&mut world, body, "velocity", &self.velocities(&position))?;
            }
        }
        if self.far {
            let corner = [FAR_AWAY; 3];
            let end = [FAR_AWAY + spacing / f64::from(PER_CELL); 3];
            world.add_shape(&material, &Region::Box { min: corner, max: end }, &self.fill())?;
        }
        Ok(world)
    }

    /// Makes the scene's model known to the context.
    fn register(&self, context: &Context, folder: &Path) -> Result<()> {
        if self.linked {
            return context.register_plugin(lahar_model_linear_elastic::plugin).map(drop);
        }
        let file = folder.join(format!("lib{}.so", self.plugin));
        context.load_plugin(&file.to_string_lossy()).map(drop)
    }

    /// Distance of the grid's nodes for about so many particles [m].
    pub fn spacing(&self, particles: usize) -> f64 {
        let volume = if self.setting.is_sand() { HEIGHT / EDGE } else { 1.0 }; // in EDGE^D
        let per_axis = (particles as f64 / volume).powf(1.0 / self.dimension as f64);
        EDGE / (per_axis / f64::from(PER_CELL)).round().max(4.0)
    }

    /// Edge of the cube that holds the flying block at first [m].
    pub fn edge(&self) -> f64 {
        EDGE
    }

    /// Young's modulus [Pa], Poisson's ratio and density [kg/m³] of an elastic scene.
    pub fn elastic(&self) -> [f64; 3] {
        [ELASTIC[0].1, ELASTIC[1].1, self.density]
    }

    /// Walls stand on half-cell planes for quadratic functions, on node planes for others.
    fn options(&self, spacing: f64) -> Options {
        let shift = match self.shape {
            ShapeKind::QuadraticBspline => 0.5 * spacing,
            _ => 0.0,
        };
        let fall = if self.setting.is_sand() { -GRAVITY } else { 0.0 };
        let defaults = Options {
            spacing,
            origin: [shift; 3],
            gravity: [0.0, 0.0, fall],
            ..Options::default()
        };
        if self.setting == Setting::Trough {
            return defaults;
        }
        Options {
            dimension: self.dimension,
            shape: self.shape,
            transfer: self.transfer,
            order: StepOrder::Usl,
            ..defaults
        }
    }

    fn add_walls(&self, world: &mut World) -> Result<()> {
        let h = world.options().spacing;
        let mut wall = |axis, side, position, kind| {
            let friction = if kind == WallKind::Friction { FRICTION } else { 0.0 };
            world.add_wall(&Wall { axis, side, position, kind, friction }).map(drop)
        };
        match self.setting {
            Setting::Flight => Ok(()),
            Setting::Column => wall(2, 1, 0.0, WallKind::Sticky),
            Setting::Trough => {
                wall(0, 1, -h, WallKind::Slip)?;
                wall(0, -1, LENGTH, WallKind::Slip)?;
                wall(1, 1, -h, WallKind::Slip)?;
                wall(1, -1, EDGE + h, WallKind::Slip)?;
                wall(2, 1, -h, WallKind::Friction)
            }
            Setting::Box => (0..self.dimension).try_for_each(|axis| {
                wall(axis, 1, 0.0, WallKind::Slip)?;
                wall(axis, -1, EDGE, WallKind::Slip)
            }),
        }
    }

    fn region(&self) -> Region {
        let mut max = [EDGE; 3];
        if self.setting.is_sand() {
            max[2] = HEIGHT;
        }
        max[self.dimension..].fill(0.0);
        Region::Box { min: [0.0; 3], max }
    }

    fn fill(&self) -> Fill {
        Fill { particles_per_cell: PER_CELL, density: self.density, ..Fill::default() }
    }

    fn add_sand(&self, world: &mut World, material: &Arc<Material>) -> Result<()> {
        let body = world.add_shape(material, &self.region(), &self.fill())?;
        let mut position = read_points(world, body, "position", 3)?;
        let shake = SHAKE * world.options().spacing / f64::from(PER_CELL);
        let mut seed = 0x2545_f491_4f6c_dd1d;
        position.iter_mut().for_each(|x| *x += shake * random(&mut seed));
        let mut stress = Vec::with_capacity(2 * position.len());
        for x in position.chunks(3) {
            let down = -self.density * GRAVITY * (HEIGHT - x[2]);
            stress.extend([SIDE_PRESSURE * down, SIDE_PRESSURE * down, down, 0.0, 0.0, 0.0]);
        }
        write_points(world, body, "position", &position)?;
        write_points(world, body, "stress", &stress)?;
        write_points(world, body, "velocity", &self.velocities(&position))
    }

    /// Velocities at the positions, point after point [m/s].
    fn velocities(&self, position: &[f64]) -> Vec<f64> {
        let mut velocity = vec![0.0; position.len()];
        let points = velocity.chunks_mut(self.dimension).zip(position.chunks(self.dimension));
        for (v, x) in points {
            let y = [x[0], x[1], x.get(2).copied().unwrap_or(0.0)];
            v.copy_from_slice(&self.velocity(y)[..self.dimension]);
        }
        velocity
    }

    fn velocity(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let (a, k) = (self.speed, PI / EDGE);
        let ((sin_x, cos_x), (sin_y, cos_y)) = ((k * x).sin_cos(), (k * y).sin_cos());
        match self.setting {
            Setting::Box => [a * sin_x * cos_y, -a * cos_x * sin_y, 0.0],
            Setting::Column => {
                let a = a / HEIGHT;
                let (x, y, z) = (x - 0.5 * EDGE, y - 0.5 * EDGE, z / EDGE);
                [a * x * z, a * y * z, -a * z * z * EDGE]
            }
            Setting::Trough => {
                let a = a / HEIGHT;
                [2.0 * a * x * z / HEIGHT, 0.0, -a * z * z / HEIGHT]
            }
            Setting::Flight => {
                let (turn, x, y) = (0.2 * a, x / EDGE - 0.5, y / EDGE - 0.5);
                let [u, v, w] = [a * sin_x * cos_y, -a * cos_x * sin_y, 0.5 * a * sin_y * cos_x];
                [u - turn * y + 0.1 * a, v + turn * x + 0.2 * a, w + 0.3 * a]
            }
        }
    }
}

/// A number from -1 to 1, the same ones in every run (xorshift, G. Marsaglia, J. Stat. Softw. 8 (2003) 14).
fn random(seed: &mut u64) -> f64 {
    *seed ^= *seed << 13;
    *seed ^= *seed >> 7;
    *seed ^= *seed << 17;
    (*seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// A field, point after point in the order of ids.
pub fn read_points(world: &World, body: i64, field: &str, components: usize) -> Result<Vec<f64>> {
    let count = world.particle_count(body)?;
    let mut values = vec![0.0; count * components];
    let strides = Strides::new(count, components, 0, 0)?;
    world.read_field(body, field, &mut StridedMut::new(&mut values, strides)?)?;
    Ok(values)
}

fn write_points(world: &mut World, body: i64, field: &str, values: &[f64]) -> Result<()> {
    let components = values.len() / world.particle_count(body)?;
    world.write_field(body, field, &Strided::interleaved(values, components)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sand_keeps_its_volume_and_stands_still_at_the_floor() {
        let e = 1e-6;
        for scene in SCENES.iter().filter(|scene| scene.setting.is_sand()) {
            let x = [0.3, 0.8, 1.1];
            let slope = |d: usize| {
                let (mut low, mut high) = (x, x);
                low[d] -= e;
                high[d] += e;
                (scene.velocity(high)[d] - scene.velocity(low)[d]) / (2.0 * e)
            };
            assert!((slope(0) + slope(1) + slope(2)).abs() < 1e-7, "{}", scene.name);
            assert_eq!(scene.velocity([0.2, 0.9, 0.0]), [0.0; 3], "{}", scene.name);
        }
    }

    #[test]
    fn the_planes_of_the_trough_lie_half_a_cell_from_nodes() {
        let scene = &SCENES[2];
        let h = scene.spacing(4000);
        let options = scene.options(h);
        assert_eq!((options.order, options.shape), (StepOrder::Musl, ShapeKind::QuadraticBspline));
        for plane in [-h, LENGTH, EDGE + h] {
            let nodes = (plane - options.origin[0]) / h;
            assert!((nodes - nodes.floor() - 0.5).abs() < 1e-9, "{plane}");
        }
    }
}
