//! What a boundary does to the velocity of a node.

use super::WallKind;

/// The velocity that a boundary leaves a node with velocity `v` relative to it [m/s]; `normal` is the unit
/// vector from the boundary to the material, `friction` the coefficient μ.
#[inline(always)]
pub fn constrain<const D: usize>(
    kind: WallKind,
    friction: f64,
    normal: [f64; D],
    v: [f64; D],
) -> [f64; D] {
    if kind == WallKind::Sticky {
        return [0.0; D];
    }
    let across = (0..D).filter(|a| normal[*a] != 0.0);
    let along: f64 = across.clone().map(|a| v[a] * normal[a]).sum();
    if kind != WallKind::Slip && along >= 0.0 {
        return v; // it leaves
    }
    let mut out = v;
    for a in across {
        let whole = normal[a].abs() == 1.0; // then nothing is left, whatever the velocity is
        out[a] = if whole { 0.0 } else { v[a] - along * normal[a] }; // [BND-1]
    }
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

    const UP: [f64; 2] = [0.0, 1.0];

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
                let found = constrain(kind, 0.5, turned(UP), turned(v));
                for a in 0..2 {
                    assert!((found[a] - expected[a]).abs() < 1e-14, "{kind:?}, {v:?}: {found:?}");
                }
            }
        }
    }
}
