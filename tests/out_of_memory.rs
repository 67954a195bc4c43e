//! No call aborts when memory is short. A binary of its own, since it limits what the process
//! allocates.
#![allow(clippy::print_stdout)] // tests report the figures that they judge

#[path = "it/support.rs"]
mod support;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::collections::BTreeMap;
use std::ffi::CString;
use std::ptr::{null, null_mut};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use lahar_plugin_abi::{lahar_host_api, lahar_plugin_desc};

use lahar::error::Status;
use lahar::ffi::answers::ANSWERS;
use lahar::ffi::body::*;
use lahar::ffi::context::*;
use lahar::ffi::error::*;
use lahar::ffi::field::*;
use lahar::ffi::grid::*;
use lahar::ffi::material::*;
use lahar::ffi::model::*;
use lahar::ffi::output::*;
use lahar::ffi::prescribed_velocity::*;
use lahar::ffi::progress::*;
use lahar::ffi::statics::*;
use lahar::ffi::table::lahar_table;
use lahar::ffi::traction::*;
use lahar::ffi::version::lahar_version;
use lahar::ffi::view::*;
use lahar::ffi::wall::*;
use lahar::ffi::world::*;

/// The allocator of the system with a limit on the bytes in use, as a limit on the address space
/// or a full machine sets one.
struct Limited;

static USED: AtomicUsize = AtomicUsize::new(0);
static LIMIT: AtomicUsize = AtomicUsize::new(usize::MAX);
/// The least limit with which the first refused allocation would have been given.
static WANTED: AtomicUsize = AtomicUsize::new(0);

thread_local! {
    /// Whether this thread calls the functions; the others are workers of a context.
    static CALLS: Cell<bool> = const { Cell::new(false) };
}

/// Most that a worker gets beyond the limit at once: workers that look for work make room in
/// rayon's queues, blocks of 1.5 kB, whenever they like, also in the moment in which the caller
/// tries how much there is. With one thread nothing is excused.
const OF_QUEUES: usize = 4096;

fn is_refused(more: usize) -> bool {
    let all = USED.fetch_add(more, Relaxed) + more;
    if all <= LIMIT.load(Relaxed) || !CALLS.get() && more <= OF_QUEUES {
        return false;
    }
    USED.fetch_sub(more, Relaxed);
    let _ = WANTED.compare_exchange(0, all, Relaxed, Relaxed);
    true
}

// SAFETY: every block comes from the allocator of the system, to which it is given back.
unsafe impl GlobalAlloc for Limited {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if is_refused(layout.size()) {
            return null_mut();
        }
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        USED.fetch_sub(layout.size(), Relaxed);
        // SAFETY: the caller keeps the contract of `dealloc`.
        unsafe { System.dealloc(block, layout) }
    }

    // `realloc` is that of the trait: old and new block are there at the same time
}

#[global_allocator]
static ALLOCATOR: Limited = Limited;

/// Functions that were walked, with their names and failures.
type Walked = BTreeMap<&'static str, usize>;

/// Calls of a function with more and more memory, until it succeeds.
struct Walk {
    name: &'static str,
    limit: usize,
    failures: usize,
}

impl Walk {
    fn new(name: &'static str) -> Self {
        Self { name, limit: USED.load(Relaxed), failures: 0 }
    }

    fn begin_call(&self) {
        WANTED.store(0, Relaxed);
        LIMIT.store(self.limit.max(USED.load(Relaxed)), Relaxed);
    }

    /// Whether the call succeeded; else it must have said that there is too little memory.
    fn end_call(&mut self, status: i32) -> bool {
        LIMIT.store(usize::MAX, Relaxed);
        if status == 0 {
            return true;
        }
        assert_eq!(Status::from_i32(status), Ok(Status::OutOfMemory), "{}", self.name);
        self.failures += 1;
        assert!(self.failures < 20_000, "{} does not end", self.name);
        // as much as was missing, but always more than before: buffers that are kept may have grown
        self.limit = WANTED.load(Relaxed).max(self.limit + 1);
        false
    }

    fn must_be_the_same<L: PartialEq>(&self, before: &L, after: &L) {
        assert!(before == after, "{} has changed something without memory", self.name);
    }
}

