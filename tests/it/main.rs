//! The integration tests, one binary: each module is one concern.

mod bad_input;
mod fortran;
mod header;
mod readme;
mod tidy;
