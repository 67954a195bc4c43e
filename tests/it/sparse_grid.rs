//! The grid follows the material: policies agree, positions far away are as good as any, flights
//! cost no memory.

use lahar::background::GridPolicy;
use lahar::boundary::{Wall, WallKind};
use lahar::error::Status;
use lahar::particles::seeding::Region;
use lahar::shape::{ShapeKind, WallTreatment};
use lahar::step::StepOrder;
use lahar::transfer::TransferKind;
use lahar::world::World;
use lahar::world::options::Options;

use crate::setup::{a_box, add_points, context, elastic, fill, read, world};

fn bits(world: &World, fields: &[&str]) -> Vec<u64> {
    let all = fields.iter().flat_map(|f| read(world, 0, f));
    all.map(f64::to_bits).collect()
}

/// A disc that bounces through a box with the given policy.
fn bounce(policy: GridPolicy) -> World {
    let context = context(1);
    let material = elastic(&context, 1e4, 0.3);
    let options = Options {
        dimension: 2,
        spacing: 0.1,
        gravity: [0.0, -9.81, 0.0],
        grid_policy: policy,
        box_min: [-3.0, -3.0, 0.0],
        box_max: [3.0, 9.0, 0.0],
        ..Options::default()
    };
    let mut world = world(&context, &options);
    for (axis, side, position) in [(0, 1, -1.05), (0, -1, 1.05), (1, 1, -1.05)] {
        let kind = WallKind::Separating;
        let wall = Wall { axis, side, position, kind, friction: 0.0 };
        world.add_wall(&wall).expect("a good wall");
    }
    let disc = Region::Sphere { center: [0.0, 0.0, 0.0], radius: 0.4 };
    fill(&mut world, &material, &disc, 1000.0, [6.0, -2.0, 0.0]);
    world
}

#[test]
fn the_three_policies_give_the_same_bits() {
    let fields = ["position", "velocity", "stress", "volume", "affine", "strain_energy"];
    let mut worlds = [GridPolicy::Dynamic, GridPolicy::GrowOnly, GridPolicy::Static].map(bounce);
    for _ in 0..8 {
        for world in &mut worlds {
            world.advance(1e9, 100).1.expect("a bounce");
        }
        let [dynamic, grow, fixed] = worlds.each_ref().map(|w| bits(w, &fields));
        assert!(dynamic == grow && dynamic == fixed, "policies differ");
    }
    let [dynamic, grow, fixed] = worlds.each_ref().map(|w| w.grid_stats().active_blocks);
    assert!(dynamic < grow && grow < fixed, "{dynamic} < {grow} < {fixed} blocks");
}

#[test]
fn leaving_a_static_box_is_an_error_that_changes_nothing() {
    let context = context(1);
    let material = elastic(&context, 1e4, 0.3);
    let options = Options {
        dimension: 2,
        spacing: 0.1,
        grid_policy: GridPolicy::Static,
        box_min: [-1.0, -1.0, 0.0],
        box_max: [1.0, 1.0, 0.0],
        ..Options::default()
    };
    let mut world = world(&context, &options);
    let region = a_box([-0.2, -0.2, 0.0], [0.2, 0.2, 0.0]);
    fill(&mut world, &material, &region, 1000.0, [50.0, 0.0, 0.0]);
    let (_, result) = world.advance(1.0, i64::MAX);
    let error = result.expect_err("the block leaves the box");
    assert_eq!(error.status, Status::OutsideGrid);
    assert!(error.message.contains("static grid"), "{error}");
    assert!(error.place.particle.is_some() && error.place.step.is_some());
    assert!(!world.is_poisoned());
    let (time, before) = (world.time(), bits(&world, &["position"]));
    assert_eq!(world.step(None).expect_err("still outside").status, Status::OutsideGrid);
    assert_eq!((time, before), (world.time(), bits(&world, &["position"])));
}

