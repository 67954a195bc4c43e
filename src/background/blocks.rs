//! The set of active blocks, their neighbours and their node records.

use super::index::Index;
use super::key::{Key, block_nodes, morton_order, split_node};
use super::{EDGE, Lanes, room};
use crate::error::Result;
use crate::memory::{reserve, reserve_exact};

/// No block.
pub const NONE: u32 = u32::MAX;

/// What memory is for, if there is none.
const WHAT: &str = "the blocks of the grid";

/// A grid of at most so many slots keeps its memory.
const SMALL: usize = 64;

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

/// Blocks, each with 4^D nodes in row-major order (last axis fastest).
///
/// A block keeps its slot, and with it the place of its node records, from the step in which it appears until it vanishes. Tables and
/// records go by slot; a free slot has no neighbours and nodes without mass. Hosts know nodes by numbers that go by the
/// Morton order of the blocks: see [`Grid::record`].
#[derive(Debug)]
pub struct Grid<const D: usize> {
    /// Distance of nodes [m].
    pub spacing: f64,
    /// Position of node 0 [m].
    pub origin: [f64; D],
    keys: Vec<Key<D>>,
    index: Index,
    order: Vec<u32>,
    place: Vec<u32>,
    free: Vec<u32>,
    /// For each slot the slots of the blocks that its tile reaches, itself first.
    pub forward: Vec<Neighbours>,
    /// For each slot the slots of the blocks whose tiles reach it, itself first.
    pub backward: Vec<Neighbours>,
    /// R0: [m, mv] after the scatter, [m, v] after the grid update.
    pub velocity: Vec<Lanes>,
    /// R1: [–, Δv] after the grid update, [–, v] of the second scatter in MUSL.
    pub increment: Vec<Lanes>,
    /// [–, f]: force of the particles on the nodes [N].
    pub force: Vec<Lanes>,
    created: usize,
    removed: usize,
    reached: Vec<bool>,
    fresh: Vec<Key<D>>,
}

impl<const D: usize> Grid<D> {
    /// A grid without blocks.
    pub fn new(spacing: f64, origin: [f64; D]) -> Self {
        Self {
            spacing,
            origin,
            keys: Vec::new(),
            index: Index::default(),
            order: Vec::new(),
            place: Vec::new(),
            free: Vec::new(),
            forward: Vec::new(),
            backward: Vec::new(),
            velocity: Vec::new(),
            increment: Vec::new(),
            force: Vec::new(),
            created: 0,
            removed: 0,
            reached: Vec::new(),
            fresh: Vec::new(),
        }
    }

    /// Key of the block in each slot; free slots have some key.
    pub fn keys(&self) -> &[Key<D>] {
        &self.keys
    }

    /// Slots of the active blocks, in Morton order.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// For each slot the place of its block in Morton order, [`NONE`] for a free slot.
    pub fn place(&self) -> &[u32] {
        &self.place
    }

    /// The keys by slot, with the records R0 and R1 of their nodes to write, and the forces.
    pub fn keys_and_records(&mut self) -> (&[Key<D>], &mut [Lanes], &mut [Lanes], &[Lanes]) {
        (&self.keys, &mut self.velocity, &mut self.increment, &self.force)
    }

    /// Slot of the block with this key.
    pub fn find(&self, key: &Key<D>) -> Option<u32> {
        self.index.find(key, &self.keys)
    }

    /// Slot of the block with this key, which is most likely next to the block in slot `from`, an owner of particles.
    #[inline]
    pub fn find_near(&self, from: u32, key: &Key<D>) -> Option<u32> {
        let old = &self.keys[from as usize];
        let (mut up, mut down) = (0, 0);
        for d in 0..D {
            match key[d] - old[d] {
                0 => {}
                1 => up |= 1 << d,
                -1 => down |= 1 << d,
                _ => return self.find(key),
            }
        }
        let ahead = self.forward[from as usize][up];
        let found = if ahead == NONE { NONE } else { self.backward[ahead as usize][down] };
        (found != NONE).then_some(found)
    }

    /// Position of a node along one axis [m].
    pub fn node_position(&self, axis: usize, node: i64) -> f64 {
        self.origin[axis] + node as f64 * self.spacing
    }

