//! `lahar plugin umat-build`: makes a library that the UMAT adapter can load of Fortran and C
//! sources.

use crate::say;
use clap::Args;
use lahar_umat::build::{Order, build};
use std::fmt::Write;
use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of `lahar plugin umat-build`.
#[derive(Args)]
pub struct Arguments {
    /// Sources with a UMAT or VUMAT and what it calls: Fortran in fixed form (.f, .for) and free
    /// form (.f90), C (.c), objects (.o)
    #[arg(required = true)]
    sources: Vec<PathBuf>,
    /// The library; else lib<first source>.so in the current folder
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// gfortran, or a compiler that takes its options
    #[arg(long, default_value = "gfortran")]
    compiler: String,
    /// More options for the compiler, behind `--`
    #[arg(last = true)]
    options: Vec<String>,
}

/// Builds the library and says what to do with it.
pub fn run(arguments: &Arguments) -> Result<ExitCode, String> {
    let built = build(&Order {
        sources: arguments.sources.clone(),
        output: arguments.output.clone(),
        compiler: arguments.compiler.clone(),
        options: arguments.options.clone(),
    })?;
    let mut text = built.warnings;
    let library = built.library.display();
    let _ = writeln!(text, "built {library}");
    for note in built.notes {
        let _ = writeln!(text, "note: {note}");
    }
    let sidecar = built.library.with_extension("json");
    if !sidecar.exists() {
        let sidecar = sidecar.display();
        let _ = writeln!(
            text,
            "names, units and bounds of its constants, and the number of its state variables, can stand in {sidecar}"
        );
    }
    say(&text);
    Ok(ExitCode::SUCCESS)
}
