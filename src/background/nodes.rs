//! What nodes hold: three records each, by number, whatever their blocks are.

use crate::error::Result;
use crate::memory::reserve_exact;
use crate::simd::{LANES, TileNode, Vector};

/// What memory is for, if there is none.
const WHAT: &str = "the nodes of the grid";

/// First lane of the mass in a node of a tile.
pub const MASS: usize = 0;
/// First lane of the vector of the first record in a node of a tile: momentum, on the way back
/// velocity.
pub const FIRST: usize = 1;
/// First lane of the vector of the second record: force, on the way back what a gather needs.
pub const SECOND: usize = 5;

/// The components of a velocity that conditions hold, a bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Held(pub u8);

impl Held {
    /// Whether component a is held.
    pub fn has(self, a: usize) -> bool {
        self.0 >> a & 1 == 1
    }

    /// Holds component a too.
    pub fn add(&mut self, a: usize) {
        self.0 |= 1 << a;
    }
}

impl std::ops::BitOr for Held {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

/// A number and a vector of a node; in two dimensions the third component is zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Record([f64; 4]);

impl Record {
    /// The record of an empty node.
    pub const ZERO: Self = Self([0.0; 4]);

    /// A record without a number.
    #[inline(always)]
    pub fn of_vector<const D: usize>(vector: [f64; D]) -> Self {
        let mut record = Self::ZERO;
        record.set_vector(vector);
        record
    }

    /// Mass [kg]; of the record of velocities alone.
    #[inline(always)]
    pub fn mass(&self) -> f64 {
        self.0[0]
    }

    /// One component of the vector.
    #[inline(always)]
    pub fn component(&self, a: usize) -> f64 {
        self.0[1 + a]
    }

    /// One component of the vector, to write.
    #[inline(always)]
    pub fn component_mut(&mut self, a: usize) -> &mut f64 {
        &mut self.0[1 + a]
    }

    /// The vector.
    #[inline(always)]
    pub fn vector<const D: usize>(&self) -> [f64; D] {
        std::array::from_fn(|a| self.0[1 + a])
    }

    /// Sets the vector, and leaves the number.
    #[inline(always)]
    pub fn set_vector<const D: usize>(&mut self, vector: [f64; D]) {
        self.0[1..=D].copy_from_slice(&vector);
    }

    /// The vector divided by a number, without a number of its own.
    #[inline(always)]
    pub fn divided(&self, by: f64) -> Self {
        let [_, x, y, z] = self.0;
        Self([0.0, x / by, y / by, z / by])
    }

    /// Notes what conditions hold of the node: walls in the record of forces, others in that of
    /// changes, whose numbers are free.
    pub fn set_held(&mut self, held: Held) {
        self.0[0] = f64::from(held.0);
    }

    /// What [`Record::set_held`] noted since the last scatter.
    pub fn held(&self) -> Held {
        Held(self.0[0] as u8)
    }

    /// Both records of two nodes.
    #[inline(always)]
    pub fn load_pair<V: Vector>(pair: &[Self; 2]) -> V {
        V::join(&pair[0].0, &pair[1].0)
    }

    /// Writes the records of two nodes.
    #[inline(always)]
    pub fn store_pair<V: Vector>(pair: &mut [Self; 2], lanes: V) {
        let [first, second] = pair;
        lanes.part(&mut first.0, &mut second.0);
    }

    /// Sets the mass of a record of velocities.
    #[inline(always)]
    pub fn set_mass(&mut self, mass: f64) {
        self.0[0] = mass;
    }
}

/// Both records in the lanes of a node of a tile.
#[inline(always)]
pub fn joined<V: Vector>(first: &Record, second: &Record) -> V {
    V::join(&first.0, &second.0)
}

/// The records in the lanes of a node of a tile.
#[inline(always)]
pub fn parted(TileNode([a, b, c, d, e, f, g, h]): &TileNode) -> (Record, Record) {
    (Record([*a, *b, *c, *d]), Record([*e, *f, *g, *h]))
}

/// A vector with `value` along the axes of both records, lane by lane: what [`Record::load_pair`]
/// adds to.
pub fn pair_of_vectors<const D: usize>(value: [f64; D]) -> [f64; LANES] {
    let mut lanes = [0.0; LANES];
    for a in 0..D {
        (lanes[FIRST + a], lanes[SECOND + a]) = (value[a], value[a]);
    }
    lanes
}

/// The records of all nodes.
#[derive(Debug, Default)]
pub struct Nodes {
    /// Mass and momentum [kg, kg m/s] after the scatter, mass and velocity [kg, m/s] after the grid
    /// update.
    pub velocity: Vec<Record>,
    /// Change of velocity after the grid update, and what prescribed velocities hold; in MUSL then the second velocity, in XPIC and FMPM
    /// the velocity that particles take [m/s].
    pub increment: Vec<Record>,
    /// Force of the particles on the node [N], and what walls hold of it.
    pub force: Vec<Record>,
}

impl Nodes {
    fn records(&mut self) -> [&mut Vec<Record>; 3] {
        [&mut self.velocity, &mut self.increment, &mut self.force]
    }

    /// Makes room for `count` nodes in all.
    pub fn reserve(&mut self, count: usize) -> Result<()> {
        self.records().into_iter().try_for_each(|records| reserve_exact(records, count, WHAT))
    }

    /// There are `count` nodes, new ones empty; there is room for them.
    pub fn resize(&mut self, count: usize) {
        self.records().into_iter().for_each(|records| records.resize(count, Record::ZERO));
    }

    /// Empties nodes.
    pub fn clear(&mut self, nodes: std::ops::Range<usize>) {
        self.records().into_iter().for_each(|records| records[nodes.clone()].fill(Record::ZERO));
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.velocity.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.velocity.is_empty()
    }

    /// Memory [bytes].
    pub fn bytes(&self) -> usize {
        let records = [&self.velocity, &self.increment, &self.force];
        records.iter().map(|r| r.capacity()).sum::<usize>() * size_of::<Record>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_do_without_blocks() {
        let mut nodes = Nodes::default();
        nodes.reserve(5).expect("memory");
        nodes.resize(5);
        nodes.velocity[3].set_mass(2.0);
        nodes.velocity[3].set_vector([4.0, 6.0]);
        nodes.increment[3] = nodes.velocity[3].divided(2.0);
        assert_eq!(nodes.increment[3].vector(), [2.0, 3.0, 0.0]);
        nodes.clear(2..4);
        assert_eq!((nodes.len(), nodes.velocity[3]), (5, Record::ZERO));
    }
}
