//! Tasks that need nothing but the standard library, and what all tasks share.
#![allow(clippy::print_stdout, clippy::print_stderr)] // a command line talks to the terminal

pub mod demo;
pub mod process;
pub mod setup;
pub mod test;

/// All tasks, with what they do.
pub const TASKS: [(&str, &str); 9] = [
    ("setup", "finds what is missing on Debian 12 and installs it, or prints the line that does"),
    ("demo", "builds lahar, runs a sand column collapse from C and draws it"),
    ("test", "builds the workspace and runs every test"),
    ("ci", "formatting, lints, headers, bits, counts of instructions, then every test"),
    ("headers", "writes the C headers and the Fortran bindings from the Rust sources"),
    ("instructions", "counts the instructions of a step, against benches/instructions.json"),
    ("bits", "compares the bits of every kernel after 100 steps with benches/bits.json"),
    ("bench", "measures nanoseconds per particle and step"),
    ("verify", "runs the verification cases and writes docs/verification.md"),
];

/// Runs the task that the arguments name.
pub fn run(arguments: &[String]) -> Result<(), String> {
    match arguments.first().map(String::as_str) {
        None | Some("help" | "-h" | "--help") => {
            println!("{}", usage());
            Ok(())
        }
        Some("setup") => setup::run(setup::Need::Tests),
        Some("demo") => demo::run(),
        Some("test") => test::run(),
        Some(task) if TASKS.iter().any(|(name, _)| *name == task) => pass_on(arguments),
        Some(task) => Err(format!("there is no task `{task}`\n\n{}", usage())),
    }
}

fn usage() -> String {
    let line = |(name, what): &(&str, &str)| format!("\n    {name:<14}{what}");
    let tasks: String = TASKS.iter().map(line).collect();
    format!("cargo xtask <task>, `cargo xtask <task> --help` for its options:\n{tasks}")
}

/// The package xtask has the tasks that need the engine, or crates for reports and plots.
fn pass_on(arguments: &[String]) -> Result<(), String> {
    let start = ["run", "--release", "--package", "xtask", "--"];
    process::cargo(
        &start.into_iter().chain(arguments.iter().map(String::as_str)).collect::<Vec<_>>(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_task_is_answered_with_the_known_ones() {
        let error = run(&["dmeo".to_string()]).expect_err("no such task");
        assert!(error.contains("`dmeo`") && error.contains("demo"), "{error}");
    }
}
