//! Seams of the engine that no host reaches yet: layers, and evaluation without commit.

use super::*;
use crate::material::scratch::{Carried, with_buffers};
use crate::particles::seeding::{Fill, Region};
use crate::step::pass::{ChunkWork, Moment, evaluate};

fn a_world() -> (World, Arc<Material>) {
    let context = Context::new(Some(1)).expect("a context");
    context.register_plugin(lahar_model_linear_elastic::plugin).expect("a plugin");
    let values = [("youngs_modulus", 1e5), ("poissons_ratio", 0.3)];
    let material = Material::new(&context, "linear_elastic", &values).expect("a material");
    let options = Options { dimension: 2, spacing: 0.1, ..Options::default() };
    (World::new(&context, &options).expect("a world"), material)
}

/// Adds a block of 0.4 m × 0.4 m that moves along x; gives its id.
fn add_block(world: &mut World, material: &Arc<Material>, x: f64, speed: f64) -> i64 {
    let region = Region::Box { min: [x, 0.0, 0.0], max: [x + 0.4, 0.4, 0.0] };
    let fill = Fill { density: 1000.0, velocity: [speed, 0.1, 0.0], ..Fill::default() };
    world.add_shape(material, &region, &fill).expect("a body")
}

fn plane(world: &mut World) -> &mut Parts<2> {
    match &mut world.inner {
        Inner::Two(parts) => parts,
        Inner::Three(_) => panic!("a plane world"),
    }
}

/// All columns of a body, in the order of its ids.
fn bits(world: &mut World, body: usize) -> Vec<Vec<u64>> {
    let particles = &plane(world).bodies[body].particles;
    let mut order: Vec<usize> = (0..particles.len()).collect();
    order.sort_by_key(|k| particles.id[*k]);
    let column = |c: usize| order.iter().map(|k| particles.column(c)[*k].to_bits()).collect();
    (0..particles.layout.components()).map(column).collect()
}

#[test]
fn bodies_of_different_layers_pass_through_each_other() {
    let go = |blocks: &[(f64, f64)]| {
        let (mut world, material) = a_world();
        for (layer, (x, speed)) in blocks.iter().enumerate() {
            add_block(&mut world, &material, *x, *speed);
            plane(&mut world).bodies[layer].layer = layer as u32;
        }
        for _ in 0..200 {
            world.step(Some(1e-3)).expect("a step");
        }
        (0..blocks.len()).map(|body| bits(&mut world, body)).collect::<Vec<_>>()
    };
    let (left, right) = ((0.0, 2.0), (0.5, -2.0));
    let both = go(&[left, right]);
    assert!(both[0] == go(&[left])[0], "the left block feels the other");
    assert!(both[1] == go(&[right])[0], "the right block feels the other");
}

#[test]
fn evaluation_leaves_the_particles_as_they_are_and_can_be_repeated() {
    let (mut world, material) = a_world();
    add_block(&mut world, &material, 0.0, 1.0);
    world.step(None).expect("a step");
    let before = bits(&mut world, 0);
    let Parts { bodies, method, .. } = plane(&mut world);
    let (ids, all) = bodies[0].particles.ids_and_chunk();
    all.for_each_chunk(|chunk| {
        with_buffers(0, |points, _| {
            let scratch = points.scratch(&material, chunk.len, Carried::default());
            let mut work = ChunkWork { chunk, scratch, body: 0, ids, material: &material };
            work.scratch.velocity_gradient.fill(0.5);
            let moment = Moment { time: 0.0, step: 1, dt: 1e-3 };
            evaluate::<2>(&mut work, method, moment).expect("an answer");
            let n = work.chunk.len;
            let first = work.scratch.stress1[..n].to_vec();
            evaluate::<2>(&mut work, method, moment).expect("an answer");
            assert_eq!(first, work.scratch.stress1[..n]);
            assert_ne!(first, work.chunk.column(work.chunk.layout.stress));
            let mut tangent = vec![0.0; 36 * work.scratch.stride];
            let asked = material.tangent(&mut work.scratch.batch(), &mut tangent);
            asked.expect("the model has a tangent").expect("an answer");
            assert!(tangent[0] > 1e5, "{}", tangent[0]);
        });
    });
    assert!(bits(&mut world, 0) == before, "particles have changed");
}
