//! What a step must conserve: mass, momentum, angular momentum, the stress of a rigid rotation; and
//! what must lose it.

use lahar::boundary::{BoxRegion, PrescribedVelocity, Table, Wall, WallKind};
use lahar::material::Material;
use lahar::particles::seeding::Region;
use lahar::shape::{ShapeKind, WallTreatment};
use lahar::step::StepOrder;
use lahar::transfer::TransferKind;
use lahar::world::World;
use lahar::world::hooks::HookPoint;
use lahar::world::options::Options;

use crate::setup::{Random, a_box, add_points, context, elastic, fill, read, world, write};
use crate::support::bad_plugin;

/// A cloud of particles with random velocities in free flight.
fn cloud(options: &Options) -> World {
    let context = context(1);
    let material = elastic(&context, 1e5, 0.3);
    let mut world = world(&context, options);
    let mut random = Random::new(3);
    let d = options.dimension;
    let x = random.many(400 * d, 0.0, 1.0);
    let v = random.many(400 * d, -1.0, 1.5);
    add_points(&mut world, &material, (&x, &v), 1.0 / 400.0, 1000.0);
    world
}

#[test]
fn mass_is_exact_and_momentum_drifts_by_round_off_only() {
    for (transfer, order) in [
        (TransferKind::PicFlip, StepOrder::Musl),
        (TransferKind::PicFlip, StepOrder::Usl),
        (TransferKind::Apic, StepOrder::Musl),
    ] {
        let options =
            Options { dimension: 3, spacing: 0.2, transfer, order, cfl: 0.2, ..Options::default() };
        let mut world = cloud(&options);
        let mass: Vec<u64> = read(&world, 0, "mass").iter().map(|m| m.to_bits()).collect();
        let before = world.totals(None).expect("totals");
        let v = read(&world, 0, "velocity");
        let m = before.mass / 400.0;
        let scale: f64 = v.chunks(3).map(|v| m * v.iter().map(|c| c * c).sum::<f64>().sqrt()).sum();
        let (steps, result) = world.advance(1e9, 400);
        result.expect("free flight");
        let after = world.totals(None).expect("totals");
        let same: Vec<u64> = read(&world, 0, "mass").iter().map(|m| m.to_bits()).collect();
        assert_eq!(mass, same);
        assert_eq!(before.mass.to_bits(), after.mass.to_bits());
        for a in 0..3 {
            let drift = (after.momentum[a] - before.momentum[a]).abs() / scale;
            assert!(drift <= 1e-12 * (steps as f64).sqrt(), "axis {a}: {drift:e} in {steps} steps");
        }
    }
}

/// Angular momentum of a spinning disc after some turns, over that at the start.
fn spin_kept(transfer: TransferKind) -> f64 {
    let context = context(1);
    let material = elastic(&context, 1000.0, 0.3);
    let pic_rate = if transfer == TransferKind::PicFlip { f64::INFINITY } else { 0.0 };
    let options =
        Options { dimension: 2, spacing: 0.05, transfer, pic_rate, cfl: 0.1, ..Options::default() };
    let mut world = world(&context, &options);
    let disc = Region::Sphere { center: [0.5, 0.5, 0.0], radius: 0.25 };
    let body = fill(&mut world, &material, &disc, 1000.0, [0.0; 3]);
    let x = read(&world, body, "position");
    let v: Vec<f64> = x.chunks(2).flat_map(|x| [-0.2 * (x[1] - 0.5), 0.2 * (x[0] - 0.5)]).collect();
    write(&mut world, body, "velocity", &v);
    if transfer == TransferKind::Apic {
        let n = x.len() / 2;
        write(&mut world, body, "affine", &[0.0, -0.2, 0.2, 0.0].repeat(n));
    }
    let before = world.totals(None).expect("totals").angular_momentum[2];
    world.advance(1e9, 2000).1.expect("a free spin");
    world.totals(None).expect("totals").angular_momentum[2] / before
}

#[test]
fn apic_keeps_angular_momentum_and_pic_visibly_loses_it() {
    let apic = spin_kept(TransferKind::Apic);
    let pic = spin_kept(TransferKind::PicFlip);
    println!("angular momentum kept: APIC 1{:+e}, PIC {pic}", apic - 1.0);
    assert!((apic - 1.0).abs() <= 1e-10, "APIC keeps {apic}");
    assert!(pic < 0.5, "PIC must lose it, but keeps {pic}");
}

