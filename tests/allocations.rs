//! A step allocates nothing once buffers are warm. A binary of its own, since it counts every allocation of the process.
#![allow(clippy::print_stdout)] // tests report the figures that they judge

#[path = "it/setup.rs"]
#[allow(dead_code)]
mod setup;
#[path = "it/support.rs"]
mod support;

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use lahar::boundary::{BoxRegion, PrescribedVelocity, Table, Traction, Wall, WallKind};
use lahar::step::StepOrder;
use lahar::transfer::TransferKind;
use lahar::world::World;
use lahar::world::options::Options;

use setup::{a_box, context, elastic, fill, world};

/// The allocator of the system, with a count of the blocks that it gave.
struct Counting;

static COUNT: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call goes to the allocator of the system unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps the contract of `dealloc`; the block came from the system.
        unsafe { System.dealloc(block, layout) }
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        COUNT.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller keeps the contract of `realloc`; the block came from the system.
        unsafe { System.realloc(block, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Two stiff blocks that fly through a box, fall and bounce: particles change blocks in every step, and blocks of the
/// grid come and go.
fn bouncing_blocks(threads: usize, order: StepOrder, transfer: TransferKind) -> World {
    let context = context(threads);
    let stiff = elastic(&context, 5e5, 0.3);
    let options = Options {
        dimension: 3,
        spacing: 0.1,
        gravity: [0.0, 0.0, -9.81],
        order,
        transfer,
        ..Options::default()
    };
    let mut world = world(&context, &options);
    for axis in 0..3 {
        for (side, position) in [(1, 0.05), (-1, 2.45)] {
            let kind = WallKind::Separating;
            world.add_wall(&Wall { axis, side, position, kind, friction: 0.0 }).expect("a wall");
        }
    }
    let (a, b) = (a_box([0.2; 3], [1.2, 1.1, 1.0]), a_box([1.3; 3], [2.2; 3]));
    let loaded = fill(&mut world, &stiff, &a, 1000.0, [3.0, -2.0, 4.0]);
    let averaged = fill(&mut world, &stiff, &b, 1000.0, [-5.0, -3.0, 1.0]);
    world.set_f_bar(averaged, true).expect("a body");
    add_conditions(&mut world, loaded);
    world
}

/// Gravity by a table, a load on the top of a body, and a current along one side.
fn add_conditions(world: &mut World, body: i64) {
    let table = |a, b| Table::new("the test", &[0.0, 1.0], &[a, b]).expect("a good table");
    let gravity = table([0.0, 0.0, -9.81], [1.0, 0.0, -8.0]);
    world.set_gravity_table(Some(gravity)).expect("a good table");
    let region = BoxRegion { min: [0.0, 0.0, 0.95], max: [1.3, 1.3, 1.0] };
    let traction = table([0.0, 0.0, -100.0], [0.0, 50.0, 0.0]);
    world.add_traction(Traction { body, region, axis: 2, side: 1, traction }).expect("a surface");
    let region = BoxRegion { min: [0.0, 0.0, 0.0], max: [0.3, 3.0, 3.0] };
    let velocity = table([0.0, 1.0, 0.0], [0.0, -1.0, 0.0]);
    let current = PrescribedVelocity { region, components: 2, velocity };
    world.add_prescribed_velocity(current).expect("a good condition");
}

/// Allocations in 200 steps after 200 others, and the blocks that came and went meanwhile.
fn allocations(threads: usize, order: StepOrder, transfer: TransferKind) -> (usize, i64) {
    let mut world = bouncing_blocks(threads, order, transfer);
    assert!(world.totals(None).expect("totals").particles > 4096, "enough for threads");
    world.advance(1e9, 200).1.expect("warm-up");
    let mut turnover = 0;
    let before = COUNT.load(Ordering::Relaxed);
    for _ in 0..200 {
        world.step(None).expect("a step");
        let stats = world.grid_stats();
        turnover += stats.blocks_created + stats.blocks_removed;
    }
    (COUNT.load(Ordering::Relaxed) - before, turnover)
}

/// The tests of this binary share the counter: one test, so that nothing else runs beside a count.
#[test]
fn a_warm_step_allocates_nothing() {
    let of_each = [
        (StepOrder::Usl, TransferKind::Apic),
        (StepOrder::Musl, TransferKind::Apic),
        (StepOrder::Usavg, TransferKind::Xpic),
    ];
    for (order, transfer) in of_each {
        let (count, turnover) = allocations(1, order, transfer);
        assert!(turnover > 20, "only {turnover} blocks came and went");
        assert_eq!(count, 0, "{order:?}: allocations in 200 steps");
        // each step enters the pool once, and rayon's queue of jobs from outside takes a new block every 63 entries
        let (count, _) = allocations(2, order, transfer);
        println!("{order:?}, 2 threads: {count} allocations in 200 steps");
        assert!(count <= 200 / 63 + 1, "{order:?}, 2 threads: {count} allocations in 200 steps");
    }
}
