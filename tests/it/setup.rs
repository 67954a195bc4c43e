//! Worlds for tests.

use std::sync::Arc;

use lahar::context::Context;
use lahar::material::Material;
use lahar::particles::seeding::{Fill, Region};
use lahar::simd::Isa;
use lahar::world::World;
use lahar::world::host_arrays::{ParticleArrays, Strided, StridedMut, Strides};
use lahar::world::options::Options;

use crate::support::plugin_path;

/// A context with all shipped plugins. A plugin that was not built fails the test.
pub fn context(threads: usize) -> Arc<Context> {
    with_plugins(Context::new(Some(threads)).expect("a context"))
}

/// The same with a given instruction set.
pub fn context_with(threads: usize, isa: Isa) -> Arc<Context> {
    with_plugins(Context::with_isa(Some(threads), isa).expect("a context"))
}

fn with_plugins(context: Arc<Context>) -> Arc<Context> {
    for plugin in ["linear_elastic", "drucker_prager", "newtonian", "neo_hookean", "hencky"] {
        context.load_plugin(&plugin_path(plugin)).expect("a plugin");
    }
    context
}

/// A context with one shipped plugin and one thread.
pub fn context_of(plugin: &str) -> Arc<Context> {
    let context = Context::new(Some(1)).expect("a context");
    context.load_plugin(&plugin_path(plugin)).expect("a plugin");
    context
}

/// A linear elastic material.
pub fn elastic(context: &Context, e: f64, nu: f64) -> Arc<Material> {
    let values = [("youngs_modulus", e), ("poissons_ratio", nu)];
    Material::new(context, "linear_elastic", &values).expect("a material")
}

/// An empty world in a context with all plugins.
pub fn world(context: &Arc<Context>, options: &Options) -> World {
    World::new(context, options).expect("good options")
}

/// A body in a region with a velocity.
pub fn fill(
    world: &mut World,
    material: &Arc<Material>,
    region: &Region,
    density: f64,
    velocity: [f64; 3],
) -> i64 {
    let fill = Fill { density, velocity, ..Fill::default() };
    world.add_shape(material, region, &fill).expect("a good region")
}

/// A box.
pub fn a_box(min: [f64; 3], max: [f64; 3]) -> Region {
    Region::Box { min, max }
}

/// A field of a body by id, point after point.
pub fn read(world: &World, body: i64, field: &str) -> Vec<f64> {
    let info = world.field_info(body, field).expect("a known field");
    let n = world.particle_count(body).expect("a known body");
    let mut out = vec![0.0; n * info.components];
    let strides = Strides::new(n, info.components, 0, 0).expect("interleaved");
    let mut array = StridedMut::new(&mut out, strides).expect("long enough");
    world.read_field(body, field, &mut array).expect("readable");
    out
}

/// Sets a field of a body by id, point after point.
pub fn write(world: &mut World, body: i64, field: &str, data: &[f64]) {
    let components = world.field_info(body, field).expect("a known field").components;
    let data = Strided::interleaved(data, components).expect("interleaved");
    world.write_field(body, field, &data).expect("writable");
}

/// A body from positions and velocities (point after point), equal volumes and a density.
pub fn add_points(
    world: &mut World,
    material: &Arc<Material>,
    (position, velocity): (&[f64], &[f64]),
    volume: f64,
    density: f64,
) -> i64 {
    let d = world.options().dimension;
    let volumes = vec![volume; position.len() / d];
    let arrays = ParticleArrays {
        position: Strided::interleaved(position, d).expect("whole points"),
        volume: Strided::interleaved(&volumes, 1).expect("whole points"),
        mass: None,
        density,
        velocity: Some(Strided::interleaved(velocity, d).expect("whole points")),
        stress: None,
        size: None,
    };
    world.add_particles(material, &arrays).expect("good particles")
}

/// A stream of numbers in [0, 1), the same in every run (xorshift64).
pub struct Random(u64);

impl Random {
    /// A stream.
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// The next number.
    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// `n` numbers in [low, high).
    pub fn many(&mut self, n: usize, low: f64, high: f64) -> Vec<f64> {
        (0..n).map(|_| low + (high - low) * self.next()).collect()
    }
}
