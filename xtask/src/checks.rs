//! `cargo xtask test`, `ci` and `headers`.

use crate::{bits, fortran, headers, instructions, process, setup};

/// Every test, on the release profile: the drivers and the plugins come from the same build.
///
/// The documentation's examples run first, so that the last lines are the summary of nextest.
pub fn test() -> Result<(), String> {
    setup::run(setup::Need::Tests)?;
    process::cargo(&["build", "--release", "--workspace"])?;
    process::cargo(&["test", "--doc", "--release", "--workspace"])?;
    process::cargo(&["nextest", "run", "--release", "--workspace", "--no-fail-fast"])
}

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
    test()
}

/// The C headers, then the Fortran bindings that are made from them.
pub fn headers(check: bool) -> Result<(), String> {
    headers::run(check)?;
    fortran::run(check)
}
