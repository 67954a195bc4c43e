//! The sparse background grid: blocks of 4^D nodes that appear where particles are and vanish behind them.

pub mod blocks;
pub mod index;
pub mod key;
pub mod tiles;

pub use blocks::{Grid, GridStats, NONE};
pub use key::{EDGE, Key};
pub use tiles::{Run, TileNode, Tiles};

use crate::error::{Error, Result};

/// Four lanes of a node: [m, mv] or [m, v] or [–, f]; in two dimensions the last lane is zero.
pub type Lanes = [f64; 4];

/// Room to make for the nodes of `n` blocks or tiles, whose number comes and goes: an eighth to a half more, so that it seldom grows. It
/// depends on n alone, not on how many there were before.
pub fn room(n: usize) -> usize {
    (n + n / 8).next_multiple_of((n.next_power_of_two() / 8).max(8))
}

/// How blocks come and go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum GridPolicy {
    /// Blocks appear with particles and vanish behind them.
    Dynamic = 0,
    /// Blocks appear with particles and stay.
    GrowOnly = 1,
    /// The blocks of a box exist from the start; particles outside it are an error.
    Static = 2,
}

impl GridPolicy {
    /// The policy with this number.
    pub fn from_i32(value: i32) -> Result<Self> {
        match value {
            0 => Ok(Self::Dynamic),
            1 => Ok(Self::GrowOnly),
            2 => Ok(Self::Static),
            _ => Err(Error::invalid(format!(
                "grid_policy must be 0 (dynamic), 1 (grow only) or 2 (static), got {value}"
            ))),
        }
    }
}
