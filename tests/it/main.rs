//! The integration tests, one binary: each module is one concern.

mod bad_input;
mod compiler;
mod fortran;
mod header;
mod host;
mod readme;
mod tidy;
mod setup;
mod kernels;
mod invariants;
mod plugins;
mod support;
