//! The set of active blocks, their neighbours and their node records.

use std::collections::HashMap;

use super::key::{Key, block_nodes, morton_order, split_node};
use super::{EDGE, Lanes};
use crate::error::Result;
use crate::particles::reserve;

/// No block.
pub const NONE: u32 = u32::MAX;

/// Corners of a block's neighbourhood: bit d of the position stands for a step along axis d.
pub type Neighbours = [u32; 8];

/// What a grid consists of at the moment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GridStats {
    /// Nodes along the edge of a block.
    pub block_edge: i64,
    /// Blocks that exist.
    pub active_blocks: i64,
    /// Nodes of those blocks.
    pub active_nodes: i64,
    /// Memory of nodes, tiles and tables [bytes].
    pub bytes: i64,
    /// Blocks that appeared in the last step.
    pub blocks_created: i64,
    /// Blocks that vanished in the last step.
    pub blocks_removed: i64,
}

/// Blocks in Morton order, each with 4^D nodes in row-major order (last axis fastest).
#[derive(Debug)]
pub struct Grid<const D: usize> {
    /// Distance of nodes [m].
    pub spacing: f64,
    /// Position of node 0 [m].
    pub origin: [f64; D],
    keys: Vec<Key<D>>,
    index: HashMap<Key<D>, u32>,
    /// Blocks that a block's tile reaches, itself first.
    pub forward: Vec<Neighbours>,
    /// Blocks whose tiles reach a block, itself first.
    pub backward: Vec<Neighbours>,
    /// R0: [m, mv] after the scatter, [m, v] after the grid update.
    pub velocity: Vec<Lanes>,
    /// R1: [–, Δv] after the grid update, [–, v] of the second scatter in MUSL.
    pub increment: Vec<Lanes>,
    /// [–, f]: force of the particles on the nodes [N].
    pub force: Vec<Lanes>,
    created: usize,
    removed: usize,
    spare: Vec<Key<D>>,
}

impl<const D: usize> Grid<D> {
    /// A grid without blocks.
    pub fn new(spacing: f64, origin: [f64; D]) -> Self {
        Self {
            spacing,
            origin,
            keys: Vec::new(),
            index: HashMap::new(),
            forward: Vec::new(),
            backward: Vec::new(),
            velocity: Vec::new(),
            increment: Vec::new(),
            force: Vec::new(),
            created: 0,
            removed: 0,
            spare: Vec::new(),
        }
    }

    /// Keys of the active blocks, in Morton order.
    pub fn keys(&self) -> &[Key<D>] {
        &self.keys
    }

    /// The keys with the records R0 and R1 of their nodes.
    pub fn keys_and_records(&mut self) -> (&[Key<D>], &mut [Lanes], &mut [Lanes]) {
        (&self.keys, &mut self.velocity, &mut self.increment)
    }

    /// Position of the block with this key.
    pub fn find(&self, key: &Key<D>) -> Option<u32> {
        self.index.get(key).copied()
    }

    /// Position of a node along one axis [m].
    pub fn node_position(&self, axis: usize, node: i64) -> f64 {
        self.origin[axis] + node as f64 * self.spacing
    }

    /// Number of a node (position of its block times 4^D, plus its place in the block), if its block is active.
    pub fn find_node(&self, index: [i64; D]) -> Option<usize> {
        let mut key = [0i32; D];
        let mut local = 0;
        for d in 0..D {
            let (block, place) = split_node(index[d]);
            key[d] = i32::try_from(block).ok()?;
            local = local * EDGE + place;
        }
        self.find(&key).map(|b| b as usize * block_nodes(D) + local)
    }

    /// Integer index of the node with this number.
    pub fn node_index(&self, node: usize) -> Option<[i64; D]> {
        let key = self.keys.get(node / block_nodes(D))?;
        let mut local = node % block_nodes(D);
        let mut index = [0; D];
        for d in (0..D).rev() {
            index[d] = i64::from(key[d]) * EDGE as i64 + (local % EDGE) as i64;
            local /= EDGE;
        }
        Some(index)
    }

    /// Numbers of blocks and nodes, and the memory of the grid's own tables.
    pub fn stats(&self) -> GridStats {
        let lanes = self.velocity.capacity() + self.increment.capacity() + self.force.capacity();
        let tables = self.forward.capacity() + self.backward.capacity();
        let keys = self.keys.capacity() + self.spare.capacity();
        let entry = size_of::<Key<D>>() + size_of::<u32>() + 1;
        let bytes = lanes * size_of::<Lanes>()
            + tables * size_of::<Neighbours>()
            + keys * size_of::<Key<D>>()
            + self.index.capacity() * entry;
        GridStats {
            block_edge: EDGE as i64,
            active_blocks: self.keys.len() as i64,
            active_nodes: self.velocity.len() as i64,
            bytes: bytes as i64,
            blocks_created: self.created as i64,
            blocks_removed: self.removed as i64,
        }
    }

