//! A stress that the host gives to particles is there after a step of a body that does not move, or
//! is refused with what to do: by every model, whichever way it was given.

use std::sync::{Arc, Mutex};

use lahar::boundary::{BoxRegion, PrescribedVelocity, Table};
use lahar::context::Context;
use lahar::error::{Result, Status};
use lahar::material::{Input, Kinematics, Material, Model};
use lahar::particles::seeding::Fill;
use lahar::world::World;
use lahar::world::options::Options;

use lahar_plugin_abi::LAHAR_OUTPUT_DIFFUSIVITY;

use crate::setup::{a_box, context_of, read, world, write};
use crate::support::shipped;

const PRESSURE: [f64; 6] = [-2e4, -2e4, -2e4, 0.0, 0.0, 0.0];
/// Inside every yield surface of the typical values, that of mud too; and the k0 of level ground
/// that is.
const SHEARED: [f64; 6] = [-2e4, -2.002e4, -1.999e4, 10.0, 0.0, 0.0];
const K0: f64 = 0.999;

/// A block whose nodes are held, of a material with typical values.
fn block(context: &Arc<Context>, model: &Model, stress: [f64; 6]) -> Result<World> {
    let required = model.parameters.iter().filter(|p| p.required);
    let values: Vec<_> = required.map(|p| (p.key, p.default)).collect();
    let material = Material::new(context, model.name, &values)?;
    let gravity = [0.0, -10.0, 0.0];
    let mut world =
        world(context, &Options { dimension: 2, spacing: 0.1, gravity, ..Options::default() });
    let density = if model.input(Input::InternalEnergy).is_some() { 1.2 } else { 2000.0 };
    let fill = Fill { density, stress, ..Fill::default() };
    world.add_shape(&material, &a_box([0.0; 3], [0.3, 1.0, 0.0]), &fill)?;
    let everywhere = BoxRegion { min: [f64::NEG_INFINITY; 3], max: [f64::INFINITY; 3] };
    let velocity = Table::constant([0.0; 3]);
    world.add_prescribed_velocity(PrescribedVelocity {
        region: everywhere,
        components: 3,
        velocity,
    })?;
    Ok(world)
}

fn write_stress(world: &mut World, stress: [f64; 6]) {
    let n = world.particle_count(0).expect("a body");
    write(world, 0, "stress", &stress.repeat(n));
}

/// A step; the largest change of the stresses that there were before, over the largest of them.
fn change(world: &mut World) -> Result<f64> {
    let before = read(world, 0, "stress");
    world.step(Some(1e-7))?;
    let after = read(world, 0, "stress");
    let largest =
        |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |m: f64, v| m.max(v.abs()));
    let most = largest(&mut before.iter().zip(&after).map(|(a, b)| a - b));
    Ok(most / largest(&mut before.iter().copied()))
}

