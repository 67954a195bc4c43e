//! The engine's side of the plugin ABI; all of the engine's `unsafe` that concerns plugins is in
//! this folder.
//!
//! `load` finds and opens a library, `register` takes the entry of a plugin that is linked in,
//! `handshake` checks its tables and copies them into safe descriptions, `adapter` calls its
//! functions with batches, `checked` does so on guarded copies where the user asks for it, `host`
//! is the table of functions that a plugin gets.

mod adapter;
mod checked;
mod extensions;
mod handshake;
mod host;
mod load;
mod register;

pub(crate) use adapter::{Functions, Instance};
pub(crate) use checked::checks;
#[cfg(test)]
pub(crate) use handshake::RESERVED;
pub(crate) use load::load;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Held while a function runs that the ABI tags as exclusive: entries, `create`, `destroy`,
/// `check`, `get_extension`.
fn exclusive() -> MutexGuard<'static, ()> {
    static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());
    ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner)
}

pub use register::RustEntry;
pub(crate) use register::{StaticEntry, register};
