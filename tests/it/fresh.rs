//! What the grid shows is what the particles and loads are, whatever a host changed and asked
//! before.

use std::process::Command;

use lahar::boundary::{BoxRegion, Table, Traction};
use lahar::world::World;
use lahar::world::options::Options;

use crate::compiler::{program, run};
use crate::setup::{a_box, context, elastic, fill, world, write};
use crate::support::{repository, target_folder};

#[test]
fn equilibrium_sees_every_change_from_c() {
    let mut host = Command::new(program(&repository("tests/c/equilibrium.c")));
    run(host.env("LAHAR_PLUGIN_PATH", target_folder()));
}

/// A plane block of 1 m x 1 m and 2000 kg, under a load on its top that grows from 0 to 1 kPa in 1
/// s.
fn loaded_block() -> (World, i64) {
    let context = context(1);
    let material = elastic(&context, 1e6, 0.3);
    let options = Options { dimension: 2, spacing: 0.25, ..Options::default() };
    let mut world = world(&context, &options);
    let body = fill(&mut world, &material, &a_box([0.0; 3], [1.0; 3]), 2000.0, [0.0; 3]);
    let region = BoxRegion { min: [0.0, 0.9, 0.0], max: [1.0; 3] };
    let traction = Table::new("a load", &[0.0, 1.0], &[[0.0; 3], [0.0, -1e3, 0.0]]).expect("rows");
    let load = Traction { body, region, axis: 1, side: 1, traction };
    world.add_traction(load).expect("a surface");
    (world, body)
}

#[test]
fn a_question_does_not_change_what_the_last_step_reports() {
    let (mut world, body) = loaded_block();
    for _ in 0..10 {
        world.step(None).expect("a step");
    }
    let middle = world.time() - 0.5 * world.last_dt();
    let force = world.traction_force(0).expect("a load").2;
    assert!((force[1] / (-1e3 * middle) - 1.0).abs() < 1e-12, "{force:?}");
    let asked = world.equilibrium().expect("forces");
    assert!((asked.external_force / force[1].abs() - 1.0).abs() < 1e-12, "{asked:?}");
    // what is mapped anew holds the load of now
    write(&mut world, body, "velocity", &vec![0.0; 2 * 64]);
    let asked = world.equilibrium().expect("forces");
    assert!((asked.external_force / (1e3 * world.time()) - 1.0).abs() < 1e-12, "{asked:?}");
    assert_eq!(world.traction_force(0).expect("a load").2, force);
}

#[test]
fn a_world_whose_particles_stay_in_their_blocks_may_be_asked_between_its_steps() {
    let go = |ask: bool| {
        let (mut world, body) = loaded_block();
        for n in 0..40 {
            if ask {
                world.equilibrium().expect("forces");
            }
            if n == 20 {
                write(&mut world, body, "stress", &vec![-10.0; 6 * 64]);
            }
            if ask {
                world.equilibrium().expect("forces");
            }
            world.step(None).expect("a step");
        }
        let totals = world.totals(None).expect("totals");
        [totals.kinetic_energy, totals.strain_energy, totals.momentum[1]].map(f64::to_bits)
    };
    assert_eq!(go(true), go(false));
}
