//! Memory that may be large: reserved before it is used, so that there being none is an error.

use crate::error::{Error, Result, Status};
use crate::simd::LANES;

const ALIGN: usize = 64;

/// A buffer of doubles whose first element is 64-byte aligned.
#[derive(Debug, Default)]
pub struct Aligned {
    memory: Vec<f64>,
    start: usize,
    len: usize,
}

impl Aligned {
    /// A zeroed buffer of `len` doubles and at least [`LANES`] more behind them, or
    /// [`Status::OutOfMemory`](crate::error::Status::OutOfMemory).
    pub fn zeroed(len: usize) -> Result<Self> {
        let mut memory = Vec::new();
        let all = len + ALIGN / size_of::<f64>() + LANES;
        reserve(&mut memory, all, "the columns of particles")?;
        memory.resize(all, 0.0);
        let start = memory.as_ptr().align_offset(ALIGN);
        Ok(Self { memory, start, len })
    }

    /// The doubles.
    pub fn as_slice(&self) -> &[f64] {
        &self.memory[self.start..self.start + self.len]
    }

    /// The doubles, and the [`LANES`] or more behind them.
    pub fn with_margin(&self) -> &[f64] {
        &self.memory[self.start..]
    }

    /// Doubles that the memory holds.
    pub fn capacity(&self) -> usize {
        self.memory.len()
    }

    /// The doubles, to write.
    pub fn as_mut_slice(&mut self) -> &mut [f64] {
        &mut self.memory[self.start..self.start + self.len]
    }
}

/// Makes room for `more` elements, or reports that there is none.
pub fn reserve<T>(list: &mut Vec<T>, more: usize, what: &str) -> Result<()> {
    list.try_reserve(more).map_err(|_| no_memory::<T>(more, what))
}

/// Makes room for `all` elements in all and not more, or reports that there is none.
pub fn reserve_exact<T>(list: &mut Vec<T>, all: usize, what: &str) -> Result<()> {
    let more = all.saturating_sub(list.len());
    list.try_reserve_exact(more).map_err(|_| no_memory::<T>(more, what))
}

/// Empties a list whose length comes and goes and makes room for `n` elements; if that takes more
/// memory, for twice as many, so that it seldom does.
pub fn refill<T>(list: &mut Vec<T>, n: usize, what: &str) -> Result<()> {
    list.clear();
    if n <= list.capacity() { Ok(()) } else { reserve_exact(list, 2 * n + 16, what) }
}

fn no_memory<T>(more: usize, what: &str) -> Error {
    let gigabytes = more as f64 * size_of::<T>() as f64 * 1e-9;
    Error::new(
        Status::OutOfMemory,
        format!(
            "{what} need {gigabytes:.1} GB, which the system does not give: use a larger spacing or fewer particles"
        ),
    )
}

/// Distance between the columns of `n` particles: whole groups of 8, and an odd number of them, so
/// that the columns of a power of two of particles do not fall into the same sets of the cache.
pub const fn stride_of(n: usize) -> usize {
    (n.div_ceil(LANES) | 1) * LANES
}
