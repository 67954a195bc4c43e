//! Hooks: calls into the middle of a step, for Rust callers and tests. A step that is repeated
//! smaller calls them again.

use crate::background::Background;

/// Where in a step a hook runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HookPoint {
    /// After the particles are sorted into blocks.
    Start = 0,
    /// When the grid holds mass, momentum and force.
    AfterScatter = 1,
    /// When the grid holds the new velocities, boundaries included.
    AfterBoundaries = 2,
    /// When the particles are updated.
    End = 3,
}

/// Number of hook points.
pub const HOOK_POINTS: usize = 4;

/// The active nodes of a grid, whatever its dimension.
pub trait Nodes {
    /// Number of active nodes.
    fn count(&self) -> usize;
    /// Position of a node [m]; z is 0 in two dimensions.
    fn position(&self, node: usize) -> [f64; 3];
    /// Mass of a node [kg].
    fn mass(&self, node: usize) -> f64;
    /// Velocity of a node [m/s]; momentum before the grid update.
    fn velocity(&self, node: usize) -> [f64; 3];
    /// Prescribes the velocity of a node [m/s]; its increment follows. After the boundaries only.
    fn set_velocity(&mut self, node: usize, velocity: [f64; 3]);
}

impl<const D: usize> Nodes for Background<D> {
    fn count(&self) -> usize {
        self.blocks.node_count()
    }

    fn position(&self, node: usize) -> [f64; 3] {
        let index = self.blocks.node_index(node).unwrap_or([0; D]);
        let mut x = [0.0; 3];
        for d in 0..D {
            x[d] = self.space.node_position(d, index[d] as f64);
        }
        x
    }

    fn mass(&self, node: usize) -> f64 {
        self.nodes.velocity[self.blocks.record(node)].mass()
    }

    fn velocity(&self, node: usize) -> [f64; 3] {
        self.nodes.velocity[self.blocks.record(node)].vector()
    }

    fn set_velocity(&mut self, node: usize, velocity: [f64; 3]) {
        let node = self.blocks.record(node);
        let (record, increment) = (&mut self.nodes.velocity[node], &mut self.nodes.increment[node]);
        for a in 0..D {
            let before = std::mem::replace(record.component_mut(a), velocity[a]);
            *increment.component_mut(a) += velocity[a] - before;
        }
    }
}

/// What a hook sees: the time at the start of the step [s], the step [s], the nodes.
pub struct HookArguments<'a> {
    /// Time at the start of the step [s].
    pub time: f64,
    /// Length of the step [s].
    pub dt: f64,
    /// The grid.
    pub nodes: &'a mut dyn Nodes,
}

/// A hook.
pub type Hook = Box<dyn FnMut(HookArguments<'_>) + Send + Sync>;
