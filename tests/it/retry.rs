//! Steps in which a material asks for a smaller step or fails: repeated, or refused with nothing
//! changed.

use crate::setup::{a_box, fill, read, world};
use crate::support::bad_plugin;
use lahar::boundary::{BoxRegion, PrescribedVelocity, Table, Traction, Wall, WallKind};
use lahar::context::Context;
use lahar::error::Status;
use lahar::material::Material;
use lahar::step::StepOrder;
use lahar::world::World;
use lahar::world::hooks::{HookArguments, HookPoint};
use lahar::world::options::Options;
use std::sync::{Arc, Mutex};
use std::thread;

/// A block that the model of a bad plugin fills, in a world that lets steps be repeated. The stable
/// step is about 4e-3 s.
fn block(plugin: &str, retries: i32, order: StepOrder) -> World {
    block_in(&Context::new(Some(2)).unwrap(), plugin, retries, order)
}

fn block_in(context: &Arc<Context>, plugin: &str, retries: i32, order: StepOrder) -> World {
    context.load_plugin(&bad_plugin(plugin)).unwrap();
    let material = Material::new(context, "minimal", &[]).unwrap();
    let options = Options {
        dimension: 2,
        spacing: 0.1,
        gravity: [0.0, -1.0, 0.0],
        retries,
        order,
        ..Options::default()
    };
    let mut world = world(context, &options);
    fill(&mut world, &material, &a_box([0.0; 3], [4.0, 4.0, 0.0]), 1000.0, [0.1, 0.0, 0.0]);
    world
}

/// Everything that a particle has, by id.
fn everything(world: &World) -> Vec<u64> {
    let fields = ["position", "velocity", "volume", "stress", "strain_energy", "affine", "memory"];
    fields.iter().flat_map(|f| read(world, 0, f)).map(f64::to_bits).collect()
}

const ORDERS: [StepOrder; 4] = [StepOrder::Usl, StepOrder::Musl, StepOrder::Usf, StepOrder::Usavg];

#[test]
fn a_step_is_repeated_with_the_length_that_the_material_asks_for() {
    for order in [StepOrder::Usl, StepOrder::Musl, StepOrder::Usf] {
        let mut repeated = block("wants_less", 3, order);
        let mut plain = block("wants_less", 0, order);
        for _ in 0..5 {
            let dt = repeated.step(None).unwrap();
            assert!((dt / 1e-3 - 1.0).abs() < 1e-12, "{dt}");
            assert_eq!(plain.step(Some(dt)).unwrap(), dt);
        }
        assert_eq!(everything(&repeated), everything(&plain), "{order:?}");
        assert_eq!((repeated.step_count(), repeated.time()), (5, plain.time()));
    }
}

#[test]
fn a_step_that_fails_is_halved_until_it_goes_or_the_retries_are_used_up() {
    for order in ORDERS {
        let mut world = block("fails_in_large_steps", 3, order);
        let stable = world.stable_dt().unwrap();
        let dt = world.step(None).unwrap();
        // Stress updates of USAVG take half the step.
        let limit = if order == StepOrder::Usavg { 2e-3 } else { 1e-3 };
        assert!(dt <= limit && dt > 0.5 * limit, "{order:?}: {dt} of {stable}");
        let (steps, result) = world.advance(0.02, 1000);
        result.unwrap();
        assert!(steps >= 9 && world.time() == 0.02);

        let mut world = block("fails_in_large_steps", 1, order);
        let before = everything(&world);
        if order == StepOrder::Usavg {
            continue; // one halving is enough
        }
        let error = world.step(None).map(|_| ()).unwrap_err();
        assert_eq!(error.status, Status::SmallerStep);
        assert!(error.message.contains("nothing was done"), "{error}");
        assert!(error.message.contains("could not update"), "{error}");
        assert_eq!(everything(&world), before);
        assert_eq!((world.time(), world.step_count(), world.is_poisoned()), (0.0, 0, false));
        let wanted = error.place.suggested_dt.unwrap();
        assert_eq!(world.step(Some(wanted)).unwrap(), wanted);
    }
}

