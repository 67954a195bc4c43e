//! Checked mode, `LAHAR_CHECK_PLUGINS=1`, in child processes: the variable is read once.

use crate::setup::{a_box, context, fill, read, world};
use crate::support::{bad_plugin, in_child};
use lahar::boundary::{Wall, WallKind};
use lahar::context::Context;
use lahar::error::{Error, Status};
use lahar::material::scratch::{Scratch, with_scratch};
use lahar::material::{Kinematics, Material, Model};
use lahar::memory::Aligned;
use lahar::world::options::Options;
use std::collections::hash_map::DefaultHasher;
use std::hash::Hasher;
use std::sync::Arc;
use std::thread;

const ON: (&str, &str) = ("LAHAR_CHECK_PLUGINS", "1");

fn minimal(plugin: &str) -> (Arc<Context>, Arc<Material>) {
    let context = Context::new(Some(1)).unwrap();
    context.load_plugin(&bad_plugin(plugin)).unwrap();
    let material = Material::new(&context, "minimal", &[]).unwrap();
    (context, material)
}

/// A start that no two points share.
fn start(s: &mut Scratch<'_>) {
    for (i, strain) in s.strain_increment.iter_mut().enumerate() {
        *strain = 1e-5 * (i as f64).sin();
    }
    s.velocity_gradient.fill(0.0);
    s.stress0.fill(-1.0);
    s.state0.fill(1.0);
    s.inputs.fill(1000.0);
    s.deformation_gradient.fill(0.0);
    for first in [0, 4, 8].map(|c| c * s.stride) {
        for (k, f) in s.deformation_gradient.iter_mut().skip(first).take(s.n).enumerate() {
            *f = 1.0 + 1e-3 * k as f64;
        }
    }
}

fn update(plugin: &str) -> Result<(), Error> {
    let (_context, material) = minimal(plugin);
    with_scratch(&material, 5, |s| {
        start(s);
        material.update(&mut s.batch())
    })
}

#[test]
fn checked_mode_tells_how_a_plugin_breaks_its_contract_and_other_runs_do_not_notice() {
    let cases: [(&str, &[&str]); 12] = [
        (
            "writes_start_state",
            &[
                "writes its start state",
                "state0 `memory` of point 2 of 5 was 1.0 and is 2.0",
                "results go to",
            ],
        ),
        ("writes_input", &["writes its input", "strain_increment xy of point 0 of 5"]),
        ("writes_past_n", &["writes past its points", "wave_speed[5], where n is 5"]),
        (
            "unwritten_output",
            &["leaves unwritten stress1 zx of point 0 of 5", "write every component"],
        ),
        (
            "adds_to_output",
            &["computes from what it has not written", "state1 `memory` of point 0"],
        ),
        (
            "hidden_state",
            &["stress1 xx of point 0 of 5", "called again with equal input", "keep nothing"],
        ),
        (
            "not_pointwise",
            &["state1 `memory` of point 0 of 5", "in a batch of its own", "_POINTWISE"],
        ),
        ("order_matters", &["state1 `memory`", "in reversed order", "_POINTWISE"]),
        ("changes_rounding", &["floating-point environment", "the rounding", "put it back"]),
        ("bad_status", &["status of point 4 of 5 is 17", "0 to 3"]),
        ("bad_dt_factor", &["dt_factor of point 0 of 5 is 0.0", "above 0 and at most 1"]),
        ("negative_wave_speed", &["wave_speed of point 1 of 5 is -10.0", "not negative"]),
    ];
    let name =
        "checked::checked_mode_tells_how_a_plugin_breaks_its_contract_and_other_runs_do_not_notice";
    if !in_child(name, &[ON]) {
        // Threads of their own: one of the plugins changes the rounding.
        for (plugin, _) in cases {
            thread::spawn(move || update(plugin).unwrap()).join().unwrap();
        }
        return;
    }
    update("nothing_wrong").unwrap();
    for (plugin, texts) in cases {
        let error = update(plugin).unwrap_err();
        println!("{plugin}: {error}");
        assert_eq!(error.status, Status::PluginBroken);
        let always = ["org.lahar.test.minimal", "`minimal`", "`update`", "LAHAR_CHECK_PLUGINS"];
        for text in texts.iter().chain(&always) {
            assert!(error.message.contains(text), "`{text}` is not in: {error}");
        }
    }
}

