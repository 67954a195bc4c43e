//! The sparse background grid: blocks of 4^D nodes that appear where particles are and vanish
//! behind them.
//!
//! [`blocks`] is the topology, [`nodes`] what the nodes hold, [`tiles`] the patches between
//! particles and nodes, [`space`] where all of it stands.

pub mod blocks;
pub mod index;
pub mod key;
pub mod nodes;
pub mod space;
pub mod tiles;

pub use blocks::{Blocks, NONE};
pub use key::{EDGE, Key, block_nodes};
pub use nodes::{Held, Nodes, Record};
pub use space::Space;
pub use tiles::{Run, TileNode, Tiles};

use crate::choice::choices;
use crate::error::Result;

/// Room to make for the nodes of `n` blocks or tiles, whose number comes and goes: an eighth to a
/// half more, so that it seldom grows. It depends on n alone, not on how many there were before.
pub fn room(n: usize) -> usize {
    (n + n / 8).next_multiple_of((n.next_power_of_two() / 8).max(8))
}

choices! {
    /// How blocks come and go.
    pub enum GridPolicy: "grid_policy" {
        /// Grid: blocks come and go with the particles (default).
        Dynamic = 0, "dynamic", LAHAR_GRID_DYNAMIC;
        /// Grid: blocks come with the particles and stay.
        GrowOnly = 1, "grow_only", LAHAR_GRID_GROW_ONLY, "grow only";
        /// Grid: the blocks of a fixed box; a particle that leaves it is an error.
        Static = 2, "static", LAHAR_GRID_STATIC;
    }
}

/// What a background grid consists of at the moment.
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

/// The background grid of a world.
#[derive(Debug)]
pub struct Background<const D: usize> {
    /// Where the nodes stand, and the walls between which shape functions are modified.
    pub space: Space<D>,
    /// Which blocks there are.
    pub blocks: Blocks<D>,
    /// What their nodes hold; the nodes of slot s are numbers s · 4^D and following.
    pub nodes: Nodes,
    /// The tiles of the blocks with particles.
    pub tiles: Tiles,
}

impl<const D: usize> Background<D> {
    /// A grid without blocks, for stencils of `shape_nodes` nodes an axis.
    pub fn new(space: Space<D>, shape_nodes: usize) -> Self {
        let (blocks, nodes) = (Blocks::default(), Nodes::default());
        Self { space, blocks, nodes, tiles: Tiles::new(shape_nodes) }
    }

    /// Makes exactly the blocks that the tiles of these owners reach active; with `keep_active`,
    /// the present ones too. An owner may be named more than once. Slots of blocks that stay may
    /// change if most are free.
    ///
    /// Errors: [`Status::OutOfMemory`](crate::error::Status::OutOfMemory), with the blocks as they
    /// were or as they shall be; the call can be repeated.
    pub fn set_owners(&mut self, owners: &[Key<D>], keep_active: bool) -> Result<()> {
        let Self { blocks, nodes, .. } = self;
        let slots = blocks.plan(owners, keep_active)?;
        nodes.reserve(slots * block_nodes(D))?;
        blocks.carry_out(slots)?;
        nodes.resize(slots * block_nodes(D));
        for slot in blocks.freed() {
            nodes.clear(nodes_of::<D>(*slot as usize));
        }
        if let Some(small) = blocks.compacted()? {
            let mut few = Nodes::default();
            let count = small.keys().len() * block_nodes(D);
            few.reserve(count)?;
            few.resize(count);
            (*blocks, *nodes) = (small, few);
        }
        Ok(())
    }

    /// Numbers of blocks and nodes, and the memory.
    pub fn stats(&self) -> GridStats {
        let Self { blocks, nodes, tiles, .. } = self;
        let (created, removed) = blocks.turnover();
        GridStats {
            block_edge: EDGE as i64,
            active_blocks: blocks.order().len() as i64,
            active_nodes: blocks.node_count() as i64,
            bytes: (blocks.bytes() + nodes.bytes() + tiles.bytes()) as i64,
            blocks_created: created as i64,
            blocks_removed: removed as i64,
        }
    }
}

/// About the memory that a block of `dimension` axes takes without its tiles [bytes]: its nodes, and
/// its neighbours of both sides.
pub const fn bytes_of_block(dimension: usize) -> usize {
    3 * block_nodes(dimension) * size_of::<Record>() + 2 * size_of::<blocks::Neighbours>()
}

/// Numbers of the nodes of the block in a slot.
pub fn nodes_of<const D: usize>(slot: usize) -> std::ops::Range<usize> {
    slot * block_nodes(D)..(slot + 1) * block_nodes(D)
}