    /// Number of active nodes.
    pub fn node_count(&self) -> usize {
        self.order.len() * block_nodes(D)
    }

    /// Where the records of the node with this number stand.
    pub fn record(&self, node: usize) -> usize {
        let nodes = block_nodes(D);
        self.order[node / nodes] as usize * nodes + node % nodes
    }

    /// Number of a node (place of its block in Morton order times 4^D, plus its place in the block), if its block is active.
    pub fn find_node(&self, index: [i64; D]) -> Option<usize> {
        let mut key = [0i32; D];
        let mut local = 0;
        for d in 0..D {
            let (block, place) = split_node(index[d]);
            key[d] = i32::try_from(block).ok()?;
            local = local * EDGE + place;
        }
        self.find(&key).map(|slot| self.place[slot as usize] as usize * block_nodes(D) + local)
    }

    /// Integer index of the node with this number.
    pub fn node_index(&self, node: usize) -> Option<[i64; D]> {
        let slot = self.order.get(node / block_nodes(D))?;
        let key = self.keys[*slot as usize];
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
        let keys = self.keys.capacity() + self.fresh.capacity();
        let slots = self.order.capacity() + self.place.capacity() + self.free.capacity();
        let bytes = lanes * size_of::<Lanes>()
            + tables * size_of::<Neighbours>()
            + keys * size_of::<Key<D>>()
            + slots * size_of::<u32>()
            + self.reached.capacity()
            + self.index.bytes();
        GridStats {
            block_edge: EDGE as i64,
            active_blocks: self.order.len() as i64,
            active_nodes: self.node_count() as i64,
            bytes: bytes as i64,
            blocks_created: self.created as i64,
            blocks_removed: self.removed as i64,
        }
    }

    /// Forgets what the last change created and removed.
    pub fn no_change(&mut self) {
        (self.created, self.removed) = (0, 0);
    }

    /// Makes exactly the blocks that the tiles of these owners reach active; with `keep`, the present ones too. An owner
    /// may be named more than once. Slots of blocks that stay may change if most slots are free.
    ///
    /// Errors: [`Status::OutOfMemory`](crate::error::Status::OutOfMemory), with the blocks as they were or as they shall be; the call can be
    /// repeated.
    pub fn set_owners(&mut self, owners: &[Key<D>], keep: bool) -> Result<()> {
        self.reach(owners)?;
        let gone = self.order.iter().filter(|slot| !keep && !self.reached[**slot as usize]).count();
        let blocks = self.order.len() - gone + self.fresh.len();
        if blocks > self.keys.len() {
            self.resize(room(blocks))?;
        }
        if gone > 0 {
            self.remove_unreached();
        }
        self.create_fresh();
        (self.created, self.removed) = (self.fresh.len(), gone);
        if self.keys.len() > SMALL && 4 * blocks < self.keys.len() {
            self.compact()?;
        }
        Ok(())
    }

    /// Marks the blocks that the owners' tiles reach, and lists those that do not exist yet, along the Morton curve.
    fn reach(&mut self, owners: &[Key<D>]) -> Result<()> {
        self.reached.fill(false);
        self.fresh.clear();
        for owner in owners {
            let slot = self.find(owner);
            for corner in 0..1 << D {
                let key = step(owner, corner, 1);
                let known = match slot {
                    Some(slot) => self.forward[slot as usize][corner],
                    None => self.find(&key).unwrap_or(NONE),
                };
                if known != NONE {
                    self.reached[known as usize] = true;
                } else {
                    reserve(&mut self.fresh, 1, WHAT)?;
                    self.fresh.push(key);
                }
            }
        }
        self.fresh.sort_unstable_by(morton_order);
        self.fresh.dedup();
        Ok(())
    }

