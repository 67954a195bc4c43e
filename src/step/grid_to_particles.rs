//! Stage 5, grid to particles: v_p from the transfer scheme, x_p += dt Σ w v, ∇v_p = Σ v ⊗ ∇w.
//!
//! The mirror image of the scatter: a node has eight lanes, two of its records, and with the
//! weights w_n and the pairs c_n of an axis (see [`weights`](crate::shape::weights)) one pass over
//! rows, planes and stencil gives Σ w R of both and, along each axis, Σ r w or Σ ∂w of each.
//! [`GatherJob::second`] and [`GatherJob::gradient_lane`] give the record of each half. Cost per
//! particle, quadratic in 3D: 62 products and 36 sums of eight lanes, 27 nodes read, 3 doubles read
//! and 24 written.

use std::marker::PhantomData;

use super::parts::Method;
use super::pass::{ChunkWork, Copied, Pass};
use crate::background::nodes::{FIRST, SECOND};
use crate::background::tiles::{TileNode, load_tile};
use crate::background::{Background, Blocks, EDGE, Key, Record, Run};
use crate::particles::{CHUNK, ChunkMut, Motion};
use crate::shape::modified::is_modified;
use crate::shape::stencil::{At, ShapeFunction, Stencil};
use crate::shape::weights::{Axes, BATCH, GROUPS, Weights, corners, span};
use crate::simd::{Kernel, LANES, Vector, each};
use crate::transfer::{Received, TransferKind, apic, pic_flip};

/// What a gather updates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gather {
    /// Velocity, position and gradient, all from R0.
    Everything,
    /// The velocity alone, from R0 and its increment R1 (first gather of MUSL).
    Velocity,
    /// Position from R0, gradient from the second velocities in R1 (last gather of MUSL).
    PositionAndGradient,
    /// The gradient alone, from R0 (first gather of USF).
    Gradient,
    /// The gradient alone, from the second velocities in R1.
    SecondGradient,
    /// Velocity and position, as [`Gather::Everything`] without the gradient (last gather of USF).
    Motion,
    /// Σ w R1, to be mapped to the grid again by a filter.
    Filter,
}

impl Gather {
    /// Whether particles take a velocity.
    const fn velocity(self) -> bool {
        matches!(self, Self::Everything | Self::Velocity | Self::Motion)
    }

    /// Whether particles move.
    const fn position(self) -> bool {
        matches!(self, Self::Everything | Self::PositionAndGradient | Self::Motion)
    }

    /// Whether velocity gradients are wanted.
    const fn gradient(self) -> bool {
        matches!(self, Self::Everything | Self::Gradient) || self.second()
    }

    /// Whether the gradient is that of R1.
    const fn second(self) -> bool {
        matches!(self, Self::PositionAndGradient | Self::SecondGradient)
    }
}

/// Everything a gather needs beside the chunk.
struct GatherJob<'a, const D: usize> {
    background: &'a Background<D>,
    /// The runs that the chunk touches.
    runs: &'a [Run],
    what: Gather,
    transfer: TransferKind,
    /// Share of PIC in this step [–].
    pic_share: f64,
    /// The step [s].
    dt: f64,
    /// Distance between components of the gradient.
    stride: usize,
    /// Where the sizes of the particles start among the columns behind the velocity.
    size: usize,
    /// Whether x is a radius, and the gradient has a hoop component v_r / r.
    axisymmetric: bool,
}

impl<'a, const D: usize> GatherJob<'a, D> {
    /// The record in the last four lanes of a node: affine transfers take moment and gradient of R0
    /// at once, the others need R1 (FLIP its increment, MUSL its second velocity).
    fn second(&self) -> &'a [Record] {
        if self.transfer.is_affine() && !self.what.second() {
            &self.background.nodes.velocity
        } else {
            &self.background.nodes.increment
        }
    }

    /// The first lane of the slopes that hold the velocity gradient.
    #[inline(always)]
    fn gradient_lane(&self) -> usize {
        if self.transfer.is_affine() || self.what.second() { SECOND } else { FIRST }
    }
}

/// Updates the particles of a chunk from the grid and leaves their velocity gradients in the
/// chunk's scratch; `runs` are those of the body.
pub fn gather<S: ShapeFunction<N>, const N: usize, const D: usize>(
    work: &mut ChunkWork<'_, '_>,
    (background, runs): (&Background<D>, &[Run]),
    copied: &mut Copied<'_>,
    method: &Method<D>,
    pass: &Pass,
) {
    let ChunkWork { chunk, scratch, .. } = work;
    if D == 2 {
        for c in [2, 5, 6, 7, 8] {
            scratch.velocity_gradient[c * scratch.stride..][..scratch.stride].fill(0.0);
        }
    }
    let start = runs.partition_point(|run| run.end as usize <= chunk.first);
    let job = GatherJob {
        background,
        runs: &runs[start..],
        what: pass.gather,
        transfer: method.options.transfer,
        pic_share: pic_flip::pic_share(method.options.pic_rate, pass.dt),
        dt: pass.dt,
        stride: scratch.stride,
        size: chunk.layout.size.map_or(0, |size| size.first - chunk.layout.mass),
        axisymmetric: method.options.axisymmetric,
    };
    let gradient = &mut *scratch.velocity_gradient;
    method.isa.dispatch(GatherChunk::<S, N, D>(&job, copied, chunk, gradient, PhantomData));
}

