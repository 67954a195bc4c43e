//! Particles are stored in the runs of their blocks, however they came there, and their ids do not
//! change.

use std::collections::BTreeMap;

use lahar::transfer::TransferKind;
use lahar::world::World;
use lahar::world::options::Options;

use crate::setup::{Random, add_points, context, elastic, read, world, write};

const H: f64 = 0.25;

/// Key of the block of a position: that of the lowest node of a quadratic stencil.
fn block(x: &[f64]) -> Vec<i64> {
    x.iter().map(|x| ((x / H - 0.5).floor() as i64).div_euclid(4)).collect()
}

/// For each block of a body the ids of its particles, ascending; checks that a block's particles
/// stand together, in block order.
fn blocks_of(world: &World, body: i64) -> BTreeMap<Vec<i64>, Vec<i64>> {
    let d = world.options().dimension;
    let x = world.field_data(body, "position").expect("a body");
    let all = world.grid_blocks();
    let number: BTreeMap<&[i64], usize> =
        all.iter().enumerate().map(|(n, key)| (&key[..d], n)).collect();
    let mut found: BTreeMap<Vec<i64>, Vec<i64>> = BTreeMap::new();
    let mut last = 0;
    for (k, id) in world.ids(body).expect("a body").iter().enumerate() {
        let at: Vec<f64> = (0..d).map(|c| x.data[c * x.stride + k]).collect();
        let key = block(&at);
        let index = number[&key[..]];
        assert!(last <= index, "particle {id} stands behind those of a later block");
        last = index;
        found.entry(key).or_default().push(*id);
    }
    found.values_mut().for_each(|ids| ids.sort_unstable());
    found
}

/// Mass of every active node, with its index.
fn masses(world: &World) -> Vec<([i64; 3], f64)> {
    let mass = |node| {
        let mut m = [0.0];
        world.node_value("mass", node, &mut m).expect("an active node");
        (world.grid_node_index(node).expect("an active node"), m[0])
    };
    (0..world.grid_stats().active_nodes).map(mass).collect()
}

/// Checks a world against one that is made from its particles and sorted as a whole.
fn check_against_a_new_world(old: &World) {
    let context = context(1);
    let material = elastic(&context, 1e4, 0.3);
    let mut new = world(&context, old.options());
    for body in old.bodies() {
        let (x, v) = (read(old, body, "position"), read(old, body, "velocity"));
        add_points(&mut new, &material, (&x, &v), 1.0, 1000.0);
    }
    new.refresh().expect("a new grid");
    assert_eq!(old.grid_blocks(), new.grid_blocks());
    for (of_old, of_new) in old.bodies().into_iter().zip(new.bodies()) {
        assert_eq!(blocks_of(old, of_old), blocks_of(&new, of_new));
    }
    for ((node, old), (same, new)) in masses(old).into_iter().zip(masses(&new)) {
        assert_eq!(node, same);
        // sums of some hundred positive terms in different orders
        assert!((old - new).abs() <= 1e-12 * new, "node {node:?}: {old} and {new} kg");
    }
}

/// Number of indices that hold another particle than before.
fn changed(world: &World, body: i64, before: &[i64]) -> usize {
    world.ids(body).expect("a body").iter().zip(before).filter(|(a, b)| a != b).count()
}

/// Moves resting particles of two bodies about by hand; a step of a resting world puts them into
/// their blocks and does nothing else.
fn shuffle(dimension: usize, threads: usize, count: usize) {
    let context = context(threads);
    let material = elastic(&context, 1e4, 0.3);
    let options =
        Options { dimension, spacing: H, transfer: TransferKind::PicFlip, ..Options::default() };
    let mut world = world(&context, &options);
    let mut random = Random::new(11);
    let mut positions = [(count, 0.0, 6.0), (count / 3, 4.0, 9.0)]
        .map(|(n, low, high)| random.many(n * dimension, low, high));
    let still = vec![0.0; count * dimension];
    for x in &positions {
        add_points(&mut world, &material, (x, &still[..x.len()]), 1.0, 1000.0);
    }
    let tag = |body: usize, k: usize| (1000 * body + k % 997) as f64;
    for (b, x) in positions.iter().enumerate() {
        let tags: Vec<f64> = (0..x.len() / dimension).map(|k| tag(b, k)).collect();
        write(&mut world, b as i64, "strain_energy", &tags);
    }
    world.step(Some(1e-6)).expect("a step at rest");
    for round in 0..40 {
        let before = world.ids(0).expect("a body").to_vec();
        for (b, x) in positions.iter_mut().enumerate() {
            for k in 0..x.len() / dimension {
                let stays = random.next() < 0.97;
                for a in 0..dimension {
                    let step = random.next() - 0.5;
                    x[dimension * k + a] += match round % 8 {
                        3 if !stays => 60.0 * step,   // a few jump across many blocks
                        5 if k % 50 == 0 => -1e3 * H, // one in fifty goes far away, into new blocks
                        6 if k % 50 == 0 => 1e3 * H,  // and comes back, leaving them empty
                        7 => 3.0 * step,              // most change their block
                        2 if a == 0 => 0.02,          // all drift
                        _ if stays => 0.0,
                        _ => H * step,
                    };
                }
            }
            write(&mut world, b as i64, "position", x);
        }
        world.step(Some(1e-6)).expect("a step at rest");
        check_against_a_new_world(&world);
        for (b, x) in positions.iter().enumerate() {
            assert_eq!(read(&world, b as i64, "position"), *x, "positions by id");
            let tags = read(&world, b as i64, "strain_energy");
            assert!(tags.iter().enumerate().all(|(k, t)| *t == tag(b, k)), "data by id");
        }
        if round % 8 < 2 {
            let changed = changed(&world, 0, &before);
            assert!(changed > 0 && changed < count / 2, "{changed} of {count} changed indices");
        }
    }
}

#[test]
fn regrouped_particles_stand_as_if_they_were_sorted_anew() {
    shuffle(2, 1, 3000);
    shuffle(3, 1, 3000);
    shuffle(3, 2, 8000);
}

#[test]
fn columns_do_not_fall_into_the_same_sets_of_the_cache() {
    let context = context(1);
    let material = elastic(&context, 1e4, 0.3);
    let mut world = world(&context, &Options { dimension: 2, spacing: H, ..Options::default() });
    for count in [1, 8, 9, 64, 1000, 1024, 4096] {
        let x = Random::new(5).many(2 * count, 0.0, 9.0);
        let body = add_points(&mut world, &material, (&x, &vec![0.0; 2 * count]), 1.0, 1000.0);
        let stride = world.field_data(body, "position").expect("a body").stride;
        assert!(stride >= count && stride < count + 16 && stride % 16 == 8, "{count}: {stride}");
    }
}