    /// More slots, all free.
    fn resize(&mut self, slots: usize) -> Result<()> {
        let (old, nodes) = (self.keys.len(), slots * block_nodes(D));
        for record in [&mut self.velocity, &mut self.increment, &mut self.force] {
            reserve_exact(record, nodes, WHAT)?;
        }
        for table in [&mut self.forward, &mut self.backward] {
            reserve_exact(table, slots, WHAT)?;
        }
        for list in [&mut self.order, &mut self.place, &mut self.free] {
            reserve_exact(list, slots, WHAT)?;
        }
        reserve_exact(&mut self.keys, slots, WHAT)?;
        reserve_exact(&mut self.fresh, slots, WHAT)?;
        reserve_exact(&mut self.reached, slots, WHAT)?;
        self.index.reserve(slots, &self.keys)?;
        for record in [&mut self.velocity, &mut self.increment, &mut self.force] {
            record.resize(nodes, [0.0; 4]);
        }
        for table in [&mut self.forward, &mut self.backward] {
            table.resize(slots, [NONE; 8]);
        }
        self.keys.resize(slots, [0; D]);
        self.place.resize(slots, NONE);
        self.reached.resize(slots, true);
        self.free.extend((old as u32..slots as u32).rev());
        Ok(())
    }

    /// Frees the slots of blocks that no tile reaches.
    fn remove_unreached(&mut self) {
        let nodes = block_nodes(D);
        for slot in self.order.iter().map(|slot| *slot as usize) {
            if self.reached[slot] {
                continue;
            }
            for corner in 0..1 << D {
                let (ahead, behind) = (self.forward[slot][corner], self.backward[slot][corner]);
                if ahead != NONE {
                    self.backward[ahead as usize][corner] = NONE;
                }
                if behind != NONE {
                    self.forward[behind as usize][corner] = NONE;
                }
            }
            (self.forward[slot], self.backward[slot]) = ([NONE; 8], [NONE; 8]);
            self.index.remove(slot as u32, &self.keys);
            self.place[slot] = NONE;
            self.free.push(slot as u32);
            for record in [&mut self.velocity, &mut self.increment, &mut self.force] {
                record[slot * nodes..(slot + 1) * nodes].fill([0.0; 4]);
            }
        }
        self.order.retain(|slot| self.reached[*slot as usize]);
    }

    /// Gives the blocks of the list `fresh` slots, neighbours and their place in the order.
    fn create_fresh(&mut self) {
        for key in &self.fresh {
            let slot = self.free.pop().expect("there is a slot for every block");
            self.keys[slot as usize] = *key;
            self.index.insert(slot, &self.keys);
        }
        let (mut old, mut new) = (self.order.len(), self.fresh.len());
        self.order.resize(old + new, NONE);
        while new > 0 {
            let key = self.fresh[new - 1];
            let before = |slot: u32| morton_order(&self.keys[slot as usize], &key).is_lt();
            if old == 0 || before(self.order[old - 1]) {
                let slot = self.find(&key).expect("the block has just been made");
                self.link(slot as usize);
                self.order[old + new - 1] = slot;
                new -= 1;
            } else {
                self.order[old + new - 1] = self.order[old - 1];
                old -= 1;
            }
        }
        for (place, slot) in self.order.iter().enumerate() {
            self.place[*slot as usize] = place as u32;
        }
    }

    /// Makes a block and its neighbours known to each other.
    fn link(&mut self, slot: usize) {
        let key = self.keys[slot];
        for corner in 0..1 << D {
            if let Some(ahead) = self.find(&step(&key, corner, 1)) {
                self.forward[slot][corner] = ahead;
                self.backward[ahead as usize][corner] = slot as u32;
            }
            if let Some(behind) = self.find(&step(&key, corner, -1)) {
                self.backward[slot][corner] = behind;
                self.forward[behind as usize][corner] = slot as u32;
            }
        }
    }

