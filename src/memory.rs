//! Memory that may be large: reserved before it is used, so that there being none is an error.
//!
//! Rust ends the process if an allocation fails that nobody tried, and what libraries and messages
//! need cannot be tried. So a call first makes sure that [`SPARE`] bytes can be had, and every
//! reservation leaves as many: what is not tried is small, and comes from them.

use crate::error::{Error, Result, Status};
use crate::simd::LANES;

const ALIGN: usize = 64;

/// Bytes that a call may use without a reservation: for messages, handles, short lists, and what
/// libraries need for themselves.
pub const SPARE: usize = 64 << 10;

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
    if list.capacity() - list.len() >= more {
        return Ok(());
    }
    beside_spare(|| list.try_reserve(more)).ok_or_else(|| no_memory::<T>(more, what))
}

/// Makes room for `all` elements in all and not more, or reports that there is none.
pub fn reserve_exact<T>(list: &mut Vec<T>, all: usize, what: &str) -> Result<()> {
    let more = all.saturating_sub(list.len());
    if list.capacity() - list.len() >= more {
        return Ok(());
    }
    beside_spare(|| list.try_reserve_exact(more)).ok_or_else(|| no_memory::<T>(more, what))
}

/// A list of what an iterator of known length gives, or the report that there is no memory.
pub fn collect<T>(
    items: impl IntoIterator<Item = T, IntoIter: ExactSizeIterator>,
    what: &str,
) -> Result<Vec<T>> {
    let (mut list, items) = (Vec::new(), items.into_iter());
    reserve_exact(&mut list, items.len(), what)?;
    list.extend(items);
    Ok(list)
}

/// Makes sure that `bytes` can be had: to be called before what cannot be tried one by one.
pub fn ensure(bytes: usize, what: &str) -> Result<()> {
    let mut all = Vec::<u8>::new();
    let tried = beside_spare(|| all.try_reserve_exact(bytes));
    std::hint::black_box(all); // which must not be optimised away
    tried.ok_or_else(|| no_memory::<u8>(bytes, what))
}

/// The same for what is filled at once: also against the memory that is free, which an address space
/// may exceed, where the system tells it.
pub fn ensure_free(bytes: usize, what: &str) -> Result<()> {
    match free_kilobytes() {
        Some(free) if bytes / 1024 > free => Err(no_memory::<u8>(bytes, what)),
        _ => ensure(bytes, what),
    }
}

/// Memory that can be had without swapping, on Linux [kB].
fn free_kilobytes() -> Option<usize> {
    let all = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = all.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    line.split_whitespace().next()?.parse().ok()
}

/// Whether the spare memory can be had.
pub fn has_spare() -> bool {
    beside_spare(|| Ok::<(), ()>(())).is_some()
}

/// Tries an allocation that must leave the spare memory; None if there is not enough for both.
fn beside_spare<E>(allocate: impl FnOnce() -> std::result::Result<(), E>) -> Option<()> {
    let mut spare = Vec::<u8>::new();
    spare.try_reserve_exact(SPARE).ok()?;
    let allocated = allocate().ok();
    std::hint::black_box(spare); // as in `ensure`
    allocated
}

/// Empties a list whose length comes and goes and makes room for `n` elements; if that takes more
/// memory, for twice as many, so that it seldom does.
pub fn refill<T>(list: &mut Vec<T>, n: usize, what: &str) -> Result<()> {
    list.clear();
    if n <= list.capacity() { Ok(()) } else { reserve_exact(list, 2 * n + 16, what) }
}

fn no_memory<T>(more: usize, what: &str) -> Error {
    let megabytes = more as f64 * size_of::<T>() as f64 * 1e-6;
    Error::new(
        Status::OutOfMemory,
        format!(
            "{what} need {megabytes:.1} MB more, which the system does not give: use a larger spacing or fewer particles"
        ),
    )
}

/// Distance between the columns of `n` particles: whole groups of 8, and an odd number of them, so
/// that the columns of a power of two of particles do not fall into the same sets of the cache.
pub const fn stride_of(n: usize) -> usize {
    (n.div_ceil(LANES) | 1) * LANES
}