#[test]
fn particles_on_the_faces_of_a_static_box_are_inside_and_those_beyond_round_off_are_not() {
    let context = context(1);
    let material = elastic(&context, 1e5, 0.3);
    // off zero, so that faces are no exact doubles, and with faces on the edges of blocks and off
    for (shape, low) in [(ShapeKind::Linear, 0.0), (ShapeKind::QuadraticBspline, 1234.6)] {
        let h = 0.1;
        let (box_min, box_max) = ([low, low, 0.0], [low + 8.0 * h, low + 9.0 * h, 0.0]);
        let options = Options {
            dimension: 2,
            spacing: h,
            shape,
            transfer: TransferKind::PicFlip,
            gravity: [0.0, -9.81, 0.0],
            grid_policy: GridPolicy::Static,
            wall_treatment: WallTreatment::Modified,
            box_min,
            box_max,
            ..Options::default()
        };
        let mut world = world(&context, &options);
        for (axis, side) in [(0, 1), (0, -1), (1, 1), (1, -1)] {
            let position = if side > 0 { box_min[axis] } else { box_max[axis] };
            let wall = Wall { axis, side, position, kind: WallKind::Sticky, friction: 0.0 };
            world.add_wall(&wall).expect("a good wall");
        }
        let points = |out: f64| -> Vec<f64> {
            let corners = [[0, 0], [1, 0], [0, 1], [1, 1]];
            let at = |i: usize, d: usize| {
                if i == 0 { box_min[d] - out } else { box_max[d] + out }
            };
            corners.iter().flat_map(|c| [at(c[0], 0), at(c[1], 1)]).collect()
        };
        let beside = f64::EPSILON * box_max[1];
        for x in [points(0.0), points(beside)] {
            add_points(&mut world, &material, (&x, &[0.0; 8]), 0.1 * h * h, 1000.0);
        }
        world.advance(1.0, 100).1.expect("steps on the faces");
        let mut moved = read(&world, 0, "position");
        for (out, refused) in [(beside, false), (1e-6 * h, true)] {
            moved.copy_from_slice(&points(out));
            crate::setup::write(&mut world, 0, "position", &moved);
            let status = world.step(None).map_err(|error| error.status);
            assert_eq!(status.is_err(), refused, "{shape:?}, {out:e} m outside: {status:?}");
        }
    }
}

/// Stresses of a squeezed block after 200 steps, started `offset` cells away from the origin of the
/// grid.
fn squeezed(offset: f64) -> Vec<f64> {
    let context = context(1);
    let material = elastic(&context, 1e4, 0.3);
    let h = 0.125;
    let options = Options { dimension: 3, spacing: h, ..Options::default() };
    let mut world = world(&context, &options);
    let at = offset * h;
    let region = a_box([at, at, -at], [at + 0.5, at + 0.5, -at + 0.5]);
    let body = fill(&mut world, &material, &region, 1000.0, [0.0; 3]);
    let x = read(&world, body, "position");
    let v: Vec<f64> = x.chunks(3).flat_map(|x| [-(x[0] - at - 0.25), 0.4, x[2] + at]).collect();
    crate::setup::write(&mut world, body, "velocity", &v);
    world.advance(1e9, 200).1.expect("200 steps");
    read(&world, body, "stress")
}

#[test]
fn a_million_cells_from_the_origin_the_stresses_are_the_same() {
    let (here, there) = (squeezed(0.0), squeezed(1e6));
    let largest = here.iter().fold(0.0, |m, s| f64::max(m, s.abs()));
    let difference = here.iter().zip(&there).fold(0.0, |m, (a, b)| f64::max(m, (a - b).abs()));
    println!("1e6 cells away: {:e} of the largest stress, {largest} Pa", difference / largest);
    assert!(largest > 100.0, "the block must be stressed");
    assert!(difference <= 1e-8 * largest, "{:e}", difference / largest);
}

