//! What walls do to the velocity of a node.
//!
//! All walls that reach a node act on it together, so that their order does not matter: each takes
//! the part along its normal, sticky ones then take the rest, and friction slows what is left. What
//! they take as a whole is *held*; a field that follows from the same step, such as the second
//! velocities of MUSL, loses what is held and keeps the rest, whatever its sign: a wall that decided
//! anew would let a field pass that moves away by noise, stop one that approaches, and do work.

use super::{Wall, WallKind};
use crate::background::Held;

/// Whether a wall takes the part of a velocity along its normal, `along` [m/s].
fn takes(kind: WallKind, along: f64) -> bool {
    match kind {
        WallKind::Sticky | WallKind::Slip => true,
        WallKind::Separating | WallKind::Friction => along < 0.0, // else it leaves
    }
}

/// Takes from the velocity `v` of a node [m/s] what the walls that reach it take, and gives what
/// they hold; `took` hears of each change: number of the wall, component, change [m/s].
#[inline]
pub fn constrain<'w, const D: usize>(
    walls: impl Iterator<Item = (usize, &'w Wall)> + Clone,
    v: &mut [f64; D],
    took: &mut impl FnMut(usize, usize, f64),
) -> Held {
    let (free, mut held) = (*v, Held::default());
    macro_rules! hold {
        ($n:expr, $a:expr) => {
            if !held.has($a) {
                held.add($a);
                took($n, $a, -v[$a]);
                v[$a] = 0.0;
            }
        };
    }
    for (n, wall) in walls.clone().filter(|(_, wall)| takes(wall.kind, wall.along(&free))) {
        hold!(n, wall.axis); // [BND-1]
    }
    for (n, _) in walls.clone().filter(|(_, wall)| wall.kind == WallKind::Sticky) {
        (0..D).for_each(|a| hold!(n, a)); // [BND-1]
    }
    let rougher = |n: usize, wall: &Wall| {
        let same = |w: &Wall| (w.kind, w.axis, w.side) == (wall.kind, wall.axis, wall.side);
        walls.clone().any(|(m, w)| same(w) && (w.friction, n) > (wall.friction, m))
    };
    let rough = walls.clone().filter(|(_, wall)| wall.kind == WallKind::Friction);
    for (n, wall) in rough.filter(|(n, wall)| !rougher(*n, wall)) {
        let taken = wall.friction * (-wall.along(&free)).max(0.0);
        let speed = v.iter().map(|c| c * c).sum::<f64>().sqrt();
        if taken > 0.0 && speed <= taken {
            (0..D).for_each(|a| hold!(n, a)); // [BND-2]
        } else if taken > 0.0 {
            for a in (0..D).filter(|a| !held.has(*a)) {
                let left = v[a] * (1.0 - taken / speed); // [BND-2]
                took(n, a, left - v[a]);
                v[a] = left;
            }
        }
    }
    held
}

/// Takes from another velocity of the node what is held; `took` as in [`constrain`].
#[inline]
pub fn constrain_again<'w, const D: usize>(
    walls: impl Iterator<Item = (usize, &'w Wall)> + Clone,
    held: Held,
    v: &mut [f64; D],
    took: &mut impl FnMut(usize, usize, f64),
) {
    let rough = |wall: &Wall| matches!(wall.kind, WallKind::Sticky | WallKind::Friction);
    for a in (0..D).filter(|a| held.has(*a)) {
        let mut both = walls.clone().filter(|(_, wall)| wall.axis == a);
        let mut along = walls.clone().filter(|(_, wall)| rough(wall));
        if let Some((n, _)) = both.next().or_else(|| along.next()) {
            took(n, a, -v[a]);
            v[a] = 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use WallKind::{Friction, Separating, Slip, Sticky};

    fn wall(axis: usize, kind: WallKind) -> Wall {
        Wall { axis, side: 1, position: 0.0, kind, friction: 0.5 }
    }

    fn after<const D: usize>(walls: &[Wall], mut v: [f64; D]) -> ([f64; D], Held) {
        let before = v;
        let mut sum = [0.0; D];
        let held = constrain(walls.iter().enumerate(), &mut v, &mut |_, a, dv| sum[a] += dv);
        for a in 0..D {
            assert!((before[a] + sum[a] - v[a]).abs() < 1e-15, "what was taken is missing");
        }
        (v, held)
    }

    #[test]
    fn each_kind_leaves_the_velocity_it_should() {
        let left = |kind, v: [f64; 2]| after(&[wall(1, kind)], v);
        let (none, normal) = (Held(0), Held(0b10));
        assert_eq!(left(Sticky, [3.0, -2.0]), ([0.0, 0.0], Held(0b11)));
        assert_eq!(left(Slip, [3.0, -2.0]), ([3.0, 0.0], normal));
        assert_eq!(left(Slip, [3.0, 2.0]), ([3.0, 0.0], normal));
        assert_eq!(left(Separating, [3.0, -2.0]), ([3.0, 0.0], normal));
        assert_eq!(left(Friction, [3.0, -2.0]), ([2.0, 0.0], normal));
        assert_eq!(left(Friction, [0.5, -2.0]), ([0.0, 0.0], Held(0b11)));
        for kind in [Separating, Friction] {
            assert_eq!(left(kind, [3.0, 2.0]), ([3.0, 2.0], none));
        }
    }

    #[test]
    fn walls_in_a_corner_act_in_any_order() {
        let kinds = [Sticky, Slip, Separating, Friction];
        for (floor, side) in kinds.iter().flat_map(|a| kinds.map(|b| (*a, b))) {
            let walls = [wall(1, floor), wall(0, side)];
            for v in [[-3.0, -2.0, 4.0], [3.0, -2.0, 0.1], [-1.0, 2.0, 2.0], [1.0, 2.0, -2.0]] {
                let (one, other) = (after(&walls, v), after(&[walls[1], walls[0]], v));
                assert_eq!(one.1, other.1, "{floor:?} and {side:?}");
                for a in 0..3 {
                    let same = (one.0[a] - other.0[a]).abs() < 1e-15;
                    assert!(same, "{floor:?} and {side:?}: {one:?}, {other:?}");
                }
            }
        }
    }

    #[test]
    fn what_is_held_stays_held_in_another_field_and_the_rest_is_free() {
        let (floor, v) = ([wall(1, Friction)], [3.0, -2.0]);
        let (_, held) = after(&floor, v);
        for mut second in [[3.0, 1.0], [-0.1, -1.0]] {
            let x = second[0];
            constrain_again(floor.iter().enumerate(), held, &mut second, &mut |_, _, _| {});
            assert_eq!(second, [x, 0.0], "it slides: its way along the wall is its own");
        }
        let mut second = [0.2, -0.1];
        constrain_again(floor.iter().enumerate(), Held(0), &mut second, &mut |_, _, _| {});
        assert_eq!(second, [0.2, -0.1], "it has left: nothing stops it");
    }
}