/// Walks through a function with these arguments. Whenever it fails, `look` must see the same as
/// before.
macro_rules! walk {
    ($walked:ident, $look:expr, $function:ident($($argument:expr),* $(,)?)) => {{
        let mut walk = Walk::new(stringify!($function));
        loop {
            let before = $look;
            walk.begin_call();
            // SAFETY: the arguments are live handles and variables of this test.
            if walk.end_call(unsafe { $function($($argument),*) }) {
                break;
            }
            walk.must_be_the_same(&before, &$look);
        }
        *$walked.entry(walk.name).or_default() += walk.failures;
    }};
}

/// Calls a function that must succeed, without a limit.
macro_rules! ok {
    ($function:ident($($argument:expr),* $(,)?)) => {
        // SAFETY: the arguments are live handles and variables of this test.
        assert_eq!(unsafe { $function($($argument),*) }, 0, stringify!($function))
    };
}

/// A struct of the interface with zeros.
fn zeros<T: Copy>() -> T {
    // SAFETY: the structs hold numbers and pointers, all of which may be zero.
    unsafe { std::mem::zeroed() }
}

/// A struct of zeros with its size.
macro_rules! sized {
    ($Struct:ident) => {{
        let mut sized: $Struct = zeros();
        sized.struct_size = size_of::<$Struct>() as u32;
        sized
    }};
}

/// A struct with its defaults, but for these fields.
macro_rules! filled {
    ($walked:ident, $Struct:ident, $init:ident, $($field:ident: $value:expr),* $(,)?) => {{
        let mut filled = sized!($Struct);
        walk!($walked, (), $init(&mut filled, size_of::<$Struct>() as i64));
        $(filled.$field = $value;)*
        filled
    }};
}

/// A way of running: dimension, shape, transfer, order, grid policy, walls, retries, F-bar, threads.
type Run = (i32, i32, i32, i32, i32, i32, i32, i32, i32);

/// Bodies, steps, time, and the positions, velocities and stresses of the first body by id.
type Picture = (i64, i64, u64, Vec<u64>);

fn picture(world: *const lahar_world, body: i64) -> Picture {
    let (mut bodies, mut steps, mut time, mut n) = (0, 0, 0.0, 0);
    ok!(lahar_world_body_count(world, &mut bodies));
    ok!(lahar_world_step_count(world, &mut steps));
    ok!(lahar_world_time(world, &mut time));
    let mut all = Vec::new();
    if bodies > 0 {
        ok!(lahar_body_particle_count(world, body, &mut n));
        for (name, components) in [(c"position", 3), (c"velocity", 3), (c"stress", 6)] {
            let mut values = vec![0.0_f64; components * n as usize];
            let to = values.as_mut_ptr();
            ok!(lahar_body_read(world, body, name.as_ptr(), n, to, n, 1));
            all.extend(values.into_iter().map(f64::to_bits));
        }
    }
    (bodies, steps, time.to_bits(), all)
}

fn path_of(plugin: &str) -> CString {
    CString::new(support::plugin_path(plugin)).expect("a path")
}

