//! The driver of an author, `examples-c/20_own_material`: a column collapses with a model that was
//! compiled from a template.
//!
//! Gates: what is known of clay of strength c under its weight: it stands if rho g H / c < 2, and
//! far above it becomes a layer that runs at least as far as a shallow one at rest (Nye 1952).

use super::compiler::{WARNINGS, library_folder, read, run};
use super::support::{repository, scratch_folder};
use super::templates::build;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::Command;

const STRONG: &str = "yield_stress=20000"; // rho g H / c = 1.53

/// The model and the driver of one language, each by its documented line and stricter.
struct Author {
    library: PathBuf,
    program: PathBuf,
}

impl Author {
    fn of(language: &str) -> Self {
        let template = format!("own_material.{language}");
        let library = build(&template, &read(&format!("plugins/template/{template}")));
        let driver = repository("examples-c").join(format!("20_own_material.{language}"));
        let (folder, lahar) = (scratch_folder(), library_folder());
        let program = folder.join("own_column");
        let mut compiler = if language == "c" {
            let mut compiler = Command::new("cc");
            compiler.args(["-std=c99", "-O2", "-g"]).args(WARNINGS);
            compiler.arg("-I").arg(repository("include"));
            compiler
        } else {
            let mut compiler = Command::new("gfortran");
            compiler.args(["-std=f2018", "-O2", "-Wall", "-Werror", "-fimplicit-none"]);
            compiler.arg("-ffpe-trap=invalid,zero,overflow");
            compiler.arg(repository("include/lahar/lahar.f90"));
            compiler
        };
        compiler.arg(driver).arg("-o").arg(&program).arg("-L").arg(&lahar).args(["-llahar", "-lm"]);
        run(compiler.arg(format!("-Wl,-rpath,{}", lahar.display())).current_dir(&folder));
        Self { library, program }
    }

    fn results(&self, arguments: &[&str]) -> BTreeMap<String, f64> {
        let mut driver = Command::new(&self.program);
        driver.arg(&self.library).args(arguments).env("LAHAR_NUM_THREADS", "2");
        let printed = run(&mut driver);
        println!("{arguments:?}:\n{printed}");
        let lines = printed.lines().filter_map(|line| line.split_once(" = "));
        lines.map(|(name, value)| (name.into(), value.trim().parse().expect("a number"))).collect()
    }
}

#[test]
fn a_column_with_a_model_of_ones_own_collapses_in_c_and_in_fortran_alike() {
    let c = Author::of("c").results(&[]);
    let fortran = Author::of("f90").results(&[]);
    assert_eq!(c, fortran);
    assert_eq!(c.len(), 25);
    assert_eq!(c["particles"], 2304.0);
    let shallow = c["run_out_of_a_shallow_layer"];
    // Inertia: the potential energy of the start has gone into more than the slow flow that the
    // layer follows from.
    let ratio = c["output5_run_out"] / shallow;
    assert!((1.0..1.6).contains(&ratio), "{ratio} times as far as a shallow layer");
    assert!(c["kinetic_over_start_potential"] < 1e-6, "the clay has not come to rest");
    assert!(c["output5_height"] < 0.5 && c["output5_plastic_strain"] > 1.0);
}

#[test]
fn strong_clay_stands_and_its_run_out_is_less_than_that_of_a_layer() {
    let c = Author::of("c").results(&[STRONG]);
    assert!(c["weight_over_strength"] < 2.0);
    assert!(c["output5_run_out"] < 0.01 && c["output5_height"] > 0.99);
    assert!(c["output5_run_out"] < c["run_out_of_a_shallow_layer"]);
}

#[test]
fn drivers_with_models_of_templates_are_clean_under_valgrind() {
    for language in ["c", "f90"] {
        let author = Author::of(language);
        let mut valgrind = Command::new("valgrind");
        valgrind.args(["-q", "--error-exitcode=9", "--leak-check=full"]);
        valgrind.arg("--errors-for-leak-kinds=definite,indirect").arg(&author.program);
        valgrind.arg(&author.library).args(["cells=6", "steps=30"]);
        assert!(run(&mut valgrind).lines().count() > 8);
    }
}