/// Stress of a prestressed block after a quarter turn in 1000 steps, prescribed at the nodes;
/// largest defect of R σ Rᵀ over the largest stress. Without `rotates` the material is one that
/// ignores the rotation.
fn spin_defect(dimension: usize, rotates: bool) -> f64 {
    let context = context(1);
    let material = if rotates {
        elastic(&context, 1e3, 0.3)
    } else {
        context.load_plugin(&bad_plugin("no_rotation")).expect("a plugin");
        Material::new(&context, "no_rotation", &[]).expect("a material")
    };
    let shape = ShapeKind::QuadraticBspline;
    let options = Options {
        dimension,
        spacing: 0.1,
        shape,
        transfer: TransferKind::PicFlip,
        order: StepOrder::Usl,
        cfl: 1.0,
        ..Options::default()
    };
    let mut world = world(&context, &options);
    let region = a_box([-0.3, -0.3, -0.1], [0.3, 0.3, 0.1]);
    let body = fill(&mut world, &material, &region, 1000.0, [0.0; 3]);
    let start = [100.0, -50.0, 30.0, 40.0, if dimension == 3 { 20.0 } else { 0.0 }, 0.0];
    let n = world.particle_count(body).expect("a body");
    write(&mut world, body, "stress", &start.repeat(n));
    let omega = std::f64::consts::FRAC_PI_2;
    let turn = Box::new(move |hook: lahar::world::hooks::HookArguments<'_>| {
        for node in 0..hook.nodes.count() {
            let x = hook.nodes.position(node);
            hook.nodes.set_velocity(node, [-omega * x[1], omega * x[0], 0.0]);
        }
    });
    world.set_hook(HookPoint::AfterBoundaries, Some(turn));
    for _ in 0..1000 {
        world.step(Some(1e-3)).expect("a turn");
    }
    // a quarter turn about z: x → y, y → −x
    let [xx, yy, zz, xy, yz, zx] = start;
    let expected = [yy, xx, zz, -xy, zx, -yz];
    let stress = read(&world, body, "stress");
    let defect = stress
        .chunks(6)
        .flat_map(|s| s.iter().zip(expected).map(|(a, b)| (a - b).abs()))
        .fold(0.0, f64::max);
    defect / 100.0
}

#[test]
fn a_rigid_quarter_turn_turns_the_stress_and_does_nothing_else() {
    for dimension in [2, 3] {
        let defect = spin_defect(dimension, true);
        println!("{dimension}D: stress = R sigma R^T to {defect:e}");
        assert!(defect <= 1e-10, "{dimension}D: {defect:e}");
        assert!(spin_defect(dimension, false) > 0.1, "a model without rotation must fail");
    }
}

#[test]
fn a_lattice_on_the_nodes_moves_rigidly_without_stress() {
    for shape in [ShapeKind::Linear, ShapeKind::QuadraticBspline] {
        for (order, transfer) in [
            (StepOrder::Usl, TransferKind::PicFlip),
            (StepOrder::Musl, TransferKind::PicFlip),
            (StepOrder::Musl, TransferKind::Apic),
        ] {
            let context = context(1);
            let material = elastic(&context, 1e6, 0.3);
            let options = Options {
                dimension: 2,
                spacing: 1.0,
                shape,
                order,
                transfer,
                ..Options::default()
            };
            let mut world = world(&context, &options);
            let at = |n: usize| 0.5 * n as f64 - 1e-17;
            let x: Vec<f64> = (0..25).flat_map(|n| [at(n / 5), at(n % 5)]).collect();
            let body = add_points(&mut world, &material, (&x, &[1.0, -0.5].repeat(25)), 0.25, 1e3);
            world.step(None).expect("a step");
            let stress = read(&world, body, "stress").iter().fold(0.0, |m, s| f64::max(m, s.abs()));
            assert!(stress <= 1e-7, "{shape:?} {order:?} {transfer:?}: {stress:e} Pa");
        }
    }
}

#[test]
fn what_rests_and_carries_no_wave_falls_onto_a_wall_and_not_through_it() {
    let context = context(1);
    let material = elastic(&context, 1e-6, 0.3);
    let gravity = [0.0, -9.81, 0.0];
    let options = Options { dimension: 2, spacing: 0.1, gravity, ..Options::default() };
    let mut world = world(&context, &options);
    let (kind, position) = (WallKind::Sticky, -0.95);
    world.add_wall(&Wall { axis: 1, side: 1, position, kind, friction: 0.0 }).expect("a wall");
    fill(&mut world, &material, &a_box([0.0; 3], [1.0, 1.0, 0.0]), 1000.0, [0.0; 3]);
    world.advance(0.5, 10_000).1.expect("a fall");
    let lowest = read(&world, 0, "position").chunks(2).fold(f64::INFINITY, |m, x| m.min(x[1]));
    assert!(lowest > position, "{lowest} is behind the wall at {position}");
}