#[test]
fn a_failure_stays_what_it_is_in_checked_mode() {
    if !in_child("checked::a_failure_stays_what_it_is_in_checked_mode", &[ON]) {
        return;
    }
    let error = update("failing_update").unwrap_err();
    assert_eq!(error.status, Status::MaterialFailed);
    assert!(error.message.contains("the clay is not in the mood"), "{error}");
}

#[test]
fn a_contract_broken_in_a_step_poisons_the_world() {
    let name = "checked::a_contract_broken_in_a_step_poisons_the_world";
    if !in_child(name, &[ON]) {
        return;
    }
    let (context, material) = minimal("writes_start_state");
    let mut world = world(&context, &Options { spacing: 0.1, ..Options::default() });
    let body = fill(&mut world, &material, &a_box([0.0; 3], [0.4; 3]), 1000.0, [0.0; 3]);
    let error = world.step(Some(1e-4)).unwrap_err();
    assert_eq!(error.status, Status::PluginBroken, "{error}");
    assert_eq!((error.place.body, error.place.step), (Some(body), Some(0)));
    assert!(world.is_poisoned());
    assert_eq!(world.step(Some(1e-4)).unwrap_err().status, Status::Poisoned);
}

/// A model with typical values.
fn typical(context: &Context, model: &Model) -> Arc<Material> {
    let required = model.parameters.iter().filter(|p| p.required);
    let values: Vec<_> = required.map(|p| (p.key, p.default)).collect();
    Material::new(context, model.name, &values).unwrap()
}

/// A digest of all fields of a column of each shipped model after some steps, and of what the
/// extensions give.
fn digest() -> String {
    let context = context(1);
    let mut hash = DefaultHasher::new();
    for model in context.models() {
        let material = typical(&context, model);
        let options = Options {
            dimension: 2,
            spacing: 0.1,
            gravity: [0.0, -9.81, 0.0],
            ..Options::default()
        };
        let mut world = world(&context, &options);
        let kind = WallKind::Sticky;
        world.add_wall(&Wall { axis: 1, side: 1, position: 0.0, kind, friction: 0.0 }).unwrap();
        let column = a_box([0.0; 3], [0.4, 0.9, 1.0]);
        let body = fill(&mut world, &material, &column, 1000.0, [1.0, -2.0, 0.0]);
        for _ in 0..20 {
            world.step(None).unwrap_or_else(|error| panic!("{}: {error}", model.name));
        }
        for info in world.fields(body).unwrap() {
            let values = read(&world, body, info.name.to_str().unwrap());
            values.iter().for_each(|value| hash.write_u64(value.to_bits()));
        }
        let mut own = Aligned::zeroed(36 * 40).unwrap();
        with_scratch(&material, 37, |s| {
            start(s);
            let own = own.as_mut_slice();
            if let Some(result) = material.tangent(&mut s.batch(), own) {
                result.unwrap();
            }
            own.iter().for_each(|value| hash.write_u64(value.to_bits()));
            if let Some(result) = material.stored_energy(&mut s.batch(), own) {
                result.unwrap();
            }
            own.iter().for_each(|value| hash.write_u64(value.to_bits()));
            Ok(())
        })
        .unwrap();
        assert_ne!(model.kinematics, Kinematics::VelocityGradient, "fill its gradients");
    }
    hash.finish().to_string()
}

#[test]
fn shipped_models_keep_their_contract_and_give_the_same_bits_in_checked_mode() {
    let name = "checked::shipped_models_keep_their_contract_and_give_the_same_bits_in_checked_mode";
    let digest = digest();
    if in_child(name, &[ON, ("LAHAR_TEST_DIGEST", &digest)]) {
        assert_eq!(std::env::var("LAHAR_TEST_DIGEST").unwrap(), digest);
    }
}

#[test]
fn the_variable_of_checked_mode_is_0_or_1() {
    for value in ["", "yes", "2", "0"] {
        if in_child("checked::the_variable_of_checked_mode_is_0_or_1", &[(ON.0, value)]) {
            let result = Context::new(Some(1)).map(|_| ());
            if std::env::var(ON.0).unwrap() == "0" {
                return result.unwrap();
            }
            let error = result.unwrap_err();
            assert_eq!(error.status, Status::InvalidArgument);
            assert!(error.message.contains("LAHAR_CHECK_PLUGINS must be 1"), "{error}");
            return;
        }
    }
}
