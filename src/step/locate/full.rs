//! The plan that sorts all particles by block (Morton order) and cell, with a stable counting sort.

use super::{Near, Plan, SORTING, block_and_cell_inside};
use crate::background::index::Index;
use crate::background::key::{block_nodes, morton_order};
use crate::background::{Key, NONE, Run};
use crate::error::Result;
use crate::memory::{refill, reserve};
use crate::particles::Body;
use crate::step::parts::particle_count;

/// Buffers of the full sort.
#[derive(Debug, Default)]
pub struct Sorter<const D: usize> {
    /// For each particle its block and cell as one number: block × cells of a block + cell.
    sort_key: Vec<u32>,
    order: Vec<u32>,
    count: Vec<u32>,
    number: Index,
    /// Keys of the blocks in which particles stand, in the order in which particles meet them.
    owners: Vec<Key<D>>,
    /// Numbers of the owners, along the Morton curve.
    sorted: Vec<u32>,
    rank: Vec<u32>,
}

/// Plans to sort all bodies. An error names a particle that is outside the grid.
pub(super) fn plan_sort<const D: usize>(
    bodies: &[Body],
    near: Near<'_, D>,
    sorter: &mut Sorter<D>,
    plan: &mut Plan<D>,
) -> Result<()> {
    plan.clear(bodies)?;
    plan.blocks_change = true;
    number_blocks(bodies, near, sorter)?;
    rank_owners(sorter)?;
    sort_bodies(bodies, sorter, plan)
}

/// Numbers the blocks in the order in which particles meet them; `sort_key` becomes number × cells
/// of a block + cell.
fn number_blocks<const D: usize>(
    bodies: &[Body],
    near: Near<'_, D>,
    sorter: &mut Sorter<D>,
) -> Result<()> {
    let cells = block_nodes(D) as u32;
    sorter.sort_key.clear();
    sorter.number.clear();
    sorter.owners.clear();
    reserve(&mut sorter.sort_key, particle_count(bodies), SORTING)?;
    let mut last: Option<(Key<D>, u32)> = None;
    for body in bodies {
        for k in 0..body.particles.len() {
            let (key, cell) = block_and_cell_inside(near, body, k)?;
            let number = match last {
                Some((same, number)) if same == key => number,
                _ => number_of(sorter, &key)?,
            };
            last = Some((key, number));
            sorter.sort_key.push(number * cells + cell);
        }
    }
    Ok(())
}

/// Number of an owner, a new one for one not met before.
fn number_of<const D: usize>(sorter: &mut Sorter<D>, key: &Key<D>) -> Result<u32> {
    let Sorter { number, owners, .. } = sorter;
    if let Some(known) = number.find(key, owners) {
        return Ok(known);
    }
    let new = owners.len() as u32;
    number.reserve(owners.len() + 1, owners)?;
    reserve(owners, 1, SORTING)?;
    owners.push(*key);
    number.insert(new, owners);
    Ok(new)
}

/// Sorts the owners along the Morton curve; `rank[number]` becomes the position of a block among
/// them.
fn rank_owners<const D: usize>(sorter: &mut Sorter<D>) -> Result<()> {
    let Sorter { owners, sorted, rank, .. } = sorter;
    for list in [&mut *sorted, &mut *rank] {
        refill(list, owners.len(), SORTING)?;
    }
    sorted.extend(0..owners.len() as u32);
    sorted.sort_unstable_by(|a, b| morton_order(&owners[*a as usize], &owners[*b as usize]));
    rank.resize(owners.len(), 0);
    for (position, number) in sorted.iter().enumerate() {
        rank[*number as usize] = position as u32;
    }
    Ok(())
}

/// Sorts each body by block and cell. Particles of one cell keep their order.
fn sort_bodies<const D: usize>(
    bodies: &[Body],
    sorter: &mut Sorter<D>,
    plan: &mut Plan<D>,
) -> Result<()> {
    let cells = block_nodes(D) as u32;
    let Sorter { sort_key, order, count, owners, sorted, rank, .. } = sorter;
    let mut start = 0;
    for (b, body) in bodies.iter().enumerate() {
        let n = body.particles.len();
        let sort_keys = &mut sort_key[start..start + n];
        start += n;
        for sort_key in sort_keys.iter_mut() {
            *sort_key = rank[(*sort_key / cells) as usize] * cells + *sort_key % cells;
        }
        let sort_keys = &*sort_keys;
        let all = owners.len() * cells as usize;
        order.clear();
        reserve(order, n, SORTING)?;
        if n < all / 8 {
            // a small body in a large grid: counting would cost the whole grid
            order.extend(0..n as u32);
            order.sort_unstable_by_key(|k| (sort_keys[*k as usize], *k));
        } else {
            order.resize(n, 0);
            count.clear();
            reserve(count, all + 1, SORTING)?;
            counting_sort(sort_keys, all, count, order);
        }
        let block = |k: &u32| sort_keys[*k as usize] / cells;
        let mut first = 0;
        for run in order.chunk_by(|a, b| block(a) == block(b)) {
            let end = first + run.len() as u32;
            let key = owners[sorted[block(&run[0]) as usize] as usize];
            plan.push(Run { block: NONE, body: b as u32, first, end }, key)?;
            first = end;
        }
        plan.moves.sort(order);
        plan.end_body();
    }
    Ok(())
}

/// The stable order of `sort_keys`, whose values are below `values`.
fn counting_sort(sort_keys: &[u32], values: usize, count: &mut Vec<u32>, order: &mut [u32]) {
    count.clear();
    count.resize(values + 1, 0);
    for sort_key in sort_keys {
        count[*sort_key as usize + 1] += 1;
    }
    for s in 1..count.len() {
        count[s] += count[s - 1];
    }
    for (k, sort_key) in sort_keys.iter().enumerate() {
        let to = &mut count[*sort_key as usize];
        order[*to as usize] = k as u32;
        *to += 1;
    }
}
