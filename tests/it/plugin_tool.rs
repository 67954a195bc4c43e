//! `lahar plugin`: every shipped plugin follows the rules, every bad one is caught by the right
//! rule with the right sentence, and the tool outlives them all.

use crate::capsules::nan_capsule;
use crate::support::{bad_plugin, plugin_path, repository, scratch_folder, shipped, target_folder};
use std::fs;
use std::process::{Command, Output};

/// Runs `lahar plugin` with these arguments.
fn lahar(arguments: &[&str]) -> Output {
    let program = target_folder().join("lahar");
    assert!(
        program.is_file(),
        "{} is missing: build the workspace first (cargo build --release --workspace), as `cargo xtask test` does",
        program.display()
    );
    let mut command = Command::new(program);
    command.arg("plugin").args(arguments).env_remove("LAHAR_PLUGIN_PATH");
    command.output().expect("the tool runs")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

/// Standard output of a call that ends with this exit status.
#[track_caller]
fn output(arguments: &[&str], status: i32) -> String {
    let output = lahar(arguments);
    let (out, err) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(status), "{arguments:?}:\n{out}{err}");
    out
}

/// A call that cannot do what it was asked for, and says why in one line.
#[track_caller]
fn refused(arguments: &[&str], texts: &[&str]) {
    let output = lahar(arguments);
    let err = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}{err}", text(&output.stdout));
    for part in texts {
        assert!(err.contains(part), "{arguments:?}: `{part}` is not in: {err}");
    }
    assert!(err.starts_with("error: ") && err.lines().count() == 1, "{err}");
}

#[test]
fn every_shipped_plugin_keeps_the_rules() {
    std::thread::scope(|scope| {
        for name in shipped() {
            scope.spawn(move || {
                let text = output(&["check", &plugin_path(&name)], 0);
                assert!(!text.contains("FAIL"), "{text}");
                for rule in ["loads", "loading", "objectivity", "wave_speed", "garbage", "prints"] {
                    let lines = text.lines().filter(|l| l.starts_with(&format!("ok   {rule}: ")));
                    assert!(lines.count() >= 1, "{name}: the rule {rule} was not run:\n{text}");
                }
            });
        }
    });
}

/// Bad plugins: the rule that catches each, and what its sentence says.
const ZOO: [(&str, &str, &[&str]); 25] = [
    ("wrong_major", "loads", &["expected major 1", "found major 2"]),
    ("no_update", "loads", &["expected the function `update`, got NULL"]),
    ("duplicate_models", "loads", &["two models are named `minimal`"]),
    ("default_out_of_bounds", "loads", &["parameter `second`", "default 11", "from 0 to 10"]),
    ("missing_symbol", "loads", &["nobody_has_this_function"]),
    ("dies_on_load", "loads", &["signal 11 (segmentation fault", "loading the library"]),
    ("leaks", "instances", &["every instance leaves about", "`destroy` must free"]),
    ("failing_update", "starts", &["none of the starts", "the clay is not in the mood"]),
    ("exits", "starts", &["ended the process with exit status 3 in update", "LAHAR_POINT_FAILED"]),
    ("segfaults", "starts", &["signal 11 (segmentation fault", "in update"]),
    ("traps", "starts", &["signal 8 (floating-point exception", "traps"]),
    ("hangs", "starts", &["update did not return within 2 s", "killed"]),
    ("aborts", "loading", &["signal 6 (abort", "in update"]),
    ("returns_nan", "loading", &["NaN", "does not say that it failed"]),
    ("creeps", "zero_increment", &["a step without strain changes the stress by 1e-3 Pa"]),
    ("forgets_stress", "zero_increment", &["a step without strain changes the stress"]),
    ("not_objective", "objectivity", &["in a turned frame the stress is"]),
    ("no_rotation", "spin", &["after a rigid spin by 0.01 rad", "must turn the stress itself"]),
    ("static_parameters", "memory", &["after another instance with other parameters", "SAVE"]),
    ("claims_threads", "threads", &["another thread", "LAHAR_CAPABILITY_THREAD_SAFE"]),
    ("wrong_tangent", "tangent", &["d stress xy / d strain xy = 5e4 Pa", "e5 Pa"]),
    ("slow_waves", "wave_speed", &["is 7.000000e0 m/s", "1.000000e1 m/s", "43 %"]),
    ("wrong_energy", "stored_energy", &["on an elastic path the stress does the work"]),
    ("mute", "bounds", &["without saying why", "set_error"]),
    ("passes_garbage", "garbage", &["NaN in component 0 of the strain increment", "status 0"]),
];