    /// Gives memory back: the blocks get new slots, in Morton order, and as many free ones. Their records are lost.
    fn compact(&mut self) -> Result<()> {
        let mut fresh = Vec::new();
        reserve(&mut fresh, self.order.len(), WHAT)?;
        fresh.extend(self.order.iter().map(|slot| self.keys[*slot as usize]));
        let (created, removed) = (self.created, self.removed);
        let mut small = Self::new(self.spacing, self.origin);
        small.resize(room(2 * fresh.len()))?;
        *self = Self { fresh, created, removed, ..small };
        self.create_fresh();
        Ok(())
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
        grid.set_owners(&[[-1, 0]], false).expect("memory");
        let stats = grid.stats();
        assert_eq!((stats.active_blocks, stats.blocks_created, stats.blocks_removed), (4, 4, 0));
        grid.set_owners(&[[0, 0]], false).expect("memory");
        let stats = grid.stats();
        assert_eq!((stats.active_blocks, stats.blocks_created, stats.blocks_removed), (4, 2, 2));
        grid.set_owners(&[[5, 5]], true).expect("memory");
        assert_eq!(grid.stats().active_blocks, 8);
        let b = grid.find(&[0, 0]).expect("an owner is active") as usize;
        assert_eq!(grid.forward[b][0] as usize, b);
        assert_eq!(grid.keys()[grid.forward[b][3] as usize], [1, 1]);
        assert_eq!(grid.backward[b][1], NONE);
    }

    /// Order, index and neighbours are those of a grid that is made at once.
    fn check<const D: usize>(grid: &Grid<D>, owners: &[Key<D>]) {
        let mut whole = Grid::<D>::new(1.0, [0.0; D]);
        whole.set_owners(owners, false).expect("memory");
        let keys = |g: &Grid<D>| g.order.iter().map(|s| g.keys[*s as usize]).collect::<Vec<_>>();
        assert_eq!(keys(grid), keys(&whole));
        assert_eq!(grid.order.len() + grid.free.len(), grid.keys.len());
        assert!(grid.free.iter().all(|s| grid.place[*s as usize] == NONE));
        assert!(grid.free.iter().all(|s| grid.forward[*s as usize] == [NONE; 8]));
        for (place, slot) in grid.order.iter().enumerate() {
            let key = grid.keys[*slot as usize];
            assert_eq!((grid.place[*slot as usize], grid.find(&key)), (place as u32, Some(*slot)));
            for corner in 0..1 << D {
                let at = |sign| grid.find(&step(&key, corner, sign)).unwrap_or(NONE);
                assert_eq!(grid.forward[*slot as usize][corner], at(1));
                assert_eq!(grid.backward[*slot as usize][corner], at(-1));
            }
        }
    }

    #[test]
    fn slots_that_come_and_go_equal_a_grid_made_at_once() {
        let mut grid = Grid::<3>::new(1.0, [0.0; 3]);
        let mut seed = 1u32;
        let mut random = |n: u32| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            ((seed >> 16) % n) as i32
        };
        for round in 0..60 {
            let (count, width) = if round % 20 == 19 { (3, 40) } else { (200, 6 + round as u32) };
            let coordinate = |random: &mut dyn FnMut(u32) -> i32| random(width) - 5;
            let owners: Vec<Key<3>> =
                (0..count).map(|_| std::array::from_fn(|_| coordinate(&mut random))).collect();
            grid.set_owners(&owners, false).expect("memory");
            check(&grid, &owners);
        }
    }

    #[test]
    fn a_neighbour_is_found_without_the_index() {
        let mut grid = Grid::<3>::new(1.0, [0.0; 3]);
        grid.set_owners(&[[0, 0, 0], [1, -1, 0], [9, 9, 9]], false).expect("memory");
        let from = grid.find(&[0, 0, 0]).expect("an owner");
        for n in 0..125 {
            let key = [n / 25 - 2, n / 5 % 5 - 2, n % 5 - 2];
            assert_eq!(grid.find_near(from, &key), grid.find(&key), "{key:?}");
        }
        assert_eq!(grid.find_near(from, &[9, 9, 9]), grid.find(&[9, 9, 9]));
    }

    #[test]
    fn a_node_is_found_by_its_index_and_back() {
        let mut grid = Grid::<3>::new(1.0, [0.0; 3]);
        grid.set_owners(&[[-2, 0, 7]], false).expect("memory");
        for index in [[-8, 0, 28], [-5, 3, 31], [-1, 7, 35]] {
            let node = grid.find_node(index).expect("inside an active block");
            assert_eq!(grid.node_index(node), Some(index));
        }
        assert_eq!(grid.find_node([0, 0, 0]), None);
    }
}
