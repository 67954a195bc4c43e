//! The tasks of `cargo xtask <task>` that need the engine, or crates for reports and plots; the package
//! `xtask-front` starts them, and has the others.
//!
//! Each task is one file. A task returns the text of what went wrong; the process then ends with
//! status 1.
#![allow(clippy::print_stdout, clippy::print_stderr)] // a command line talks to the terminal

mod bench;
mod bits;
mod checks;
mod fortran;
mod headers;
mod instructions;
mod verify;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

#[derive(Parser)]
#[command(name = "cargo xtask", about = "Tasks of the lahar repository")]
struct Cli {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Formatting, lints, headers, bits, counts of instructions, then every test
    Ci,
    /// Writes the C headers and the Fortran bindings from the Rust sources
    Headers {
        /// Only compares with the committed files
        #[arg(long)]
        check: bool,
    },
    /// Counts the instructions of a step under valgrind and compares with benches/instructions.json
    Instructions {
        /// Writes the counts as the new baseline
        #[arg(long)]
        write: bool,
    },
    /// Compares the bits of every kernel after 100 steps with benches/bits.json
    Bits {
        /// Writes the sums as they are now
        #[arg(long)]
        write: bool,
        /// The workspace is built already
        #[arg(long)]
        built: bool,
    },
    /// Measures nanoseconds per particle and step
    Bench(bench::Arguments),
    /// Runs the verification cases and writes docs/verification.md
    Verify(verify::Arguments),
}

fn main() -> ExitCode {
    let result = match Cli::parse().task {
        Task::Ci => checks::ci(),
        Task::Headers { check } => checks::headers(check),
        Task::Instructions { write } => instructions::run(write),
        Task::Bits { write, built } => bits::run(write, built),
        Task::Bench(arguments) => bench::run(&arguments),
        Task::Verify(arguments) => verify::run(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("xtask: {message}");
            ExitCode::FAILURE
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_front_knows_every_task() {
        let command = Cli::command();
        let here: Vec<&str> = command.get_subcommands().map(|task| task.get_name()).collect();
        let front = xtask_front::TASKS.map(|(name, _)| name);
        assert_eq!(front[..3], ["setup", "demo", "test"]);
        assert_eq!(front[3..], here);
    }
}