#[test]
fn every_bad_plugin_is_caught_by_its_rule() {
    for few in ZOO.chunks(4) {
        std::thread::scope(|scope| {
            for (name, rule, texts) in few {
                scope.spawn(move || catch(name, rule, texts));
            }
        });
    }
    catch("leaves_files_open", "files", &["3 files are open that were not before"]);
    catch("prints", "prints", &["the library prints", "first `stress update of 1 points`"]);
}

/// A bad plugin fails its rule with these texts, with the input where there was one, and the rules
/// before hold.
fn catch(name: &str, rule: &str, texts: &[&str]) {
    let limit = if name == "hangs" { "2" } else { "60" };
    let text = output(&["check", &bad_plugin(name), "--time-limit", limit], 1);
    let lines: Vec<&str> = text.lines().collect();
    let first = lines.iter().position(|l| l.starts_with("FAIL")).expect("a line that fails");
    let line = lines[first];
    assert!(line.starts_with(&format!("FAIL {rule}: ")), "{name}: not caught by {rule}:\n{text}");
    for part in texts {
        assert!(line.contains(part), "{name}: `{part}` is not in: {line}");
    }
    let needs_input =
        ["contract", "loading", "objectivity", "spin", "memory", "tangent", "garbage"];
    if needs_input.contains(&rule) {
        let input = lines.get(first + 1).copied().unwrap_or_default();
        let known = ["dt = ", "stress = [", "density = "].iter().all(|part| input.contains(part));
        assert!(input.starts_with("     input: ") && known, "{name}: no input: {input}");
    }
}

#[test]
fn what_checked_mode_finds_is_a_broken_contract() {
    let all = [
        ("adds_to_output", "computes from what it has not written: state1 `memory`"),
        ("bad_dt_factor", "dt_factor of point 0 of 1 is 0.0"),
        ("changes_rounding", "changed the floating-point environment (the rounding)"),
        ("leaves_traps_on", "changed the floating-point environment"),
        ("hidden_state", "when called again with equal input"),
        ("not_pointwise", "in a batch of its own"),
        ("order_matters", "with the points in reversed order"),
        ("unwritten_output", "leaves unwritten stress1 zx"),
        ("negative_wave_speed", "wave_speed of point 1 of 2 is -10.0"),
        ("writes_input", "writes its input: strain_increment"),
        ("writes_past_n", "writes past its points: wave_speed[1]"),
        ("writes_start_state", "writes its start state: state0 `memory`"),
    ];
    for few in all.chunks(4) {
        std::thread::scope(|scope| {
            for (name, part) in few {
                scope.spawn(move || catch(name, "contract", &[part, "LAHAR_CHECK_PLUGINS"]));
            }
        });
    }
}

#[test]
fn the_control_of_the_bad_plugins_keeps_the_rules() {
    let text = output(&["check", &bad_plugin("nothing_wrong")], 0);
    assert!(text.contains("ok   memory: ") && text.contains("-    tangent: not offered"), "{text}");
    // It does not declare that it is thread-safe, and is called one at a time.
    let text = output(&["check", &bad_plugin("not_thread_safe")], 0);
    assert!(text.contains("-    threads: not thread-safe"), "{text}");
}

