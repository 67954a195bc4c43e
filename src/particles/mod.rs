//! Particles of a body: one column of doubles per component, all in one aligned allocation.
//!
//! Component `c` of the columns and particle `k` stand at `data[c * stride + k]`; the same memory
//! is what hosts see through views, what the stages work on in chunks, and what a sort permutes.

mod body;
pub mod chunk;
pub mod dilations;
pub mod fields;
pub mod inputs;
pub mod moves;
pub mod seeding;

pub use body::{Body, Sizes};
pub use chunk::{CHUNK, ChunkMut, Motion};
pub use dilations::Dilations;
pub use fields::{Carrier, Columns, FieldInfo, Layout, Rule};
pub use moves::{BodyMoves, Moves, MovesEnd, RunStart, Segment, in_order};

use crate::error::Result;
use crate::memory::{Aligned, reserve, stride_of};
use crate::parallel::{Cut, Team};
use crate::simd::{LANES, prefetch};

/// Prefetch distance of moves [segments].
const AHEAD: usize = 8;

/// Particles of a segment that are prefetched; the processor prefetches the others by itself.
const FETCHED: u32 = 512;

/// The particles of one body.
#[derive(Debug)]
pub struct Particles {
    /// Where each field starts among the columns.
    pub layout: Layout,
    /// Persistent ids, in storage order: the position at which the host gave the particle.
    pub id: Vec<i64>,
    /// Bit k % 64 of word k / 64 is set if particle k may have left its block since particles were
    /// last sorted into blocks. Chunks of a multiple of 64 particles have words of their own.
    pub moved: Vec<u64>,
    stride: usize,
    data: Aligned,
    scratch: Aligned,
}

impl Particles {
    /// `count` particles with all columns zero and ids 0, 1, ...
    pub fn new(layout: Layout, count: usize) -> Result<Self> {
        let stride = stride_of(count);
        let mut id = Vec::new();
        reserve(&mut id, count, "the ids of particles")?;
        id.extend(0..count as i64);
        let mut moved = Vec::new();
        reserve(&mut moved, count.div_ceil(64), "the marks of moved particles")?;
        moved.resize(count.div_ceil(64), 0);
        Ok(Self {
            data: Aligned::zeroed(stride * layout.components())?,
            scratch: Aligned::zeroed(stride)?,
            id,
            moved,
            layout,
            stride,
        })
    }

    /// The same particles with other columns: `pairs` of columns from these and in the layout.
    pub fn with_layout(
        &self,
        layout: Layout,
        pairs: impl Iterator<Item = (usize, usize)>,
    ) -> Result<Self> {
        let mut new = Self::new(layout, self.len())?;
        new.id.copy_from_slice(&self.id);
        new.moved.copy_from_slice(&self.moved);
        for (from, to) in pairs {
            new.column_mut(to).copy_from_slice(self.column(from));
        }
        Ok(new)
    }

    /// Copies all columns.
    pub fn copy_columns(&self, copy: &mut Vec<f64>) -> Result<()> {
        copy.clear();
        reserve(copy, self.data.as_slice().len(), "the start of a step")?;
        copy.extend_from_slice(self.data.as_slice());
        Ok(())
    }

    /// Takes all columns from a copy that was made since particles were last sorted into blocks.
    pub fn restore_columns(&mut self, copy: &[f64]) {
        self.data.as_mut_slice().copy_from_slice(copy);
        self.moved.fill(0);
    }

