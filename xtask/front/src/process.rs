//! Running other programs, and the folders of the repository and the build.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Folder of the repository: the one with Cargo.lock above the package that cargo started.
pub fn root() -> PathBuf {
    let package = std::env::var("CARGO_MANIFEST_DIR")
        .map_or_else(|_| PathBuf::from(env!("CARGO_MANIFEST_DIR")), PathBuf::from);
    let found = package.ancestors().find(|folder| folder.join("Cargo.lock").exists());
    found.map_or_else(|| PathBuf::from("."), Path::to_path_buf)
}

/// Folder of the release build: where this program itself is, so `CARGO_TARGET_DIR` is
/// honoured.
pub fn release_folder() -> Result<PathBuf, String> {
    let exe = std::env::current_exe().map_err(|e| format!("cannot find the path of xtask: {e}"))?;
    exe.parent().map(Path::to_path_buf).ok_or_else(|| format!("{} has no folder", exe.display()))
}

/// The program of the package xtask, to be started once more. A build that ran meanwhile may have written it anew.
pub fn this_program() -> Result<PathBuf, String> {
    Ok(release_folder()?.join("xtask"))
}

/// Runs a program in the repository's folder with its output shown; anything but success is an
/// error.
pub fn run(program: &str, arguments: &[&str]) -> Result<(), String> {
    run_command(Command::new(program).args(arguments).current_dir(root()))
}

/// Runs cargo, the one that started this task if there is one.
pub fn cargo(arguments: &[&str]) -> Result<(), String> {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_string());
    run(&cargo, arguments)
}

/// Runs a prepared command with its output shown.
pub fn run_command(command: &mut Command) -> Result<(), String> {
    let line = shown(command);
    eprintln!("$ {line}"); // standard output belongs to results
    let status = command.status().map_err(|e| format!("cannot start `{line}`: {e}"))?;
    if status.success() { Ok(()) } else { Err(format!("`{line}` ended with {status}")) }
}

/// Runs a prepared command and gives what it printed on standard output.
pub fn output_of(command: &mut Command) -> Result<String, String> {
    let line = shown(command);
    let output = command
        .stderr(Stdio::inherit())
        .output()
        .map_err(|e| format!("cannot start `{line}`: {e}"))?;
    if !output.status.success() {
        return Err(format!("`{line}` ended with {}", output.status));
    }
    String::from_utf8(output.stdout).map_err(|e| format!("`{line}` printed no UTF-8: {e}"))
}

/// Whether a program starts and ends well, with its output thrown away.
pub fn succeeds(program: &str, arguments: &[&str]) -> bool {
    Command::new(program)
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success())
}

fn shown(command: &Command) -> String {
    let mut line = short(command.get_program());
    for argument in command.get_args() {
        line.push(' ');
        line.push_str(&argument.to_string_lossy());
    }
    line
}

/// The program's name without its folder.
fn short(program: &std::ffi::OsStr) -> String {
    Path::new(program).file_name().unwrap_or(program).to_string_lossy().into_owned()
}
