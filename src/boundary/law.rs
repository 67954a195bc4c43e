//! What a boundary does to the velocity of a node.

use super::WallKind;

/// A unit vector from a boundary to the material.
pub trait Normal<const D: usize>: Copy {
    /// v·n [m/s].
    fn along(self, v: [f64; D]) -> f64;
    /// v less its part along the normal, which is `along` n.
    fn without(self, v: [f64; D], along: f64) -> [f64; D];
}

/// Any direction.
impl<const D: usize> Normal<D> for [f64; D] {
    #[inline(always)]
    fn along(self, v: [f64; D]) -> f64 {
        (0..D).map(|a| v[a] * self[a]).sum()
    }

    #[inline(always)]
    fn without(self, v: [f64; D], along: f64) -> [f64; D] {
        std::array::from_fn(|a| v[a] - along * self[a])
    }
}

/// The direction of an axis, or against it; what is removed leaves exactly zero.
#[derive(Clone, Copy, Debug)]
pub struct AxisNormal {
    /// The axis.
    pub axis: usize,
    /// +1 or −1.
    pub side: f64,
}

impl<const D: usize> Normal<D> for AxisNormal {
    #[inline(always)]
    fn along(self, v: [f64; D]) -> f64 {
        self.side * v[self.axis]
    }

    #[inline(always)]
    fn without(self, mut v: [f64; D], _along: f64) -> [f64; D] {
        v[self.axis] = 0.0;
        v
    }
}

/// The velocity that a boundary leaves a node with velocity `v` relative to it [m/s]; `friction` is
/// the coefficient μ.
#[inline(always)]
pub fn constrain<const D: usize>(
    kind: WallKind,
    friction: f64,
    normal: impl Normal<D>,
    v: [f64; D],
) -> [f64; D] {
    if kind == WallKind::Sticky {
        return [0.0; D];
    }
    let along = normal.along(v);
    if kind != WallKind::Slip && along >= 0.0 {
        return v; // it leaves
    }
    let mut out = normal.without(v, along); // [BND-1]
    if kind == WallKind::Friction {
        let tangential = out.iter().map(|c| c * c).sum::<f64>().sqrt();
        let left = (tangential + friction * along).max(0.0); // [BND-2]
        if tangential > 0.0 {
            out = out.map(|c| c * (left / tangential));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    const UP: AxisNormal = AxisNormal { axis: 1, side: 1.0 };

    #[test]
    fn each_kind_leaves_the_velocity_it_should() {
        let v = [3.0, -2.0];
        let constrain = |kind, v| constrain(kind, 0.5, UP, v);
        assert_eq!(constrain(WallKind::Sticky, v), [0.0, 0.0]);
        assert_eq!(constrain(WallKind::Slip, v), [3.0, 0.0]);
        assert_eq!(constrain(WallKind::Separating, v), [3.0, 0.0]);
        assert_eq!(constrain(WallKind::Friction, v), [2.0, 0.0]);
        assert_eq!(constrain(WallKind::Friction, [0.5, -2.0]), [0.0, 0.0]);
        for kind in [WallKind::Separating, WallKind::Friction] {
            assert_eq!(constrain(kind, [3.0, 2.0]), [3.0, 2.0]);
        }
        assert_eq!(constrain(WallKind::Slip, [3.0, 2.0]), [3.0, 0.0]);
    }

    #[test]
    fn the_law_turns_with_the_normal() {
        let (c, s) = (0.6, 0.8);
        let turned = |v: [f64; 2]| [c * v[0] - s * v[1], s * v[0] + c * v[1]];
        for kind in [WallKind::Slip, WallKind::Separating, WallKind::Friction] {
            for v in [[3.0, -2.0], [0.5, -2.0], [3.0, 2.0]] {
                let expected = turned(constrain(kind, 0.5, UP, v));
                let found = constrain(kind, 0.5, turned([0.0, 1.0]), turned(v));
                for a in 0..2 {
                    assert!((found[a] - expected[a]).abs() < 1e-14, "{kind:?}, {v:?}: {found:?}");
                }
            }
        }
    }
}
