//! UMATs in worlds: built by the command line, loaded like plugins, compared with the plugins of
//! the same laws.

use crate::setup::{a_box, fill, read, world, write};
use crate::support::{in_child, plugin_path, repository, scratch_folder, target_folder};
use lahar::context::Context;
use lahar::error::Status;
use lahar::material::Material;
use lahar::world::World;
use lahar::world::options::Options;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::Arc;

const ELASTIC: &str = r#"{"states": 0, "parameters": [
    {"key": "youngs_modulus", "unit": "Pa", "typical": 1e7, "hard": [1, null], "advised": [1e3, 1e12]},
    {"key": "poissons_ratio", "typical": 0.3, "hard": [-0.99, 0.4999], "advised": [0, 0.49]}]}"#;
const RUDE: &str = r#"{"states": 1, "parameters": [
    {"key": "m", "typical": 1e6}, {"key": "g", "typical": 1e5}, {"key": "rudeness", "default": 0}]}"#;

/// Runs `lahar plugin` with the adapter in reach.
fn lahar(arguments: &[&str]) -> Output {
    let mut command = Command::new(target_folder().join("lahar"));
    command.arg("plugin").args(arguments).env("LAHAR_PLUGIN_PATH", target_folder());
    command.output().expect("the tool runs: build the workspace first")
}

/// The library that the command line makes of a guest of the adapter's tests, with a sidecar.
fn guest(source: &str, sidecar: &str) -> String {
    let source = repository("plugins/umat/tests/fortran").join(source);
    let stem = Path::new(&source).file_stem().expect("a name").to_string_lossy().into_owned();
    let library: PathBuf = scratch_folder().join(format!("lib{stem}.so"));
    let path = library.to_str().expect("UTF-8").to_string();
    let built = lahar(&["umat-build", source.to_str().expect("UTF-8"), "-o", &path]);
    let said = String::from_utf8_lossy(&built.stdout).into_owned();
    assert!(built.status.success(), "{said}{}", String::from_utf8_lossy(&built.stderr));
    assert!(said.contains(&format!("built {path}")) && said.contains("can stand in"), "{said}");
    fs::write(library.with_extension("json"), sidecar).expect("a sidecar");
    path
}

/// A block that spins and stretches, of the model of a plugin.
fn block(dimension: usize, plugin: &str, model: &str, named: &[(&str, f64)]) -> World {
    let context: Arc<Context> = Context::new(Some(2)).unwrap();
    context.load_plugin(plugin).unwrap();
    let material = Material::new(&context, model, named).unwrap();
    let options = Options { dimension, spacing: 0.25, retries: 0, ..Options::default() };
    let mut world = world(&context, &options);
    let far = if dimension == 3 { [2.0; 3] } else { [2.0, 2.0, 0.0] };
    let body = fill(&mut world, &material, &a_box([0.0; 3], far), 1000.0, [0.0; 3]);
    let position = read(&world, body, "position");
    let mut velocity = position.clone();
    for (v, x) in velocity.chunks_mut(dimension).zip(position.chunks(dimension)) {
        let z = if dimension == 3 { x[2] - 1.0 } else { 0.0 };
        v[0] = -3.0 * (x[1] - 1.0) + 0.4 * (x[0] - 1.0);
        v[1] = 3.0 * (x[0] - 1.0) + z;
        if dimension == 3 {
            v[2] = 0.7 * (x[0] - 1.0) - 0.2 * z;
        }
    }
    write(&mut world, body, "velocity", &velocity);
    world
}

#[track_caller]
fn assert_close(a: &World, b: &World, field: &str, tolerance: f64) {
    let (a, b) = (read(a, 0, field), read(b, 0, field));
    let largest = b.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    assert!(largest > 0.0, "{field} is zero");
    for (k, (x, y)) in a.iter().zip(&b).enumerate() {
        assert!((x - y).abs() <= tolerance * largest, "{field} [{k}]: {x} and {y} of {largest}");
    }
}

/// Runs the test in a child process that finds the adapter, with and without checked mode.
fn with_adapter(test: &str) -> bool {
    let folder = target_folder();
    let path = ("LAHAR_PLUGIN_PATH", folder.to_str().expect("UTF-8"));
    in_child(test, &[path]) || in_child(test, &[path, ("LAHAR_CHECK_PLUGINS", "1")])
}