/// All functions, one after the other, on a world that is made for them and freed.
fn all_functions(run: Run, walked: &mut Walked) {
    let threads = run.8;
    let mut context: *mut lahar_context = null_mut();
    walk!(walked, context.is_null(), lahar_context_create(threads, &mut context));
    let (mut index, mut count, mut small) = (0, 0, 0);
    let path = path_of("drucker_prager");
    walk!(walked, (), lahar_context_load_plugin(context, path.as_ptr(), &mut index));
    context_functions(context, walked);
    walk!(walked, (), lahar_version(&mut small, &mut small, &mut small));
    let mut material: *mut lahar_material = null_mut();
    let keys = [c"youngs_modulus", c"poissons_ratio", c"friction_angle", c"cohesion", c"cone"];
    let keys = keys.map(|key| key.as_ptr());
    let (values, model) = ([1e6, 0.3, 30.0, 1e3, 0.0], c"drucker_prager".as_ptr());
    let given = (keys.as_ptr(), values.as_ptr());
    walk!(
        walked,
        material.is_null(),
        lahar_material_create(context, model, 5, given.0, given.1, &mut material)
    );
    let mut value = 0.0;
    walk!(walked, (), lahar_material_value(material, keys[0], &mut value));
    let (dimension, shape, transfer, order, grid_policy, wall_treatment, retries, ..) = run;
    let options = filled!(
        walked, lahar_world_options, lahar_world_options_init, dimension: dimension, shape: shape,
        transfer: transfer, order: order, grid_policy: grid_policy, wall_treatment: wall_treatment,
        retries: retries, spacing: 0.1, gravity: [0.0, -9.81, 0.0], box_min: [-0.5; 3], box_max: [6.0; 3],
    );
    let mut world: *mut lahar_world = null_mut();
    walk!(walked, world.is_null(), lahar_world_create(context, &options, &mut world));
    conditions(world, wall_treatment == 0, walked);
    let body = bodies(world, material, walked);
    if run.7 == 1 {
        walk!(walked, picture(world, body), lahar_body_set_f_bar(world, body, 1));
    }
    fields(world, body, walked);
    statics(world, body, walked);
    steps(world, body, walked);
    grid(world, body, walked);
    let file = std::env::temp_dir().join(format!("lahar-memory-{}.vtp", std::process::id()));
    let file = CString::new(file.to_str().expect("UTF-8")).expect("a path");
    walk!(walked, picture(world, body), lahar_world_write_vtp(world, file.as_ptr()));
    std::fs::remove_file(file.to_str().expect("UTF-8")).expect("a file");
    walk!(walked, picture(world, 0), lahar_body_remove(world, body + 1));
    walk!(walked, (), lahar_world_body_count(world, &mut count));
    // SAFETY: handles that are not used again.
    unsafe {
        lahar_world_free(world);
        lahar_material_free(material);
        lahar_context_free(context);
    }
}

/// The entry of a plugin that is linked in.
unsafe extern "C" fn linked(host: *const lahar_host_api) -> *const lahar_plugin_desc {
    // SAFETY: the engine passes its static table.
    lahar_model_linear_elastic::plugin(unsafe { &*host }).desc()
}

fn context_functions(context: *mut lahar_context, walked: &mut Walked) {
    let (mut index, mut small) = (0, 0);
    let name = c"drucker_prager".as_ptr();
    let mut text = [0; 100];
    walk!(walked, (), lahar_context_thread_count(context, &mut small));
    walk!(walked, (), lahar_context_threads_used(context, &mut small));
    walk!(walked, (), lahar_context_set_log(context, None, null_mut(), 1));
    walk!(walked, (), lahar_context_set_capsule_folder(context, c".".as_ptr()));
    walk!(walked, (), lahar_context_register_plugin(context, Some(linked), &mut index));
    walk!(walked, (), lahar_context_plugin_count(context, &mut index));
    walk!(walked, (), lahar_context_plugin_info(context, 0, &mut sized!(lahar_plugin_info)));
    walk!(walked, (), lahar_context_model_count(context, &mut index));
    walk!(walked, (), lahar_context_model_info(context, 0, &mut sized!(lahar_model_info)));
    walk!(walked, (), lahar_context_find_model(context, name, &mut index));
    walk!(
        walked,
        (),
        lahar_context_model_parameter(context, 0, 0, &mut sized!(lahar_parameter_info))
    );
    walk!(walked, (), lahar_context_model_state(context, 0, 0, &mut sized!(lahar_state_info)));
    walk!(walked, (), lahar_last_error_message(text.as_mut_ptr(), 100, &mut index));
    walk!(walked, (), lahar_last_error_info(&mut sized!(lahar_error_info)));
    let to = text.as_mut_ptr();
    walk!(walked, (), lahar_context_error_message(context, to, 100, &mut index));
}

