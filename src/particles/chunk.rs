//! Runs of particles that threads work on.

use super::Layout;
use crate::parallel::Divide;
use crate::simd::prefetch;

/// Particles in a chunk: its columns and its scratch fit the second-level cache.
pub const CHUNK: usize = 512;

/// Particles in a task, a number of chunks that one thread works through.
const TASK: usize = 2 * CHUNK;

/// Most components that a body can have: those of the engine and 128 of a model's state.
pub const MAX_COMPONENTS: usize = 168;

/// The columns of a run of particles.
pub struct ChunkMut<'a> {
    /// Where each field starts among the columns.
    pub layout: Layout,
    /// Place of the first particle in its body.
    pub first: usize,
    /// Number of particles.
    pub len: usize,
    columns: Columns<'a>,
    moved: &'a mut [u64],
}

type Columns<'a> = [&'a mut [f64]; MAX_COMPONENTS];

impl<'a> ChunkMut<'a> {
    /// The first `len` particles of a table with the given stride, and their marks (see [`Particles::moved`](super::Particles::moved)).
    pub fn new(
        layout: Layout,
        len: usize,
        data: &'a mut [f64],
        stride: usize,
        moved: &'a mut [u64],
    ) -> Self {
        let mut columns = std::array::from_fn(|_| Default::default());
        if stride > 0 {
            for (to, column) in columns.iter_mut().zip(data.chunks_exact_mut(stride)) {
                *to = &mut column[..len];
            }
        }
        Self { layout, first: 0, len, columns, moved }
    }

    /// One component of all particles of the run.
    #[inline(always)]
    pub fn column(&self, component: usize) -> &[f64] {
        self.columns[component]
    }

    /// What a gather writes of the particles in `range`, with their marks (see [`ChunkMut::moved`]).
    pub fn motion<const D: usize>(&mut self, (first, end): (usize, usize)) -> Motion<'_, D> {
        let layout = self.layout;
        let (motion, rest) = self.columns.split_at_mut(layout.mass);
        let (position, velocity) = motion.split_at_mut(layout.velocity);
        let (others, affine) = rest.split_at_mut(layout.affine - layout.mass);
        let (affine, rest) = affine.split_at_mut(layout.filtered - layout.affine);
        let filtered = &mut rest[..layout.deformation_gradient - layout.filtered];
        let mut rows = affine.chunks_exact_mut(D);
        Motion {
            position: parts(position, first, end),
            velocity: parts(velocity, first, end),
            affine: std::array::from_fn(|_| parts(rows.next().unwrap_or_default(), first, end)),
            filtered: parts(filtered, first, end),
            others,
            first,
        }
    }

    /// One component of all particles of the run, to write.
    #[inline(always)]
    pub fn column_mut(&mut self, component: usize) -> &mut [f64] {
        self.columns[component]
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

    /// The run in two, the first part with `mid` particles, a multiple of 64.
    fn split(mut self, mid: usize) -> (Self, Self) {
        let n = self.layout.components();
        let mut right = std::array::from_fn(|_| Default::default());
        for c in 0..n {
            let (a, b) = std::mem::take(&mut self.columns[c]).split_at_mut(mid);
            self.columns[c] = a;
            right[c] = b;
        }
        let (moved, later) = self.moved.split_at_mut(mid / 64);
        self.moved = moved;
        let right = Self {
            moved: later,
            layout: self.layout,
            first: self.first + mid,
            len: self.len - mid,
            columns: right,
        };
        self.len = mid;
        (self, right)
    }

    /// Calls `work` on one chunk of the run after the other.
    pub fn for_each_chunk(self, mut work: impl FnMut(&mut Self)) {
        let (mut rest, mut marks, end) = (self.columns, self.moved, self.first + self.len);
        let columns = std::array::from_fn(|_| Default::default());
        let mut chunk = Self { columns, moved: &mut [], ..self };
        for first in (self.first..end).step_by(CHUNK) {
            (chunk.first, chunk.len) = (first, CHUNK.min(end - first));
            for c in 0..self.layout.components() {
                let (now, later) = std::mem::take(&mut rest[c]).split_at_mut(chunk.len);
                (chunk.columns[c], rest[c]) = (now, later);
            }
            let (now, later) = marks.split_at_mut(chunk.len.div_ceil(64));
            (chunk.moved, marks) = (now, later);
            work(&mut chunk);
        }
    }
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
    others: &'a [&'a mut [f64]],
    first: usize,
}

impl<const D: usize> Motion<'_, D> {
    /// Column c behind the velocity, of the particles of the range.
    #[inline(always)]
    pub fn other(&self, c: usize) -> &[f64] {
        &self.others[c][self.first..]
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
        for column in self.others {
            prefetch(column, self.first + k);
        }
    }
}

/// The elements `first..end` of D columns; empty where there are no columns.
fn parts<'a, const D: usize>(
    columns: &'a mut [&mut [f64]],
    first: usize,
    end: usize,
) -> [&'a mut [f64]; D] {
    let mut columns = columns.iter_mut();
    std::array::from_fn(|_| columns.next().map_or(&mut [][..], |column| &mut column[first..end]))
}

/// Tasks of at most 1024 particles: which particles belong to one does not depend on the number of threads.
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
