//! Stage 4c, F-bar: the rate at which particles of a body grow is averaged over patches of the
//! grid, so that nearly incompressible and plastic material does not lock. Bodies without F-bar are
//! skipped.
//!
//! A patch is a cell between nodes, whatever the shape function. Patches between the half-cell
//! planes of quadratic splines would be the cells of their polynomials, but the growth of such a
//! cell is (v₊₁ − v₋₁) / 2: the pressure of every other one would be free of its neighbours.
//! L̄ = L + (⟨tr L⟩ − tr L) I / n with the mean weighted by volume, n = 2 in plane strain, else 3;
//! strain increment, volume and F take L̄. In rates it is the F̄ = (⟨J⟩ / J)^(1/n) F of E. A. de
//! Souza Neto, D. Perić, M. Dutko, D. R. J. Owen, Int. J. Solids Struct. 33 (1996) 3277–3296,
//! doi:10.1016/0020-7683(95)00259-6; for particles: W. M. Coombs, T. J. Charlton, M. Cortis, C. E.
//! Augarde, Comput. Methods Appl. Mech. Engrg. 333 (2018) 1–21, doi:10.1016/j.cma.2018.01.010.

use super::grid_to_particles::Gather;
use super::parts::Method;
use super::pass::{ChunkWork, Pass, Then};
use crate::background::{Background, Blocks, EDGE, Key, Run, Space};
use crate::error::Result;
use crate::memory::{refill, reserve_exact};
use crate::parallel::{Cut, Divide, Team};
use crate::particles::{Body, Dilations};

/// Patches that the particles of a block reach along each axis: their lowest nodes are in the
/// block, or behind it by one.
const REACH: usize = EDGE + 1;

/// Sums over patches, a buffer reused from step to step.
#[derive(Debug, Default)]
pub struct Patches {
    /// For each run of a body and each patch that it reaches: Σ V tr L and Σ V of the run's own
    /// particles.
    sums: Vec<[f64; 2]>,
    /// The run of each slot of the grid.
    runs: Vec<u32>,
}

/// What memory is for, if there is none.
const WHAT: &str = "the averages of F-bar";

/// No run.
const NONE: u32 = u32::MAX;

/// Leaves with every particle of the bodies with F-bar the mean rate of its patch, of the gradient
/// that `gather` takes.
pub fn average_dilation<const D: usize>(
    bodies: &mut [Body],
    background: &Background<D>,
    method: &Method<D>,
    patches: &mut Patches,
    team: &Team,
    gather: Gather,
) {
    if !bodies.iter().any(Body::has_f_bar) {
        return;
    }
    let pass = Pass { gather, dt: 0.0, then: Then::Rates };
    (method.kernels.pass)(bodies, background, method, team, &pass);
    let Background { space, blocks, .. } = background;
    for Body { particles, runs, .. } in bodies {
        let Some(mut particles) = particles.dilations::<D>() else {
            continue;
        };
        patches.collect(space, blocks.keys(), &mut particles, runs, team);
        let whole = Whole { space, blocks, patches };
        team.for_each(Sharing { particles, runs, first: 0 }, |part| whole.share(part));
    }
}

/// Turns the velocity gradients of a chunk into those of F-bar.
pub fn share_dilation<const D: usize>(work: &mut ChunkWork<'_, '_>, axisymmetric: bool) {
    let ChunkWork { chunk, scratch, .. } = work;
    let Some(dilation) = chunk.layout.dilation else {
        return;
    };
    let axes = if axisymmetric { 3 } else { D };
    let (stride, l) = (scratch.stride, &mut *scratch.velocity_gradient);
    for (k, mean) in chunk.column(dilation.first).iter().enumerate() {
        let trace = l[k] + l[4 * stride + k] + l[8 * stride + k];
        for a in 0..axes {
            l[4 * a * stride + k] += (mean - trace) / axes as f64; // [STR-16]
        }
    }
}

/// Stores the trace of the velocity gradient of every particle of a chunk.
pub fn store_rates(work: &mut ChunkWork<'_, '_>) {
    let ChunkWork { chunk, scratch, .. } = work;
    let Some(dilation) = chunk.layout.dilation else {
        return;
    };
    let (stride, l) = (scratch.stride, &*scratch.velocity_gradient);
    for (k, rate) in chunk.column_mut(dilation.first).iter_mut().enumerate() {
        *rate = l[k] + l[4 * stride + k] + l[8 * stride + k];
    }
}

/// Index of the patch of a point among those that a block reaches.
fn patch_of<const D: usize>(space: &Space<D>, key: Key<D>, x: [f64; D]) -> usize {
    let xi = space.to_units(x);
    (0..D).fold(0, |patch, d| {
        let cell = space.fits[d].start(xi[d], 0.0).floor() - f64::from(key.at[d]) * EDGE as f64;
        patch * REACH + cell.clamp(0.0, EDGE as f64) as usize
    })
}

