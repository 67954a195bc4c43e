//! The program in the README is compiled and run by the lines that stand there.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

#[test]
fn the_program_of_the_readme_compiles_and_runs_by_its_own_lines() {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let readme = fs::read_to_string(root.join("README.md")).expect("README.md");
    let program = block(&readme, "c");
    assert!(program.lines().count() <= 60, "the program of the README grows too long");
    let exe = std::env::current_exe().expect("the test knows where it stands");
    let release = exe.parent().and_then(Path::parent).expect("target/release");
    let folder = std::env::temp_dir().join(format!("lahar_readme_{}", std::process::id()));
    fs::create_dir_all(folder.join("target")).expect("a folder for the test");
    std::os::unix::fs::symlink(release, folder.join("target/release")).expect("a link");
    std::os::unix::fs::symlink(root.join("include"), folder.join("include")).expect("a link");
    fs::write(folder.join("sand.c"), program).expect("sand.c");
    fs::write(
        folder.join("sand.cpp"),
        "#include <lahar/lahar.h>\nint main() { return lahar_abi_version() - 1; }\n",
    )
    .expect("sand.cpp");
    fs::write(
        folder.join("sand.f90"),
        "program sand\nuse lahar\nimplicit none\nif (lahar_abi_version_function() /= 1) error stop\nend program\n",
    )
    .expect("sand.f90");

    let lines: Vec<&str> = readme
        .lines()
        .filter(|line| ["cc ", "c++ ", "gfortran "].iter().any(|s| line.starts_with(s)))
        .collect();
    assert_eq!(lines.len(), 3, "the README has one compile line for C, C++ and Fortran each");
    let start = readme.lines().find(|line| line.starts_with("LAHAR_PLUGIN_PATH="));
    let start = start.expect("the README says how to start the program");
    for line in lines {
        shell(&folder, &format!("{line} -Wall -Werror"));
        shell(&folder, start);
    }
    assert!(fs::metadata(folder.join("sand.vtp")).expect("the program's output").len() > 1000);
    fs::remove_dir_all(&folder).expect("the folder goes");
}

/// The first block of the language.
fn block<'a>(text: &'a str, language: &str) -> &'a str {
    let start = format!("```{language}\n");
    let (_, rest) = text.split_once(&start).expect("a block of code");
    rest.split("```").next().unwrap_or_default()
}

fn shell(folder: &Path, line: &str) {
    let output =
        Command::new("sh").args(["-c", line]).current_dir(folder).output().expect("a shell");
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "`{line}` ended with {}:\n{error}", output.status);
}