/// Walls, gravity by a long table, and a current by another.
fn conditions(world: *mut lahar_world, many_walls: bool, walked: &mut Walked) {
    let (mut id, mut force) = (0, [0.0; 3]);
    let to = force.as_mut_ptr();
    let wall = filled!(walked, lahar_wall, lahar_wall_init, axis: 1, kind: 2);
    walk!(walked, (), lahar_wall_add(world, &wall, &mut id));
    for axis in (0..if many_walls { 20 } else { 1 }).map(|n| n % 2) {
        let wall = lahar_wall { axis, side: -1, position: 9.0, ..wall };
        walk!(walked, (), lahar_wall_add(world, &wall, &mut id));
    }
    walk!(walked, (), lahar_wall_remove(world, id));
    walk!(walked, (), lahar_wall_reaction(world, 0, to));
    let times: Vec<f64> = (0..3000).map(f64::from).collect();
    let rows: Vec<f64> = (0..3000).flat_map(|_| [0.0, -9.81, 0.0]).collect();
    let (count, times, values) = (3000, times.as_ptr(), rows.as_ptr());
    walk!(walked, (), lahar_world_set_gravity_table(world, count, times, values));
    let condition = filled!(
        walked, lahar_prescribed_velocity, lahar_prescribed_velocity_init, components: 1,
        box_min: [4.0; 3], box_max: [5.0; 3], table: lahar_table { count, times, values },
    );
    for _ in 0..20 {
        walk!(walked, (), lahar_prescribed_velocity_add(world, &condition, &mut id));
    }
    walk!(walked, (), lahar_prescribed_velocity_remove(world, id));
    walk!(walked, (), lahar_prescribed_velocity_reaction(world, 0, to));
}

/// A box that is looked at, and one body of each other kind; gives the id of the box.
fn bodies(world: *mut lahar_world, material: *const lahar_material, walked: &mut Walked) -> i64 {
    let (mut box_id, mut id, mut ids, mut count) = (-1, -1, [0; 100], 0);
    let fill = filled!(
        walked, lahar_fill, lahar_fill_init, density: 1000.0, velocity: [3.0, 1.0, 0.0],
    );
    let (min, max) = ([0.2, 0.2, 0.2], [2.2, 2.0, 0.5]);
    let (min, max) = (min.as_ptr(), max.as_ptr());
    walk!(
        walked,
        picture(world, 0),
        lahar_body_add_box(world, material, min, max, &fill, &mut box_id)
    );
    let center = [3.0, 3.0, 1.0].as_ptr();
    walk!(
        walked,
        picture(world, 0),
        lahar_body_add_sphere(world, material, center, 0.3, &fill, &mut id)
    );
    let corner = |k: i32| f64::from(k) * std::f64::consts::TAU / 5000.0;
    let corners: Vec<f64> = (0..5000)
        .flat_map(|k| [1.0 + 0.3 * corner(k).cos(), 4.0 + 0.3 * corner(k).sin()])
        .collect();
    let vertices = corners.as_ptr();
    if dimension_of(world) == 2 {
        walk!(
            walked,
            picture(world, 0),
            lahar_body_add_polygon(world, material, 5000, vertices, &fill, &mut id)
        );
    }
    let n = 2000;
    let position: Vec<f64> = (0..3 * n).map(|k| 2.5 + 1e-3 * f64::from(k / 3)).collect();
    let ones: Vec<f64> = (0..3 * n).map(|_| 1e-2).collect();
    let (interleaved, tight) = (3, 1);
    let array = |values: &[f64]| lahar_array {
        data: values.as_ptr(),
        component_stride: tight,
        point_stride: interleaved,
    };
    let particles = filled!(
        walked, lahar_particles, lahar_particles_init, count: i64::from(n), position: array(&position),
        volume: array(&ones), size: array(&ones), density: 1000.0,
    );
    walk!(
        walked,
        picture(world, 0),
        lahar_body_add_particles(world, material, &particles, &mut id)
    );
    walk!(walked, (), lahar_world_bodies(world, 100, ids.as_mut_ptr(), &mut count));
    walk!(walked, (), lahar_body_particle_count(world, box_id, &mut count));
    for _ in 0..40 {
        ok!(lahar_body_add_particles(world, material, &particles, &mut id));
        ok!(lahar_body_remove(world, id));
    }
    box_id
}

fn dimension_of(world: *const lahar_world) -> i32 {
    let mut statistics = sized!(lahar_grid_statistics);
    ok!(lahar_grid_stats(world, &mut statistics));
    statistics.dimension
}