type Way = (&'static str, fn(&Arc<Context>, &Model, [f64; 6]) -> Result<World>);

/// The ways to give a stress; for level ground the pressure only tells what k0 is.
const WAYS: [Way; 4] = [
    ("at add", |context, model, stress| block(context, model, stress)),
    ("by a write", |context, model, stress| {
        let mut world = block(context, model, [0.0; 6])?;
        write_stress(&mut world, stress);
        Ok(world)
    }),
    ("by init_state", |context, model, stress| {
        let mut world = block(context, model, [0.0; 6])?;
        write_stress(&mut world, stress);
        world.init_body_state(0)?;
        Ok(world)
    }),
    ("by set_k0_stress", |context, model, stress| {
        let mut world = block(context, model, [0.0; 6])?;
        world.set_k0_stress(0, 1.0, None, if stress == PRESSURE { 1.0 } else { K0 })?;
        Ok(world)
    }),
];

#[test]
fn a_given_stress_is_kept_or_refused_by_every_model_and_on_every_way() {
    for name in shipped() {
        let context = context_of(&name);
        for model in context.models() {
            let follows = model.kinematics == Kinematics::DeformationGradient
                || model.input(Input::InternalEnergy).is_some();
            let fluid = model.states.iter().any(|s| s.key == "volume_ratio");
            let viscous = model.gives(LAHAR_OUTPUT_DIFFUSIVITY);
            for (stress, what) in [(PRESSURE, "a pressure"), (SHEARED, "shear")] {
                for (way, give) in WAYS {
                    let result =
                        give(&context, model, stress).and_then(|mut world| change(&mut world));
                    println!(
                        "{}: {what} {way}: {:?}",
                        model.name,
                        result.as_ref().map_err(|e| &e.message)
                    );
                    let kept = match result {
                        Ok(changed) => {
                            assert!(
                                changed < 1e-6,
                                "{}: {what} {way} changes by {changed}",
                                model.name
                            );
                            true
                        }
                        Err(error) => {
                            let known = [Status::MaterialRefused, Status::Unsupported];
                            assert!(
                                known.contains(&error.status),
                                "{}: {}",
                                model.name,
                                error.message
                            );
                            let advice = [
                                "write `deformation_gradient`",
                                "write `strain_energy`",
                                "call lahar_body_init_state",
                                "settle instead",
                            ];
                            assert!(
                                advice.iter().any(|a| error.message.contains(a)),
                                "{}",
                                error.message
                            );
                            false
                        }
                    };
                    // A fluid derives its state from the pressure, but in a plain write, and
                    // without a yield stress bears no shear.
                    let lost = way == "by a write" || viscous && stress == SHEARED;
                    let possible = !(follows || fluid && lost);
                    assert_eq!(kept, possible, "{}: {what} {way}", model.name);
                }
            }
        }
    }
}

fn each<const N: usize>(world: &mut World, field: &str, value: [f64; N]) {
    let n = world.particle_count(0).expect("a body");
    write(world, 0, field, &value.repeat(n));
}

#[test]
fn a_stress_that_follows_from_what_the_host_gives_with_it_is_kept() {
    for (plugin, energy) in
        [("neo_hookean", None), ("hencky", None), ("ideal_gas", Some(2e4 / 0.4))]
    {
        let context = context_of(plugin);
        let model = context.models()[0];
        let prepared = |part: f64| {
            let mut world = block(&context, model, [0.0; 6]).expect("a block");
            match energy {
                Some(energy) => {
                    let volume = read(&world, 0, "volume");
                    let energies: Vec<f64> = volume.iter().map(|v| part * energy * v).collect();
                    write(&mut world, 0, "strain_energy", &energies);
                }
                None => {
                    let stretch = 1.0 - 1e-3 * part;
                    let f = [stretch, 0.0, 0.0, 2e-3 * part, 1.0, 0.0, 0.0, 0.0, 1.0];
                    each(&mut world, "deformation_gradient", f);
                }
            }
            world
        };
        // What the model makes of it, given with it to another body.
        let mut first = prepared(1.0);
        first.step(Some(1e-7)).expect("a step");
        let stress: [f64; 6] = std::array::from_fn(|c| read(&first, 0, "stress")[c]);
        assert!(stress[0] < -1e3, "{stress:?}");
        let mut second = prepared(1.0);
        write_stress(&mut second, stress);
        let changed = change(&mut second).expect("a step");
        assert!(changed < 1e-6, "{plugin}: {changed}");
        // Negative control: what belongs to a stress that is a thousandth larger.
        let mut other = prepared(1.001);
        write_stress(&mut other, stress);
        let refused = change(&mut other).expect_err("another stress");
        assert_eq!(refused.status, Status::MaterialRefused);
        // Nothing was done: the host may give the right one, and go on.
        assert_eq!(other.step_count(), 0);
        each(&mut other, "stress", stress.map(|s| 1.001 * s));
        if energy.is_some() {
            assert!(change(&mut other).expect("a step") < 1e-6);
        }
    }
}

#[test]
fn a_stress_beyond_the_yield_surface_is_told_and_returned() {
    let context = context_of("drucker_prager");
    let lines = Arc::new(Mutex::new(Vec::new()));
    let sink = Arc::clone(&lines);
    context.set_log(Some(Arc::new(move |l, t| sink.lock().unwrap().push((l, t.to_string())))), 1);
    let model = context.models()[0];
    for (stress, told) in [
        (SHEARED, false),
        ([-2e4, -2e5, -2e4, 0.0, 0.0, 0.0], true),
        ([5e4, 5e4, 5e4, 1e3, 0.0, 0.0], true),
    ] {
        let mut world = block(&context, model, stress).expect("a block");
        let changed = change(&mut world).expect("a step");
        context.flush_log();
        let lines = std::mem::take(&mut *lines.lock().unwrap());
        assert_eq!(changed > 1e-6, told, "{changed}");
        assert_eq!(lines.len(), usize::from(told), "{lines:?}");
        assert!(!told || lines[0].1.contains("`drucker_prager` cannot bear"), "{lines:?}");
    }
}

#[test]
fn a_viscous_stress_of_a_moving_fluid_may_be_given() {
    // As when a host puts a run together again from the fields that it saved.
    let context = context_of("newtonian");
    let model = context.model("newtonian").expect("a model");
    let mut world = block(&context, model, SHEARED).expect("a block");
    let refused = change(&mut world).expect_err("shear at rest");
    assert_eq!(refused.status, Status::MaterialRefused);
    let n = world.particle_count(0).expect("a body");
    let speeds: Vec<f64> = (0..2 * n).map(|i| 1e-3 * i as f64).collect();
    write(&mut world, 0, "velocity", &speeds);
    change(&mut world).expect("a step");
}
