//! Failure capsules: written when a step fails at a point, read and run again alone.

use crate::compiler;
use crate::setup::{a_box, fill, read, world, write};
use crate::support::{bad_plugin, in_child, repository, scratch_folder};
use lahar::context::Context;
use lahar::error::{Error, Status};
use lahar::material::{Capsule, Material, Number};
use lahar::world::options::Options;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Arc, Mutex};

fn context_with(plugin: &str) -> Arc<Context> {
    let context = Context::new(Some(1)).unwrap();
    context.load_plugin(&bad_plugin(plugin)).unwrap();
    context
}

/// The error of a step in which the particle with id 7 of a block that is squeezed fails, the third
/// step.
fn fail(context: &Arc<Context>, model: &str) -> Error {
    let material = Material::new(context, model, &[("second", 2.5)]).unwrap();
    let options = Options { dimension: 2, spacing: 0.1, ..Options::default() };
    let mut world = world(context, &options);
    let body = fill(&mut world, &material, &a_box([0.0; 3], [0.5, 0.5, 0.0]), 1e4, [0.0; 3]);
    let n = world.particle_count(body).unwrap();
    let mut memory = vec![0.0; n];
    memory[7] = 3.0;
    write(&mut world, body, "memory", &memory);
    let velocity: Vec<f64> =
        read(&world, body, "position").iter().map(|x| -0.1 * x * x / 3.0).collect();
    write(&mut world, body, "velocity", &velocity);
    for _ in 0..2 {
        world.step(Some(1e-3)).unwrap();
    }
    let error = world.step(Some(1e-3)).unwrap_err();
    assert!(world.is_poisoned() && error.message.contains("particle 7"), "{error}");
    error
}

fn files(folder: &Path) -> Vec<String> {
    let names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
    let mut names: Vec<_> = names.map(|name| name.into_string().unwrap()).collect();
    names.sort();
    names
}

/// A capsule of `nan_model`, and a context with the model.
pub fn nan_capsule() -> (Arc<Context>, PathBuf) {
    let (context, folder) = (context_with("nan_model"), scratch_folder());
    context.set_capsule_folder(Some(&folder)).unwrap();
    fail(&context, "nan_model");
    (context, folder.join("lahar-capsule-nan_model-0-7-2.json"))
}

#[test]
fn a_point_that_fails_in_a_step_fails_again_alone_with_the_same_numbers() {
    for (model, status, point) in
        [("failing_model", Status::MaterialFailed, 3), ("nan_model", Status::NonFinite, 0)]
    {
        let (context, folder) = (context_with(model), scratch_folder());
        context.set_capsule_folder(Some(&folder)).unwrap();
        let error = fail(&context, model);
        assert_eq!(error.status, status);
        let name = format!("lahar-capsule-{model}-0-7-2.json");
        let path = folder.join(&name);
        assert!(error.message.contains(path.to_str().unwrap()), "{error}");
        assert_eq!(files(&folder), std::slice::from_ref(&name));

        // In another context, as in another process.
        let capsule = Capsule::read(&path).unwrap();
        let replay = capsule.replay(&context_with(model)).unwrap();
        assert!(replay.reproduced);
        assert_eq!((replay.end.status, &replay.end), (point, &capsule.end));
        assert_eq!(replay.plugin, [format!("org.lahar.test.{model}"), "1.0".into()]);
        assert_eq!([&capsule.plugin, &capsule.plugin_version], replay.plugin.each_ref());
        assert_eq!(Path::new(&capsule.plugin_path), context.plugins()[0].path);

        // The numbers are those of the step: nothing of the point was at rest.
        assert_eq!((capsule.body, capsule.particle, capsule.step), (0, 7, 2));
        assert_eq!((capsule.time.0, capsule.dt.0), (2e-3, 1e-3));
        assert_eq!(capsule.parameters.get("first"), Some(&Number(1.0)));
        assert_eq!(capsule.parameters.get("second"), Some(&Number(2.5)));
        assert_eq!(capsule.state0.get("memory"), Some(&vec![Number(1.0)]));
        let density = capsule.inputs.get("density").unwrap().0;
        assert!(density > 1e4 && density < 1.01e4, "{density}");
        let strain = capsule.kinematics.get("strain_increment").unwrap();
        for c in [0, 1] {
            let (start, end) = (capsule.stress0[c].0, capsule.end.stress1[c].0);
            assert!(start < -1e-3 && strain[c].0 < 0.0, "{start} {:?}", strain[c]);
            if point == 3 || c == 1 {
                assert_eq!(end, start + 1e5 * strain[c].0, "the model's law");
            }
        }
        let nan = capsule.end.stress1[0].0.is_nan();
        assert_eq!(nan, model == "nan_model");
        assert_eq!(fs::read_to_string(&path).unwrap().contains("\"NaN\""), nan);

        // A second failure of the same name does not touch the first file.
        let before = fs::read_to_string(&path).unwrap();
        let error = fail(&context, model);
        let second = format!("lahar-capsule-{model}-0-7-2-2.json");
        assert!(error.message.contains(&second), "{error}");
        assert_eq!(files(&folder), [second, name]);
        assert_eq!(fs::read_to_string(&path).unwrap(), before);
    }
}