fn fields(world: *mut lahar_world, body: i64, walked: &mut Walked) {
    let (mut n, mut index) = (0, 0);
    ok!(lahar_body_particle_count(world, body, &mut n));
    let mut values = vec![0.0; 6 * n as usize];
    let mut ids = vec![0; n as usize];
    let (stress, data) = (c"stress".as_ptr(), values.as_mut_ptr());
    walk!(walked, (), lahar_body_field_count(world, body, &mut index));
    walk!(walked, (), lahar_body_field_info(world, body, 0, &mut sized!(lahar_field_info)));
    walk!(walked, (), lahar_body_find_field(world, body, stress, &mut index));
    walk!(walked, (), lahar_body_read(world, body, stress, n, data, 0, 0));
    walk!(walked, picture(world, body), lahar_body_write(world, body, stress, n, data, 0, 0));
    let ids = ids.as_mut_ptr();
    walk!(walked, picture(world, body), lahar_body_ids(world, body, n, ids, &mut index));
    for access in [0, 1] {
        ok!(lahar_body_write(world, body, c"velocity".as_ptr(), n, data, 6, 1));
        let mut view: *mut lahar_view = null_mut();
        walk!(walked, view.is_null(), lahar_body_view(world, body, stress, access, &mut view));
        walk!(walked, (), lahar_view_data(view, &mut sized!(lahar_view_info)));
        // SAFETY: a handle that is not used again.
        unsafe { lahar_view_free(view) };
    }
}

fn statics(world: *mut lahar_world, body: i64, walked: &mut Walked) {
    let (mut id, mut area, mut force, mut count) = (0, 0.0, [0.0; 3], 0);
    walk!(walked, picture(world, body), lahar_body_set_k0_stress(world, body, 2.0, 1e4, 0.5));
    walk!(walked, picture(world, body), lahar_body_init_state(world, body));
    let factors: Vec<f64> = (0..2000).map(f64::from).collect();
    let table = lahar_table { count: 2000, times: factors.as_ptr(), values: factors.as_ptr() };
    let traction = filled!(
        walked, lahar_traction, lahar_traction_init, axis: 1, body: body, traction: [0.0, -10.0, 0.0],
        box_min: [-1.0, 1.951, -1.0], box_max: [9.0, 9.0, 9.0], factors: table,
    );
    for _ in 0..20 {
        walk!(walked, (), lahar_traction_add(world, &traction, &mut id));
    }
    walk!(walked, (), lahar_traction_remove(world, id));
    let to = force.as_mut_ptr();
    walk!(walked, (), lahar_traction_force(world, 0, &mut count, &mut area, to));
    let mut equilibrium = sized!(lahar_equilibrium);
    walk!(walked, picture(world, body), lahar_world_equilibrium(world, &mut equilibrium));
    walk!(walked, (), lahar_world_totals(world, -1, &mut sized!(lahar_totals)));
}

/// Steps of all kinds; now and then something is changed, so that they sort and ask the models.
fn steps(world: *mut lahar_world, body: i64, walked: &mut Walked) {
    let (mut dt, mut n, mut done) = (0.0, 0, 0);
    ok!(lahar_body_particle_count(world, body, &mut n));
    // more than the model can bear, so that the next step looks at every point twice
    let tension = vec![1e5; 6 * n as usize];
    ok!(lahar_body_write(world, body, c"stress".as_ptr(), n, tension.as_ptr(), 0, 0));
    walk!(walked, picture(world, body), lahar_world_stable_dt(world, &mut dt));
    walk!(walked, picture(world, body), lahar_world_step(world, 0.5 * dt));
    walk!(walked, (), lahar_world_last_dt(world, &mut dt));
    walk!(walked, (), lahar_world_time(world, &mut dt));
    walk!(walked, (), lahar_world_step_count(world, &mut done));
    for factor in 1..5 {
        // apart more and more, so that particles change blocks and the grid grows
        let speeds: Vec<f64> = (0..n).map(|k| f64::from(factor) * (k as f64 / n as f64)).collect();
        let mut both = speeds.clone();
        both.extend(&speeds);
        both.extend(&speeds);
        let field = c"velocity".as_ptr();
        ok!(lahar_body_write(world, body, field, n, both.as_ptr(), n, 1));
        walk!(walked, picture(world, body), lahar_world_step_auto(world, &mut dt));
        let (until, time) = (1e9, null_mut());
        for _ in 0..10 {
            walk!(walked, (), lahar_world_advance(world, until, 1, &mut done, time));
        }
    }
    walk!(walked, (), lahar_world_set_damping(world, 0.5));
    walk!(walked, (), lahar_world_set_progress(world, None, null_mut(), 0.0));
    let criteria = filled!(
        walked, lahar_settle_criteria, lahar_settle_criteria_init, max_steps: 3,
    );
    let mut result = sized!(lahar_settle_result);
    walk!(walked, (), lahar_world_settle(world, &criteria, &mut result));
    walk!(walked, (), lahar_world_set_gravity(world, [0.0, -1.0, 0.0].as_ptr()));
}

