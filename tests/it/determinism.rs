//! The state after 200 steps is the same, bit for bit, for any number of threads.

use std::sync::Arc;

use lahar::boundary::{Wall, WallKind};
use lahar::context::Context;
use lahar::material::Material;
use lahar::shape::ShapeKind;
use lahar::simd::Isa;
use lahar::step::StepOrder;
use lahar::transfer::TransferKind;
use lahar::world::World;
use lahar::world::options::Options;

use crate::setup::{a_box, add_points, context_with, elastic, fill, read, world, write};

/// All fields of two colliding bodies (more than 20 000 particles) after 200 steps, and the number
/// of threads that worked.
fn state_after_a_collision(
    threads: usize,
    isa: Isa,
    method: &Options,
    steps: usize,
    (models, f_bar): ([&str; 2], bool),
) -> (Vec<u64>, usize) {
    let context = context_with(threads, isa);
    let elastic = |model: &str, e: f64, nu: f64| {
        let values = [("youngs_modulus", e), ("poissons_ratio", nu)];
        Material::new(&context, model, &values).expect("a material")
    };
    let soft = elastic(models[0], 1e5, 0.3);
    let stiff = elastic(models[1], 4e5, 0.2);
    let options = Options { spacing: 0.1, gravity: [0.0, 0.0, -9.81], ..method.clone() };
    let mut world = world(&context, &options);
    let lower = a_box([0.0, 0.0, 0.05], [1.6, 1.4, 0.55]);
    let upper = a_box([0.2, 0.3, 0.6], [1.4, 1.6, 1.5]);
    fill(&mut world, &soft, &lower, 1000.0, [0.0; 3]);
    let upper = fill(&mut world, &stiff, &upper, 2000.0, [0.5, 0.0, -2.0]);
    world.set_f_bar(upper, f_bar).expect("a body");
    let kind = WallKind::Friction;
    world
        .add_wall(&Wall { axis: 2, side: 1, position: 0.05, kind, friction: 0.4 })
        .expect("a good wall");
    assert!(world.totals(None).expect("totals").particles >= 20_000);
    for _ in 0..steps {
        world.step(None).expect("a good step");
    }
    let mut bits = Vec::new();
    for body in world.bodies() {
        for info in world.fields(body).expect("fields") {
            let name = info.name.to_str().expect("ASCII");
            bits.extend(read(&world, body, name).iter().map(|v| v.to_bits()));
        }
        bits.extend(world.ids(body).expect("ids").iter().map(|id| *id as u64));
    }
    let totals = world.totals(None).expect("totals");
    bits.extend([totals.kinetic_energy, totals.momentum[2], world.time()].map(f64::to_bits));
    (bits, context.threads_used())
}

const RATE: ([&str; 2], bool) = (["linear_elastic", "linear_elastic"], false);

fn with(transfer: TransferKind) -> Options {
    Options { transfer, ..Options::default() }
}

#[test]
fn any_number_of_threads_gives_the_same_bits_with_filters_averages_and_every_order() {
    let f_bar = (RATE.0, true);
    for (shape, transfer, order) in [
        (ShapeKind::CubicBspline, TransferKind::Xpic, StepOrder::Usl),
        (ShapeKind::ContiguousGimp, TransferKind::Fmpm, StepOrder::Usavg),
        (ShapeKind::QuadraticBspline, TransferKind::Mls, StepOrder::Usf),
        (ShapeKind::Linear, TransferKind::Tpic, StepOrder::Musl),
    ] {
        let method = Options { shape, transfer, order, cfl: 0.2, ..Options::default() };
        let run = |threads| state_after_a_collision(threads, Isa::best(), &method, 30, f_bar);
        let (one, two) = (run(1), run(2));
        assert_eq!(two.1, 2, "the threads worked");
        assert!(one.0 == two.0, "2 threads give other bits with {method:?}");
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits_for_models_that_need_the_deformation_gradient() {
    let models = (["linear_elastic_green_naghdi", "neo_hookean"], false);
    let run = |threads| {
        state_after_a_collision(threads, Isa::best(), &with(TransferKind::Apic), 60, models)
    };
    let (one, two) = (run(1), run(2));
    assert_eq!(two.1, 2, "the threads worked");
    assert!(one.0 == two.0, "2 threads give other bits");
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    for transfer in [TransferKind::PicFlip, TransferKind::Apic] {
        let (one, _) = state_after_a_collision(1, Isa::best(), &with(transfer), 200, RATE);
        for threads in [2, 3, 8] {
            let (bits, used) =
                state_after_a_collision(threads, Isa::best(), &with(transfer), 200, RATE);
            assert!(used >= 2, "of {threads} threads only {used} worked");
            assert!(bits == one, "{threads} threads give other bits than one");
        }
    }
}

/// A row of particles, 20 in a line, 0.05 m apart.
fn row(count: usize) -> Vec<f64> {
    let x = |k: usize| 0.05 * (k % 20) as f64 + 0.01 * (k as f64).sin();
    (0..count).flat_map(|k| [x(k), 0.05 + 0.05 * (k / 20) as f64]).collect()
}

/// A world with a sticky floor.
fn a_floor(context: &Arc<Context>) -> World {
    let gravity = [0.0, -9.81, 0.0];
    let options = Options { dimension: 2, spacing: 0.1, gravity, ..Options::default() };
    let mut world = world(context, &options);
    let kind = WallKind::Sticky;
    let floor = Wall { axis: 1, side: 1, position: 0.0, kind, friction: 0.0 };
    world.add_wall(&floor).expect("a good wall");
    world
}

/// Bits of a body of 101 particles, no multiple of eight, after 50 steps.
fn state_of_a_small_body(context: &Arc<Context>) -> Vec<u64> {
    let material = elastic(context, 1e6, 0.3);
    let mut world = a_floor(context);
    let speed = |k: usize| [8.0 * (7.0 * k as f64).sin(), -8.0 * (3.0 * k as f64).cos()];
    let v: Vec<f64> = (0..101).flat_map(speed).collect();
    let body = add_points(&mut world, &material, (&row(101), &v), 0.0025, 1000.0);
    for _ in 0..50 {
        world.step(None).expect("a good step");
    }
    let fields = ["position", "velocity", "stress", "volume", "strain_energy"];
    fields.iter().flat_map(|f| read(&world, body, f)).map(f64::to_bits).collect()
}

#[test]
fn it_does_not_matter_what_a_thread_worked_on_before() {
    for isa in Isa::all() {
        let context = context_with(1, isa);
        let alone = state_of_a_small_body(&context);
        for particles in [16, 17, 24] {
            let material = elastic(&context, 1e6, 0.3);
            let mut other = a_floor(&context);
            let rest = vec![0.0; 2 * particles];
            let body = add_points(&mut other, &material, (&row(particles), &rest), 0.0025, 1000.0);
            write(&mut other, body, "stress", &vec![-1e5; 6 * particles]);
            other.step(None).expect("a good step");
            assert!(
                state_of_a_small_body(&context) == alone,
                "{isa:?}, {particles} particles before"
            );
        }
    }
}

#[test]
fn so_it_is_for_every_instruction_set() {
    for isa in Isa::all() {
        let (one, _) = state_after_a_collision(1, isa, &with(TransferKind::Apic), 50, RATE);
        let (two, _) = state_after_a_collision(2, isa, &with(TransferKind::Apic), 50, RATE);
        assert!(one == two, "{isa:?}: two threads give other bits than one");
    }
}
