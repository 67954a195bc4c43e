//! The templates that authors copy, `plugins/template`: each is built by the line that stands in
//! it, and all are the same model.

use super::compiler::{self, library_folder, read, run};
use super::support::{repository, scratch_folder, target_folder};
use lahar::context::Context;
use lahar::error::Status;
use lahar::material::{Material, Model, StressBatch};
use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;

/// Source, how its line begins, and what makes the compiler strict.
const COMPILED: [(&str, &str, &str); 3] = [
    ("own_material.c", "cc ", "-Wall -Wextra -Wpedantic -Werror"),
    ("own_material.cpp", "c++ ", "-Wall -Wextra -Wpedantic -Werror"),
    ("own_material.f90", "gfortran ", "-Wall -Werror -fimplicit-none"),
];
const YIELD_STRESS: f64 = 2e4;
const VALUES: [(&str, f64); 3] =
    [("youngs_modulus", 1e7), ("poissons_ratio", 0.3), ("yield_stress", YIELD_STRESS)];

/// Builds the text of a template in a folder of its own that shows `include`, by the line in its
/// head.
pub fn build(name: &str, text: &str) -> PathBuf {
    let (_, start, strict) = COMPILED.iter().find(|(n, ..)| *n == name).expect("a template");
    let folder = scratch_folder();
    symlink(repository("include"), folder.join("include")).expect("a link");
    fs::write(folder.join(name), text).expect("a source");
    let line = documented_line(text, start);
    run(Command::new("sh").args(["-c", &format!("{line} {strict}")]).current_dir(&folder));
    folder.join("libown_material.so")
}

/// The one line of the comments that begins with the compiler's name.
fn documented_line<'a>(text: &'a str, start: &str) -> &'a str {
    let lines = text.lines().map(|line| line.trim_start_matches(['!', '*', '/', '>', ' ']));
    let mut found = lines.filter(|line| line.starts_with(start));
    let line = found.next().expect("the line that compiles the template");
    assert!(found.next().is_none(), "one line, not two");
    line
}

/// The Rust template, by its line, into a target folder of its own: others may be loading the
/// library of the workspace.
fn build_rust() -> PathBuf {
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("rust_template");
    let text = read("plugins/template/src/lib.rs");
    let line = documented_line(&text, "cargo build ");
    let mut shell = Command::new("sh");
    shell.args(["-c", &format!("{line} --quiet --offline")]).current_dir(repository(""));
    run(shell.env("CARGO_TARGET_DIR", &target));
    target.join("release/libown_material.so")
}

fn build_all() -> Vec<(&'static str, PathBuf)> {
    let compiled =
        COMPILED.map(|(name, ..)| (name, build(name, &read(&format!("plugins/template/{name}")))));
    compiled.into_iter().chain([("lib.rs", build_rust())]).collect()
}

/// A context with the library at `path` alone.
fn context(path: &Path) -> Arc<Context> {
    let context = Context::new(Some(1)).unwrap();
    context.load_plugin(path.to_str().expect("a UTF-8 path")).unwrap();
    context
}

/// `n` points of a material that go through many steps.
struct Points {
    n: usize,
    stride: usize,
    strain: Vec<f64>,
    stress: [Vec<f64>; 2],
    state: [Vec<f64>; 2],
    density: Vec<f64>,
    wave_speed: Vec<f64>,
    status: Vec<i32>,
}

impl Points {
    fn new(n: usize) -> Self {
        let stride = n.next_multiple_of(8);
        Self {
            n,
            stride,
            strain: vec![0.0; 6 * stride],
            stress: [vec![0.0; 6 * stride], vec![f64::NAN; 6 * stride]],
            state: [vec![0.0; stride], vec![f64::NAN; stride]],
            density: vec![1600.0; stride],
            wave_speed: vec![f64::NAN; stride],
            status: vec![0; stride],
        }
    }

    fn batch(&mut self) -> StressBatch<'_> {
        let ([stress0, stress1], [state0, state1]) = (&mut self.stress, &mut self.state);
        StressBatch {
            n: self.n,
            stride: self.stride,
            dt: 1e-3,
            time: 0.0,
            step: -1,
            strain_increment: &self.strain,
            velocity_gradient: &[],
            deformation_gradient: &[],
            stress0,
            state0,
            stress1,
            state1,
            inputs: &self.density,
            wave_speed: &mut self.wave_speed,
            diffusivity: &mut [],
            energy: &mut [],
            dt_factor: &mut [],
            status: &mut self.status,
        }
    }

    /// Goes on with what the last step gave.
    fn commit(&mut self) {
        self.stress.swap(0, 1);
        self.state.swap(0, 1);
    }

    /// The end of point `k`, bit by bit.
    fn bits(&self, k: usize) -> Vec<u64> {
        let stress = (0..6).map(|c| self.stress[1][c * self.stride + k]);
        let all = stress.chain([self.state[1][k], self.wave_speed[k]]);
        all.map(f64::to_bits).chain([self.status[k] as u64]).collect()
    }

    fn mises(&self, k: usize) -> f64 {
        let s: [f64; 6] = std::array::from_fn(|c| self.stress[1][c * self.stride + k]);
        let differences = (s[0] - s[1]).powi(2) + (s[1] - s[2]).powi(2) + (s[2] - s[0]).powi(2);
        (0.5 * differences + 3.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5])).sqrt()
    }
}

