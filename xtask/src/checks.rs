//! `cargo xtask ci` and `headers`.

use crate::{bits, fortran, headers, instructions};
use xtask_front::{process, setup, test};

/// What runs on every change.
pub fn ci() -> Result<(), String> {
    setup::run(setup::Need::Tests)?;
    process::cargo(&["fmt", "--all", "--check"])?;
    process::cargo(&[
        "clippy",
        "--workspace",
        "--all-targets",
        "--release",
        "--",
        "-D",
        "warnings",
    ])?;
    headers(true)?;
    bits::run(false, false)?;
    instructions::run(false)?;
    test::run()
}

/// The C headers, then the Fortran bindings that are made from them.
pub fn headers(check: bool) -> Result<(), String> {
    headers::run(check)?;
    fortran::run(check)
}
