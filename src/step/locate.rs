//! Stage 1: every particle stands in the run of its block; blocks appear and vanish with their
//! particles.
//!
//! A particle belongs to the block of the lowest node of its stencil. Particles that may have left
//! their block are marked; if none has, nothing is done. Else a [`Plan`] lists the new runs and the
//! particles that move for them:
//!
//! * [`movers`]: only those that left their block, and those that must make room. The order inside
//!   a block becomes stale.
//! * [`full`]: all particles, by block (Morton order) and cell, when particles came or went, or
//!   when more than half left their block.
//!
//! A plan is made without a change to the world, so that particles outside the grid are an error
//! that changes nothing. Both ways depend on positions and on the order of particles alone, not on
//! slots of the grid, its policy or threads.

pub mod full;
pub mod movers;

use super::freshness::Freshness;
use super::options::Options;
use super::parts::particle_count;
use crate::background::space::FARTHEST;
use crate::background::{Background, Blocks, EDGE, GridPolicy, Key, Run, Space};
use crate::error::{Error, Place, Result, Status};
use crate::memory::{refill, reserve};
use crate::parallel::{Cut, Team};
use crate::particles::{Body, Moves, MovesEnd};
use crate::simd::Real;

use full::{Sorter, plan_sort};
use movers::{Regrouper, plan_moves};

/// What memory is for, if there is none.
const SORTING: &str = "the buffers of the sort";

/// Words of marks that a thread checks at a time.
const WORDS: usize = 64;

/// Plan and buffers of the sort, reused from step to step.
#[derive(Debug, Default)]
pub struct Sorting<const D: usize> {
    plan: Plan<D>,
    sorter: Sorter<D>,
    regrouper: Regrouper<D>,
}

/// The new runs, and the moves of particles that make them.
#[derive(Debug, Default)]
pub struct Plan<const D: usize> {
    /// Runs of all bodies; those in new blocks have no valid slot.
    runs: Vec<Run>,
    /// For each run the key of its block.
    keys: Vec<Key<D>>,
    /// Moves of all bodies, with indices that count from the first particle of the body.
    moves: Moves,
    /// For each body the ends of its runs and of its moves.
    ends: Vec<(usize, MovesEnd)>,
    /// Whether a run is in a block that had none of this body, or a block lost its run.
    blocks_change: bool,
}

impl<const D: usize> Plan<D> {
    /// An empty plan, with room for all particles to move and for about as many runs as there are.
    fn clear(&mut self, bodies: &[Body]) -> Result<()> {
        let runs = bodies.iter().map(|body| body.runs.len()).sum();
        self.blocks_change = false;
        self.moves.clear();
        refill(&mut self.runs, runs, SORTING)?;
        refill(&mut self.keys, runs, SORTING)?;
        refill(&mut self.ends, bodies.len(), SORTING)?;
        reserve(&mut self.moves.from, particle_count(bodies), SORTING)?;
        reserve(&mut self.moves.to, particle_count(bodies), SORTING)
    }

    /// Adds a run of the current body.
    fn push(&mut self, run: Run, key: Key<D>) -> Result<()> {
        reserve(&mut self.runs, 1, SORTING)?;
        reserve(&mut self.keys, 1, SORTING)?;
        self.runs.push(run);
        self.keys.push(key);
        Ok(())
    }

    /// Ends the current body.
    fn end_body(&mut self) {
        self.ends.push((self.runs.len(), self.moves.end()));
    }
}

/// Moves particles into the runs of their blocks if any has left its own.
pub fn locate<const D: usize>(
    bodies: &mut [Body],
    background: &mut Background<D>,
    options: &Options,
    sorting: &mut Sorting<D>,
    freshness: &mut Freshness,
    team: &Team,
) -> Result<()> {
    let Sorting { plan, sorter, regrouper } = sorting;
    if freshness.is_grouped() {
        if !freshness.is_marked() || options.grid_policy == GridPolicy::Static {
            mark_moved(bodies, background, options, team);
        }
        if bodies.iter().all(|body| body.particles.moved.iter().all(|word| *word == 0)) {
            freshness.located();
            return Ok(());
        }
    }
    let near = Near { space: &background.space, options };
    if !freshness.is_grouped() || !plan_moves(bodies, &background.blocks, near, regrouper, plan)? {
        plan_sort(bodies, near, sorter, plan)?;
    }
    freshness.locating();
    carry_out(bodies, background, options, plan, team)?;
    freshness.located();
    Ok(())
}

