//! The plan that moves only particles that left their block, and those that stand in the way.
//!
//! Runs stay in the Morton order of their blocks. A run that grows or shrinks shifts the next ones;
//! of each of them only the particles at one end move to the other end, since the order inside a
//! run is free. Those with consecutive indices move as one [`Segment`](crate::particles::Segment).
//!
//! Three runs a, b and c; a letter is the run of a particle after the moves, a point a hole, a bar
//! the start of a run. One particle leaves a for c, three leave c for a:
//!
//! ```text
//! index   0  1  2  3  4  5  6  7  8  9 10 11 12 13 14 15
//!
//! before |a  a  c  a |b  b  b  b  b |c  c  a  a  a  c  c
//!               ^                          ^  ^  ^          movers 2, 11, 12, 13: taken out
//! holes  |a  a  .  a |b  b  b  b  b |c  c  .  .  .  c  c
//!                                    >-----^                c starts at 11 now: segments 9 -> 11
//!                                       >-----^             and 10 -> 12 fill two of its holes
//! refill |a  a  .  a |b  b  b  b  b  .  . |c  c  .  c  c
//!                     >--------------^                      b starts at 6 now: segment 4, 5 -> 9
//! refill |a  a  .  a  .  . |b  b  b  b  b |c  c  .  c  c
//!               ^     ^  ^                       ^          11, 12, 13 arrive in a, 2 in c
//! after  |a  a  a  a  a  a |b  b  b  b  b |c  c  c  c  c
//! ```
//!
//! The ends of a and b move up, so the runs are refilled from the last to the first ([`in_order`]):
//! b moves onto 9 and 10 only when c is gone from there. Particles 0, 1, 3, 6, 7, 8, 14 and 15 do
//! not move. The test `the_picture_of_three_runs_is_true` makes these moves.

use super::{Near, Plan, SORTING, block_and_cell_inside};
use crate::background::index::Index;
use crate::background::key::morton_order;
use crate::background::{Blocks, Key, NONE, Run};
use crate::error::Result;
use crate::memory::{refill, reserve};
use crate::particles::{Body, RunStart, in_order};
use crate::step::parts::particle_count;

/// Buffers of the regrouping. The runs of a body have numbers: first those that it has, then those
/// in blocks that are new to it.
#[derive(Debug, Default)]
pub struct Regrouper<const D: usize> {
    /// Number of the body's run in each slot of the grid.
    run_of: Vec<u32>,
    /// Indices of the particles that leave their run (the movers), in storage order.
    movers: Vec<u32>,
    /// For each mover the number of the run that it goes to.
    targets: Vec<u32>,
    /// For each run the first of its movers; one more at the end.
    first_mover: Vec<u32>,
    /// Keys of blocks that are new to the body.
    new_keys: Vec<Key<D>>,
    new_index: Index,
    /// Numbers of the runs in those blocks, in Morton order.
    new_runs: Vec<u32>,
    /// Particles of each run after the moves.
    count: Vec<u32>,
    /// Numbers of all runs in Morton order.
    sequence: Vec<u32>,
    /// Movers by the run that they go to.
    arrivals: Vec<u32>,
    /// For each run the end of its arrivals; before that the number of them, then their start.
    arrived: Vec<u32>,
    /// The starts of the runs of the sequence; one more at the end.
    starts: Vec<RunStart>,
}

