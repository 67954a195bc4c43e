//! A body may have as many state variables as the handshake admits.

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use lahar::context::Context;
use lahar::material::Material;
use lahar::world::World;
use lahar::world::options::Options;

use crate::compiler::run;
use crate::setup::{a_box, fill, read, world};
use crate::support::{repository, scratch_folder};

/// Compiles the plugin with so many state variables; the path of the library.
fn plugin(states: usize) -> String {
    let library = scratch_folder().join(format!("libmany_states_{states}.so"));
    let mut command = Command::new("cc");
    command.args(["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-O2"]);
    command.arg(format!("-DSTATES={states}")).args(["-shared", "-fPIC", "-I"]);
    command.args([&repository("include"), &repository("tests/c/many_states.c")]);
    run(command.args([Path::new("-o"), &library]));
    library.to_str().expect("a UTF-8 path").to_string()
}

/// A block of 8000 particles that falls onto a floor it squeezes against.
fn block(threads: usize, library: &str) -> World {
    let context = Context::new(Some(threads)).expect("a context");
    context.load_plugin(library).expect("a plugin");
    let material = Material::new(&context, "many_states", &[]).expect("a material");
    let options = Options { spacing: 0.1, gravity: [0.0, 0.0, -9.81], ..Options::default() };
    let mut world = world(&context, &options);
    let kind = lahar::boundary::WallKind::Sticky;
    let floor = lahar::boundary::Wall { axis: 2, side: 1, position: 0.05, kind, friction: 0.0 };
    world.add_wall(&floor).expect("a wall");
    let region = a_box([0.0, 0.0, 0.05], [1.0, 1.0, 1.05]);
    fill(&mut world, &material, &region, 1000.0, [0.0, 0.0, -1.0]);
    world
}

#[test]
fn a_body_with_300_state_variables_runs_bit_for_bit_on_any_number_of_threads() {
    let library = plugin(300);
    let go = |threads: usize| {
        let mut world = block(threads, &library);
        for _ in 0..10 {
            world.step(None).expect("a step");
        }
        let field = |name: &str| read(&world, 0, name);
        let (first, last) = (field("s0"), field("s299"));
        assert!(first.iter().any(|v| v.abs() > 1e-6), "the block is squeezed");
        for (a, b) in first.iter().zip(&last) {
            assert!((300.0 * a - b).abs() <= 1e-12 * b.abs(), "{a} and {b}");
        }
        let bits: Vec<u64> = [first, last, field("position"), field("stress")]
            .concat()
            .iter()
            .map(|v| v.to_bits())
            .collect();
        bits
    };
    let one = go(1);
    assert!(go(2) == one && go(3) == one, "other threads give other bits");
}

#[test]
fn a_body_may_have_4096_state_variables() {
    let mut world = block(1, &plugin(4096));
    world.step(None).expect("a step");
    let (first, last) = (read(&world, 0, "s0"), read(&world, 0, "s4095"));
    assert!(first.iter().zip(&last).all(|(a, b)| (4096.0 * a - b).abs() <= 1e-12 * b.abs()));
}

/// A variable is copied in and out and looked at: some 40 bytes, a nanosecond of memory. The bound leaves
/// room for a busy machine, and none for a cost that grows with the number of variables.
#[test]
fn state_variables_cost_what_their_columns_cost() {
    let time = |states: usize| {
        let mut world = block(1, &plugin(states));
        let mut least = f64::INFINITY;
        for _ in 0..10 {
            let start = Instant::now();
            world.step(None).expect("a step");
            least = least.min(start.elapsed().as_secs_f64());
        }
        1e9 * least / 8000.0
    };
    let [few, some, many] = [1, 100, 300].map(time);
    println!(
        "{few:.1}, {some:.1}, {many:.1} ns a particle and step with 1, 100, 300 state variables"
    );
    let (below, above) = ((some - few) / 99.0, (many - some) / 200.0);
    println!("{below:.2}, {above:.2} ns a variable");
    assert!(below < 20.0 && above < 20.0, "{below} and {above} ns a variable");
}
