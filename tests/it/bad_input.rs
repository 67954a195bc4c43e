//! Bad input from C: `tests/c/null_arguments.c`, `bad_input.c`, `bad_methods.c` and
//! `bad_conditions.c` beside it.

use super::compiler::{program, read, run};
use super::header::{is_pointer, prototypes};
use super::support::{bad_plugin, plugin_path, repository};
use std::collections::BTreeSet;
use std::process::Command;

#[test]
fn null_is_refused_or_allowed_for_every_pointer_and_nothing_changes() {
    let program = program(&repository("tests/c/null_arguments.c"));
    run(Command::new(program).arg(plugin_path("linear_elastic")));
}

#[test]
fn the_null_tests_go_through_every_pointer_of_the_header() {
    let source = read("tests/c/null_arguments.c");
    let in_tests: BTreeSet<(String, String)> = source
        .lines()
        .filter_map(|line| line.trim().strip_prefix("NULL_")?.split_once('(')?.1.split_once(", ("))
        .filter_map(|(names, _)| names.split_once(", "))
        .map(|(function, argument)| (function.to_string(), argument.to_string()))
        .collect();
    // These two are checked without the macros, since they must not replace the last error.
    let apart = |f: &str, a: &str| {
        (f, a) == ("lahar_last_error_info", "info")
            || (f, a) == ("lahar_context_error_message", "context")
    };
    let in_header: BTreeSet<(String, String)> = prototypes()
        .into_iter()
        .flat_map(|(f, arguments)| {
            arguments.into_iter().filter(|a| is_pointer(a)).map(move |a| (f.clone(), name_of(&a)))
        })
        .filter(|(f, a)| !apart(f, a))
        .collect();
    assert!(in_header.len() > 100, "only {} pointers were found", in_header.len());
    assert_eq!(in_tests, in_header);
}

fn name_of(argument: &str) -> String {
    let name = argument.split(['*', ' ']).next_back().unwrap_or_default();
    name.split('[').next().unwrap_or_default().to_string()
}

#[test]
fn bad_conditions_are_answered_before_the_first_step() {
    let program = program(&repository("tests/c/bad_conditions.c"));
    run(Command::new(program).arg(plugin_path("linear_elastic")));
}

#[test]
fn methods_that_do_not_go_together_are_refused_with_the_nearest_that_do() {
    let program = program(&repository("tests/c/bad_methods.c"));
    run(Command::new(program).arg(plugin_path("linear_elastic")));
}

#[test]
fn every_kind_of_bad_input_is_answered_and_changes_nothing() {
    let mut command = Command::new(program(&repository("tests/c/bad_input.c")));
    command.arg(plugin_path("linear_elastic"));
    command.args(["nan_model", "failing_model", "wrong_major"].map(bad_plugin));
    run(command.arg(repository("Cargo.toml")));
}
