//! Stage 1: every particle stands in the run of its block; blocks appear and vanish with their particles.
//!
//! A particle belongs to the block of the lowest node of its stencil. If no particle has left its block nothing is done; else
//! all bodies are sorted by block (Morton order) and cell with a stable counting sort.

use std::collections::HashMap;

use rayon::prelude::*;

use crate::error::{Error, Place, Result, Status};
use crate::grid::key::{block_nodes, morton_order};
use crate::grid::{EDGE, GridPolicy, Key, Run};
use crate::particles::reserve;
use crate::simd::Real;
use crate::world::state::{Body, Space, State};

/// Largest distance from the origins of grid and space, in cells, at which particles are accepted: farther away a double is too coarse
/// for the small moves of a step.
pub const FARTHEST: f64 = 1e8;

/// What memory is for, if there is none.
const SORTING: &str = "the buffers of the sort";

/// Buffers of the sort, kept from step to step.
#[derive(Debug, Default)]
pub struct Sorting<const D: usize> {
    slot: Vec<u32>,
    order: Vec<u32>,
    count: Vec<u32>,
    number: HashMap<Key<D>, u32>,
    owners: Vec<Key<D>>,
    rank: Vec<u32>,
}

/// Sorts particles into blocks if any has left its own.
pub fn locate<const D: usize>(world: &mut State<D>) -> Result<()> {
    if !world.regroup && nobody_moved(world) {
        world.grid.no_change();
        return Ok(());
    }
    regroup(world)?;
    world.regroup = false;
    Ok(())
}

/// Block of a particle and the number of its cell in the block; None if it is too far away or not finite.
#[inline(always)]
fn place<const D: usize>(space: &Space<D>, x: [f64; D]) -> Option<(Key<D>, u32)> {
    let xi = space.to_units(x);
    let mut key = [0; D];
    let mut cell = 0;
    for d in 0..D {
        let first = Real::floor(xi[d] - space.first_offset);
        if !(first.abs() < FARTHEST) {
            return None;
        }
        let first = first as i64;
        key[d] = first.div_euclid(EDGE as i64) as i32;
        cell = cell * EDGE as u32 + first.rem_euclid(EDGE as i64) as u32;
    }
    Some((key, cell))
}

fn nobody_moved<const D: usize>(world: &State<D>) -> bool {
    let (space, keys) = (world.space(), world.grid.keys());
    let stays = |body: &Body, run: &Run| {
        let key = keys[run.block as usize];
        let at = body.particles.layout.position;
        let inside = |k: u32| place(&space, body.particles.get::<D>(at, k as usize));
        (run.first..run.end).all(|k| inside(k).is_some_and(|(of_particle, _)| of_particle == key))
    };
    world.bodies.iter().all(|body| {
        if world.parallel() {
            body.runs.par_iter().all(|run| stays(body, run))
        } else {
            body.runs.iter().all(|run| stays(body, run))
        }
    })
}

fn regroup<const D: usize>(world: &mut State<D>) -> Result<()> {
    let mut sorting = std::mem::take(&mut world.sorting);
    let result = number_blocks(world, &mut sorting).and_then(|()| {
        world.regroup = true; // until it is done: without memory the runs would not belong to the new blocks
        rank_owners(&mut sorting);
        match world.options.grid_policy {
            GridPolicy::Static => world.grid.no_change(),
            policy => world.grid.set_blocks(&sorting.owners, policy == GridPolicy::GrowOnly)?,
        }
        sort_bodies(world, &mut sorting)?;
        let runs = world.bodies.iter().flat_map(|body| body.runs.iter().copied());
        world.tiles.assign(runs, world.grid.keys().len(), D)
    });
    world.sorting = sorting;
    result
}