    /// What the averaging of F-bar takes; None for a body without it.
    pub fn dilations<const D: usize>(&mut self) -> Option<Dilations<'_, D>> {
        let (layout, stride, n) = (self.layout, self.stride, self.len());
        let first = layout.dilation?.first;
        let (before, rates) = self.data.as_mut_slice().split_at_mut(first * stride);
        let column = |c: usize| &before[c * stride..][..n];
        let position = std::array::from_fn(|d| column(layout.position + d));
        Some(Dilations::new(position, column(layout.volume), &mut rates[..n]))
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.id.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.id.is_empty()
    }

    /// Distance between the components of a field in memory.
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// One component of all particles.
    pub fn column(&self, component: usize) -> &[f64] {
        &self.data.as_slice()[component * self.stride..][..self.len()]
    }

    /// One component of all particles, to write.
    pub fn column_mut(&mut self, component: usize) -> &mut [f64] {
        let (stride, n) = (self.stride, self.len());
        &mut self.data.as_mut_slice()[component * stride..][..n]
    }

    /// Consecutive components, with the padding between them.
    pub fn columns(&self, first: usize, components: usize) -> &[f64] {
        &self.data.as_slice()[first * self.stride..(first + components) * self.stride]
    }

    /// Some components in a row, with the padding between them, to write.
    pub fn columns_mut(&mut self, first: usize, components: usize) -> &mut [f64] {
        &mut self.data.as_mut_slice()[first * self.stride..(first + components) * self.stride]
    }

    /// The ids, and some components in a row to write.
    pub fn ids_and_columns_mut(&mut self, first: usize, components: usize) -> (&[i64], &mut [f64]) {
        let columns = first * self.stride..(first + components) * self.stride;
        (&self.id, &mut self.data.as_mut_slice()[columns])
    }

    /// `N` components of the particles `first..end`, each followed by [`LANES`] more doubles, so
    /// that eight can be read at a time.
    pub fn read<const N: usize>(&self, component: usize, first: usize, end: usize) -> [&[f64]; N] {
        let data = self.data.with_margin();
        let column = |c: usize| &data[c * self.stride..][first..end + LANES];
        std::array::from_fn(|c| column(component + c))
    }

    /// `N` components of particle k.
    #[inline(always)]
    pub fn get<const N: usize>(&self, first: usize, k: usize) -> [f64; N] {
        let data = self.data.as_slice();
        std::array::from_fn(|c| data[(first + c) * self.stride + k])
    }

    /// The ids, and the whole table as a chunk, to be split among threads.
    pub fn ids_and_chunk(&mut self) -> (&[i64], ChunkMut<'_>) {
        let n = self.len();
        let data = self.data.as_mut_slice();
        (&self.id, ChunkMut::new(self.layout, n, data, self.stride, &mut self.moved))
    }

    /// The columns of the positions, and the marks of moved particles, to write.
    pub fn positions_and_moved<const D: usize>(&mut self) -> ([&[f64]; D], &mut [u64]) {
        let (data, n) = (self.data.as_slice(), self.id.len());
        let column = |d: usize| &data[(self.layout.position + d) * self.stride..][..n];
        (std::array::from_fn(column), &mut self.moved)
    }

    /// Carries out moves of particles; several threads move a column each.
    pub fn rearrange(&mut self, moves: BodyMoves<'_>, team: &Team) {
        let (stride, single) = (self.stride, moves.from.len().max(1));
        if moves.from.is_empty() && moves.segments.is_empty() {
            return;
        }
        let scratch = self.scratch.as_mut_slice();
        let data = self.data.as_mut_slice();
        let columns = data.len() / stride;
        let at_a_time = if team.is_together() { columns.min(stride / single) } else { 1 };
        let group = stride * columns.div_ceil(at_a_time);
        let slices = (Cut(&mut data[..], group), Cut(&mut scratch[..], single));
        team.for_each_piece(slices, 1, |_, (columns, scratch)| {
            for column in columns.chunks_exact_mut(stride) {
                move_all(column, scratch, moves, |x| x, |x| x);
            }
        });
        let (pack, unpack) = (|id| f64::from_bits(id as u64), |x: f64| x.to_bits() as i64);
        move_all(&mut self.id, scratch, moves, pack, unpack);
    }

    /// Memory of the columns [bytes].
    pub fn bytes(&self) -> usize {
        let doubles = self.data.capacity() + self.scratch.capacity();
        (doubles + self.id.len() + self.moved.len()) * size_of::<f64>()
    }
}

/// Carries out the moves of one column, whose elements are packed into doubles for a while.
#[inline(always)]
fn move_all<T: Copy>(
    column: &mut [T],
    scratch: &mut [f64],
    BodyMoves { from, to, segments }: BodyMoves<'_>,
    pack: impl Fn(T) -> f64,
    unpack: impl Fn(f64) -> T,
) {
    for (mover, from) in scratch.iter_mut().zip(from) {
        *mover = pack(column[*from as usize]);
    }
    for (s, Segment { from, to, len }) in segments.iter().enumerate() {
        if let Some(next) = segments.get(s + AHEAD) {
            for k in (0..next.len.min(FETCHED)).step_by(LANES) {
                prefetch(column, (next.from + k) as usize);
                prefetch(column, (next.to + k) as usize);
            }
        }
        column.copy_within(*from as usize..(from + len) as usize, *to as usize);
    }
    for (to, mover) in to.iter().zip(scratch) {
        column[*to as usize] = unpack(*mover);
    }
}