#[test]
fn after_a_crash_the_other_rules_are_run() {
    let text = output(&["check", &bad_plugin("aborts")], 1);
    for line in ["FAIL loading: ", "ok   small_steps: ", "ok   objectivity: ", "FAIL memory: "] {
        assert!(text.lines().any(|l| l.starts_with(line)), "no `{line}` in:\n{text}");
    }
    assert!(text.contains("-    threads: not run, since the process has died too often"), "{text}");
}

#[test]
fn a_check_as_json_has_a_line_for_each_rule() {
    let text = output(&["check", &bad_plugin("slow_waves"), "--json"], 1);
    let lines: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let lines = lines.as_array().expect("a list");
    let result = |rule: &str| lines.iter().find(|l| l["rule"] == rule).expect("a rule");
    assert_eq!(result("loads")["result"], "ok");
    assert_eq!(result("tangent")["result"], "skip");
    let failed = result("wave_speed");
    assert_eq!((&failed["result"], &failed["model"]), (&"fail".into(), &"minimal".into()));
    assert!(failed["input"].as_str().expect("an input").contains("strain increment = ["));
    assert_eq!(lines.iter().filter(|l| l["result"] == "fail").count(), 1);
}

#[test]
fn info_prints_what_the_tables_say() {
    let path = plugin_path("drucker_prager");
    let text = output(&["info", &path], 0);
    for part in [
        concat!("plugin   org.lahar.drucker_prager ", env!("CARGO_PKG_VERSION"), "\n"),
        "ABI      1.0\n",
        "author   The lahar developers\n",
        "licence  MIT OR Apache-2.0\n",
        &format!("file     {path}\n"),
        "model drucker_prager: ",
        "doi:10.1090/qam/48291",
        "  kinematics    strain increment\n",
        "  inputs        density\n",
        "  capabilities  thread_safe, pointwise, deterministic",
        "compression | extension | plane_strain",
        "required, typically 1e7",
        "equivalent_plastic_strain",
    ] {
        assert!(text.contains(part), "`{part}` is not in:\n{text}");
    }
    let row = text.lines().find(|l| l.contains("poissons_ratio")).expect("a row");
    assert!(row.contains("nu") && row.contains("-0.999 to 0.4999") && row.contains("0 to 0.495"));
}

#[test]
fn info_as_json_has_every_entry_of_the_tables() {
    let text = output(&["info", &bad_plugin("wrong_energy"), "--json"], 0);
    let plugin: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(plugin["id"], "org.lahar.test.minimal");
    assert_eq!((&plugin["abi_major"], &plugin["abi_minor"]), (&1.into(), &0.into()));
    let model = &plugin["models"][0];
    assert_eq!(model["name"], "minimal");
    assert_eq!(model["extensions"], serde_json::json!(["lahar.energy"]));
    assert_eq!(model["capabilities"], serde_json::json!(["thread_safe"]));
    assert_eq!(model["outputs"], serde_json::json!(["wave_speed"]));
    assert_eq!(model["inputs"], serde_json::json!(["density"]));
    let parameter = &model["parameters"][1];
    let expected = serde_json::json!({
        "key": "second", "symbol": "second", "unit": "-", "kind": "real", "required": false, "default": 1.0,
        "hard_min": 0.0, "hard_max": 10.0, "advised_min": null, "advised_max": 5.0, "choices": [],
        "description": "A number."
    });
    assert_eq!(*parameter, expected);
    let expected = serde_json::json!({
        "key": "memory", "unit": "-", "kind": "scalar", "rotation": "none", "transfer": "mean", "initial": 0.0,
        "description": "A number."
    });
    assert_eq!(model["states"][0], expected);
}

