//! Chunks of particles, which threads work on.

use super::{Columns, Layout};
use crate::parallel::Divide;
use crate::simd::{Table, prefetch};

/// Particles in a chunk: its columns and its scratch fit the second-level cache.
pub const CHUNK: usize = 512;

/// Particles in a task, a number of chunks that one thread works through.
const TASK: usize = 2 * CHUNK;

/// The columns of consecutive particles: of a body, of a task, or of a chunk of [`CHUNK`].
pub struct ChunkMut<'a> {
    /// Where the fields stand among the columns.
    pub layout: Layout,
    /// Index of the first particle in its body.
    pub first: usize,
    /// Number of particles.
    pub len: usize,
    table: Table<'a>,
    moved: &'a mut [u64],
}

impl<'a> ChunkMut<'a> {
    /// The first `len` particles of columns with the given stride, and their marks (see
    /// [`Particles::moved`](super::Particles::moved)).
    pub fn new(
        layout: Layout,
        len: usize,
        data: &'a mut [f64],
        stride: usize,
        moved: &'a mut [u64],
    ) -> Self {
        Self { layout, first: 0, len, table: Table::new(data, stride, len), moved }
    }

    /// One component of all particles of the chunk.
    #[inline(always)]
    pub fn column(&self, component: usize) -> &[f64] {
        self.table.column(component)
    }

    /// `N` components from one on.
    #[inline(always)]
    pub fn columns<const N: usize>(&self, first: usize) -> [&[f64]; N] {
        std::array::from_fn(|c| self.column(first + c))
    }

    /// What a gather writes of the particles in `range`, with their marks (see
    /// [`ChunkMut::moved`]).
    #[inline(always)]
    pub fn motion<const D: usize>(&mut self, (first, end_of): (usize, usize)) -> Motion<'_, D> {
        let layout = self.layout;
        let written = [layout.affine, layout.filtered];
        let others = [layout.deformation_gradient, Some(layout.state)];
        let behind = written.iter().chain(&others).flatten().map(|columns| columns.first);
        let end = behind.min().unwrap_or(layout.mass);
        let (motion, rest) = self.table.some_rows(first, end_of - first).split_columns(layout.mass);
        let (position, velocity) = motion.split_columns(layout.velocity);
        let (others, rest) = rest.split_columns(end - layout.mass);
        let (affine, rest, at) = take(rest, end, layout.affine);
        let (filtered, ..) = take(rest, at, layout.filtered);
        Motion {
            position: position.into_columns(),
            velocity: velocity.into_columns(),
            affine: affine.into_matrix(),
            filtered: filtered.into_columns(),
            others,
        }
    }

    /// One component of all particles of the chunk, to write.
    #[inline(always)]
    pub fn column_mut(&mut self, component: usize) -> &mut [f64] {
        self.table.column_mut(component)
    }

    /// Marks the particles k + l that may have left their block, for each bit l of `bits`.
    #[inline(always)]
    pub fn mark_moved(&mut self, k: usize, bits: u8) {
        if bits != 0 {
            let bits = u128::from(bits) << (k % 64); // of two words
            self.moved[k / 64] |= bits as u64;
            if let Some(next) = self.moved.get_mut(k / 64 + 1) {
                *next |= (bits >> 64) as u64;
            }
        }
    }

    /// `N` components of particle k.
    pub fn get<const N: usize>(&self, first: usize, k: usize) -> [f64; N] {
        std::array::from_fn(|c| self.column(first + c)[k])
    }

    /// The first `mid` particles, a multiple of 64, and the others.
    fn split(self, mid: usize) -> (Self, Self) {
        let Self { layout, first, len, table, moved } = self;
        let (table, right) = table.split_rows(mid);
        let (moved, later) = moved.split_at_mut(mid / 64);
        let right = Self { layout, first: first + mid, len: len - mid, table: right, moved: later };
        (Self { layout, first, len: mid, table, moved }, right)
    }

    /// Calls `work` on one chunk of [`CHUNK`] particles after the other.
    pub fn for_each_chunk(self, mut work: impl FnMut(&mut ChunkMut<'_>)) {
        let mut rest = self;
        while rest.len > CHUNK {
            let (mut chunk, later) = rest.split(CHUNK);
            work(&mut chunk);
            rest = later;
        }
        work(&mut rest);
    }
}

/// Takes columns out of a table that begins with column `at`: those, the ones behind, and the column
/// with which these begin. Nothing if there are none.
#[inline(always)]
fn take(table: Table<'_>, at: usize, columns: Option<Columns>) -> (Table<'_>, Table<'_>, usize) {
    let Some(Columns { first, count }) = columns else {
        let (none, rest) = table.split_columns(0);
        return (none, rest, at);
    };
    let (_, table) = table.split_columns(first - at);
    let (taken, rest) = table.split_columns(count);
    (taken, rest, first + count)
}

/// The columns that a gather writes.
pub struct Motion<'a, const D: usize> {
    /// Position [m].
    pub position: [&'a mut [f64]; D],
    /// Velocity [m/s].
    pub velocity: [&'a mut [f64]; D],
    /// Rows of the affine matrix [1/s]; empty if there is none.
    pub affine: [[&'a mut [f64]; D]; D],
    /// Velocity on its way through a filter [m/s]; empty if there is none.
    pub filtered: [&'a mut [f64]; D],
    others: Table<'a>,
}

impl<const D: usize> Motion<'_, D> {
    /// Column c behind the velocity, of the particles of the range.
    #[inline(always)]
    pub fn other(&self, c: usize) -> &[f64] {
        self.others.column(c)
    }

    /// Prefetches the particles from k on: what a gather writes, and what the next stages read.
    #[inline(always)]
    pub fn prefetch(&self, k: usize) {
        for a in 0..D {
            prefetch(self.position[a], k);
            prefetch(self.velocity[a], k);
            for column in &self.affine[a] {
                prefetch(column, k);
            }
        }
        for c in 0..self.others.columns() {
            prefetch(self.others.column(c), k);
        }
    }
}

/// Tasks of at most 1024 particles: which particles belong to one does not depend on the number of
/// threads.
impl Divide for ChunkMut<'_> {
    fn divide(self) -> (Self, Option<Self>) {
        if self.len <= TASK {
            return (self, None);
        }
        let mid = (self.len / 2).next_multiple_of(TASK);
        let (left, right) = self.split(mid);
        (left, Some(right))
    }
}