    /// Forgets what the last change created and removed.
    pub fn no_change(&mut self) {
        (self.created, self.removed) = (0, 0);
    }

    /// Makes exactly these blocks and the ones their tiles reach active; with `keep`, the present ones too.
    ///
    /// Errors: [`Status::OutOfMemory`](crate::error::Status::OutOfMemory), with the grid as it was.
    pub fn set_blocks(&mut self, owners: &[Key<D>], keep: bool) -> Result<()> {
        let mut new = std::mem::take(&mut self.spare);
        new.clear();
        reserve(&mut new, (owners.len() << D) + self.keys.len(), "the blocks of the grid")?;
        for owner in owners {
            new.extend((0..1usize << D).map(|corner| step(owner, corner, 1)));
        }
        if keep {
            new.extend_from_slice(&self.keys);
        }
        new.sort_unstable_by(morton_order);
        new.dedup();
        let missing = |from: &[Key<D>], of: &[Key<D>]| {
            let absent = |k: &&Key<D>| of.binary_search_by(|n| morton_order(n, k)).is_err();
            from.iter().filter(absent).count()
        };
        let (created, removed) = (missing(&new, &self.keys), missing(&self.keys, &new));
        if created + removed > 0 {
            self.resize(&new)?;
        }
        (self.created, self.removed) = (created, removed);
        self.spare = std::mem::replace(&mut self.keys, new);
        Ok(())
    }

    /// Room for the nodes of the blocks `keys`, and their neighbours.
    fn resize(&mut self, keys: &[Key<D>]) -> Result<()> {
        let (what, nodes) = ("the nodes of the grid", keys.len() * block_nodes(D));
        let records = [&mut self.velocity, &mut self.increment, &mut self.force];
        for record in records {
            let more = nodes.saturating_sub(record.len());
            reserve(record, more, what)?;
        }
        for table in [&mut self.forward, &mut self.backward] {
            let more = keys.len().saturating_sub(table.len());
            reserve(table, more, what)?;
        }
        self.index.clear();
        self.index.extend(keys.iter().enumerate().map(|(b, k)| (*k, b as u32)));
        self.rebuild_neighbours(keys);
        for record in [&mut self.velocity, &mut self.increment, &mut self.force] {
            record.clear();
            record.resize(nodes, [0.0; 4]);
        }
        Ok(())
    }

    fn rebuild_neighbours(&mut self, keys: &[Key<D>]) {
        let find = |key: Key<D>| self.index.get(&key).copied().unwrap_or(NONE);
        self.forward.clear();
        self.backward.clear();
        for key in keys {
            let around = |sign| {
                std::array::from_fn(|corner| {
                    if corner < 1 << D { find(step(key, corner, sign)) } else { NONE }
                })
            };
            let (forward, backward) = (around(1), around(-1));
            self.forward.push(forward);
            self.backward.push(backward);
        }
    }
}

fn step<const D: usize>(key: &Key<D>, corner: usize, sign: i32) -> Key<D> {
    std::array::from_fn(|d| key[d] + sign * (corner >> d & 1) as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_appear_with_their_neighbours_and_vanish_behind() {
        let mut grid = Grid::<2>::new(0.5, [0.0, 0.0]);
        grid.set_blocks(&[[-1, 0]], false).expect("memory");
        let stats = grid.stats();
        assert_eq!((stats.active_blocks, stats.blocks_created, stats.blocks_removed), (4, 4, 0));
        grid.set_blocks(&[[0, 0]], false).expect("memory");
        let stats = grid.stats();
        assert_eq!((stats.active_blocks, stats.blocks_created, stats.blocks_removed), (4, 2, 2));
        grid.set_blocks(&[[5, 5]], true).expect("memory");
        assert_eq!(grid.stats().active_blocks, 8);
        let b = grid.find(&[0, 0]).expect("an owner is active") as usize;
        assert_eq!(grid.forward[b][0] as usize, b);
        assert_eq!(grid.keys()[grid.forward[b][3] as usize], [1, 1]);
        assert_eq!(grid.backward[b][1], NONE);
    }

    #[test]
    fn a_node_is_found_by_its_index_and_back() {
        let mut grid = Grid::<3>::new(1.0, [0.0; 3]);
        grid.set_blocks(&[[-2, 0, 7]], false).expect("memory");
        for index in [[-8, 0, 28], [-5, 3, 31], [-1, 7, 35]] {
            let node = grid.find_node(index).expect("inside an active block");
            assert_eq!(grid.node_index(node), Some(index));
        }
        assert_eq!(grid.find_node([0, 0, 0]), None);
    }
}