#[test]
fn a_step_of_the_hosts_own_length_is_refused_and_not_made_shorter() {
    let mut world = block("wants_less", 3, StepOrder::Musl);
    world.step(Some(1e-3)).unwrap();
    let before = everything(&world);
    let error = world.step(Some(2e-3)).map(|_| ()).unwrap_err();
    assert_eq!(error.status, Status::SmallerStep);
    assert!(error.message.contains("a material asks for a smaller step"), "{error}");
    let wanted = error.place.suggested_dt.unwrap();
    assert!((wanted / 1e-3 - 1.0).abs() < 1e-12);
    assert_eq!((error.place.step, error.place.time), (Some(1), Some(1e-3)));
    assert_eq!(everything(&world), before);
    assert_eq!((world.step_count(), world.last_dt()), (1, 1e-3));
    // What was taken back leaves no trace.
    let mut other = block("wants_less", 0, StepOrder::Musl);
    other.step(Some(1e-3)).unwrap();
    world.step(Some(9e-4)).unwrap();
    other.step(Some(9e-4)).unwrap();
    assert_eq!(everything(&world), everything(&other));
}

#[test]
fn without_retries_a_wish_shortens_the_next_step_and_a_failure_poisons_the_world() {
    let mut world = block("wants_less", 0, StepOrder::Musl);
    let first = world.step(None).unwrap();
    let second = world.step(None).unwrap();
    assert!(first > 3e-3 && (second / 1e-3 - 1.0).abs() < 1e-12, "{first}, {second}");
    let mut world = block("fails_in_large_steps", 0, StepOrder::Musl);
    let error = world.step(None).map(|_| ()).unwrap_err();
    assert_eq!(error.status, Status::MaterialFailed);
    assert!(error.message.contains("the world is poisoned"), "{error}");
    assert!(world.is_poisoned());
}

#[test]
fn points_that_are_less_accurate_than_promised_are_reported_once() {
    let context = Context::new(Some(2)).unwrap();
    let mut world = block_in(&context, "unreliable", 0, StepOrder::Musl);
    let lines = Arc::new(Mutex::new(Vec::new()));
    let sink = Arc::clone(&lines);
    context.set_log(Some(Arc::new(move |l, t| sink.lock().unwrap().push((l, t.to_string())))), 3);
    for _ in 0..4 {
        world.step(None).unwrap();
    }
    context.flush_log();
    let lines = lines.lock().unwrap();
    assert_eq!(lines.len(), 1, "{lines:?}");
    let expected = "in step 2 the model `minimal` answered for 6400 points with less accuracy than it promises, first for particle";
    assert!(lines[0].0 == 1 && lines[0].1.contains(expected), "{lines:?}");
}

#[test]
fn the_number_of_retries_is_checked() {
    let context = Context::new(Some(1)).unwrap();
    for retries in [-1, 21] {
        let options = Options { spacing: 0.1, retries, ..Options::default() };
        let error = World::new(&context, &options).map(|_| ()).unwrap_err();
        assert_eq!(error.status, Status::InvalidArgument);
        assert!(error.message.contains("retries must be 0 (none) to 20"), "{error}");
    }
}

/// A block on a floor, pushed from the left and loaded on top, and its forces: of the floor, of the
/// push, of the load.
fn held_block(plugin: &str, retries: i32, order: StepOrder) -> World {
    let mut world = block(plugin, retries, order);
    let kind = WallKind::Slip;
    world.add_wall(&Wall { axis: 1, side: 1, position: 0.0, kind, friction: 0.0 }).unwrap();
    let region = BoxRegion { min: [-1.0; 3], max: [0.3, 9.0, 1.0] };
    let velocity = Table::constant([0.2, 0.0, 0.0]);
    world.add_prescribed_velocity(PrescribedVelocity { region, components: 1, velocity }).unwrap();
    let region = BoxRegion { min: [0.0, 3.95, -1.0], max: [4.0, 4.0, 1.0] };
    let traction = Table::new("a load", &[0.0, 1.0], &[[0.0; 3], [0.0, -100.0, 0.0]]).unwrap();
    world.add_traction(Traction { body: 0, region, axis: 1, side: 1, traction }).unwrap();
    world
}

