//! The tasks of the repository: `cargo xtask <task>`.
//!
//! A task returns the text of what went wrong; the process then ends with status 1.
#![allow(clippy::print_stderr)] // a command line talks to the terminal

use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match xtask_front::run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("xtask: {message}");
            ExitCode::FAILURE
        }
    }
}
