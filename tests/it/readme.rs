//! The program in the README is compiled and run by the lines that stand there.

use super::compiler::{read, run};
use super::support::{repository, scratch_folder, target_folder};
use std::fs;
use std::os::unix::fs::symlink;
use std::process::Command;

const CPP: &str = "#include <lahar/lahar.h>\nint main() { return lahar_abi_version() - 1; }\n";
const FORTRAN: &str = "program sand\nuse lahar\nimplicit none\n\
                       if (lahar_abi_version_function() /= 1) error stop\nend program\n";

#[test]
fn the_program_of_the_readme_compiles_and_runs_by_its_own_lines() {
    let readme = read("README.md");
    let program = block(&readme, "c");
    assert!(program.lines().count() <= 60, "the program of the README grows too long");
    // A folder that looks like the repository's after its build.
    let folder = scratch_folder();
    fs::create_dir(folder.join("target")).expect("a folder");
    symlink(target_folder(), folder.join("target/release")).expect("a link");
    symlink(repository("include"), folder.join("include")).expect("a link");
    for (name, text) in [("sand.c", program), ("sand.cpp", CPP), ("sand.f90", FORTRAN)] {
        fs::write(folder.join(name), text).expect("a source");
    }

    let compile: Vec<&str> = readme
        .lines()
        .filter(|line| ["cc ", "c++ ", "gfortran "].iter().any(|start| line.starts_with(start)))
        .collect();
    assert_eq!(compile.len(), 3, "one compile line for C, C++ and Fortran each");
    let start = readme.lines().find(|line| line.starts_with("LAHAR_PLUGIN_PATH="));
    let start = start.expect("the README says how to start the program");
    let shell = |line: &str| run(Command::new("sh").args(["-c", line]).current_dir(&folder));
    for line in compile {
        shell(&format!("{line} -Wall -Werror"));
        shell(start);
    }
    assert!(fs::metadata(folder.join("sand.vtp")).expect("the program's output").len() > 1000);
}

/// The first block of the language.
fn block<'a>(text: &'a str, language: &str) -> &'a str {
    let (_, rest) = text.split_once(&format!("```{language}\n")).expect("a block of code");
    rest.split("```").next().unwrap_or_default()
}
