//! Where the nodes stand.

use crate::simd::{Real, each};

/// Largest distance from the origins of grid and space, in cells, at which particles are accepted:
/// farther away a double is too coarse for the small moves of a step.
pub const FARTHEST: f64 = 1e8;

/// How far below an upper wall, in cells, a position on it counts to be: its stencil must not begin
/// a cell further.
const BELOW_WALL: f64 = 1e-9;

fn below(wall: f64) -> f64 {
    if wall.is_finite() { wall - BELOW_WALL * (1.0 + wall.abs()) } else { wall }
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
    /// Nodes of the walls below and above along each axis, next to which shape functions are
    /// modified; infinite if they are not.
    pub walls: [[f64; 2]; D],
    /// Positions between those walls.
    inside: [[f64; 2]; D],
}

impl<const D: usize> Space<D> {
    /// A grid without walls; `first_offset` and `wall_reach` are those of the shape function.
    pub fn new(spacing: f64, origin: [f64; D], first_offset: f64, wall_reach: f64) -> Self {
        let walls = [[f64::NEG_INFINITY, f64::INFINITY]; D];
        let inverse = 1.0 / spacing;
        Self { origin, spacing, inverse, first_offset, wall_reach, walls, inside: walls }
    }

    /// The same with walls that modify shape functions: axis, side of the material, and position
    /// [m] of each.
    pub fn with_walls(mut self, walls: impl Iterator<Item = (usize, i32, f64)>) -> Self {
        self.walls = [[f64::NEG_INFINITY, f64::INFINITY]; D];
        for (axis, side, position) in walls {
            let node = ((position - self.origin[axis]) / self.spacing).round();
            self.walls[axis][usize::from(side < 0)] = node;
        }
        self.inside = self.walls.map(|[low, high]| [low, below(high)]);
        self
    }

    /// Position in units of the spacing, from node 0.
    #[inline(always)]
    pub fn to_units<R: Real>(&self, x: [R; D]) -> [R; D] {
        let inverse = R::splat(self.inverse);
        each!(d in D => (x[d] - R::splat(self.origin[d])) * inverse)
    }

    /// The same; what is behind a wall that modifies shape functions counts as on it.
    #[inline(always)]
    pub fn between_walls<R: Real>(&self, x: [R; D]) -> [R; D] {
        let xi = self.to_units(x);
        each!(d in D => xi[d].max(R::splat(self.inside[d][0])).min(R::splat(self.inside[d][1])))
    }

    /// Position of a node along one axis [m].
    pub fn node_position(&self, axis: usize, node: i64) -> f64 {
        self.origin[axis] + node as f64 * self.spacing
    }
}