fn forces(world: &World) -> [[f64; 3]; 3] {
    [
        world.wall_reaction(0).unwrap(),
        world.prescribed_velocity_reaction(0).unwrap(),
        world.traction_force(0).unwrap().2,
    ]
}

#[test]
fn a_step_that_is_repeated_leaves_the_forces_of_the_step_that_was_made() {
    for order in [StepOrder::Usl, StepOrder::Musl, StepOrder::Usf] {
        let mut repeated = held_block("wants_less", 3, order);
        let mut plain = held_block("wants_less", 0, order);
        for _ in 0..5 {
            let dt = repeated.step(None).unwrap();
            plain.step(Some(dt)).unwrap();
            assert_eq!(forces(&repeated), forces(&plain), "{order:?}");
        }
        assert_eq!(everything(&repeated), everything(&plain), "{order:?}");
    }
}

#[test]
fn hooks_run_once_in_each_attempt_with_its_length() {
    let mut world = block("wants_less", 3, StepOrder::Musl);
    let calls = Arc::new(Mutex::new(Vec::new()));
    let points =
        [HookPoint::Start, HookPoint::AfterScatter, HookPoint::AfterBoundaries, HookPoint::End];
    for point in points {
        let calls = Arc::clone(&calls);
        let hook = move |a: HookArguments<'_>| {
            calls.lock().unwrap().push((point, a.time, a.dt));
        };
        world.set_hook(point, Some(Box::new(hook)));
    }
    let stable = world.stable_dt().unwrap();
    let dt = world.step(None).unwrap();
    assert!(dt < stable);
    let expected: Vec<_> =
        [stable, dt].iter().flat_map(|dt| points.map(|point| (point, 0.0, *dt))).collect();
    assert_eq!(*calls.lock().unwrap(), expected);
}

#[test]
fn exclusive_calls_of_a_model_that_is_not_thread_safe_do_not_overlap_its_steps() {
    let context = Context::new(Some(2)).unwrap();
    let mut world = block_in(&context, "alone", 0, StepOrder::Musl);
    thread::scope(|scope| {
        let steps = scope.spawn(|| {
            for _ in 0..20 {
                world.step(Some(1e-3)).unwrap();
            }
        });
        let mut made = 0;
        while !steps.is_finished() {
            drop(Material::new(&context, "minimal", &[]).unwrap());
            made += 1;
        }
        assert!(made >= 20, "{made} materials are too few to meet a step");
        steps.join().unwrap();
    });
    // The model refuses values once two of its calls have overlapped.
    Material::new(&context, "minimal", &[]).unwrap();
}

#[test]
fn a_step_that_is_refused_leaves_the_forces_of_the_step_before() {
    for order in ORDERS {
        let mut world = held_block("fails_in_large_steps", 3, order);
        (0..3).for_each(|_| assert_eq!(world.step(Some(9e-4)).unwrap(), 9e-4));
        let before = forces(&world);
        assert!(before.iter().all(|f| f.iter().any(|f| *f != 0.0)), "{before:?}");
        let error = world.step(Some(3e-3)).map(|_| ()).unwrap_err();
        assert_eq!(error.status, Status::SmallerStep, "{order:?}");
        assert_eq!(forces(&world), before, "{order:?}");
        // What comes next changes them.
        world.step(Some(9e-4)).unwrap();
        assert_ne!(forces(&world), before, "{order:?}");
    }
}