struct GatherChunk<'a, 'b, 'c, S, const N: usize, const D: usize>(
    &'a GatherJob<'a, D>,
    &'a mut Copied<'b>,
    &'a mut ChunkMut<'c>,
    &'a mut [f64],
    PhantomData<S>,
);

impl<S: ShapeFunction<N>, const N: usize, const D: usize> Kernel
    for GatherChunk<'_, '_, '_, S, N, D>
{
    type Output = ();
    #[inline(always)]
    fn run<V: Vector>(self) {
        let Self(job, Copied { tile, block }, chunk, gradient, _) = self;
        let Background { blocks, nodes, .. } = job.background;
        let mut batch = Batch::<N, D>::new();
        let mut taken = Taken::new();
        let (first, end) = (chunk.first, chunk.first + chunk.len);
        for run in job.runs.iter().take_while(|run| (run.first as usize) < end) {
            if block.replace(run.block) != Some(run.block) {
                let second = job.second();
                load_tile::<V, D>((blocks, nodes), second, run.block, EDGE + N - 1, tile);
            }
            let key = blocks.keys()[run.block as usize];
            let range = (first.max(run.first as usize) - first, end.min(run.end as usize) - first);
            let mut marks = [0; CHUNK / LANES];
            let mut motion = chunk.motion::<D>(range);
            let mut gradient = Gradient::new(gradient, job.stride, range);
            for start in (0..range.1 - range.0).step_by(BATCH) {
                let count = BATCH.min(range.1 - range.0 - start);
                batch.set::<V, S>(job, &motion, key, (start, count));
                batch.take(tile, count, &mut taken);
                for k in (start..start + count).step_by(LANES) {
                    let received = taken.received(job, (k - start) / LANES);
                    let end = (start + count).min(k + LANES);
                    let out = (&mut motion, &mut gradient);
                    marks[k / LANES] = if end == k + LANES {
                        // of known length
                        store::<V, S, N, D>(job, key, &received, out, (k, k + LANES))
                    } else {
                        store::<V, S, N, D>(job, key, &received, out, (k, end))
                    };
                }
            }
            for (n, mark) in marks.iter().take((range.1 - range.0).div_ceil(LANES)).enumerate() {
                chunk.mark_moved(range.0 + n * LANES, *mark);
            }
        }
    }
}

