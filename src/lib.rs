//! lahar: an embeddable material point method engine.
//!
//! Bodies are clouds of particles that carry mass, momentum, stress and history. In every step the
//! particles give mass and momentum to a background grid, the equation of motion is solved at its
//! nodes, and the particles take velocities and velocity gradients back; constitutive models,
//! loaded as plugins, turn the gradients into stresses. The grid is sparse: blocks of nodes appear
//! where particles are and vanish behind them, so that the domain is unbounded.
//!
//! # Map
//!
//! * [`step`] is the method, one file a stage; [`step::naive`] the same as the textbook writes it.
//! * [`particles`], [`background`]: the data. [`shape`], [`transfer`], [`boundary`]: the methods to
//!   choose from, each choice a list ([`choice`]).
//! * [`material`]: what the engine knows of a constitutive model; `plugin` loads them.
//! * [`world`] owns everything; [`context`] owns threads, log and plugins; `ffi` is the C ABI,
//!   documented in `lahar.h`.
#![deny(missing_docs)]

pub mod background;
pub mod boundary;
pub mod choice;
pub mod context;
pub mod error;
#[doc(hidden)]
pub mod ffi;
mod log;
pub mod material;
pub mod memory;
pub mod output;
mod parallel;
pub mod particles;
mod platform;
mod plugin;
pub mod shape;
pub mod simd;
pub mod step;
pub mod tensor;
pub mod transfer;
pub mod world;
