//! Finding and loading plugins, and the handshake with bad ones.

use crate::compiler::{library_folder, program, run};
use crate::plugins::{context, expect, with_plugin};
use crate::support::{
    bad_plugin, in_child, plugin_path, repository, scratch_folder, target_folder,
};
use lahar::error::{Error, Status};
use lahar::material::Material;
use std::fs;
use std::process::Command;
use std::sync::{Arc, Mutex};

fn refusal(path: &str) -> Error {
    let context = context();
    let error = context.load_plugin(path).unwrap_err();
    assert!(context.plugins().is_empty(), "a refused plugin is in the list");
    error
}

#[test]
fn a_loaded_plugin_is_a_line_of_the_log_at_level_information() {
    let lines = Arc::new(Mutex::new(Vec::new()));
    for (most, expected) in [(1, 0), (2, 1)] {
        let context = context();
        let sink = Arc::clone(&lines);
        context.set_log(
            Some(Arc::new(move |l, t| sink.lock().unwrap().push((l, t.to_string())))),
            most,
        );
        let path = plugin_path("newtonian");
        // Found again, it is not told again.
        for _ in 0..2 {
            context.load_plugin(&path).expect("a plugin");
        }
        context.flush_log();
        let lines = std::mem::take(&mut *lines.lock().unwrap());
        assert_eq!(lines.len(), expected, "{lines:?}");
        for (level, text) in lines {
            let parts = ["org.lahar.newtonian ", path.as_str(), ": newtonian, tait_water"];
            assert!(level == 2 && parts.iter().all(|p| text.contains(p)), "{level} {text}");
        }
    }
}

#[test]
fn a_bare_name_is_looked_for_in_the_plugin_path_and_nowhere_else() {
    let folder = target_folder();
    let path = format!(".::{}", folder.display());
    let name = "loading::a_bare_name_is_looked_for_in_the_plugin_path_and_nowhere_else";
    if !in_child(name, &[("LAHAR_PLUGIN_PATH", &path)]) {
        return;
    }
    let context = context();
    context.load_plugin("lahar_linear_elastic").unwrap();
    assert_eq!(context.models()[0].name, "linear_elastic");
    // The current directory is not searched, though `.` and an empty folder are in the variable.
    let here = scratch_folder();
    fs::copy(plugin_path("newtonian"), here.join("liblahar_here.so")).unwrap();
    std::env::set_current_dir(&here).unwrap();
    let result = context.load_plugin("lahar_here");
    expect(
        result,
        Status::PluginNotFound,
        &["lahar_here", "liblahar_here.so", "./liblahar_here.so"],
    );
    context.load_plugin("./liblahar_here.so").unwrap();
    expect(context.load_plugin(""), Status::InvalidArgument, &["empty"]);
}

#[test]
fn a_plugin_path_that_is_unset_or_relative_is_called_that() {
    let name = "loading::a_plugin_path_that_is_unset_or_relative_is_called_that";
    let both = format!("target/release:{}", std::env::temp_dir().display());
    let missing = format!("it is not in {} (LAHAR_PLUGIN_PATH)", std::env::temp_dir().display());
    let none = "LAHAR_PLUGIN_PATH has no absolute folder";
    let relative = "relative folders are not searched: target/release;";
    let program = program(&repository("tests/c/installed.c"));
    let unset = Command::new(&program).env_remove("LAHAR_PLUGIN_PATH").output().expect("it runs");
    let text = String::from_utf8_lossy(&unset.stdout);
    assert!(text.contains(".so: LAHAR_PLUGIN_PATH is not set; nor is it in"), "{text}");
    for (value, texts) in [
        ("", [none, "folder; nor"]),
        ("target/release", [none, relative]),
        (&both, [&missing, relative]),
    ] {
        if in_child(name, &[("LAHAR_PLUGIN_PATH", value)]) {
            if std::env::var("LAHAR_PLUGIN_PATH").as_deref() != Ok(value) {
                continue; // this child is of another value
            }
            let result = context().load_plugin("lahar_linear_elastic");
            return expect(
                result,
                Status::PluginNotFound,
                &[&texts[..], &["absolute path"]].concat(),
            );
        }
    }
}

