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

/// The same of a node between walls on the nodes `low` and `high`, where fields continue linearly
/// behind the walls: node i has what is its own, twice what is of the node behind if it stands on
/// the wall, and less that if it is the next one. `r(i)` is the distance from node i.
pub fn weight_between(
    shape: ShapeKind,
    i: i64,
    r: impl Fn(i64) -> f64,
    l: f64,
    [low, high]: [i64; 2],
) -> (f64, f64) {
    let (mut w, mut slope) = (0.0, 0.0);
    let mut add = |factor: f64, node: i64| {
        let of_node = weight(shape, r(node), l);
        w += factor * of_node.0;
        slope += factor * of_node.1;
    };
    if low <= i && i <= high {
        add(1.0, i);
    }
    for (wall, behind, next) in [
        (low, low.wrapping_sub(1), low.wrapping_add(1)),
        (high, high.wrapping_add(1), high.wrapping_sub(1)),
    ] {
        if i == wall {
            add(2.0, behind);
        } else if i == next {
            add(-1.0, behind);
        }
    }
    (w, slope)
}