/// The velocity gradient of the particles in a range: its rows, and its last component, which is
/// that of the hoop in axial symmetry.
struct Gradient<'a, const D: usize> {
    rows: [[&'a mut [f64]; D]; D],
    hoop: &'a mut [f64],
}

impl<'a, const D: usize> Gradient<'a, D> {
    fn new(gradient: &'a mut [f64], stride: usize, (first, end): (usize, usize)) -> Self {
        let (gradient, hoop) = gradient.split_at_mut(if D == 2 { 8 * stride } else { 9 * stride });
        let hoop = if D == 2 { &mut hoop[first..end] } else { hoop };
        let mut rows = gradient.chunks_mut(3 * stride);
        let rows = std::array::from_fn(|_| {
            let mut row = rows.next().unwrap_or_default().chunks_exact_mut(stride);
            std::array::from_fn(|_| &mut row.next().unwrap_or_default()[first..end])
        });
        Self { rows, hoop }
    }
}

/// Prefetch distance of the columns, here and in the stages that follow [particles].
const AHEAD: usize = 64;

/// Stencils of a batch.
struct Batch<const N: usize, const D: usize> {
    weights: [Weights<N, D>; GROUPS],
    corners: [[u32; LANES]; GROUPS],
}

impl<const N: usize, const D: usize> Batch<N, D> {
    #[inline(always)]
    fn new() -> Self {
        Self { weights: [const { Weights::ZERO }; GROUPS], corners: [[0; LANES]; GROUPS] }
    }

    #[inline(always)]
    fn set<V: Vector, S: ShapeFunction<N>>(
        &mut self,
        job: &GatherJob<'_, D>,
        motion: &Motion<'_, D>,
        key: Key<D>,
        (start, count): (usize, usize),
    ) {
        for g in 0..count.div_ceil(LANES) {
            let k = start + g * LANES;
            let end = (start + count).min(k + LANES);
            motion.prefetch(k + AHEAD);
            let x: [V; D] = each!(d in D => V::load(&motion.position[d][k..end]));
            let mut size = [V::splat(0.0); D];
            if S::SIZED {
                size = each!(d in D => V::load(&motion.other(job.size + d)[k..end]));
            }
            let stencil = Stencil::<V, N, D>::of_particles::<S>(&job.background.space, x, size);
            self.weights[g].set(&stencil, job.transfer.is_affine());
            self.corners[g] = corners(&stencil, key);
        }
    }

    /// What the particles take from the nodes of their stencils.
    #[inline(always)]
    fn take<V: Vector>(&self, tile: &[TileNode], count: usize, taken: &mut Taken<V, D>) {
        for p in 0..count {
            let (g, l) = (p / LANES, p % LANES);
            let nodes = &tile[self.corners[g][l] as usize..][..span(N, D)];
            let (sum, slopes) = collect(nodes, &self.weights[g].axes(l));
            taken.sums[g][l] = sum;
            for d in 0..D {
                taken.slopes[g][d][l] = slopes[d];
            }
        }
    }
}

/// Σ w R and Σ c_d R of a batch: a vector holds the lanes of the nodes, for one particle.
struct Taken<V, const D: usize> {
    sums: [[V; LANES]; GROUPS],
    slopes: [[[V; LANES]; D]; GROUPS],
}

impl<V: Vector, const D: usize> Taken<V, D> {
    #[inline(always)]
    fn new() -> Self {
        let zero = V::splat(0.0);
        Self { sums: [[zero; LANES]; GROUPS], slopes: [[[zero; LANES]; D]; GROUPS] }
    }

    /// The same for the eight particles of a group: a vector holds one component.
    #[inline(always)]
    fn received(&self, job: &GatherJob<'_, D>, g: usize) -> Received<V, D> {
        let sums = V::transpose(self.sums[g]);
        let mut slopes = [V::transpose(self.slopes[g][0]); D];
        for d in 1..D {
            slopes[d] = V::transpose(self.slopes[g][d]);
        }
        let space = &job.background.space;
        let (h, inverse) = (V::splat(space.spacing), V::splat(space.inverse));
        let second = job.gradient_lane() == SECOND;
        Received {
            velocity: each!(a in D => sums[FIRST + a]),
            increment: each!(a in D => sums[SECOND + a]),
            moment: each!(a in D, b in D => slopes[b][FIRST + a] * h),
            gradient: each!(a in D, b in D => {
                let (low, high) = (slopes[b][FIRST + a], slopes[b][SECOND + a]);
                (if second { high } else { low }) * inverse // [G2P-1]
            }),
        }
    }
}

/// Stores what the particles of a range took. Returns a bit for each that left its block.
#[inline(always)]
fn store<V: Vector, S: ShapeFunction<N>, const N: usize, const D: usize>(
    job: &GatherJob<'_, D>,
    key: Key<D>,
    received: &Received<V, D>,
    (motion, gradient): (&mut Motion<'_, D>, &mut Gradient<'_, D>),
    (k, end): (usize, usize),
) -> u8 {
    let old = each!(a in D => V::load(&motion.position[a][k..end]));
    if job.what.velocity() {
        store_velocity::<V, S, N, D>(job, old, received, motion, (k, end));
    }
    if job.what.gradient() {
        for a in 0..D {
            for b in 0..D {
                received.gradient[a][b].store(&mut gradient.rows[a][b][k..end]);
            }
        }
        if job.axisymmetric {
            let inverse = V::splat(1.0) / old[0];
            if job.gradient_lane() == SECOND {
                (received.increment[0] * inverse).store(&mut gradient.hoop[k..end]);
            } else {
                (received.velocity[0] * inverse).store(&mut gradient.hoop[k..end]); // [AXI-2]
            }
        }
    }
    if job.what == Gather::Filter {
        for a in 0..D {
            received.increment[a].store(&mut motion.filtered[a][k..end]);
        }
    }
    if !job.what.position() {
        return 0;
    }
    let x = each!(a in D => V::splat(job.dt).mul_add(received.velocity[a], old[a])); // [G2P-2]
    for a in 0..D {
        x[a].store(&mut motion.position[a][k..end]);
    }
    outside::<V, S, N, D>(job, key, x, end - k)
}

/// Stores the velocities, and affine matrices, of eight particles at `x`. (Each scheme stores for
/// itself: a choice between values in memory would force the compiler to hold them there instead of
/// in registers.)
#[inline(always)]
fn store_velocity<V: Vector, S: ShapeFunction<N>, const N: usize, const D: usize>(
    job: &GatherJob<'_, D>,
    x: [V; D],
    received: &Received<V, D>,
    motion: &mut Motion<'_, D>,
    (k, end): (usize, usize),
) {
    if job.transfer.is_affine() {
        for a in 0..D {
            received.velocity[a].store(&mut motion.velocity[a][k..end]); // [TRF-1]
        }
        if job.transfer == TransferKind::Tpic {
            for a in 0..D {
                for b in 0..D {
                    received.gradient[a][b].store(&mut motion.affine[a][b][k..end]); // [TRF-4]
                }
            }
            return;
        }
        let mut modified = None;
        if S::MODIFIED {
            let space = &job.background.space;
            let (xi, size) = (space.to_units(x), V::splat(0.0)); // splines have none
            modified = Some(each!(d in D => {
                is_modified::<V, S, N>(&At::along(space, d, xi[d], size))
            }));
        }
        let c = apic::affine(received, S::MOMENT, job.background.space.spacing, modified);
        for a in 0..D {
            for b in 0..D {
                c[a][b].store(&mut motion.affine[a][b][k..end]);
            }
        }
    } else if job.transfer.is_filtered() {
        for a in 0..D {
            received.increment[a].store(&mut motion.velocity[a][k..end]); // [TRF-6]
        }
    } else {
        let old = each!(a in D => V::load(&motion.velocity[a][k..end]));
        let v = pic_flip::velocity(old, received, job.pic_share);
        for a in 0..D {
            v[a].store(&mut motion.velocity[a][k..end]);
        }
    }
}

/// Bit l is set if particle l of `count` is not in the block of its run any more.
#[inline(always)]
fn outside<V: Vector, S: ShapeFunction<N>, const N: usize, const D: usize>(
    job: &GatherJob<'_, D>,
    key: Key<D>,
    x: [V; D],
    count: usize,
) -> u8 {
    let space = &job.background.space;
    let starts = if S::MODIFIED {
        space.starts(x)
    } else {
        let xi = space.to_units(x);
        each!(d in D => xi[d] - V::splat(space.first_offset))
    };
    let mut inside = u8::MAX;
    for d in 0..D {
        let lowest = f64::from(key.at[d]) * EDGE as f64;
        let (low, high) = (V::splat(lowest), V::splat(lowest + EDGE as f64));
        inside &= !starts[d].less_than(low) & starts[d].less_than(high);
    }
    !inside & first_lanes(count)
}

/// A bit for each of the first `count` lanes, of which there is at least one.
#[inline(always)]
fn first_lanes(count: usize) -> u8 {
    u8::MAX >> (LANES - count)
}

/// Σ w R and, for each axis d, Σ c_d R over the nodes of a stencil, in units of the spacing.
#[inline(always)]
fn collect<V: Vector, const N: usize, const D: usize>(
    nodes: &[TileNode],
    axes: &Axes<V, N, D>,
) -> (V, [V; D]) {
    let edge = EDGE + N - 1;
    let zeros = [V::splat(0.0); N];
    let (mut planes, mut along_y, mut along_z) = (zeros, zeros, zeros);
    for i in 0..N {
        if D == 2 {
            (planes[i], along_y[i]) = axes.collect(1, load_row(&nodes[i * edge..][..N]));
        } else {
            let (mut rows, mut slopes) = (zeros, zeros);
            for j in 0..N {
                let row = load_row(&nodes[(i * edge + j) * edge..][..N]);
                (rows[j], slopes[j]) = axes.collect(D - 1, row);
            }
            (planes[i], along_y[i]) = axes.collect(1, rows);
            along_z[i] = axes.sum(1, slopes);
        }
    }
    let (sum, along_x) = axes.collect(0, planes);
    let mut slopes = [along_x; D];
    slopes[1] = axes.sum(0, along_y);
    if D == 3 {
        slopes[D - 1] = axes.sum(0, along_z);
    }
    (sum, slopes)
}

#[inline(always)]
fn load_row<V: Vector, const N: usize>(nodes: &[TileNode]) -> [V; N] {
    each!(n in N => V::load_node(&nodes[n]))
}

/// Nodes of a stencil that a point sees in a layer: calls `visit` with node number and weight;
/// false if a node is missing.
pub fn for_stencil_nodes<S: ShapeFunction<N>, const N: usize, const D: usize>(
    blocks: &Blocks<D>,
    layer: u32,
    at: [At<f64>; D],
    visit: &mut dyn FnMut(usize, f64),
) -> bool {
    let mut complete = true;
    Stencil::<f64, N, D>::new::<S>(at).nodes(|index, w, _| match blocks.find_node(layer, index) {
        Some(node) => visit(node, w),
        None => complete = false,
    });
    complete
}