/// Makes the blocks that the plan needs, moves the particles and assigns the runs to tiles.
fn carry_out<const D: usize>(
    bodies: &mut [Body],
    background: &mut Background<D>,
    options: &Options,
    plan: &mut Plan<D>,
    team: &Team,
) -> Result<()> {
    if plan.blocks_change {
        match options.grid_policy {
            GridPolicy::Static => {}
            policy => background.set_owners(&plan.keys, policy == GridPolicy::GrowOnly)?,
        }
        for (run, key) in plan.runs.iter_mut().zip(&plan.keys) {
            run.block = background.blocks.find(key).expect("owners are active blocks");
        }
    }
    let (mut run, mut done) = (0, MovesEnd::default());
    for (body, (end, last)) in bodies.iter_mut().zip(&plan.ends) {
        refill(&mut body.runs, end - run, SORTING)?;
        body.runs.extend_from_slice(&plan.runs[run..*end]);
        body.particles.rearrange(plan.moves.between(done, *last), team);
        body.particles.moved.fill(0);
        (run, done) = (*end, *last);
    }
    background.tiles.assign(plan.runs.iter().copied(), background.blocks.place(), D)
}

/// Where particles may stand.
#[derive(Clone, Copy)]
struct Near<'a, const D: usize> {
    space: &'a Space<D>,
    options: &'a Options,
}

/// Block of a particle and the number of its cell in the block; None if it is too far away or not
/// finite.
#[inline(always)]
fn block_and_cell<const D: usize>(space: &Space<D>, x: [f64; D]) -> Option<([i32; D], u32)> {
    let starts = space.starts(x);
    let mut at = [0; D];
    let mut cell = 0;
    for d in 0..D {
        let first = Real::floor(starts[d]);
        if !(first.abs() < FARTHEST) {
            return None;
        }
        let first = first as i64;
        at[d] = first.div_euclid(EDGE as i64) as i32;
        cell = cell * EDGE as u32 + first.rem_euclid(EDGE as i64) as u32;
    }
    Some((at, cell))
}

/// Block and cell of particle k of a body, or the error that it is outside the grid.
#[inline(always)]
fn block_and_cell_inside<const D: usize>(
    near: Near<'_, D>,
    body: &Body,
    k: usize,
) -> Result<(Key<D>, u32)> {
    let x = body.particles.get::<D>(body.particles.layout.position, k);
    match block_and_cell(near.space, x) {
        Some((at, cell)) if near.options.holds(&x) => Ok((Key { layer: body.layer, at }, cell)),
        _ => Err(outside(near.options, body, k, x)),
    }
}

#[cold]
fn outside<const D: usize>(options: &Options, body: &Body, k: usize, x: [f64; D]) -> Error {
    let id = body.particles.id[k];
    let limit = match options.grid_policy {
        GridPolicy::Static => {
            "the box of the static grid (use a larger box or grid_policy dynamic)"
        }
        _ => "1e8 cells around the origin of the grid (check velocities and spacing)",
    };
    Error::new(
        Status::OutsideGrid,
        format!("particle {id} of body {} at {x:?} is outside {limit}", body.id),
    )
    .at(Place { particle: Some(id), body: Some(body.id), ..Place::default() })
}

