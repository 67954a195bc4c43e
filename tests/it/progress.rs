//! Long runs tell how far they are, and can be cancelled.

use std::process::Command;

use crate::compiler::{program, run};
use crate::fortran;
use crate::support::{repository, target_folder};

#[test]
fn a_run_can_be_watched_and_cancelled_from_c() {
    let mut host = Command::new(program(&repository("tests/c/progress.c")));
    run(host.env("LAHAR_PLUGIN_PATH", target_folder()));
}

#[test]
fn a_run_can_be_watched_and_cancelled_from_fortran() {
    let source = repository("tests/fortran/progress.f90");
    let mut host = Command::new(fortran::program(&source, &["-ffpe-trap=invalid,zero,overflow"]));
    assert_eq!(run(host.env("LAHAR_PLUGIN_PATH", target_folder())).trim(), "cancelled");
}
