//! Where the nodes stand.

use crate::simd::{Real, each};

/// Largest distance from the origins of grid and space, in cells, at which particles are accepted:
/// farther away a double is too coarse for the small moves of a step.
pub const FARTHEST: f64 = 1e8;

/// A wall this close to a node, in cells, stands on it: the round-off of positions.
const ON_NODE: f64 = 1e-9;

/// The walls of an axis between which shape functions are modified, in units of the spacing. The
/// first node in front of a wall moves back onto it; the cell there is one to two cells wide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// Positions of the walls below and above; infinite where there is none.
    pub walls: [f64; 2],
    /// Their nodes.
    pub nodes: [f64; 2],
}

impl Fit {
    /// No walls.
    pub const FREE: Self = {
        let walls = [f64::NEG_INFINITY, f64::INFINITY];
        Self { walls, nodes: walls }
    };

    /// Between walls at these positions.
    pub fn between([low, high]: [f64; 2]) -> Self {
        let mut nodes = [(low - ON_NODE).ceil(), (high + ON_NODE).floor()];
        if nodes[1] < nodes[0] + 1.0 {
            let first = (0.5 * (low + high - 1.0)).round(); // one cell is left
            nodes = [first, first + 1.0];
        }
        let snapped =
            |wall: f64, node: f64| if (wall - node).abs() <= ON_NODE { node } else { wall };
        Self { walls: [snapped(low, nodes[0]), snapped(high, nodes[1])], nodes }
    }

    /// Whether nodes have moved.
    #[inline(always)]
    pub fn moves(&self) -> bool {
        self.walls != self.nodes
    }

    /// How far the nodes of the walls have moved.
    #[inline(always)]
    pub fn moved(&self) -> [f64; 2] {
        let by = |w: usize| self.walls[w] - self.nodes[w];
        [0, 1].map(|w| if self.walls[w].is_finite() { by(w) } else { 0.0 })
    }

    /// Where a node stands.
    pub fn position(&self, node: f64) -> f64 {
        match self.nodes.iter().position(|of_wall| *of_wall == node) {
            Some(w) => self.walls[w],
            None => node,
        }
    }

    /// A position, or the wall if it is behind one.
    #[inline(always)]
    pub fn inside<R: Real>(&self, xi: R) -> R {
        xi.max(R::splat(self.walls[0])).min(R::splat(self.walls[1]))
    }

    /// ξ − offset, of which the lowest node of a stencil is the whole part, such that the wall's
    /// node is the second of a stencil, or the first of two.
    #[inline(always)]
    pub fn start<R: Real>(&self, xi: R, offset: f64) -> R {
        let behind = if offset > 0.0 { 1.0 } else { 0.0 };
        let [low, high] = [self.nodes[0] - behind, self.nodes[1] - 1.0];
        (xi - R::splat(offset)).max(R::splat(low)).min(R::splat(high))
    }
}

/// Where the grid stands in space.
#[derive(Clone, Copy, Debug)]
pub struct Space<const D: usize> {
    /// Position of node 0 [m].
    pub origin: [f64; D],
    /// Distance of nodes [m].
    pub spacing: f64,
    /// One over the distance [1/m].
    pub inverse: f64,
    /// The lowest node of a stencil is floor(ξ − first_offset).
    pub first_offset: f64,
    /// Distance, in cells, at which nodes feel a wall.
    pub wall_reach: f64,
    /// The walls between which shape functions are modified; there are none if they are not.
    pub fits: [Fit; D],
}

impl<const D: usize> Space<D> {
    /// A grid without walls; `first_offset` and `wall_reach` are those of the shape function.
    pub fn new(spacing: f64, origin: [f64; D], first_offset: f64, wall_reach: f64) -> Self {
        let (inverse, fits) = (1.0 / spacing, [Fit::FREE; D]);
        Self { origin, spacing, inverse, first_offset, wall_reach, fits }
    }

    /// The same with walls that modify shape functions: axis, side of the material, and position
    /// [m] of each. Of several on a side the innermost counts.
    pub fn with_walls(mut self, walls: impl Iterator<Item = (usize, i32, f64)>) -> Self {
        let mut innermost = [Fit::FREE.walls; D];
        for (axis, side, position) in walls {
            let at = (position - self.origin[axis]) / self.spacing;
            let [low, high] = &mut innermost[axis];
            if side > 0 {
                *low = low.max(at);
            } else {
                *high = high.min(at);
            }
        }
        self.fits = innermost.map(Fit::between);
        self
    }

    /// Position in units of the spacing, from node 0.
    #[inline(always)]
    pub fn to_units<R: Real>(&self, x: [R; D]) -> [R; D] {
        let inverse = R::splat(self.inverse);
        each!(d in D => (x[d] - R::splat(self.origin[d])) * inverse)
    }

    /// Along each axis a position of which the lowest node of a stencil is the whole part.
    #[inline(always)]
    pub fn starts<R: Real>(&self, x: [R; D]) -> [R; D] {
        let xi = self.to_units(x);
        each!(d in D => self.fits[d].start(xi[d], self.first_offset))
    }

    /// Position of a node along one axis [m].
    pub fn node_position(&self, axis: usize, node: f64) -> f64 {
        self.origin[axis] + self.fits[axis].position(node) * self.spacing
    }
}