#[test]
fn a_block_of_an_elastic_umat_moves_as_that_of_the_plugin() {
    if !with_adapter("umat::a_block_of_an_elastic_umat_moves_as_that_of_the_plugin") {
        return;
    }
    let named = [("youngs_modulus", 1e6), ("poissons_ratio", 0.3)];
    let plane = ELASTIC.replacen('{', "{\"ntens\": 4, \"threads\": \"copies\", ", 1);
    for (dimension, sidecar) in [(3, ELASTIC), (2, ELASTIC), (2, &plane)] {
        let mut umat = block(dimension, &guest("elastic.f", sidecar), "elastic", &named);
        let mut plugin = block(dimension, &plugin_path("linear_elastic"), "linear_elastic", &named);
        let (dt, expected) = (umat.stable_dt().unwrap(), plugin.stable_dt().unwrap());
        assert!((dt / expected - 1.0).abs() < 1e-9, "{dt} {expected}");
        let steps = 120; // most of a radian
        for _ in 0..steps {
            umat.step(Some(0.5 * expected)).unwrap();
            plugin.step(Some(0.5 * expected)).unwrap();
        }
        // Round-off grows over the steps; a wrong order of shears, factor or turn would show in the
        // first digit.
        for field in ["position", "velocity", "stress"] {
            assert_close(&umat, &plugin, field, 1e-9);
        }
        // The adapter's F - I is that of the volume.
        let h = read(&umat, 0, "displacement_gradient");
        assert!(h.iter().any(|x| x.abs() > 0.1), "nothing has turned");
    }
}

#[test]
fn a_umat_shortens_the_step_by_pnewdt_and_ends_it_by_xit() {
    if !with_adapter("umat::a_umat_shortens_the_step_by_pnewdt_and_ends_it_by_xit") {
        return;
    }
    // Its count of calls is hidden state, which `safe` denies and checked mode finds.
    if std::env::var_os("LAHAR_CHECK_PLUGINS").is_some() {
        let path = guest("rude.f", &RUDE.replacen('{', "{\"threads\": \"safe\", ", 1));
        let mut world = block(2, &path, "rude", &[("m", 1e6), ("g", 1e5)]);
        let error = world.step(None).expect_err("SAVE variables");
        assert_eq!(error.status, Status::PluginBroken, "{error}");
        return;
    }
    let path = guest("rude.f", RUDE);
    let mut world = block(2, &path, "rude", &[("m", 1e6), ("g", 1e5)]);
    let first = world.step(None).unwrap();
    let second = world.step(None).unwrap();
    assert!((0.4..0.51).contains(&(second / first)), "{second} after {first}");

    let mut world = block(2, &path, "rude", &[("m", 1e6), ("g", 1e5), ("rudeness", 1.0)]);
    let error = world.step(Some(1e-5)).expect_err("XIT");
    assert!(matches!(error.status, Status::MaterialFailed), "{error}");
}

#[test]
fn the_tool_checks_umats_like_plugins() {
    let good = guest("elastic.f", ELASTIC);
    let output = lahar(&["check", &good]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success() && !text.contains("FAIL"), "{text}");
    for rule in ["contract", "objectivity", "spin", "memory", "wave_speed", "garbage"] {
        assert!(text.contains(&format!("ok   {rule}: ")), "{rule}: {text}");
    }
    let output = lahar(&["check", &guest("rude.f", RUDE)]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("FAIL memory: ") && text.contains("SAVE"), "{text}");
    let output = lahar(&[
        "check",
        &guest(
            "vumat_von_mises.f",
            r#"{"states": 1, "parameters": [
        {"key": "e", "typical": 2e11}, {"key": "nu", "typical": 0.3, "hard": [-0.9, 0.49]},
        {"key": "y", "typical": 2e8, "hard": [1, null]}, {"key": "h", "default": 0, "hard": [0, null]}]}"#,
        ),
    ]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success() && text.contains("ok   spin: "), "{text}");
}

#[test]
fn umat_build_says_what_the_compiler_says_and_what_to_do() {
    let folder = scratch_folder();
    let source = folder.join("free.f");
    fs::write(&source, "subroutine umat(a)\nend subroutine\n").unwrap();
    let output = lahar(&["umat-build", source.to_str().unwrap()]);
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.starts_with("error: gfortran could not build libfree.so"), "{text}");
    assert!(text.contains("free.f:1") && text.contains("`.f90` is free form"), "{text}");
}

#[test]
fn a_library_without_a_umat_is_refused_by_engine_and_adapter() {
    if !with_adapter("umat::a_library_without_a_umat_is_refused_by_engine_and_adapter") {
        return;
    }
    let folder = scratch_folder();
    let (source, library) = (folder.join("none.c"), folder.join("libnone.so"));
    fs::write(&source, "int nothing;\n").unwrap();
    let mut cc = Command::new("cc");
    cc.args(["-shared", "-fPIC"]).arg(&source).arg("-o").arg(&library);
    assert!(cc.status().unwrap().success());
    let error = Context::new(Some(1)).unwrap().load_plugin(library.to_str().unwrap());
    let error = error.expect_err("neither plugin nor UMAT");
    assert_eq!(error.status, Status::PluginInvalid);
    for part in ["not a lahar plugin", "looked for `umat_`, `umat`, `UMAT`, `vumat_`", "umat-build"]
    {
        assert!(error.message.contains(part), "{error}");
    }
}