/// Flies an unstressed block over 1e5 cells and checks blocks, bytes, the parabola and the stress.
fn fly(transfer: TransferKind, order: StepOrder) {
    let context = context(1);
    let e = 1e4;
    let material = elastic(&context, e, 0.3);
    let h = 0.1;
    let gravity = [0.0, 0.0, -0.1];
    let options = Options {
        dimension: 3,
        spacing: h,
        transfer,
        order,
        gravity,
        cfl: 1.0,
        ..Options::default()
    };
    let mut world = world(&context, &options);
    let region = a_box([0.0, 0.0, 0.0], [0.2, 0.2, 0.2]);
    let v0 = [100.0, 10.0, 5.0];
    let body = fill(&mut world, &material, &region, 1000.0, v0);
    assert!(world.particle_count(body).expect("a body") <= 64);
    let start = world.totals(None).expect("totals").center_of_mass;
    let (mut blocks, mut bytes) = (0, 0);
    let dt = 0.9 * h / 106.0;
    while world.totals(None).expect("totals").center_of_mass[0] - start[0] < 1e5 * h {
        world.step(Some(dt)).expect("a flight");
        let stats = world.grid_stats();
        if world.step_count() <= 1000 {
            (blocks, bytes) = (stats.active_blocks.max(blocks), stats.bytes.max(bytes));
        }
        assert!(stats.active_blocks <= blocks, "{} > {blocks} blocks", stats.active_blocks);
        assert!(stats.bytes <= bytes, "{} > {bytes} bytes", stats.bytes);
    }
    let (t, end) = (world.time(), world.totals(None).expect("totals").center_of_mass);
    let distance = end[0] - start[0];
    let mut worst = 0.0;
    for a in 0..3 {
        // positions move with the velocity at the end of a step: its steps sum up to ½ g t (t + dt)
        let ballistic = v0[a] * t + 0.5 * gravity[a] * t * (t + dt);
        worst = f64::max(worst, (end[a] - start[a] - ballistic).abs() / distance);
    }
    let stress = read(&world, body, "stress").iter().fold(0.0, |m, s| f64::max(m, s.abs()));
    let steps = world.step_count();
    println!(
        "{transfer:?} {order:?}: {steps} steps, at most {blocks} blocks and {bytes} bytes, off the parabola by {worst:e}, stress {:e} E",
        stress / e
    );
    assert!(worst <= 1e-9, "off the parabola by {worst:e} of the distance");
    assert!(stress <= 1e-10 * e, "stress {:e} E", stress / e);
}

#[test]
fn a_flight_of_1e5_cells_takes_no_more_blocks_or_bytes_than_its_start() {
    fly(TransferKind::Apic, StepOrder::Usl);
    fly(TransferKind::PicFlip, StepOrder::Musl);
}

#[test]
fn blocks_vanish_behind_a_body_and_its_nodes_hold_its_mass() {
    let mut world = bounce(GridPolicy::Dynamic);
    let (mut created, mut removed) = (0, 0);
    for _ in 0..300 {
        world.step(None).expect("a bounce");
        let stats = world.grid_stats();
        created += stats.blocks_created;
        removed += stats.blocks_removed;
        assert_eq!(stats.active_nodes, 16 * stats.active_blocks);
    }
    assert!(created > 0 && removed > 0, "created {created}, removed {removed}");
    let mut mass = 0.0;
    for node in 0..world.grid_stats().active_nodes {
        let mut m = [0.0];
        world.node_value("mass", node, &mut m).expect("an active node");
        mass += m[0];
        let index = world.grid_node_index(node).expect("an active node");
        assert_eq!(world.grid_find_node(index), Some(node));
    }
    let expected = world.totals(None).expect("totals").mass;
    assert!((mass - expected).abs() <= 1e-13 * expected);
    assert_eq!(world.grid_find_node([1 << 40, 0, 0]), None);
    let mut v = [0.0; 2];
    let x = world.totals(None).expect("totals").center_of_mass;
    assert!(world.sample("velocity", &x[..2], &mut v).expect("a sample"));
    assert!(!world.sample("velocity", &[99.0, 0.0], &mut v).expect("a sample"));
    let unknown = world.sample("velocty", &x[..2], &mut v).expect_err("a typing mistake");
    assert!(unknown.message.contains("did you mean `velocity`"), "{unknown}");
}
