//! The integration tests, one binary: each module is one concern.
#![allow(clippy::print_stdout)] // tests report the figures that they judge

mod columns;
mod compiler;
mod setup;
mod support;

mod bad_input;
mod capsules;
mod checked;
mod conditions;
mod determinism;
mod equations;
mod examples;
mod fortran;
mod fresh;
mod given_stress;
mod header;
mod host;
mod invariants;
mod kernels;
mod loading;
mod many_states;
mod negotiation;
mod objectivity;
mod order;
mod own_material;
mod plugin_tool;
mod plugins;
mod progress;
mod readme;
mod register;
mod retry;
mod sparse_grid;
mod templates;
mod tidy;
mod umat;
mod units;
mod vtp;
mod write_a_material;