/// Plans the moves of marked particles that did leave their block. False, with half a plan, if more
/// than half of all particles did; an error names a particle that is outside the grid.
pub(super) fn plan_moves<const D: usize>(
    bodies: &[Body],
    blocks: &Blocks<D>,
    near: Near<'_, D>,
    buffers: &mut Regrouper<D>,
    plan: &mut Plan<D>,
) -> Result<bool> {
    let most = particle_count(bodies) / 2;
    plan.clear(bodies)?;
    let slots = blocks.keys().len();
    if buffers.run_of.len() != slots {
        refill(&mut buffers.run_of, slots, SORTING)?;
        buffers.run_of.resize(slots, NONE);
    }
    for (b, body) in bodies.iter().enumerate() {
        for (r, run) in body.runs.iter().enumerate() {
            buffers.run_of[run.block as usize] = r as u32;
        }
        let found = find_movers(body, blocks, near, buffers, most);
        for run in &body.runs {
            buffers.run_of[run.block as usize] = NONE;
        }
        if !found? {
            return Ok(false);
        }
        order_runs(body, blocks, buffers)?;
        sort_arrivals(buffers)?;
        lay_out((b, body), blocks, buffers, plan)?;
        fill_runs(buffers, plan)?;
        plan.end_body();
        if plan.moves.from.len() > most {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Lists the particles that left their block, with the run that they go to. False if there are more
/// than `most`.
fn find_movers<const D: usize>(
    body: &Body,
    blocks: &Blocks<D>,
    near: Near<'_, D>,
    buffers: &mut Regrouper<D>,
    most: usize,
) -> Result<bool> {
    buffers.new_keys.clear();
    buffers.new_index.clear();
    for list in [&mut buffers.movers, &mut buffers.targets] {
        refill(list, body.particles.len() / 8, SORTING)?;
    }
    refill(&mut buffers.first_mover, body.runs.len() + 1, SORTING)?;
    let (mut run, mut key) =
        (Run { block: 0, body: 0, first: 0, end: 0 }, Key { layer: body.layer, at: [0; D] });
    for (w, word) in body.particles.moved.iter().enumerate() {
        let mut bits = *word;
        while bits != 0 {
            let k = 64 * w as u32 + bits.trailing_zeros();
            bits &= bits - 1;
            while run.end <= k {
                run = body.runs[buffers.first_mover.len()];
                key = blocks.keys()[run.block as usize];
                buffers.first_mover.push(buffers.movers.len() as u32);
            }
            let (new, _) = block_and_cell_inside(near, body, k as usize)?;
            if new != key {
                let slot = blocks.find_near(run.block, &new);
                let known = slot.map_or(NONE, |slot| buffers.run_of[slot as usize]);
                let target =
                    if known == NONE { new_run(buffers, body.runs.len(), new)? } else { known };
                reserve(&mut buffers.movers, 1, SORTING)?;
                reserve(&mut buffers.targets, 1, SORTING)?;
                buffers.movers.push(k);
                buffers.targets.push(target);
            }
        }
    }
    buffers.first_mover.resize(body.runs.len() + 1, buffers.movers.len() as u32);
    Ok(buffers.movers.len() <= most)
}

/// Number of the run in a block that is new to a body of `runs` runs.
fn new_run<const D: usize>(buffers: &mut Regrouper<D>, runs: usize, key: Key<D>) -> Result<u32> {
    let Regrouper { new_keys, new_index, .. } = buffers;
    let number = match new_index.find(&key, new_keys) {
        Some(number) => number,
        None => {
            new_index.reserve(new_keys.len() + 1, new_keys)?;
            reserve(new_keys, 1, SORTING)?;
            new_keys.push(key);
            new_index.insert(new_keys.len() as u32 - 1, new_keys);
            new_keys.len() as u32 - 1
        }
    };
    Ok(runs as u32 + number)
}

/// Counts the particles of each run after the moves, and puts the new runs in Morton order among
/// the others.
fn order_runs<const D: usize>(
    body: &Body,
    blocks: &Blocks<D>,
    buffers: &mut Regrouper<D>,
) -> Result<()> {
    let Regrouper { targets, first_mover, new_keys, new_runs, count, sequence, .. } = buffers;
    let (old, all) = (body.runs.len(), body.runs.len() + new_keys.len());
    for list in [&mut *count, &mut *sequence, &mut *new_runs] {
        refill(list, all, SORTING)?;
    }
    for (r, run) in body.runs.iter().enumerate() {
        count.push(run.end - run.first - (first_mover[r + 1] - first_mover[r]));
    }
    count.resize(all, 0);
    for target in targets {
        count[*target as usize] += 1;
    }
    let keys = blocks.keys();
    let key = |r: u32| match body.runs.get(r as usize) {
        Some(run) => &keys[run.block as usize],
        None => &new_keys[r as usize - old],
    };
    new_runs.extend(old as u32..all as u32);
    new_runs.sort_unstable_by(|a, b| morton_order(key(*a), key(*b)));
    let mut next = 0;
    for new in &*new_runs {
        while next < old && morton_order(key(next as u32), key(*new)).is_lt() {
            sequence.push(next as u32);
            next += 1;
        }
        sequence.push(*new);
    }
    sequence.extend(next as u32..old as u32);
    Ok(())
}

/// Sorts the movers by the run that they go to; those of a run keep their order.
fn sort_arrivals<const D: usize>(buffers: &mut Regrouper<D>) -> Result<()> {
    let Regrouper { movers, targets, count, arrivals, arrived, .. } = buffers;
    refill(arrivals, movers.len(), SORTING)?;
    arrivals.resize(movers.len(), 0);
    refill(arrived, count.len() + 1, SORTING)?;
    arrived.resize(count.len() + 1, 0);
    for target in &*targets {
        arrived[*target as usize + 1] += 1;
    }
    for r in 1..arrived.len() {
        arrived[r] += arrived[r - 1];
    }
    for (mover, target) in movers.iter().zip(&*targets) {
        let to = &mut arrived[*target as usize];
        arrivals[*to as usize] = *mover;
        *to += 1;
    }
    Ok(())
}

/// Gives every run its new range.
fn lay_out<const D: usize>(
    (b, body): (usize, &Body),
    blocks: &Blocks<D>,
    buffers: &mut Regrouper<D>,
    plan: &mut Plan<D>,
) -> Result<()> {
    let Regrouper { new_keys, count, sequence, starts, .. } = buffers;
    let (runs, keys) = (&body.runs, blocks.keys());
    refill(starts, sequence.len() + 1, SORTING)?;
    let (mut last, mut first) = (0, 0);
    for r in sequence.iter().map(|r| *r as usize) {
        starts.push(RunStart { old: last, new: first });
        let end = first + count[r];
        let (block, key) = match runs.get(r) {
            Some(run) => {
                last = run.end;
                (run.block, keys[run.block as usize])
            }
            None => (NONE, new_keys[r - runs.len()]),
        };
        plan.blocks_change |= block == NONE || first == end;
        if first < end {
            plan.push(Run { block, body: b as u32, first, end }, key)?;
        }
        first = end;
    }
    starts.push(RunStart { old: last, new: first });
    Ok(())
}

/// Adds the moves that fill the new ranges.
fn fill_runs<const D: usize>(buffers: &Regrouper<D>, plan: &mut Plan<D>) -> Result<()> {
    let Regrouper { movers, first_mover, sequence, arrivals, arrived, starts, .. } = buffers;
    let moves = &mut plan.moves;
    moves.reserve_segments(sequence.len(), movers.len(), SORTING)?;
    in_order(starts, |s| {
        let r = sequence[s] as usize;
        let (this, next) = (starts[s], starts[s + 1]);
        let leavers = match first_mover.get(r + 1) {
            Some(end) => &movers[first_mover[r] as usize..*end as usize],
            None => &[],
        };
        let start = if r > 0 { arrived[r - 1] } else { 0 };
        let arrivals = &arrivals[start as usize..arrived[r] as usize];
        moves.refill(this.old..next.old, this.new..next.new, leavers, arrivals);
    });
    Ok(())
}
