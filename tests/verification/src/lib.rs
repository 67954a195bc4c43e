//! The verification cases of lahar: what an engineer is shown as a table of case, reference, value, error and gate.
//!
//! A case is data: `tests/cases/<case>.json` holds its source, its runs, and the checks with their references and gates. What a
//! run does is the driver of its family, a function from the set-up to named quantities and curves ([`family`]).
//!
//! * [`case`] reads the files, [`run`] runs them side by side, [`judge`] compares with references and gates.
//! * [`known`] says what is known of a run whose method misses its gate.
//! * [`family`] holds the drivers, [`world`] and [`statics`] what they share.
//!
//! `cargo xtask verify` writes the report; the test `cases` runs each case in its small sizes.

pub mod case;
pub mod family;
pub mod homogeneous;
pub mod jet;
pub mod judge;
pub mod known;
pub mod motion;
pub mod run;
pub mod statics;
pub mod world;
