//! Guests without manners, libraries that are none, and threads.

mod support;

use lahar_plugin_abi::*;
use lahar_umat::build::{Order, build};
use std::fs;
use std::path::PathBuf;
use std::process::Command;
use support::{Material, adapt, close, folder, library, library_of, logged, source};

const RUDE: &str =
    r#"{"states": 1, "parameters": [{"key": "m"}, {"key": "g"}, {"key": "rudeness"}]}"#;

fn rude(rudeness: f64, threads: &str, n: usize) -> (Material, PathBuf) {
    let sidecar = RUDE.replacen('{', &format!("{{\"threads\": \"{threads}\", "), 1);
    let path = library("rude.f", Some(&sidecar));
    let model = adapt(&path).unwrap_or_else(|e| panic!("{e}"));
    (Material::new(model, &[4e6, 1e6, rudeness], n).expect("an instance"), path)
}

fn pulled(m: &mut Material) {
    for k in 0..m.n {
        m.set_gradient(k, [1e-3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    }
}

#[test]
fn a_umat_that_writes_its_inputs_spoils_neither_the_next_point_nor_the_start() {
    let (mut m, _) = rude(0.0, "serial", 11);
    pulled(&mut m);
    for step in 0..3 {
        m.update().expect("an update");
        for k in 0..11 {
            let stress = 1e3 * f64::from(step + 1);
            let expected = [4.0 * stress, 2.0 * stress, 2.0 * stress, 0.0, 0.0, 0.0];
            assert!(close(&m.stress1(k), &expected, 1e-13), "{:?}", m.stress1(k));
            assert!(close(
                &m.state1::<1>(k, m.at("total_strain")),
                &[1e-3 * f64::from(step + 1)],
                1e-13
            ));
            // PNEWDT = 0.5 is a wish for half the step; the point is updated.
            assert_eq!((m.status[k], m.dt_factor[k]), (LAHAR_POINT_SMALLER_STEP, 0.5));
        }
        m.commit();
    }
    assert_eq!(m.state1::<1>(10, 0), [33.0], "SAVE counts the calls");
}

#[test]
fn xit_ends_the_call_and_fails_the_point_and_its_message_reaches_the_log() {
    let (mut m, _) = rude(1.0, "serial", 3);
    pulled(&mut m);
    m.set_input(LAHAR_INPUT_PARTICLE_ID, 0, 16.0);
    logged();
    m.update().expect("an update");
    assert_eq!(m.status[..3], [LAHAR_POINT_FAILED; 3]);
    let log = logged();
    assert_eq!(log[0], (LAHAR_PLUGIN_LOG_WARNING, "element 17 of RUDE: 2.5".into()));
    let last = &log.last().expect("a line").1;
    assert!(last.contains("XIT at particle 16"), "{last}");
    // Nor is there a wave speed, which a time step could be taken from.
    m.wave_speed().expect("a wave speed");
    assert_eq!(m.status[..3], [LAHAR_POINT_FAILED; 3]);
}

#[test]
fn a_state_variable_too_many_is_found() {
    for place in [2.0, 4.0] {
        let (mut m, path) = rude(place, "serial", 3);
        pulled(&mut m);
        let error = m.update().expect_err("STATEV(2) or STATEV(101)");
        assert!(error.contains("wrote behind STATEV(1)") && error.contains("`states`"), "{error}");
        assert!(error.contains(path.with_extension("json").to_str().expect("UTF-8")), "{error}");
    }
}

#[test]
fn constants_beyond_their_number_are_refused_and_reading_there_fails_the_point() {
    let model = adapt(&library("elastic.f", None)).expect("a model");
    let refused = Material::new(model, &[2.0, 1e7, 0.3, 30.0], 1).err().expect("an error");
    assert!(refused.contains("prop_3 is given, but nprops is 2"), "{refused}");
    for (count, status) in [(2.0, LAHAR_POINT_OK), (1.0, LAHAR_POINT_FAILED)] {
        let values = [count, 1e7, if count > 1.0 { 0.3 } else { 0.0 }];
        let mut m = Material::new(model, &values, 1).expect("a material");
        pulled(&mut m);
        m.update().expect("an update");
        assert_eq!(m.status[0], status, "nprops = {count}");
    }
}

#[test]
fn what_is_not_a_number_fails_the_point() {
    let (mut m, _) = rude(3.0, "serial", 2);
    pulled(&mut m);
    m.update().expect("an update");
    assert_eq!(m.status[..2], [LAHAR_POINT_FAILED; 2]);
    let (mut m, _) = rude(0.0, "serial", 2);
    pulled(&mut m);
    m.set_stress(1, [f64::NAN; 6]);
    m.update().expect("an update");
    assert_eq!(m.status[..2], [LAHAR_POINT_SMALLER_STEP, LAHAR_POINT_FAILED]);
}

/// Two threads, of which each makes 5 calls of one point at the same time as the other; the call numbers that SAVE gave last.
fn counts(threads: &str) -> (Vec<f64>, Vec<f64>) {
    let sidecar = RUDE.replacen('{', &format!("{{\"threads\": \"{threads}\", "), 1);
    let model = adapt(&library("rude.f", Some(&sidecar))).unwrap_or_else(|e| panic!("{e}"));
    let barrier = std::sync::Barrier::new(2);
    let run = || {
        let mut m = Material::new(model, &[4e6, 1e6, 0.0], 1).expect("an instance");
        pulled(&mut m);
        let mut last = 0.0;
        for _ in 0..5 {
            barrier.wait();
            m.update().expect("an update");
            last = m.state1::<1>(0, 0)[0];
        }
        barrier.wait();
        last
    };
    let both = || -> Vec<f64> {
        std::thread::scope(|s| {
            let threads = [s.spawn(run), s.spawn(run)];
            threads.map(|t| t.join().expect("a thread")).to_vec()
        })
    };
    (both(), both())
}

#[test]
fn copies_give_each_thread_save_variables_of_its_own() {
    let before = temporary();
    let (first, second) = counts("copies");
    assert_eq!(first, [5.0, 5.0]);
    // The copies of threads that have ended serve the next ones.
    assert_eq!(second, [10.0, 10.0]);
    assert_eq!(temporary(), before, "copies are left behind");
    let model = adapt(&library("rude.f", Some(r#"{"threads": "copies", "states": 1}"#)));
    let model = model.expect("a model");
    assert!(model.capabilities & LAHAR_CAPABILITY_THREAD_SAFE != 0);
    // The control: one library for both, as `safe` promises to stand.
    let (shared, _) = counts("safe");
    assert!(shared.iter().any(|count| *count > 5.0), "{shared:?}");
}

/// Copies of this process in the folder for temporary files.
fn temporary() -> usize {
    let start = format!("lahar-umat-{}-", std::process::id());
    let files = fs::read_dir(std::env::temp_dir()).expect("a folder");
    files.flatten().filter(|f| f.file_name().to_string_lossy().starts_with(&start)).count()
}

const SET_TRAPS: &str = r"
#define _GNU_SOURCE
#include <fenv.h>
void umat(double *stress, double *statev, double *ddsdde)
{
    stress[0] = (__builtin_ia32_stmxcsr() & 0x7f80) == 0x1f80; /* to nearest, no traps */
    for (int i = 0; i < 36; i += 7) {
        ddsdde[i] = 1;
    }
    fesetround(FE_UPWARD);
    feenableexcept(FE_INVALID);
}
";

unsafe extern "C" {
    fn fegetround() -> i32;
}

#[test]
fn rounding_and_traps_that_a_umat_sets_are_gone_after_eight_points() {
    let file = folder().join("traps.c");
    fs::write(&file, SET_TRAPS).expect("a source");
    let sidecar = r#"{"hidden_length": "none", "states": 0, "parameters": 0}"#;
    let model = adapt(&library_of(&file, Some(sidecar))).expect("a model");
    let mut m = Material::new(model, &[], 17).expect("an instance");
    m.set_stress(2, [f64::NAN; 6]); // would trap
    m.update().expect("an update");
    // SAFETY: a function of the C library that takes nothing.
    assert_eq!(unsafe { fegetround() }, 0);
    let trap = std::hint::black_box(0.0) / std::hint::black_box(0.0);
    assert!(f64::is_nan(trap));
    for k in [0, 8, 16] {
        assert_eq!(m.stress1(k)[0], 1.0, "point {k}");
    }
    assert_eq!(m.stress1(1)[0], 0.0, "the UMAT does not set them");
}

#[test]
fn a_library_without_a_umat_is_refused_with_the_names_that_were_tried() {
    let folder = folder();
    let (file, library) = (folder.join("other.c"), folder.join("libother.so"));
    fs::write(&file, "void user_material(void) {}\nint umat_missing;\n").expect("a source");
    let mut cc = Command::new("cc");
    cc.args(["-shared", "-fPIC", "-o"]).arg(&library).arg(&file);
    assert!(cc.status().expect("a compiler").success());
    let error = adapt(&library).err().expect("no UMAT");
    for part in
        ["`umat_`, `umat`, `UMAT`", "`vumat_`, `vumat`, `VUMAT`", "umat-build", "libother.so"]
    {
        assert!(error.contains(part), "{error}");
    }
    fs::write(library.with_extension("json"), r#"{"routine": "vumat"}"#).expect("a sidecar");
    let error = adapt(&library).err().expect("no VUMAT");
    assert!(!error.contains("`umat_`") && error.contains("`vumat_`"), "{error}");
}

#[test]
fn an_unresolved_utility_routine_is_named_with_the_way_out() {
    let library = folder().join("libbare.so");
    let mut gfortran = Command::new("gfortran");
    gfortran.args(["-shared", "-fPIC", "-I"]).arg(source("../../share"));
    gfortran.arg("-o").arg(&library).arg(source("utilities.f90"));
    assert!(gfortran.status().expect("gfortran").success());
    let error = adapt(&library).err().expect("unresolved symbols");
    assert!(
        error.contains("undefined symbol") && error.contains("`lahar plugin umat-build`"),
        "{error}"
    );
}

#[test]
fn a_mistake_in_the_sidecar_is_told_with_file_line_and_nearest_name() {
    let path = library("elastic.f", Some("{\n  \"parameters\": 2,\n  \"thread\": \"safe\"\n}"));
    let error = adapt(&path).err().expect("an unknown key");
    for part in ["libelastic.json", "unknown field `thread`", "did you mean `threads`?", "line 3"] {
        assert!(error.contains(part), "{error}");
    }
    fs::write(
        path.with_extension("json"),
        r#"{"parameters": [{"key": "modulus_e"}], "modulus": "modulus"}"#,
    )
    .expect("a sidecar");
    let error = adapt(&path).err().expect("an unknown parameter");
    assert!(error.contains("did you mean `modulus_e`?"), "{error}");
}

#[test]
fn the_build_tells_what_is_wrong_with_a_source() {
    let folder = folder();
    let write = |name: &str, text: &str| {
        let path = folder.join(name);
        fs::write(&path, text).expect("a source");
        path
    };
    let output = Some(folder.join("libbad.so"));
    let error = |source: PathBuf| {
        let order = Order { output: output.clone(), ..Order::new([source]) };
        build(&order).expect_err("a build that fails")
    };
    let text = error(write("free.f", "subroutine umat(a)\nend subroutine\n"));
    assert!(text.contains("free.f") && text.contains("`.f90` is free form"), "{text}");
    let text = error(write("calls.f90", "subroutine umat(a)\ncall getvrm(a)\nend subroutine\n"));
    assert!(text.contains("getvrm_") && text.contains("utility routine of Abaqus"), "{text}");
    let text = error(write("none.f90", "subroutine mine(a)\nend subroutine\n"));
    assert!(text.contains("no subroutine UMAT or VUMAT") && text.contains("mine_"), "{text}");
    assert!(!folder.join("libbad.so").exists(), "a library without a UMAT is left");
    let text = error(write("notes.txt", ""));
    assert!(
        text.contains("expected Fortran in fixed form") && text.contains("notes.txt"),
        "{text}"
    );
    let text = error(folder.join("absent.f"));
    assert!(text.contains("absent.f` cannot be read"), "{text}");
    let order = Order { compiler: "no-such-compiler".into(), ..Order::new([source("elastic.f")]) };
    let text = build(&order).expect_err("no compiler");
    assert!(
        text.contains("`no-such-compiler` cannot be run") && text.contains("install"),
        "{text}"
    );
}

#[test]
fn the_build_exports_the_routine_alone_and_notes_what_may_surprise() {
    let folder = folder();
    let file = folder.join("stops.f90");
    fs::write(
        &file,
        "subroutine umat(a)\ncall helper(a)\nend subroutine\nsubroutine helper(a)\nprint *, a\nstop 3\nend subroutine\n",
    )
    .expect("a source");
    let library = folder.join("libstops.so");
    let built =
        build(&Order { output: Some(library.clone()), ..Order::new([file]) }).expect("a library");
    let notes = built.notes.join("\n");
    assert!(
        notes.contains("STOP") && notes.contains("CALL XIT") && notes.contains("print"),
        "{notes}"
    );
    let nm = Command::new("nm").args(["-D", "--defined-only"]).arg(&library).output().expect("nm");
    let names = String::from_utf8_lossy(&nm.stdout).into_owned();
    let mut names: Vec<_> = names.lines().filter_map(|l| l.split_whitespace().last()).collect();
    names.sort_unstable();
    assert_eq!(names, ["lahar_umat_guard", "lahar_umat_set_log", "umat_"]);
    let quiet = build(&Order { output: Some(library), ..Order::new([source("elastic.f")]) });
    assert_eq!(quiet.expect("a library").notes, Vec::<String>::new());
}