#[test]
fn a_missing_file_a_folder_and_a_text_have_messages_of_their_own() {
    let missing = refusal("/nowhere/liblahar_x.so");
    assert_eq!(missing.status, Status::PluginNotFound);
    assert!(missing.message.contains("/nowhere/liblahar_x.so"));
    let folder = scratch_folder();
    let directory = refusal(folder.to_str().unwrap());
    assert_eq!(directory.status, Status::PluginInvalid);
    assert!(directory.message.contains("directory"));
    for content in ["not a library", ""] {
        let file = folder.join("text.so");
        fs::write(&file, content).unwrap();
        let text = refusal(file.to_str().unwrap());
        assert_eq!(text.status, Status::PluginInvalid);
        assert!(text.message.contains("not a shared library"));
    }
    // A file that was copied by half: the system's loader would take the process down.
    let whole = fs::read(plugin_path("newtonian")).unwrap();
    let cut = folder.join("cut.so");
    for length in [16, 64, 4096, whole.len() / 2] {
        fs::write(&cut, &whole[..length]).unwrap();
        let error = refusal(cut.to_str().unwrap());
        assert_eq!(error.status, Status::PluginInvalid);
    }
    fs::write(&cut, &whole).unwrap();
    context().load_plugin(cut.to_str().unwrap()).unwrap();
}

#[test]
fn every_bad_plugin_is_refused_with_its_reason() {
    let invalid = Status::PluginInvalid;
    for (name, status, texts) in [
        ("wrong_major", Status::PluginAbi, &["expected major 1", "found major 2"][..]),
        ("wrong_table_major", Status::PluginAbi, &["expected major 1", "found major 2"]),
        ("null_desc", Status::PluginRefused, &["without saying why"]),
        ("refusing", Status::PluginRefused, &["the licence server is asleep"]),
        ("not_a_plugin", invalid, &["not a lahar plugin", "lahar_plugin_entry_v1"]),
        ("missing_symbol", invalid, &["nobody_has_this_function"]),
        ("duplicate_parameters", invalid, &["model `minimal`", "two parameters", "`first`"]),
        ("default_out_of_bounds", invalid, &["parameter `second`", "default 11", "from 0 to 10"]),
        ("nan_bound", invalid, &["parameter `first`", "hard_min", "NaN"]),
        ("no_update", invalid, &["expected the function `update`, got NULL"]),
        ("no_wave_speed_output", invalid, &["LAHAR_OUTPUT_WAVE_SPEED"]),
        ("unknown_output", invalid, &["expected outputs among", "0x10000000001"]),
        ("unknown_input", invalid, &["wants input 12", "density"]),
        ("unknown_kinematics", invalid, &["expected kinematics 0, 1, 2 or 3, got 7"]),
        ("small_table", invalid, &["plugin table", "struct_size", "got 16"]),
        ("small_parameters", invalid, &["expected parameters of at least", "got 8"]),
        ("no_models", invalid, &["at least one model"]),
        ("duplicate_models", invalid, &["two models are named `minimal`"]),
        ("bad_name", invalid, &["expected ASCII letters", "`name`"]),
        ("null_name", invalid, &["expected a text for `name`, got NULL"]),
        ("reserved_state", invalid, &["`stress` has the name of a field", "choose another"]),
        ("newer_output", invalid, &["expected outputs among", "made for a newer lahar"]),
        ("needs_newer", Status::PluginAbi, &["model `minimal`", "minor 7", "speaks 1.0"]),
        ("refuses_old_host", Status::PluginRefused, &["needs an engine of minor 7"]),
        ("undeclared_tangent", invalid, &["LAHAR_CAPABILITY_TANGENT is declared", "not offered"]),
        ("null_extension", invalid, &["`lahar.tangent`, got NULL"]),
        ("wrong_rules", invalid, &["expected 1 rules in `lahar.transfer`, got 2"]),
        ("null_states", invalid, &["expected 1 states, got NULL"]),
    ] {
        let path = bad_plugin(name);
        let error = refusal(&path);
        assert!(error.message.contains(&path), "{error}");
        expect::<()>(Err(error), status, texts);
    }
    // The control: the same file with nothing spoiled is accepted.
    context().load_plugin(&bad_plugin("nothing_wrong")).unwrap();
}

#[test]
fn tables_of_a_later_minor_are_read_as_far_as_they_are_known() {
    let context = with_plugin(&bad_plugin("newer_minor"));
    assert_eq!(context.plugins()[0].abi_minor, 7);
    let keys: Vec<&str> =
        context.model("minimal").unwrap().parameters.iter().map(|p| p.key).collect();
    assert_eq!(keys, ["first", "second"]);
    Material::new(&context, "minimal", &[("second", 2.0)]).unwrap();
}

