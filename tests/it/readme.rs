//! The program in the README is compiled and run by the lines that stand there.

use super::compiler::{read, run};
use super::support::{repository, scratch_folder, target_folder};
use std::fs;
use std::os::unix::fs::symlink;
use std::process::Command;

#[test]
fn the_program_of_the_readme_compiles_and_runs_by_its_own_lines_in_all_three_languages() {
    let readme = read("README.md");
    let (c, fortran) = (block(&readme, "c"), block(&readme, "fortran"));
    for program in [c, fortran] {
        assert!(program.lines().count() <= 60, "the program of the README grows too long");
    }
    // A folder that looks like the repository's after its build.
    let folder = scratch_folder();
    fs::create_dir(folder.join("target")).expect("a folder");
    symlink(target_folder(), folder.join("target/release")).expect("a link");
    symlink(repository("include"), folder.join("include")).expect("a link");
    for (name, text) in [("sand.c", c), ("sand.cpp", c), ("sand.f90", fortran)] {
        fs::write(folder.join(name), text).expect("a source");
    }

    let line = |start: &str| {
        let found: Vec<&str> = readme.lines().filter(|line| line.starts_with(start)).collect();
        assert_eq!(found.len(), 1, "one line of the README begins with `{start}`");
        found[0]
    };
    let shell = |line: &str| run(Command::new("sh").args(["-c", line]).current_dir(&folder));
    let result = folder.join("sand.vtp");
    // as strict as the languages have it: what C++ lacks of C is a warning to many compilers
    for compile in [line("cc "), line("c++ "), line("gfortran ")] {
        shell(&format!("{compile} -Wall -Werror -pedantic"));
        let printed = shell(line("LAHAR_PLUGIN_PATH="));
        assert!(printed.contains("sand.vtp") && printed.contains("ParaView"), "{printed}");
        assert!(fs::metadata(&result).expect("the program's output").len() > 1000);
        fs::remove_file(&result).expect("removed");
    }
}

/// The first block of the language.
fn block<'a>(text: &'a str, language: &str) -> &'a str {
    let (_, rest) = text.split_once(&format!("```{language}\n")).expect("a block of code");
    rest.split("```").next().unwrap_or_default()
}