/// Refuses particles on or beyond the axis of symmetry.
pub fn check_radii(bodies: &[Body], options: &Options) -> Result<()> {
    for body in bodies.iter().filter(|_| options.axisymmetric) {
        let radii = body.particles.column(body.particles.layout.position);
        let least = radii.iter().fold(f64::INFINITY, |least, r| least.min(*r));
        if least > 0.0 {
            continue;
        }
        let k = radii.iter().position(|r| *r <= 0.0).unwrap_or(0);
        let id = body.particles.id[k];
        let text = format!(
            "particle {id} of body {} has crossed the axis of symmetry, to x = {:e}: add a slip wall at x = 0, or take smaller steps",
            body.id, radii[k]
        );
        let place = Place { particle: Some(id), body: Some(body.id), ..Place::default() };
        return Err(Error::new(Status::OutsideGrid, text).at(place));
    }
    Ok(())
}

/// Marks every particle that may have left the block of its run, or the box of a static grid, and
/// clears the other marks.
fn mark_moved<const D: usize>(
    bodies: &mut [Body],
    background: &Background<D>,
    options: &Options,
    team: &Team,
) {
    let limits = options.limits();
    let Background { space, blocks, .. } = background;
    for body in bodies {
        let Body { particles, runs, .. } = body;
        let (columns, moved) = particles.positions_and_moved::<D>();
        team.for_each_piece(Cut(moved, WORDS), 1, |n, words| {
            words.fill(0);
            let (first, end) = (64 * WORDS * n, 64 * WORDS * n + 64 * words.len());
            let start = runs.partition_point(|run| run.end as usize <= first);
            for run in runs[start..].iter().take_while(|run| (run.first as usize) < end) {
                let inside = sure_inside(blocks, space, run.block, limits);
                let range = (first.max(run.first as usize), end.min(run.end as usize));
                mark_run(&columns, &inside, range, words, first);
            }
        });
    }
}

/// Positions that are in a block in spite of all round-off [m], lower and upper corner.
fn sure_inside<const D: usize>(
    blocks: &Blocks<D>,
    space: &Space<D>,
    slot: u32,
    limits: Option<[[f64; 3]; 2]>,
) -> ([f64; D], [f64; D]) {
    let key = blocks.keys()[slot as usize];
    let (mut low, mut high) = ([0.0; D], [0.0; D]);
    for d in 0..D {
        let lowest = f64::from(key.at[d]) * EDGE as f64 + space.first_offset;
        let edge = |cells: f64| space.origin[d] + (lowest + cells) * space.spacing;
        // positions, their differences to the origin and their quotients by the spacing are each
        // exact to 2^-53
        let scale = space.origin[d].abs() + (lowest.abs() + EDGE as f64) * space.spacing;
        let margin = 64.0 * f64::EPSILON * scale;
        (low[d], high[d]) = (edge(0.0) + margin, edge(EDGE as f64) - margin);
        // next to a wall, stencils begin elsewhere
        let [wall, far] = space.fits[d].nodes.map(|node| space.node_position(d, node));
        (low[d], high[d]) = (low[d].max(wall + space.spacing), high[d].min(far - space.spacing));
        if let Some([min, max]) = limits {
            (low[d], high[d]) = (low[d].max(min[d]), high[d].min(max[d]));
        }
    }
    (low, high)
}

/// Marks the particles of a range whose positions are not between the corners; `words` begins with
/// the mark of particle `first`.
fn mark_run<const D: usize>(
    columns: &[&[f64]; D],
    (low, high): &([f64; D], [f64; D]),
    (start, end): (usize, usize),
    words: &mut [u64],
    first: usize,
) {
    let mut k = start;
    while k < end {
        let stop = end.min((k / 64 + 1) * 64);
        let mut flags = [0u64; 64];
        for d in 0..D {
            let column = &columns[d][k..stop];
            for (flag, x) in flags.iter_mut().zip(column) {
                *flag |= u64::from(!(low[d] <= *x && *x <= high[d]));
            }
        }
        if flags.iter().fold(0, |any, flag| any | flag) != 0 {
            words[(k - first) / 64] |= packed(&flags) << (k % 64);
        }
        k = stop;
    }
}

/// The word whose bit l is flag l, which is 0 or 1.
#[inline(always)]
fn packed(flags: &[u64; 64]) -> u64 {
    flags.iter().rev().fold(0, |bits, flag| bits << 1 | flag)
}