#[test]
fn bench_times_batches_of_three_sizes() {
    let text = output(&["bench", &plugin_path("linear_elastic"), "--json"], 0);
    let times: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let update = |n: i64| {
        let times = times.as_array().expect("a list").iter();
        let mut found = times
            .filter(|t| t["model"] == "linear_elastic" && t["function"] == "update" && t["n"] == n);
        found.next().expect("a time")["ns_per_point"].as_f64().expect("a number")
    };
    let [one, some, many] = [update(1), update(64), update(1024)];
    println!("linear_elastic: {one:.1}, {some:.1}, {many:.1} ns per point");
    // What a call costs is shared by the points of a batch.
    assert!(many > 0.0 && many < one && some < one, "{one} {some} {many}");
    let table = output(&["bench", &plugin_path("newtonian")], 0);
    assert!(table.contains("n = 1024") && table.contains("newtonian"), "{table}");
}

#[test]
fn bad_input_is_refused_in_a_line() {
    let newtonian = plugin_path("newtonian");
    let folder = scratch_folder();
    for command in ["info", "check", "bench"] {
        refused(&[command, "/nowhere/x.so"], &["/nowhere/x.so", "cannot be found"]);
        refused(&[command, "nowhere.so"], &["./nowhere.so", "cannot be found"]);
        refused(&[command, "lahar_nowhere"], &["no plugin `lahar_nowhere`", "LAHAR_PLUGIN_PATH"]);
        let wrong = [command, &newtonian, "--model", "newtonain"];
        refused(&wrong, &["no model is named `newtonain`", "did you mean `newtonian`?"]);
    }
    // What is there and is no plugin: `check` says it as the rule `loads`.
    let script = folder.join("script.so");
    fs::write(&script, "#!/bin/sh\n").expect("a file");
    let foreign = folder.join("foreign.so");
    let mut library = fs::read(&newtonian).expect("a library");
    library[18..20].copy_from_slice(&183_u16.to_le_bytes()); // e_machine: AArch64
    fs::write(&foreign, library).expect("a file");
    let [folder, script, foreign] =
        [&folder, &script, &foreign].map(|p| p.to_str().expect("UTF-8"));
    let unresolved = bad_plugin("missing_symbol");
    for (path, reason) in [
        (folder, "this is a directory"),
        (script, "not a shared library"),
        (foreign, foreign),
        (&unresolved, "nobody_has_this_function"),
    ] {
        refused(&["info", path], &[reason]);
        refused(&["bench", path], &[reason]);
        let text = output(&["check", path], 1);
        assert!(text.starts_with("FAIL loads: ") && text.contains(reason), "{text}");
    }
    for command in ["check", "bench"] {
        let set =
            |text: &str, texts: &[&str]| refused(&[command, &newtonian, "--set", text], texts);
        set("viscosty=1", &["no parameter of `newtonian`", "did you mean `viscosity`?"]);
        set("viscosity=thick", &["expected a number for `viscosity` [Pa s], got `thick`"]);
        set("equation_of_state=ideal", &["one of tait, linear", "got `ideal`"]);
        set("viscosity", &["--set key=value", "`viscosity`"]);
        set("viscosity=-1", &["`viscosity` of `newtonian` must be from", "got -1"]);
        set("viscosity=nan", &["viscosity"]);
    }
    refused(&["check", &newtonian, "--time-limit", "0"], &["time limit above 0 s, got 0"]);
}

#[test]
fn a_library_that_ends_the_process_does_not_do_so_without_a_word() {
    refused(&["info", &bad_plugin("dies_on_load")], &["signal 11 (segmentation fault"]);
    refused(&["bench", &bad_plugin("segfaults")], &["signal 11 (segmentation fault"]);
    refused(&["bench", &bad_plugin("exits")], &["exit status 3", "take the host down"]);
}