/// Numbers the blocks in the order in which particles meet them; `slot` becomes number × cells of a block + cell.
fn number_blocks<const D: usize>(world: &State<D>, sorting: &mut Sorting<D>) -> Result<()> {
    let space = world.space();
    let cells = block_nodes(D) as u32;
    sorting.slot.clear();
    sorting.number.clear();
    sorting.owners.clear();
    reserve(&mut sorting.slot, world.particle_count(), SORTING)?;
    let mut last: Option<(Key<D>, u32)> = None;
    for body in &world.bodies {
        let at = body.particles.layout.position;
        for k in 0..body.particles.len() {
            let x = body.particles.get::<D>(at, k);
            let found = place(&space, x).filter(|_| world.inside_box(&x));
            let Some((key, cell)) = found else { return Err(outside(world, body, k, x)) };
            let number = match last {
                Some((same, number)) if same == key => number,
                _ => *sorting.number.entry(key).or_insert_with(|| {
                    sorting.owners.push(key);
                    sorting.owners.len() as u32 - 1
                }),
            };
            last = Some((key, number));
            sorting.slot.push(number * cells + cell);
        }
    }
    Ok(())
}

fn outside<const D: usize>(world: &State<D>, body: &Body, k: usize, x: [f64; D]) -> Error {
    let id = body.particles.id[k];
    let limit = match world.options.grid_policy {
        GridPolicy::Static => {
            "the box of the static grid (use a larger box or grid_policy dynamic)"
        }
        _ => "1e8 cells around the origin of the grid (check velocities and spacing)",
    };
    Error::new(
        Status::OutsideGrid,
        format!("particle {id} of body {} at {x:?} is outside {limit}", body.id),
    )
    .at(Place { particle: Some(id), body: Some(body.id), ..world.place() })
}

/// Sorts the owners along the Morton curve; `rank[number]` becomes the place of a block among them.
fn rank_owners<const D: usize>(sorting: &mut Sorting<D>) {
    sorting.owners.sort_unstable_by(morton_order);
    sorting.rank.clear();
    sorting.rank.resize(sorting.owners.len(), 0);
    for (rank, key) in sorting.owners.iter().enumerate() {
        sorting.rank[sorting.number[key] as usize] = rank as u32;
    }
}

/// Sorts each body by block and cell. Particles of one cell keep their order.
fn sort_bodies<const D: usize>(world: &mut State<D>, sorting: &mut Sorting<D>) -> Result<()> {
    let cells = block_nodes(D) as u32;
    let mut first = 0;
    for (b, body) in world.bodies.iter_mut().enumerate() {
        let n = body.particles.len();
        let slots = &mut sorting.slot[first..first + n];
        first += n;
        for slot in slots.iter_mut() {
            *slot = sorting.rank[(*slot / cells) as usize] * cells + *slot % cells;
        }
        let slots = &*slots;
        let all = sorting.owners.len() * cells as usize;
        let order = &mut sorting.order;
        order.clear();
        reserve(order, n, SORTING)?;
        if n < all / 8 {
            // a small body in a large grid: counting would cost the whole grid
            order.extend(0..n as u32);
            order.sort_unstable_by_key(|k| (slots[*k as usize], *k));
        } else {
            order.resize(n, 0);
            sorting.count.clear();
            reserve(&mut sorting.count, all + 1, SORTING)?;
            counting_sort(slots, all, &mut sorting.count, order);
        }
        body.runs.clear();
        let rank = |k: &u32| slots[*k as usize] / cells;
        for run in order.chunk_by(|a, b| rank(a) == rank(b)) {
            let first = body.runs.last().map_or(0, |r| r.end);
            let key = sorting.owners[rank(&run[0]) as usize];
            let block = world.grid.find(&key).expect("owners are active blocks");
            let end = first + run.len() as u32;
            body.runs.push(Run { block, body: b as u32, first, end });
        }
        if !order.is_sorted() {
            body.particles.permute(order);
        }
    }
    Ok(())
}

/// The stable order of `slots`, whose values are below `values`.
fn counting_sort(slots: &[u32], values: usize, count: &mut Vec<u32>, order: &mut [u32]) {
    count.clear();
    count.resize(values + 1, 0);
    for slot in slots {
        count[*slot as usize + 1] += 1;
    }
    for s in 1..count.len() {
        count[s] += count[s - 1];
    }
    for (k, slot) in slots.iter().enumerate() {
        let to = &mut count[*slot as usize];
        order[*to as usize] = k as u32;
        *to += 1;
    }
}