#[test]
fn a_capsule_that_was_changed_is_not_reproduced() {
    let (context, path) = nan_capsule();
    let mut capsule = Capsule::read(&path).unwrap();
    capsule.stress0[3].0 += 1e-9;
    assert!(!capsule.replay(&context).unwrap().reproduced);
    let mut capsule = Capsule::read(&path).unwrap();
    capsule.state0.0[0].1[0].0 = 0.0; // the model counts to one
    let replay = capsule.replay(&context).unwrap();
    assert!(!replay.reproduced && replay.end.stress1[0].0.is_finite());
}

#[test]
fn capsules_keep_every_number() {
    let (_, path) = nan_capsule();
    let mut capsule = Capsule::read(&path).unwrap();
    let values = [
        0.1 + 0.2,
        -0.0,
        5e-324,
        f64::MAX,
        f64::NEG_INFINITY,
        f64::INFINITY,
        f64::NAN,
        1.0 / 3.0,
        2.225_073_858_507_201e-308,
        -123_456.789e-200,
    ];
    capsule.stress0 = values.map(Number).to_vec();
    let copy = Capsule::read(&capsule.write(&scratch_folder()).unwrap()).unwrap();
    assert_eq!(copy, capsule);
}

#[test]
fn capsules_are_written_where_the_host_asked_for_them_and_nowhere_else() {
    let context = context_with("nan_model");
    assert_eq!(context.capsule_folder(), None);
    assert!(!fail(&context, "nan_model").message.contains("kept in"));

    let folder = scratch_folder();
    context.set_capsule_folder(Some(&folder)).unwrap();
    let file = folder.join("file");
    fs::write(&file, "").unwrap();
    for wrong in [folder.join("nowhere"), file.clone()] {
        let error = context.set_capsule_folder(Some(&wrong)).unwrap_err();
        assert_eq!(error.status, Status::File);
        let name = wrong.to_str().unwrap();
        assert!(error.message.contains(name), "{error}");
        assert_eq!(context.capsule_folder(), Some(folder.canonicalize().unwrap()));
    }
    // The folder goes away: the error is that of the model, and the file is in the log.
    fs::remove_dir_all(&folder).unwrap();
    let lines = Arc::new(Mutex::new(String::new()));
    let sink = Arc::clone(&lines);
    context.set_log(Some(Arc::new(move |_, line| sink.lock().unwrap().push_str(line))), 3);
    let error = fail(&context, "nan_model");
    assert_eq!(error.status, Status::NonFinite);
    assert!(!error.message.contains("kept in"), "{error}");
    context.flush_log();
    let log = lines.lock().unwrap().clone();
    assert!(log.contains("lahar-capsule-nan_model-0-7-2.json can not be written"), "{log}");

    context.set_capsule_folder(None).unwrap();
    assert_eq!(context.capsule_folder(), None);
}

#[test]
fn the_environment_gives_the_folder_of_capsules() {
    let name = "capsules::the_environment_gives_the_folder_of_capsules";
    let folder = scratch_folder();
    for value in [folder.to_str().unwrap(), "", "/nowhere/at/all"] {
        if in_child(name, &[("LAHAR_CAPSULES", value)]) {
            let value = PathBuf::from(std::env::var_os("LAHAR_CAPSULES").unwrap());
            match Context::new(Some(1)) {
                Ok(context) if value.as_os_str().is_empty() => {
                    assert_eq!(context.capsule_folder(), None);
                }
                Ok(context) => assert_eq!(context.capsule_folder(), value.canonicalize().ok()),
                Err(error) => {
                    assert_eq!((error.status, value.exists()), (Status::File, false));
                    assert!(error.message.contains("LAHAR_CAPSULES must be a folder"), "{error}");
                }
            }
            return;
        }
    }
}