impl Patches {
    /// Makes room for the bodies with F-bar.
    pub fn make_room<const D: usize>(&mut self, bodies: &[Body], blocks: &Blocks<D>) -> Result<()> {
        let averaged = bodies.iter().filter(|body| body.has_f_bar());
        let Some(runs) = averaged.map(|body| body.runs.len()).max() else {
            return Ok(());
        };
        refill(&mut self.sums, runs * REACH.pow(D as u32), WHAT)?;
        reserve_exact(&mut self.runs, blocks.keys().len(), WHAT)
    }

    /// Sums up Σ V tr L and Σ V of each run of a body, patch by patch.
    fn collect<const D: usize>(
        &mut self,
        space: &Space<D>,
        keys: &[Key<D>],
        particles: &mut Dilations<'_, D>,
        runs: &[Run],
        team: &Team,
    ) {
        let reached = REACH.pow(D as u32);
        self.sums.clear();
        self.sums.resize(runs.len() * reached, [0.0; 2]);
        self.runs.clear();
        self.runs.resize(keys.len(), NONE);
        for (n, run) in runs.iter().enumerate() {
            self.runs[run.block as usize] = n as u32;
        }
        let particles = &*particles;
        let slices = (Cut(runs, 1), Cut(&mut self.sums[..], reached));
        team.for_each_piece(slices, FEW, |_, (run, sums)| {
            let run = run[0];
            let key = keys[run.block as usize];
            for k in run.first as usize..run.end as usize {
                let sum = &mut sums[patch_of(space, key, particles.position(k))];
                sum[0] += particles.volume[k] * particles.rate(k);
                sum[1] += particles.volume[k];
            }
        });
    }
}

/// Runs that one thread takes at least.
const FEW: usize = 8;

/// Particles whose rates become means: those of some runs, the first of them run `first` of the
/// body.
struct Sharing<'a, const D: usize> {
    particles: Dilations<'a, D>,
    runs: &'a [Run],
    first: usize,
}

impl<const D: usize> Divide for Sharing<'_, D> {
    fn divide(self) -> (Self, Option<Self>) {
        let Self { particles, runs, first } = self;
        if runs.len() <= FEW {
            return (Self { particles, runs, first }, None);
        }
        let half = runs.len() / 2;
        let (left, right) = runs.split_at(half);
        let (of_left, of_right) = particles.split(right[0].first as usize);
        let part = |particles, runs, first| Self { particles, runs, first };
        (part(of_left, left, first), Some(part(of_right, right, first + half)))
    }
}

/// What the runs of a body share.
struct Whole<'a, const D: usize> {
    space: &'a Space<D>,
    blocks: &'a Blocks<D>,
    patches: &'a Patches,
}

impl<const D: usize> Whole<'_, D> {
    /// Replaces the rates of particles by the means of their patches.
    fn share(&self, Sharing { mut particles, runs, first }: Sharing<'_, D>) {
        for (n, run) in runs.iter().enumerate() {
            self.share_run(&mut particles, run, first + n);
        }
    }

    fn share_run(&self, particles: &mut Dilations<'_, D>, run: &Run, n: usize) {
        let key = self.blocks.keys()[run.block as usize];
        let mut means = [0.0; REACH * REACH * REACH];
        let reached = REACH.pow(D as u32);
        for patch in 0..reached {
            if self.patches.sums[n * reached + patch][1] > 0.0 {
                let [rate, volume] = self.total(run.block, key, patch);
                means[patch] = rate / volume;
            }
        }
        for k in run.first as usize..run.end as usize {
            *particles.rate_mut(k) = means[patch_of(self.space, key, particles.position(k))];
        }
    }

    /// The sums of a patch over all runs that reach it, from lower blocks to higher ones, so that
    /// all of them get the same.
    fn total(&self, slot: u32, key: Key<D>, patch: usize) -> [f64; 2] {
        let index: [usize; D] =
            std::array::from_fn(|d| patch / REACH.pow((D - 1 - d) as u32) % REACH);
        let mut total = [0.0; 2];
        for choice in 0..1 << D {
            // along an axis, the first patch of a block is the last of the block below
            let mut other = key;
            let mut theirs = 0;
            let mut exists = true;
            for d in 0..D {
                let upper = choice >> d & 1 == 1;
                let (step, at) = match (index[d], upper) {
                    (0, false) => (-1, EDGE),
                    (EDGE, true) => (1, 0),
                    (0, true) => (0, 0),
                    (at, false) => (0, at),
                    _ => {
                        exists = false;
                        break;
                    }
                };
                other.at[d] += step;
                theirs = theirs * REACH + at;
            }
            let found = if exists { self.blocks.find_near(slot, &other) } else { None };
            let run = found.map_or(NONE, |slot| self.patches.runs[slot as usize]);
            if run != NONE {
                let sum = self.patches.sums[run as usize * REACH.pow(D as u32) + theirs];
                total = [total[0] + sum[0], total[1] + sum[1]];
            }
        }
        total
    }
}