/// Numbers between -1 and 1 that look random.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// What `steps` random steps of `n` points give; how many ended on the cap and how many did not.
fn history(material: &Material, n: usize, steps: usize) -> (Vec<Vec<u64>>, [usize; 2]) {
    let (mut points, mut noise) = (Points::new(n), Noise(n as u64));
    let (mut ends, mut counts) = (Vec::new(), [0; 2]);
    points.density.fill_with(|| 1500.0 + 500.0 * noise.next());
    for step in 0..steps {
        let size = [1e-4, 1e-3, 1e-2][step % 3];
        points.strain.fill_with(|| size * noise.next());
        material.update(&mut points.batch()).unwrap();
        for k in 0..n {
            let before = points.state[0][k];
            let yielded = points.state[1][k] > before;
            let mises = points.mises(k) / YIELD_STRESS;
            // Round-off of a stress that may be much larger than its deviator.
            assert!(if yielded { (mises - 1.0).abs() < 1e-11 } else { mises < 1.0 + 1e-11 });
            assert_eq!(points.status[k], 0);
            counts[usize::from(yielded)] += 1;
            ends.push(points.bits(k));
        }
        points.commit();
    }
    (ends, counts)
}

/// Everything that a model says of itself.
fn description(model: &Model) -> String {
    let mut text = format!("{} {} {:?}", model.name, model.summary, model.kinematics);
    text += &format!(
        " {} {:?} {} {}",
        model.reference, model.inputs, model.outputs, model.capabilities
    );
    for p in &model.parameters {
        text += &format!("\n{} {} {} {} {}", p.key, p.symbol, p.unit, p.description, p.required);
        let bounds = [p.hard_min, p.hard_max, p.advised_min, p.advised_max];
        text += &format!(" {:?} {} {bounds:?}", p.kind, p.default);
    }
    for s in &model.states {
        text += &format!(
            "\n{} {} {} {} {}",
            s.key,
            s.unit,
            s.description,
            s.initial,
            s.kind.components()
        );
    }
    text
}

#[test]
fn all_templates_are_built_by_their_own_lines_and_give_equal_results_bit_for_bit() {
    let mut first: Option<(String, Vec<Vec<Vec<u64>>>)> = None;
    for (name, library) in build_all() {
        let nm = run(Command::new("nm").args(["-D", "--defined-only"]).arg(&library));
        let symbols: Vec<_> = nm.lines().filter_map(|l| l.split_whitespace().last()).collect();
        assert_eq!(symbols, ["lahar_plugin_entry_v1"], "{name}");

        // It follows the rules of the conformance suite.
        let mut lahar = Command::new(target_folder().join("lahar"));
        run(lahar.args(["plugin", "check"]).arg(&library));

        let context = context(&library);
        let material = Material::new(&context, "own_material", &VALUES).unwrap();
        let mut results = Vec::new();
        for (n, steps) in [(1, 30), (13, 30), (64, 12)] {
            let (ends, [elastic, plastic]) = history(&material, n, steps);
            assert!(elastic > steps / 4 && plastic > steps / 4, "{elastic} {plastic}");
            results.push(ends);
        }
        // The wave speed alone is that of the step.
        let mut points = Points::new(13);
        material.wave_speed(&mut points.batch()).unwrap();
        let exact = (1e7 * 0.7 / (1.3 * 0.4) / 1600.0_f64).sqrt();
        assert!(points.wave_speed[..13].iter().all(|c| (c / exact - 1.0).abs() < 1e-14));

        let of_this = (description(context.model("own_material").unwrap()), results);
        let of_first = first.get_or_insert_with(|| of_this.clone());
        assert_eq!(of_first.0, of_this.0, "{name}");
        assert!(of_first.1 == of_this.1, "{name} differs from {}", COMPILED[0].0);
    }
}

#[test]
fn what_is_not_a_number_fails_alone_and_values_without_moduli_are_refused_by_all_templates() {
    for (name, library) in build_all() {
        let context = context(&library);
        let material = Material::new(&context, "own_material", &VALUES).unwrap();
        let mut points = Points::new(9);
        points.strain[2 * points.stride + 4] = f64::NAN;
        points.stress[0][5 * points.stride + 6] = f64::INFINITY;
        points.state[0][2] = f64::NAN;
        points.density[7] = 0.0;
        points.density[8] = -1.0;
        material.update(&mut points.batch()).unwrap();
        assert_eq!(points.status[..9], [0, 0, 3, 0, 3, 0, 3, 3, 3], "{name}");
        assert!(points.stress[1][5].is_finite(), "{name}");

        let huge = [("youngs_modulus", 1e308), ("poissons_ratio", 0.4999), ("yield_stress", 1.0)];
        let error = Material::new(&context, "own_material", &huge).err().expect("a refusal");
        assert!(error.message.contains("not finite"), "{name}: {error}");
    }
}

