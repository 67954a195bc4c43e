//! The orders in which a step can go through its stages.

use crate::error::{Error, Result};

/// Where in a step the stress is updated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum StepOrder {
    /// Update stress last.
    Usl = 0,
    /// Modified update stress last: the velocity gradient comes from particle velocities mapped a second time.
    Musl = 1,
    /// Update stress first.
    Usf = 2,
    /// Half of the stress update first, half last.
    Usavg = 3,
}

impl StepOrder {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Usl, Self::Musl, Self::Usf, Self::Usavg];

    /// The order with this number.
    pub fn from_i32(value: i32) -> Result<Self> {
        Self::ALL.into_iter().find(|order| *order as i32 == value).ok_or_else(|| {
            Error::invalid(format!(
                "order must be 0 (USL), 1 (MUSL), 2 (USF) or 3 (USAVG), got {value}"
            ))
        })
    }
}