fn grid(world: *mut lahar_world, body: i64, walked: &mut Walked) {
    let (mut n, mut node, mut count) = (0, 0, 0);
    ok!(lahar_body_particle_count(world, body, &mut n));
    let zeros = vec![0.0; 6 * n as usize];
    // what was written makes the grid stale
    let change =
        || ok!(lahar_body_write(world, body, c"velocity".as_ptr(), n, zeros.as_ptr(), n, 1));
    change();
    let mut statistics = sized!(lahar_grid_statistics);
    walk!(walked, picture(world, body), lahar_grid_stats(world, &mut statistics));
    let nodes = statistics.active_nodes;
    let mut blocks = vec![0; 3 * statistics.active_blocks as usize];
    let blocks = blocks.as_mut_ptr();
    walk!(walked, (), lahar_grid_blocks(world, statistics.active_blocks, blocks, &mut count));
    let mut index = [0; 3];
    walk!(walked, (), lahar_grid_node_index(world, 0, index.as_mut_ptr()));
    walk!(walked, (), lahar_grid_find_node(world, index.as_ptr(), &mut node));
    walk!(walked, (), lahar_grid_field_count(world, &mut count));
    walk!(walked, (), lahar_grid_field_info(world, 0, &mut sized!(lahar_field_info)));
    let mut values = vec![0.0; 3 * nodes as usize];
    let (mass, values) = (c"mass".as_ptr(), values.as_mut_ptr());
    change();
    walk!(walked, picture(world, body), lahar_grid_read(world, mass, nodes, null(), values));
    let points = zeros.as_ptr();
    walk!(walked, (), lahar_grid_sample(world, mass, 100, points, values, null_mut()));
}

/// Runs a test of memory on a thread of its own, whose buffers end with it.
fn alone(work: impl FnOnce() + Send) {
    let calls = || {
        CALLS.set(true);
        work();
    };
    std::thread::scope(|scope| scope.spawn(calls).join()).expect("a passed test");
}

/// The tests of this binary share the limit: one test, so that nothing else runs beside.
#[test]
fn every_function_says_that_memory_is_missing_and_has_changed_nothing() {
    // dimension, shape, transfer, order, grid policy, walls, retries, F-bar, threads
    let runs: [Run; 6] = [
        (2, 1, 1, 1, 0, 0, 0, 0, 1),
        (3, 2, 4, 1, 0, 0, 2, 1, 1),
        (2, 4, 5, 0, 1, 0, 0, 1, 1),
        (2, 1, 2, 3, 2, 1, 0, 0, 1),
        (2, 1, 4, 2, 0, 0, 1, 1, 2),
        (3, 1, 1, 1, 0, 0, 0, 0, 3),
    ];
    let mut walked = Walked::new();
    for run in runs {
        alone(|| all_functions(run, &mut walked));
        let before = USED.load(Relaxed);
        alone(|| all_functions(run, &mut Walked::new()));
        let left = USED.load(Relaxed).saturating_sub(before);
        // a pool's queues are freed some time later
        assert!(left == 0 || run.8 > 1, "{run:?}: {left} bytes are left of a run");
    }
    for (name, failures) in &walked {
        println!("{name}: {failures} failures");
    }
    let missing: Vec<_> = ANSWERS.iter().filter(|(name, _)| !walked.contains_key(name)).collect();
    assert!(missing.is_empty(), "not walked: {missing:?}");
}
