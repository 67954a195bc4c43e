//! The set of active blocks: keys, slots, neighbours. What the nodes hold is in
//! [`nodes`](super::nodes).

use super::index::Index;
use super::key::{Key, block_nodes, morton_order, split_node};
use super::{EDGE, room};
use crate::error::Result;
use crate::memory::{reserve, reserve_exact};

/// No block.
pub const NONE: u32 = u32::MAX;

/// What memory is for, if there is none.
const WHAT: &str = "the blocks of the grid";

/// A grid of at most so many slots is never compacted.
const SMALL: usize = 64;

/// Slots of the blocks around one; bit d of the corner number stands for a step along axis d.
pub type Neighbours = [u32; 8];

/// Blocks, each with 4^D nodes in row-major order (last axis fastest).
///
/// A block stays in its slot, and its nodes' records stay where they are, from the step in which it
/// appears until it vanishes. Tables and records go by slot; a free slot has no neighbours and
/// nodes without mass. Hosts know nodes by numbers that go by the Morton order of the blocks: see
/// [`Blocks::record`].
///
/// An active slot is **owned**, or a **ghost**: a block that tiles here reach and that somebody
/// else updates. Until work is shared among processes all are owned.
#[derive(Debug)]
pub struct Blocks<const D: usize> {
    keys: Vec<Key<D>>,
    index: Index,
    order: Vec<u32>,
    place: Vec<u32>,
    free: Vec<u32>,
    ghost: Vec<bool>,
    /// For each slot the slots of the blocks that its tile reaches, itself first.
    pub forward: Vec<Neighbours>,
    /// For each slot the slots of the blocks whose tiles reach it, itself first.
    pub backward: Vec<Neighbours>,
    created: usize,
    removed: usize,
    reached: Vec<bool>,
    fresh: Vec<Key<D>>,
    freed: Vec<u32>,
}

impl<const D: usize> Default for Blocks<D> {
    fn default() -> Self {
        Self {
            keys: Vec::new(),
            index: Index::default(),
            order: Vec::new(),
            place: Vec::new(),
            free: Vec::new(),
            ghost: Vec::new(),
            forward: Vec::new(),
            backward: Vec::new(),
            created: 0,
            removed: 0,
            reached: Vec::new(),
            fresh: Vec::new(),
            freed: Vec::new(),
        }
    }
}

impl<const D: usize> Blocks<D> {
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

    /// Slots of the blocks that are updated here, in Morton order.
    pub fn owned(&self) -> impl Iterator<Item = usize> {
        let slots = self.order.iter().map(|slot| *slot as usize);
        slots.filter(|slot| !self.ghost[*slot])
    }

    /// Makes those of the active blocks ghosts whose keys are chosen, and all others owned.
    pub fn set_ghosts(&mut self, is_ghost: impl Fn(&Key<D>) -> bool) {
        for slot in self.order.iter().map(|slot| *slot as usize) {
            self.ghost[slot] = is_ghost(&self.keys[slot]);
        }
    }

    /// Slot of the block with this key.
    pub fn find(&self, key: &Key<D>) -> Option<u32> {
        self.index.find(key, &self.keys)
    }

