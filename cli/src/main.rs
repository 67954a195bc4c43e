//! The command line of lahar. `lahar plugin ...` serves authors of constitutive models; see
//! cli/README.md.
#![forbid(unsafe_code)]
#![allow(clippy::print_stderr)] // a command line talks to the terminal

mod bench;
mod check;
mod info;
mod inside;
mod plugin;
mod point;
mod replay;
mod umat_build;

use clap::{Parser, Subcommand};
use std::io::{ErrorKind, Write};
use std::process::ExitCode;

/// Ends a command that could not do what it was asked for.
const CANNOT: u8 = 2;

#[derive(Parser)]
#[command(name = "lahar", version, about = "An embeddable material point method engine")]
struct Cli {
    /// Part of the other commands
    #[arg(long, hide = true)]
    inside: bool,
    #[command(subcommand)]
    group: Group,
}

#[derive(Subcommand)]
enum Group {
    /// Looks at constitutive models that come as plugins, checks and times them
    #[command(subcommand)]
    Plugin(Command),
}

#[derive(Subcommand)]
enum Command {
    /// Prints what a plugin says of itself and of its models
    Info(info::Arguments),
    /// Runs the conformance suite in a child process, one line a rule
    Check(check::Arguments),
    /// Prints nanoseconds per point
    Bench(bench::Arguments),
    /// Runs a point that failed in a step again, alone
    Replay(replay::Arguments),
    /// Makes a library that can be loaded of an Abaqus UMAT or VUMAT
    UmatBuild(umat_build::Arguments),
    /// Part of check
    #[command(hide = true)]
    CheckChild(check::child::Arguments),
}

fn main() -> ExitCode {
    let Cli { inside, group: Group::Plugin(command) } = Cli::parse();
    let result = match command {
        Command::Info(_) | Command::Bench(_) if !inside => inside::watched(),
        Command::Check(_) | Command::Replay(_) if !inside => inside::instead(),
        Command::Info(arguments) => info::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Replay(arguments) => replay::run(&arguments),
        Command::UmatBuild(arguments) => umat_build::run(&arguments),
        Command::CheckChild(arguments) => check::child::run(&arguments),
    };
    result.unwrap_or_else(|text| {
        eprintln!("error: {text}");
        ExitCode::from(CANNOT)
    })
}

/// Prints text. That a reader has gone away, as `head` does, is no error.
fn say(text: &str) {
    if let Err(e) = std::io::stdout().write_all(text.as_bytes())
        && e.kind() != ErrorKind::BrokenPipe
    {
        eprintln!("error: standard output: {e}");
    }
}
