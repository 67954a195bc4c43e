//! What a C host may rely on: `tests/c/host.c`.

use super::compiler::{program, run};
use super::support::{plugin_path, repository};
use std::process::Command;

#[test]
fn a_trapping_host_keeps_its_environment_and_frees_handles_in_any_order() {
    let program = program(&repository("tests/c/host.c"));
    run(Command::new(program).arg(plugin_path("linear_elastic")));
}