    /// Slot of the block with this key, which is most likely next to the block in slot `from`, an
    /// owner of particles.
    #[inline]
    pub fn find_near(&self, from: u32, key: &Key<D>) -> Option<u32> {
        let old = &self.keys[from as usize];
        let (mut up, mut down) = (0, 0);
        if key.layer != old.layer {
            return self.find(key);
        }
        for d in 0..D {
            match key.at[d] - old.at[d] {
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

    /// Number of active nodes.
    pub fn node_count(&self) -> usize {
        self.order.len() * block_nodes(D)
    }

    /// Where the records of the node with this number stand.
    pub fn record(&self, node: usize) -> usize {
        let nodes = block_nodes(D);
        self.order[node / nodes] as usize * nodes + node % nodes
    }

    /// Number of a node of a layer (place of its block in Morton order times 4^D, plus its number
    /// in the block), if its block is active.
    pub fn find_node(&self, layer: u32, index: [i64; D]) -> Option<usize> {
        let mut key = Key { layer, at: [0; D] };
        let mut local = 0;
        for d in 0..D {
            let (block, within) = split_node(index[d]);
            key.at[d] = i32::try_from(block).ok()?;
            local = local * EDGE + within;
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
            index[d] = i64::from(key.at[d]) * EDGE as i64 + (local % EDGE) as i64;
            local /= EDGE;
        }
        Some(index)
    }

    /// Blocks that were created and removed since [`Blocks::no_change`].
    pub fn turnover(&self) -> (usize, usize) {
        (self.created, self.removed)
    }

    /// Memory [bytes].
    pub fn bytes(&self) -> usize {
        let tables = self.forward.capacity() + self.backward.capacity();
        let keys = self.keys.capacity() + self.fresh.capacity();
        let slots = [&self.order, &self.place, &self.free, &self.freed];
        let slots: usize = slots.into_iter().map(Vec::capacity).sum();
        tables * size_of::<Neighbours>()
            + keys * size_of::<Key<D>>()
            + slots * size_of::<u32>()
            + self.reached.capacity()
            + self.ghost.capacity()
            + self.index.bytes()
    }

    /// Begins to count created and removed blocks anew.
    pub fn no_change(&mut self) {
        (self.created, self.removed) = (0, 0);
    }

    /// First half of a change: determines which blocks shall be active, those that the tiles of the
    /// owners reach, and with `keep_active` the present ones too. An owner may be named more than
    /// once. Returns the number of slots that the second half needs.
    pub fn plan(&mut self, owners: &[Key<D>], keep_active: bool) -> Result<usize> {
        self.reach(owners)?;
        if keep_active {
            self.order.iter().for_each(|slot| self.reached[*slot as usize] = true);
        }
        let stays = self.order.iter().filter(|slot| self.reached[**slot as usize]).count();
        let blocks = stays + self.fresh.len();
        Ok(if blocks > self.keys.len() { room(blocks) } else { self.keys.len() })
    }

    /// Second half: there are `slots` slots, and exactly the planned blocks are active. Slots that
    /// were freed are listed in [`Blocks::freed`].
    ///
    /// Errors: [`Status::OutOfMemory`](crate::error::Status::OutOfMemory), with the blocks as they
    /// were.
    pub fn carry_out(&mut self, slots: usize) -> Result<()> {
        self.freed.clear();
        if slots > self.keys.len() {
            self.resize(slots)?;
        }
        if self.order.iter().any(|slot| !self.reached[*slot as usize]) {
            self.remove_unreached();
        }
        self.create_fresh();
        self.created += self.fresh.len();
        self.removed += self.freed.len();
        Ok(())
    }

    /// Slots of the blocks that the last change removed.
    pub fn freed(&self) -> &[u32] {
        &self.freed
    }

    /// The same blocks in new slots, in Morton order, with as many free ones; None unless most
    /// slots are free now.
    pub fn compacted(&self) -> Result<Option<Self>> {
        if self.keys.len() <= SMALL || 4 * self.order.len() >= self.keys.len() {
            return Ok(None);
        }
        let mut fresh = Vec::new();
        reserve(&mut fresh, self.order.len(), WHAT)?;
        fresh.extend(self.order.iter().map(|slot| self.keys[*slot as usize]));
        let mut small = Self::default();
        small.resize(room(2 * fresh.len()))?;
        let (created, removed) = (self.created, self.removed);
        small = Self { fresh, created, removed, ..small };
        small.create_fresh();
        for slot in self.order.iter().map(|slot| *slot as usize).filter(|slot| self.ghost[*slot]) {
            if let Some(new) = small.find(&self.keys[slot]) {
                small.ghost[new as usize] = true;
            }
        }
        Ok(Some(small))
    }

    /// Marks the blocks that the owners' tiles reach, and lists those that do not exist yet, along
    /// the Morton curve.
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
        let old = self.keys.len();
        for table in [&mut self.forward, &mut self.backward] {
            reserve_exact(table, slots, WHAT)?;
        }
        for list in [&mut self.order, &mut self.place, &mut self.free, &mut self.freed] {
            reserve_exact(list, slots, WHAT)?;
        }
        reserve_exact(&mut self.keys, slots, WHAT)?;
        reserve_exact(&mut self.fresh, slots, WHAT)?;
        reserve_exact(&mut self.reached, slots, WHAT)?;
        reserve_exact(&mut self.ghost, slots, WHAT)?;
        self.index.reserve(slots, &self.keys)?;
        for table in [&mut self.forward, &mut self.backward] {
            table.resize(slots, [NONE; 8]);
        }
        self.keys.resize(slots, Key { layer: 0, at: [0; D] });
        self.place.resize(slots, NONE);
        self.reached.resize(slots, true);
        self.ghost.resize(slots, false);
        self.free.extend((old as u32..slots as u32).rev());
        Ok(())
    }

    /// Frees the slots of blocks that no tile reaches.
    fn remove_unreached(&mut self) {
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
            self.ghost[slot] = false;
            self.free.push(slot as u32);
            self.freed.push(slot as u32);
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

    /// Enters a block and its neighbours into each other's tables.
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
}

fn step<const D: usize>(key: &Key<D>, corner: usize, sign: i32) -> Key<D> {
    let at = std::array::from_fn(|d| key.at[d] + sign * (corner >> d & 1) as i32);
    Key { at, ..*key }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn key<const D: usize>(at: [i32; D]) -> Key<D> {
        Key { layer: 0, at }
    }

    /// Both halves of a change, and the compaction.
    fn set_owners<const D: usize>(grid: &mut Blocks<D>, owners: &[Key<D>], keep_active: bool) {
        grid.no_change();
        let slots = grid.plan(owners, keep_active).expect("memory");
        grid.carry_out(slots).expect("memory");
        if let Some(small) = grid.compacted().expect("memory") {
            *grid = small;
        }
    }

    #[test]
    fn blocks_appear_with_their_neighbours_and_vanish_behind() {
        let mut grid = Blocks::<2>::default();
        set_owners(&mut grid, &[key([-1, 0])], false);
        assert_eq!((grid.order.len(), grid.turnover()), (4, (4, 0)));
        set_owners(&mut grid, &[key([0, 0])], false);
        assert_eq!((grid.order.len(), grid.turnover(), grid.freed.len()), (4, (2, 2), 2));
        set_owners(&mut grid, &[key([5, 5])], true);
        assert_eq!(grid.order.len(), 8);
        let b = grid.find(&key([0, 0])).expect("an owner is active") as usize;
        assert_eq!(grid.forward[b][0] as usize, b);
        assert_eq!(grid.keys()[grid.forward[b][3] as usize], key([1, 1]));
        assert_eq!(grid.backward[b][1], NONE);
    }

    /// Order, index and neighbours are those of a grid that is made at once.
    fn check<const D: usize>(grid: &Blocks<D>, owners: &[Key<D>]) {
        let mut whole = Blocks::<D>::default();
        set_owners(&mut whole, owners, false);
        let keys = |g: &Blocks<D>| g.order.iter().map(|s| g.keys[*s as usize]).collect::<Vec<_>>();
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
        let mut grid = Blocks::<3>::default();
        let mut seed = 1u32;
        let mut random = |n: u32| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            ((seed >> 16) % n) as i32
        };
        for round in 0..60 {
            let (count, width) = if round % 20 == 19 { (3, 40) } else { (200, 6 + round as u32) };
            let coordinate = |random: &mut dyn FnMut(u32) -> i32| random(width) - 5;
            let owners: Vec<Key<3>> =
                (0..count).map(|_| key(std::array::from_fn(|_| coordinate(&mut random)))).collect();
            set_owners(&mut grid, &owners, false);
            check(&grid, &owners);
        }
    }

    #[test]
    fn a_neighbour_is_found_without_the_index() {
        let mut grid = Blocks::<3>::default();
        set_owners(&mut grid, &[[0, 0, 0], [1, -1, 0], [9, 9, 9]].map(key), false);
        let from = grid.find(&key([0, 0, 0])).expect("an owner");
        for n in 0..125 {
            let key = key([n / 25 - 2, n / 5 % 5 - 2, n % 5 - 2]);
            assert_eq!(grid.find_near(from, &key), grid.find(&key), "{key:?}");
        }
        assert_eq!(grid.find_near(from, &key([9, 9, 9])), grid.find(&key([9, 9, 9])));
    }

    #[test]
    fn a_node_is_found_by_its_index_and_back() {
        let mut grid = Blocks::<3>::default();
        set_owners(&mut grid, &[key([-2, 0, 7])], false);
        for index in [[-8, 0, 28], [-5, 3, 31], [-1, 7, 35]] {
            let node = grid.find_node(0, index).expect("inside an active block");
            assert_eq!(grid.node_index(node), Some(index));
        }
        assert_eq!(grid.find_node(0, [0, 0, 0]), None);
    }

    #[test]
    fn layers_have_blocks_of_their_own_at_the_same_coordinates() {
        let mut grid = Blocks::<2>::default();
        let upper = Key { layer: 1, at: [0, 0] };
        set_owners(&mut grid, &[key([0, 0]), upper], false);
        assert_eq!(grid.order.len(), 8);
        let slots = [key([0, 0]), upper].map(|key| grid.find(&key).expect("an owner"));
        assert_ne!(slots[0], slots[1]);
        for (layer, slot) in slots.into_iter().enumerate() {
            let ahead = grid.forward[slot as usize][3] as usize;
            assert_eq!(grid.keys()[ahead], Key { layer: layer as u32, at: [1, 1] });
            assert_eq!(grid.find_near(slots[0], &grid.keys()[ahead]), Some(ahead as u32));
        }
        let layers: Vec<u32> = grid.owned().map(|slot| grid.keys()[slot].layer).collect();
        assert_eq!(layers, [0, 0, 0, 0, 1, 1, 1, 1], "one layer after the other");
        assert_ne!(grid.find_node(0, [2, 3]), grid.find_node(1, [2, 3]));
    }

    #[test]
    fn ghosts_are_active_but_not_owned() {
        let mut grid = Blocks::<2>::default();
        set_owners(&mut grid, &[key([0, 0])], false);
        assert_eq!(grid.owned().count(), 4);
        grid.set_ghosts(|key| key.at[0] == 1);
        assert_eq!(grid.owned().count(), 2);
        assert!(grid.owned().all(|slot| grid.keys()[slot].at[0] == 0));
        let ahead = grid.forward[grid.find(&key([0, 0])).expect("an owner") as usize][1];
        assert_eq!(grid.keys()[ahead as usize], key([1, 0]), "tiles reach a ghost");
    }
}
