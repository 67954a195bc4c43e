//! Particles of a body: one column of doubles per component, all in one aligned allocation.
//!
//! Component `c` of the columns and particle `k` stand at `data[c * stride + k]`; the same memory is what hosts see through
//! views, what the stages work on in chunks, and what a sort permutes.

pub mod chunk;
pub mod fields;
pub mod seeding;

pub use chunk::{CHUNK, ChunkMut, for_each_task};
pub use fields::{FieldInfo, Layout};

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
    /// A zeroed buffer of `len` doubles and at least [`LANES`] more behind them, or [`Status::OutOfMemory`](crate::error::Status::OutOfMemory).
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

    /// The doubles, to write.
    pub fn as_mut_slice(&mut self) -> &mut [f64] {
        &mut self.memory[self.start..self.start + self.len]
    }
}

/// Makes room for `more` elements, or says that there is none.
pub fn reserve<T>(list: &mut Vec<T>, more: usize, what: &str) -> Result<()> {
    list.try_reserve(more).map_err(|_| {
        let gigabytes = more as f64 * size_of::<T>() as f64 * 1e-9;
        Error::new(
            Status::OutOfMemory,
            format!("{what} need {gigabytes:.1} GB, which the system does not give: use a larger spacing or fewer particles"),
        )
    })
}

/// Rounds a number of points up to whole groups of 8.
pub const fn padded(n: usize) -> usize {
    n.next_multiple_of(LANES)
}

/// The particles of one body.
#[derive(Debug)]
pub struct Particles {
    /// Where each field starts among the columns.
    pub layout: Layout,
    /// Persistent ids, in storage order: the place in which the host gave the particle.
    pub id: Vec<i64>,
    stride: usize,
    data: Aligned,
    scratch: Aligned,
}

impl Particles {
    /// `count` particles with all columns zero and ids 0, 1, ...
    pub fn new(layout: Layout, count: usize) -> Result<Self> {
        let stride = padded(count);
        let mut id = Vec::new();
        reserve(&mut id, count, "the ids of particles")?;
        id.extend(0..count as i64);
        Ok(Self {
            data: Aligned::zeroed(stride * layout.components())?,
            scratch: Aligned::zeroed(stride)?,
            id,
            layout,
            stride,
        })
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

    /// Some components in a row, with the padding between them.
    pub fn columns(&self, first: usize, components: usize) -> &[f64] {
        &self.data.as_slice()[first * self.stride..(first + components) * self.stride]
    }

    /// Some components in a row, with the padding between them, to write.
    pub fn columns_mut(&mut self, first: usize, components: usize) -> &mut [f64] {
        &mut self.data.as_mut_slice()[first * self.stride..(first + components) * self.stride]
    }

    /// `N` components of the particles `first..end`, each followed by [`LANES`] more doubles, so that eight can be read at a time.
    pub fn read<const N: usize>(&self, component: usize, first: usize, end: usize) -> [&[f64]; N] {
        let data = &self.data.memory[self.data.start..];
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
        (&self.id, ChunkMut::new(self.layout, n, self.data.as_mut_slice(), self.stride))
    }

    /// Puts particle `order[k]` at place k, one column at a time.
    pub fn permute(&mut self, order: &[u32]) {
        let (stride, n) = (self.stride, self.len());
        let scratch = &mut self.scratch.as_mut_slice()[..n];
        for column in self.data.as_mut_slice().chunks_exact_mut(stride) {
            for (to, from) in scratch.iter_mut().zip(order) {
                *to = column[*from as usize];
            }
            column[..n].copy_from_slice(scratch);
        }
        for (to, from) in scratch.iter_mut().zip(order) {
            *to = f64::from_bits(self.id[*from as usize] as u64);
        }
        for (to, from) in self.id.iter_mut().zip(scratch) {
            *to = from.to_bits() as i64;
        }
    }

    /// Memory of the columns [bytes].
    pub fn bytes(&self) -> usize {
        let doubles = self.data.memory.len() + self.scratch.memory.len() + self.id.len();
        doubles * size_of::<f64>()
    }
}