#[test]
fn a_library_for_another_processor_and_one_that_lacks_symbols_say_so() {
    let mut bytes = fs::read(plugin_path("newtonian")).unwrap();
    bytes[18..20].copy_from_slice(&8_u16.to_le_bytes()); // MIPS
    let foreign = scratch_folder().join("foreign.so");
    fs::write(&foreign, bytes).unwrap();
    let error = refusal(foreign.to_str().unwrap());
    let texts = &["another kind of processor (ELF machine 8, expected", "build it for this one"];
    expect::<()>(Err(error), Status::PluginInvalid, texts);
    let texts = &["undefined symbol: nobody_has_this_function", "link what defines it"];
    let error = refusal(&bad_plugin("missing_symbol"));
    expect::<()>(Err(error), Status::PluginInvalid, texts);
}

#[test]
fn a_library_that_is_no_plugin_is_offered_to_the_adapter() {
    let name = "loading::a_library_that_is_no_plugin_is_offered_to_the_adapter";
    let folder = scratch_folder();
    if !in_child(name, &[("LAHAR_PLUGIN_PATH", folder.to_str().unwrap())]) {
        return;
    }
    let error = refusal(&bad_plugin("not_a_plugin"));
    let texts = &["not a lahar plugin", "if it holds an Abaqus UMAT, put liblahar_umat.so into"];
    expect::<()>(Err(error), Status::PluginInvalid, texts);
}

#[test]
fn the_adapter_itself_is_distinguished_from_what_it_adapts() {
    let texts = &["this is an adapter", "give the library with the UMAT"];
    expect::<()>(Err(refusal(&plugin_path("umat"))), Status::PluginInvalid, texts);
}

#[test]
fn a_model_that_may_print_or_end_the_process_is_reported_when_it_is_loaded() {
    let context = context();
    let lines = Arc::new(Mutex::new(Vec::new()));
    let sink = Arc::clone(&lines);
    context.set_log(Some(Arc::new(move |l, t| sink.lock().unwrap().push((l, t.to_string())))), 3);
    context.load_plugin(&bad_plugin("legacy")).unwrap();
    context.flush_log();
    let lines = lines.lock().unwrap();
    let warned = |text: &str| lines.iter().any(|(l, t)| *l == 1 && t.contains(text));
    assert!(warned("`minimal` may end the process") && warned("`minimal` may print"), "{lines:?}");
}

#[test]
fn plugins_are_found_where_the_library_is_installed() {
    let installed = scratch_folder();
    let plugins = installed.join("lib/lahar/plugins-1");
    fs::create_dir_all(&plugins).unwrap();
    fs::copy(library_folder().join("liblahar.so"), installed.join("lib/liblahar.so")).unwrap();
    fs::copy(plugin_path("newtonian"), plugins.join("liblahar_newtonian.so")).unwrap();
    let program = program(&repository("tests/c/installed.c"));
    // A library that is found through the environment comes before the one that the program was
    // linked with.
    let found = run(Command::new(&program)
        .env_remove("LAHAR_PLUGIN_PATH")
        .env("LD_PRELOAD", installed.join("lib/liblahar.so")));
    assert!(found.trim().ends_with("/lib/lahar/plugins-1/liblahar_newtonian.so"), "{found}");
    let moved = scratch_folder().join("moved");
    fs::rename(&installed, &moved).unwrap();
    let found = run(Command::new(&program)
        .env_remove("LAHAR_PLUGIN_PATH")
        .env("LD_PRELOAD", moved.join("lib/liblahar.so")));
    assert!(found.contains("/moved/lib/lahar/plugins-1/"), "{found}");
}

#[test]
fn the_same_file_is_loaded_once() {
    let (a, b) = (context(), context());
    let path = plugin_path("linear_elastic");
    assert_eq!(a.load_plugin(&path).unwrap(), 0);
    assert_eq!(a.load_plugin(&plugin_path("newtonian")).unwrap(), 1);
    assert_eq!(a.load_plugin(&path).unwrap(), 0);
    let link = scratch_folder().join("another_name.so");
    std::os::unix::fs::symlink(&path, &link).unwrap();
    assert_eq!(a.load_plugin(link.to_str().unwrap()).unwrap(), 0);
    assert_eq!(a.plugins().len(), 2);
    b.load_plugin(&path).unwrap();
    assert!(std::ptr::eq(a.plugins()[0], b.plugins()[0]));
    assert_eq!(b.plugins().len(), 1);
}
