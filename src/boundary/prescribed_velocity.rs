//! Velocities prescribed on a region of the grid.

use std::ops::Range;

use super::wall::ROUND_OFF;
use super::{BoxRegion, Condition, Holding, Table};
use crate::background::{Background, EDGE, Key, Record, Space, block_nodes};
use crate::error::{Error, Result};

/// The component along x in [`PrescribedVelocity::components`].
pub const X: i32 = 1;
/// The component along y.
pub const Y: i32 = 2;
/// The component along z.
pub const Z: i32 = 4;

/// The nodes in a box move with a given velocity, whatever the forces on them.
#[derive(Clone, Debug)]
pub struct PrescribedVelocity {
    /// Where: the nodes in this box, to 1e-9 of the spacing.
    pub region: BoxRegion,
    /// Which components: the sum of [`X`], [`Y`] and [`Z`]; the others stay free.
    pub components: i32,
    /// The velocity [m/s].
    pub velocity: Table,
}

impl PrescribedVelocity {
    /// Whether the condition makes sense in a world of `dimension` axes.
    pub fn check(&self, dimension: usize) -> Result<()> {
        self.region.check("a prescribed velocity", dimension)?;
        let all = if dimension == 3 { X | Y | Z } else { X | Y };
        if !(1..=all).contains(&self.components) {
            return Err(Error::invalid(format!(
                "components must be the sum of 1 (x), 2 (y){} for the components that are prescribed, got {}",
                if dimension == 3 { " and 4 (z)" } else { ", in two dimensions without z," },
                self.components
            )));
        }
        Ok(())
    }

    /// Whether the velocity along an axis is prescribed.
    pub fn holds(&self, axis: usize) -> bool {
        self.components >> axis & 1 == 1
    }

    /// Calls `visit` for each node of block `key` inside the box, with its index in the block.
    pub fn for_nodes_inside<const D: usize>(
        &self,
        space: &Space<D>,
        key: &Key<D>,
        mut visit: impl FnMut(usize),
    ) {
        let mut layers: [Range<usize>; D] = std::array::from_fn(|_| 0..0);
        for d in 0..D {
            layers[d] = self.layers_inside(space, key, d);
            if layers[d].is_empty() {
                return;
            }
        }
        for node in 0..block_nodes(D) {
            let layer = |d: usize| node / EDGE.pow((D - 1 - d) as u32) % EDGE;
            if (0..D).all(|d| layers[d].contains(&layer(d))) {
                visit(node);
            }
        }
    }

    /// Layers of nodes of block `key`, along axis d, that are inside the box.
    fn layers_inside<const D: usize>(
        &self,
        space: &Space<D>,
        key: &Key<D>,
        d: usize,
    ) -> Range<usize> {
        let lowest = f64::from(key.at[d]) * EDGE as f64;
        let units = |x: f64| (x - space.origin[d]) * space.inverse;
        let (min, max) = (units(self.region.min[d]), units(self.region.max[d]));
        let inside = |layer: &usize| {
            let at = space.fits[d].position(lowest + *layer as f64);
            min - ROUND_OFF <= at && at <= max + ROUND_OFF
        };
        let first = (0..EDGE).find(inside).unwrap_or(EDGE);
        first..(first..EDGE).rfind(inside).map_or(first, |last| last + 1)
    }
}

/// A prescribed velocity in a world.
#[derive(Clone, Debug)]
pub struct Prescribed {
    /// The condition.
    pub condition: PrescribedVelocity,
    /// Velocity of the nodes at the end of the step [m/s].
    pub target: [f64; 3],
}

impl Condition for Prescribed {
    const WHAT: &'static str = "prescribed velocity";

    fn end(&self) -> f64 {
        self.condition.velocity.end()
    }

    fn largest_speed(&self, from: f64, until: f64) -> f64 {
        self.condition.velocity.largest(from, until)
    }

    /// Nodes of the box with any mass get the velocity of the end of the step in the components
    /// that are prescribed; what that changes is the reaction. They are few beside the particles:
    /// one thread does it, in the order of the blocks.
    fn hold<const D: usize>(
        &mut self,
        background: &mut Background<D>,
        &Holding { time, dt }: &Holding,
    ) -> Option<[f64; 3]> {
        let target = self.condition.velocity.at(time + dt);
        let mut impulse = [0.0; 3];
        for_each_held(&self.condition, background, |a, velocity, increment| {
            let change = target[a] - velocity.component(a);
            *velocity.component_mut(a) = target[a]; // [CND-3]
            *increment.component_mut(a) += change;
            let mut held = increment.held();
            held.add(a);
            increment.set_held(held);
            impulse[a] += velocity.mass() * change;
        });
        self.target = target;
        Some(impulse)
    }

    fn hold_again<const D: usize>(&self, background: &mut Background<D>) -> Option<[f64; 3]> {
        let mut impulse = [0.0; 3];
        for_each_held(&self.condition, background, |a, velocity, increment| {
            impulse[a] += velocity.mass() * (self.target[a] - increment.component(a));
            *increment.component_mut(a) = self.target[a];
        });
        Some(impulse)
    }
}

/// Calls `visit` with every component that a condition holds, and the velocity and increment of its
/// node.
fn for_each_held<const D: usize>(
    condition: &PrescribedVelocity,
    background: &mut Background<D>,
    mut visit: impl FnMut(usize, &mut Record, &mut Record),
) {
    let Background { space, blocks, nodes, .. } = background;
    for slot in blocks.owned() {
        let first = slot * block_nodes(D);
        condition.for_nodes_inside(space, &blocks.keys()[slot], |node| {
            let node = first + node;
            if nodes.velocity[node].mass() > 0.0 {
                for a in (0..D).filter(|a| condition.holds(*a)) {
                    visit(a, &mut nodes.velocity[node], &mut nodes.increment[node]);
                }
            }
        });
    }
}
