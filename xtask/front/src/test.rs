//! `cargo xtask test`: every test.

use crate::{process, setup};

/// Every test, on the release profile: the drivers and the plugins come from the same build.
///
/// nextest is faster and shows more, but is built for up to half an hour where it is missing: cargo
/// itself runs the same tests. The documentation's examples run first, so that the last lines are
/// the summary of nextest, which does not run them.
pub fn run() -> Result<(), String> {
    setup::run(setup::Need::Tests)?;
    process::cargo(&["build", "--release", "--workspace"])?;
    if !process::succeeds("cargo", &["nextest", "--version"]) {
        println!(
            "cargo-nextest is missing: `cargo test` runs the same tests, one binary after the other \
             (`cargo install cargo-nextest --locked`, or https://nexte.st for a binary, brings it)"
        );
        return process::cargo(&["test", "--release", "--workspace", "--no-fail-fast"]);
    }
    process::cargo(&["test", "--doc", "--release", "--workspace"])?;
    process::cargo(&["nextest", "run", "--release", "--workspace", "--no-fail-fast"])
}
