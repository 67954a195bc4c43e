//! Compiles and runs C sources with the system's compilers, as a host would.

use super::support::{repository, scratch_folder};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The warnings that every C and C++ source of the repository is free of.
pub const WARNINGS: [&str; 4] = ["-Wall", "-Wextra", "-Wpedantic", "-Werror"];

/// The text of a file of the repository.
pub fn read(path: &str) -> String {
    fs::read_to_string(repository(path)).unwrap_or_else(|e| panic!("{path}: {e}"))
}

/// The folder with liblahar.so. Cargo builds it for the tests beside the test's own executable.
pub fn library_folder() -> PathBuf {
    let exe = std::env::current_exe().expect("the path of the test");
    let found = exe.ancestors().skip(1).take(2).find(|folder| folder.join("liblahar.so").exists());
    found.map(Path::to_path_buf).expect("liblahar.so: cargo build --release --workspace")
}

/// Runs a command; its output if it succeeds, else the test fails with what it said.
pub fn run(command: &mut Command) -> String {
    let output = command.output().unwrap_or_else(|e| panic!("{command:?}: {e}"));
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?} ended with {}:\n{error}", output.status);
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Compiles a C source to a program that is linked with liblahar.so.
pub fn program(source: &Path) -> PathBuf {
    let library = library_folder();
    let target = scratch_folder().join(source.file_stem().expect("a file name"));
    let mut command = Command::new("cc");
    command.args(["-std=c11", "-D_GNU_SOURCE", "-g"]).args(WARNINGS).arg("-Wno-unused-function");
    command.arg("-I").arg(repository("include")).arg(source).arg("-o").arg(&target);
    command.arg("-L").arg(&library).args(["-llahar", "-lm", "-pthread"]);
    run(command.arg(format!("-Wl,-rpath,{}", library.display())));
    target
}
