//! Runs the program once more around a plugin: with the program's own folder among those where
//! plugins are looked for, since the adapter of UMATs is there, and so that the end of the process
//! by a library is reported.

use crate::CANNOT;
use crate::check::process::Ending;
use std::env;
use std::os::unix::process::CommandExt;
use std::process::{Command, ExitCode, ExitStatus};

/// The option that marks the inner run.
pub const FLAG: &str = "--inside";

/// The same command in a child process; says how it ended if the plugin ended it.
pub fn watched() -> Result<ExitCode, String> {
    let status = again()?.status().map_err(|e| format!("a child process: {e}"))?;
    match status.code().and_then(|code| u8::try_from(code).ok()) {
        Some(code) if code <= CANNOT => Ok(ExitCode::from(code)),
        _ => Err(ended(status)),
    }
}

/// Replaces this process by the same command, which debuggers follow.
pub fn instead() -> Result<ExitCode, String> {
    Err(format!("this program cannot be run again: {}", again()?.exec()))
}

fn ended(status: ExitStatus) -> String {
    Ending::Died(status).sentence("", "a function of the plugin")
}

fn again() -> Result<Command, String> {
    let program = env::current_exe().map_err(|e| format!("the path of this program: {e}"))?;
    let own = program.parent().map(std::path::Path::to_path_buf);
    let asked = env::var_os("LAHAR_PLUGIN_PATH").unwrap_or_default();
    let folders = env::join_paths(env::split_paths(&asked).chain(own))
        .map_err(|e| format!("the folder of this program: {e}"))?;
    let mut command = Command::new(program);
    command.arg(FLAG).args(env::args_os().skip(1)).env("LAHAR_PLUGIN_PATH", folders);
    Ok(command)
}