/// What is spoiled in a good capsule, and what is said then.
const SPOILED: [(&str, &str, Status, &[&str]); 13] = [
    (
        "\"model\": \"nan_model\"",
        "\"model\": \"nan_mode\"",
        Status::UnknownName,
        &["did you mean `nan_model`?"],
    ),
    ("\"second\": 2.5", "\"secund\": 2.5", Status::UnknownName, &["did you mean `second`?"]),
    (
        ",\n    \"second\": 2.5",
        "",
        Status::MissingParameter,
        &["parameter of `nan_model` `second`"],
    ),
    ("\"second\": 2.5", "\"second\": 11", Status::OutOfBounds, &["from 0e0 to 1e1"]),
    ("\"second\": 2.5", "\"first\": 2.5", Status::InvalidArgument, &["`first` is given twice"]),
    (
        "\"second\": 2.5",
        "\"second\": \"none\"",
        Status::InvalidArgument,
        &["NaN, inf and -inf", "line"],
    ),
    ("\"density\":", "\"densitty\":", Status::UnknownName, &["did you mean `density`?"]),
    (
        "\"strain_increment\":",
        "\"velocity_gradient\":",
        Status::UnknownName,
        &["known: strain_increment"],
    ),
    (
        "\"memory\": [\n      1.0",
        "\"memory\": [\n      1.0, 2.0",
        Status::InvalidArgument,
        &["`memory`", "2 components; expected 1"],
    ),
    ("\"body\": 0", "\"bodi\": 0", Status::InvalidArgument, &["missing field `body`"]),
    ("\"body\": 0", "\"body\": 0,\n  \"bodi\": 0", Status::UnknownName, &["did you mean `body`?"]),
    (
        "\"status\": 0",
        "\"status\": 0, \"statu\": 1",
        Status::UnknownName,
        &["did you mean `status`?"],
    ),
    ("\"lahar_capsule\": 1", "\"lahar_capsule\": 2", Status::Unsupported, &["format 2", "reads 1"]),
];

#[test]
fn a_bad_capsule_is_refused_with_its_reason() {
    let (context, path) = nan_capsule();
    let good = fs::read_to_string(&path).unwrap();
    let copy = scratch_folder().join("capsule.json");
    let run = |context: &Context| Capsule::read(&copy).and_then(|c| c.replay(context));
    fs::write(&copy, &good).unwrap();
    let error = run(&Context::new(Some(1)).unwrap()).unwrap_err();
    assert_eq!(error.status, Status::UnknownName);
    for text in ["`nan_model`", "org.lahar.test.nan_model 1.0", "load it first"] {
        assert!(error.message.contains(text), "`{text}` is not in: {error}");
    }
    for (from, to, status, texts) in SPOILED {
        let text = good.replacen(from, to, 1);
        assert!(text != good, "`{from}` is not in the capsule");
        fs::write(&copy, text).unwrap();
        let error = run(&context).unwrap_err();
        assert_eq!(error.status, status, "{from} -> {to}: {error}");
        for text in texts {
            assert!(error.message.contains(text), "`{text}` is not in: {error}");
        }
    }
    for end in [0, 1, good.len() / 2, good.len() - 3] {
        fs::write(&copy, &good[..end]).unwrap();
        let error = run(&context).unwrap_err();
        assert_eq!(error.status, Status::InvalidArgument);
        assert!(error.message.contains("not a whole one"), "{error}");
    }
    fs::remove_file(&copy).unwrap();
    assert_eq!(run(&context).unwrap_err().status, Status::File);
    fs::write(&copy, &good).unwrap();
    assert!(run(&context).unwrap().reproduced);
}

#[test]
fn a_model_that_gives_no_wave_speed_or_no_sane_factor_stops_the_world_with_its_reason() {
    for (name, status, poisoned, texts) in [
        (
            "no_wave_speed",
            Status::MaterialRefused,
            false,
            &["no wave speed for particle", "failed"],
        ),
        ("zero_factor", Status::MaterialFailed, true, &["factor on the time step", "not above 0"]),
    ] {
        let context = Context::new(Some(1)).unwrap();
        context.load_plugin(&bad_plugin(name)).unwrap();
        let material = Material::new(&context, "minimal", &[]).unwrap();
        let mut world =
            world(&context, &Options { dimension: 2, spacing: 0.1, ..Options::default() });
        fill(&mut world, &material, &a_box([0.0; 3], [0.2, 0.2, 0.0]), 1000.0, [0.0; 3]);
        let error = world.step(None).map(|_| ()).unwrap_err();
        assert_eq!((error.status, world.is_poisoned()), (status, poisoned), "{error}");
        for text in texts {
            assert!(error.message.contains(text), "`{text}` is not in: {error}");
        }
        assert_eq!(error.place.body, Some(0));
    }
}

#[test]
fn a_host_in_c_asks_for_capsules() {
    let folder = scratch_folder();
    let mut host = Command::new(compiler::program(&repository("tests/c/capsules.c")));
    compiler::run(host.arg(bad_plugin("failing_model")).arg(&folder));
    assert_eq!(files(&folder), ["lahar-capsule-failing_model-0-7-2.json"]);
    let capsule = Capsule::read(&folder.join("lahar-capsule-failing_model-0-7-2.json")).unwrap();
    assert!(capsule.replay(&context_with("failing_model")).unwrap().reproduced);
}
