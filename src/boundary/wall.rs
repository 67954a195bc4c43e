//! Planar walls normal to an axis.
//!
//! A wall acts on every node whose signed distance to it (positive on the side of the material) is
//! at most its reach: the radius of the shape function's support less one cell, 0 for linear and
//! h/2 for quadratic shapes. With the wall on a node plane (linear) or a half-cell plane
//! (quadratic) no free node's function then reaches the wall; elsewhere the wall acts up to one
//! cell late. All nodes behind it are held too. [`law`](super::law) says what several walls do
//! together.

use std::ops::Range;

use super::{Condition, Entry};
use crate::background::{EDGE, Key, Space};
use crate::choice::choices;
use crate::error::{Error, Result};

/// Nodes this close to the reach of a condition, in cells, still count as reached: the round-off of
/// positions.
pub const ROUND_OFF: f64 = 1e-9;

choices! {
    /// What a wall does to the velocity of a node.
    pub enum WallKind: "kind of wall" {
        /// Wall: nothing moves at it.
        Sticky = 0, "sticky", LAHAR_WALL_STICKY;
        /// Wall: no motion across it, free motion along it.
        Slip = 1, "slip", LAHAR_WALL_SLIP;
        /// Wall: as slip, but material may leave it.
        Separating = 2, "separating", LAHAR_WALL_SEPARATING;
        /// Wall: as separating, with Coulomb friction.
        Friction = 3, "friction", LAHAR_WALL_FRICTION;
    }
}

/// A wall through the whole world, normal to an axis.
#[derive(Clone, Copy, Debug)]
pub struct Wall {
    /// Axis of the normal: 0, 1 or 2.
    pub axis: usize,
    /// +1: the material is at larger coordinates; −1: at smaller ones.
    pub side: i32,
    /// Coordinate of the wall along the axis [m].
    pub position: f64,
    /// What it does.
    pub kind: WallKind,
    /// Friction coefficient μ [–]; used by [`WallKind::Friction`].
    pub friction: f64,
}

impl Wall {
    /// Whether the wall makes sense in a world of `dimension` axes.
    pub fn check(&self, dimension: usize) -> Result<()> {
        if self.axis >= dimension {
            return Err(Error::invalid(format!(
                "a wall's axis must be 0 to {} in {dimension} dimensions, got {}",
                dimension - 1,
                self.axis
            )));
        }
        if self.side != 1 && self.side != -1 {
            return Err(Error::invalid(format!(
                "a wall's side must be 1 (material at larger coordinates) or -1, got {}",
                self.side
            )));
        }
        if !self.position.is_finite() {
            return Err(Error::invalid(format!(
                "a wall's position must be finite, got {}",
                self.position
            )));
        }
        if !(self.friction >= 0.0 && self.friction.is_finite()) {
            return Err(Error::invalid(format!(
                "a wall's friction must be finite and not negative, got {}",
                self.friction
            )));
        }
        Ok(())
    }

    /// The part of a velocity along the wall's normal [m/s]; negative if it approaches.
    pub fn along<const D: usize>(&self, v: &[f64; D]) -> f64 {
        f64::from(self.side) * v[self.axis]
    }

    /// Layers of nodes of block `key`, along the wall's axis, that the wall reaches.
    pub fn reached<const D: usize>(&self, space: &Space<D>, key: &Key<D>) -> Range<usize> {
        let fit = &space.fits[self.axis];
        let side = usize::from(self.side < 0);
        let mut at = (self.position - space.origin[self.axis]) / space.spacing;
        if fit.walls[side].is_finite() {
            if (at - fit.walls[side]).abs() > ROUND_OFF {
                return 0..0; // another one stands in front of it
            }
            at = fit.nodes[side];
        }
        let reach = space.wall_reach + ROUND_OFF; // [BND-3]
        let lowest = f64::from(key.at[self.axis]) * EDGE as f64;
        let clamp = |layer: f64| layer.clamp(0.0, EDGE as f64) as usize;
        if self.side > 0 {
            0..clamp((at + reach).floor() - lowest + 1.0)
        } else {
            clamp((at - reach).ceil() - lowest)..EDGE
        }
    }
}

impl Condition for Wall {
    const WHAT: &'static str = "wall";
}

/// The layer along an axis in which the node of this number stands in its block.
#[inline]
pub fn layer(node: usize, axis: usize, dimension: usize) -> usize {
    node / EDGE.pow((dimension - 1 - axis) as u32) % EDGE
}

/// The walls that reach a node of a block, with their numbers.
#[derive(Clone)]
pub struct Reaching<'a, const D: usize> {
    walls: &'a [Entry<Wall>],
    next: usize,
    space: &'a Space<D>,
    key: &'a Key<D>,
    node: usize,
}

impl<'a, const D: usize> Reaching<'a, D> {
    /// Those that reach the node of this number of a block.
    pub fn new(
        walls: &'a [Entry<Wall>],
        space: &'a Space<D>,
        key: &'a Key<D>,
        node: usize,
    ) -> Self {
        Self { walls, next: 0, space, key, node }
    }
}

impl<'a, const D: usize> Iterator for Reaching<'a, D> {
    type Item = (usize, &'a Wall);

    fn next(&mut self) -> Option<Self::Item> {
        while let Some(entry) = self.walls.get(self.next) {
            let (n, wall) = (self.next, &entry.condition);
            self.next += 1;
            if wall.reached(self.space, self.key).contains(&layer(self.node, wall.axis, D)) {
                return Some((n, wall));
            }
        }
        None
    }
}