#[test]
fn an_exception_of_a_cplusplus_model_becomes_an_error_with_its_text() {
    let name = "own_material.cpp";
    let text = read("plugins/template/own_material.cpp");
    let with = |anchor: &str, statement: &str| {
        let changed = text.replacen(anchor, &format!("{anchor}\n{statement}"), 1);
        assert_ne!(changed, text, "the template has no `{anchor}`");
        context(&build(name, &changed))
    };
    let update = "void update(const Start &start, End &end) const {";
    for (thrown, expected) in
        [("std::runtime_error(\"no such soil\")", "no such soil"), ("42", "no std::exception")]
    {
        let context =
            with(update, &format!("if (start.strain_increment[0] > 0.5) throw {thrown};"));
        let material = Material::new(&context, "own_material", &VALUES).unwrap();
        let mut points = Points::new(9);
        material.update(&mut points.batch()).unwrap();
        points.strain[3] = 1.0;
        let error = material.update(&mut points.batch()).unwrap_err();
        assert_eq!(error.status, Status::MaterialFailed);
        assert!(error.message.contains(expected), "{error}");
    }
    let constructor = "explicit OwnMaterial(const double *values) {";
    let context = with(constructor, "throw std::runtime_error(\"no licence\");");
    let error = Material::new(&context, "own_material", &VALUES).err().expect("a refusal");
    assert!(error.message.contains("no licence"), "{error}");
}

#[test]
fn mistakes_in_the_tables_of_a_cplusplus_model_do_not_compile() {
    let text = read("plugins/template/own_material.cpp");
    let folder = scratch_folder();
    let compile = |text: &str| {
        let file = folder.join("model.cpp");
        fs::write(&file, text).expect("a source");
        let mut compiler = Command::new("c++");
        compiler.args(["-std=c++17", "-fsyntax-only", "-I"]).arg(repository("include")).arg(file);
        let output = compiler.output().expect("a compiler");
        (output.status.success(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    assert!(compile(&text).0, "the control");
    for (right, wrong, expected) in [
        (".typical(0.3)", ".typical(0.6)", "outside its bounds"),
        ("\"poissons_ratio\"", "\"youngs_modulus\"", "no two are equal"),
        ("name = \"own_material\"", "name = \"own material\"", "letters, digits"),
        ("LAHAR_OUTPUT_WAVE_SPEED | ", "", "is mandatory"),
        ("const double *values", "int", "needs a constructor"),
    ] {
        let changed = text.replacen(right, wrong, 1);
        assert_ne!(changed, text, "the template has no `{right}`");
        let (compiles, message) = compile(&changed);
        assert!(!compiles && message.contains(expected), "`{wrong}` gives:\n{message}");
    }
}

#[test]
fn templates_linked_into_programs_are_registered_by_their_entries() {
    let library = library_folder();
    let link = [format!("-L{}", library.display()), format!("-Wl,-rpath,{}", library.display())];
    let template = |name: &str| repository("plugins/template").join(name);
    let folder = scratch_folder();
    let mut compile = Command::new("cc");
    compile.args(["-std=c99", "-O2"]).args(compiler::WARNINGS).arg("-Wno-unused-function");
    compile.arg("-I").arg(repository("include"));
    compile.arg(template("own_material.c")).arg(repository("tests/c/linked_plugin.c"));
    run(compile.args(&link).args(["-llahar", "-lm", "-o", "in_c"]).current_dir(&folder));
    let mut compile = Command::new("gfortran");
    compile.args(["-std=f2018", "-O2", "-Wall", "-Werror", "-fimplicit-none"]);
    compile.arg(repository("include/lahar/lahar.f90"));
    compile.arg(repository("include/lahar/lahar_plugin.f90")).arg(template("own_material.f90"));
    compile.arg(repository("tests/fortran/linked_plugin.f90")).args(&link);
    run(compile.args(["-llahar", "-o", "in_fortran"]).current_dir(&folder));
    let numbers = |program: &str| -> Vec<f64> {
        let printed = run(&mut Command::new(folder.join(program)));
        printed.lines().map(|line| line.trim().parse().expect("a number")).collect()
    };
    let (c, fortran) = (numbers("in_c"), numbers("in_fortran"));
    assert_eq!(c, fortran);
    // Index of the plugin, twice; a sum of plastic strains: the block has yielded.
    assert_eq!(c[..2], [0.0, 0.0]);
    assert!(c[2] > 0.1, "{c:?}");
}
