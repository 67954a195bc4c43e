//! The shape functions as textbooks write them, for the oracle: weight and slope of one node, by
//! cases.

use super::ShapeKind;

/// Weight and slope [1/h] of the node at the signed distance r = (x_p − x_i) / h; `l` is half the
/// particle's edge over h.
pub fn weight(shape: ShapeKind, r: f64, l: f64) -> (f64, f64) {
    let (a, sign) = (r.abs(), if r < 0.0 { -1.0 } else { 1.0 });
    let (w, slope) = match shape {
        ShapeKind::Linear if a < 1.0 => (1.0 - a, -1.0),
        ShapeKind::QuadraticBspline if a < 0.5 => (0.75 - a * a, -2.0 * a),
        ShapeKind::QuadraticBspline if a < 1.5 => (0.5 * (1.5 - a).powi(2), a - 1.5),
        ShapeKind::CubicBspline if a < 1.0 => {
            (0.5 * a.powi(3) - a * a + 2.0 / 3.0, 1.5 * a * a - 2.0 * a)
        }
        ShapeKind::CubicBspline if a < 2.0 => ((2.0 - a).powi(3) / 6.0, -0.5 * (2.0 - a).powi(2)),
        ShapeKind::UniformGimp | ShapeKind::ContiguousGimp if a < l => {
            (1.0 - (a * a + l * l) / (2.0 * l), -a / l)
        }
        ShapeKind::UniformGimp | ShapeKind::ContiguousGimp if a < 1.0 - l => (1.0 - a, -1.0),
        ShapeKind::UniformGimp | ShapeKind::ContiguousGimp if a < 1.0 + l => {
            let rest = 1.0 + l - a;
            (rest * rest / (4.0 * l), -rest / (2.0 * l))
        }
        _ => (0.0, 0.0),
    };
    (w, sign * slope)
}

/// Weights of sums that cancel.
const ROUND_OFF: f64 = 1e-15;

/// Nodes between two walls, in units of the spacing; either may be infinitely far away.
#[derive(Clone, Copy)]
pub struct Between {
    /// Positions of the walls.
    pub walls: [f64; 2],
    /// Their nodes, which stand on them.
    pub nodes: [i64; 2],
}

impl Between {
    /// The first nodes in front of the walls, or two if there is but one.
    pub fn new(walls: [f64; 2]) -> Self {
        let mut nodes = [(walls[0] - 1e-9).ceil() as i64, (walls[1] + 1e-9).floor() as i64];
        if nodes[1] <= nodes[0] {
            nodes[0] = (0.5 * (walls[0] + walls[1] - 1.0)).round() as i64;
            nodes[1] = nodes[0] + 1;
        }
        Self { walls, nodes }
    }

    /// Whether a node has moved.
    pub fn moved(&self) -> bool {
        (0..2).any(|w| {
            self.walls[w].is_finite() && (self.walls[w] - self.nodes[w] as f64).abs() > 1e-9
        })
    }

    fn position(&self, node: i64) -> f64 {
        let of_wall = self.nodes.iter().position(|n| *n == node);
        of_wall.map_or(node as f64, |w| self.walls[w])
    }

    /// The cell between walls that holds ξ or is next to it, by its lower node.
    pub fn cell(&self, xi: f64) -> i64 {
        (xi.floor() as i64).clamp(self.nodes[0], self.nodes[1].saturating_sub(1))
    }

    /// Where a node stands.
    pub fn distance(&self, node: i64, xi: f64) -> f64 {
        self.position(node) - xi
    }

    /// Weight and slope at ξ of a node: of the field that is 1 there and 0 at the others, linear
    /// between nodes and behind walls, with kinks of which each is as smooth as on equal distances.
    pub fn weight(&self, shape: ShapeKind, node: i64, xi: f64, l: f64) -> (f64, f64) {
        if self.walls.iter().all(|wall| wall.is_infinite()) {
            return weight(shape, xi - node as f64, l);
        }
        let ramp = |t: f64| {
            let terms = (1..8).map(|m| (m, weight(shape, t - f64::from(m), l)));
            terms.fold((0.0, 0.0), |(w, s), (m, (dw, ds))| {
                (w + f64::from(m) * dw, s + f64::from(m) * ds)
            })
        };
        let value = |n: i64| f64::from(n == node);
        let slope_of =
            |n: i64| (value(n + 1) - value(n)) / (self.position(n + 1) - self.position(n));
        let [low, high] = self.nodes;
        let first = (xi.floor() as i64 - 3).clamp(low, high.saturating_sub(1));
        let slope = slope_of(first);
        let start = (value(first) + slope * (xi - self.position(first)), slope);
        let kinks = (first + 1..high.min(first + 8)).map(|n| {
            let (ramp, step) = ramp(xi - self.position(n));
            let bend = slope_of(n) - slope_of(n - 1);
            (bend * ramp, bend * step)
        });
        let (w, slope) = kinks.fold(start, |(w, s), (dw, ds)| (w + dw, s + ds));
        if w > ROUND_OFF { (w, slope) } else { (0.0, 0.0) }
    }
}