#[test]
fn f_bar_gives_the_particles_of_a_cell_one_rate() {
    for dimension in [2, 3] {
        for order in StepOrder::ALL {
            for transfer in [TransferKind::Apic, TransferKind::PicFlip] {
                let options =
                    Options { dimension, spacing: 0.1, order, transfer, ..Options::default() };
                let spread = spread_of_growth(&options, true);
                assert!(spread <= 1e-12, "{options:?}: {spread:e}");
                assert!(spread_of_growth(&options, false) > 1e-2, "without it they differ");
            }
        }
    }
}

/// Largest difference between the growths of two particles of a cell in one step, over the largest
/// growth.
fn spread_of_growth(options: &Options, f_bar: bool) -> f64 {
    let context = context(2);
    let material = elastic(&context, 1e4, 0.3);
    let mut world = world(&context, options);
    let body = fill(&mut world, &material, &a_box([0.03; 3], [0.83; 3]), 1000.0, [0.0; 3]);
    world.set_f_bar(body, f_bar).expect("a body");
    let d = options.dimension;
    let x = read(&world, body, "position");
    let field = |x: &[f64]| [x[0] * x[0] * x[1], (3.0 * x[0]).sin(), x[0] - x[1]];
    let v: Vec<f64> = x.chunks(d).flat_map(|x| field(x)[..d].to_vec()).collect();
    write(&mut world, body, "velocity", &v);
    let v0 = read(&world, body, "volume");
    world.step(None).expect("a good step");
    let volumes = read(&world, body, "volume");
    let growth: Vec<f64> = volumes.iter().zip(&v0).map(|(v, v0)| v / v0 - 1.0).collect();
    let mut patches = std::collections::BTreeMap::<Vec<i64>, Vec<f64>>::new();
    for (x, r) in x.chunks(d).zip(&growth) {
        let cell = x.iter().map(|x| (x / 0.1).floor() as i64).collect();
        patches.entry(cell).or_default().push(*r);
    }
    let range = |list: &Vec<f64>| {
        let fold = |start, f: fn(f64, f64) -> f64| list.iter().copied().fold(start, f);
        fold(f64::NEG_INFINITY, f64::max) - fold(f64::INFINITY, f64::min)
    };
    let largest = growth.iter().fold(0.0, |m, r| f64::max(m, r.abs()));
    assert!(patches.values().any(|list| list.len() > 2) && largest > 1e-6);
    patches.values().map(range).fold(0.0, f64::max) / largest
}

/// Positions and stresses of a block of linear shapes that a prescribed velocity drives onto a wall
/// on a node plane, and behind it.
fn driven_onto_a_wall(wall_treatment: WallTreatment) -> Vec<u64> {
    let context = context(1);
    let material = elastic(&context, 1e4, 0.3);
    let shape = ShapeKind::Linear;
    let options =
        Options { dimension: 2, spacing: 0.1, shape, wall_treatment, ..Options::default() };
    let mut world = world(&context, &options);
    let wall = Wall { axis: 1, side: 1, position: 0.0, kind: WallKind::Slip, friction: 0.0 };
    world.add_wall(&wall).expect("a wall on a node plane");
    let body = fill(&mut world, &material, &a_box([0.0; 3], [0.5; 3]), 1000.0, [0.0; 3]);
    let mut x = read(&world, body, "position");
    x[1] = 0.0; // on the wall
    write(&mut world, body, "position", &x);
    let velocity = Table::constant([0.0, -1.0, 0.0]);
    let region = BoxRegion { min: [-1.0; 3], max: [2.0; 3] };
    world
        .add_prescribed_velocity(PrescribedVelocity { region, components: 2, velocity })
        .expect("a good condition");
    for _ in 0..60 {
        world.step(None).expect("a good step");
    }
    let fields = ["position", "stress"];
    fields.iter().flat_map(|field| read(&world, body, field)).map(f64::to_bits).collect()
}

#[test]
fn walls_on_node_planes_leave_linear_shapes_as_they_are() {
    assert!(
        driven_onto_a_wall(WallTreatment::Plain) == driven_onto_a_wall(WallTreatment::Modified),
        "linear functions have nothing to modify"
    );
}