#[test]
fn the_adapter_beside_the_tool_is_found() {
    let folder = scratch_folder();
    let umat = repository("plugins/umat/tests/fortran/elastic.f");
    let library = folder.join("libmine.so");
    let library = library.to_str().expect("UTF-8");
    output(&["umat-build", umat.to_str().expect("UTF-8"), "-o", library], 0);
    assert!(output(&["info", library], 0).contains("model mine: "));
    // As the manual has it: without a sidecar constants are given by number.
    let set = ["--set", "nprops=2", "--set", "prop_1=1e7", "--set", "prop_2=0.3"];
    let text = output(&[&["check", library][..], &set].concat(), 0);
    assert!(text.contains("ok   wave_speed: "), "{text}");
    let text = output(&["check", library], 1);
    assert!(text.contains("all parameters are 0"), "{text}");
    // A UMAT of plane strain is checked in the plane.
    let sidecar = r#"{"ntens": 4, "parameters": [{"key": "e", "typical": 1e7}, {"key": "nu", "typical": 0.3}]}"#;
    fs::write(folder.join("libmine.json"), sidecar).expect("a sidecar");
    let text = output(&["check", library], 0);
    assert!(text.contains("plane"), "{text}");
}

#[test]
fn values_of_the_caller_reach_the_model() {
    let path = plugin_path("newtonian");
    let set =
        ["--model", "newtonian", "--set", "viscosity=0.5", "--set", "equation_of_state=linear"];
    let text = output(&[&["check", &path][..], &set].concat(), 0);
    assert!(text.contains("viscosity = 0.5, equation_of_state = 1"), "{text}");
}

#[test]
fn a_point_that_failed_is_replayed_and_its_answer_compared() {
    let (_, capsule) = nan_capsule();
    let path = capsule.to_str().expect("UTF-8");
    let text = output(&["replay", path], 0);
    for part in [
        "model nan_model at particle 7 of body 0, step 2, t = 0.002 s, dt = 0.001 s",
        "plugin   org.lahar.test.nan_model 1.0",
        "  second                             2.5",
        "  strain_increment xx                -",
        "  memory                             1.0",
        "  stress1 xx                         NaN                        NaN\n",
        "reproduced: the point",
    ] {
        assert!(text.contains(part), "`{part}` is not in:\n{text}");
    }
    assert!(!text.contains("differs"), "{text}");

    // Another state: the model does not fail.
    let good = fs::read_to_string(&capsule).expect("a capsule");
    let changed = scratch_folder().join("changed.json");
    let changed_path = changed.to_str().expect("UTF-8");
    let (start, rest) = good.split_once("\"end\"").expect("an end");
    let other = start.replace("\"memory\": [\n      1.0", "\"memory\": [\n      0.0");
    assert_ne!(other, start);
    fs::write(&changed, format!("{other}\"end\"{rest}")).expect("a file");
    let text = output(&["replay", changed_path], 1);
    let differs = text.lines().filter(|line| line.contains("differs")).count();
    assert!(differs == 1 && text.contains("not reproduced"), "{text}");
    let json = output(&["replay", changed_path, "--json"], 1);
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(json["reproduced"], false);
    assert!(json["again"]["stress1"][0].is_f64() && json["capsule"]["end"]["stress1"][0] == "NaN");

    // Plugins that are elsewhere, or another.
    refused(&["replay", "/nowhere/capsule.json"], &["/nowhere/capsule.json", "can not be read"]);
    let elastic = plugin_path("linear_elastic");
    refused(
        &["replay", path, "--plugin", &elastic],
        &["`nan_model`", "org.lahar.test.nan_model 1.0"],
    );
    let (before, after) = good.split_once("\"plugin_path\": \"").expect("a path");
    let after = after.split_once('"').expect("its end").1;
    for (file, part) in [("/nowhere/x.so", "--plugin another"), ("[org.x]", "linked into the host")]
    {
        fs::write(&changed, format!("{before}\"plugin_path\": \"{file}\"{after}")).expect("a file");
        refused(&["replay", changed_path], &[part]);
        output(&["replay", changed_path, "--plugin", &bad_plugin("nan_model")], 0);
    }
}
