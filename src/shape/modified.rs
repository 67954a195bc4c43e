//! Splines next to a wall: the functions of the nodes behind it are given to the first two in
//! front, so that linear fields are reproduced up to the wall and the value on it is that of its
//! node.
//!
//! With the wall on node 0 and the material above, a field continues linearly to the node behind,
//! v₋₁ = 2 v₀ − v₁; hence w₀ ← w₀ + 2 w₋₁, w₁ ← w₁ − w₋₁, and the same with the slopes. Both
//! weights are positive. It is the natural spline: what holds on the wall is the condition on v₀,
//! and nothing else. The idea of functions modified at the boundary is that of M. Steffen, R. M.
//! Kirby, M. Berzins, Int. J. Numer. Meth. Engng 76 (2008) 922–948, doi:10.1002/nme.2360, who build
//! the first functions on knots that end at the wall instead.

use std::marker::PhantomData;

use super::stencil::{At, Axis, ShapeFunction};
use crate::simd::Real;

/// A shape function of three or four nodes, modified next to walls on node planes. Positions lie
/// between the walls.
pub struct Modified<S>(PhantomData<S>);

impl<S: ShapeFunction<N>, const N: usize> ShapeFunction<N> for Modified<S> {
    const FIRST_OFFSET: f64 = S::FIRST_OFFSET;
    const MOMENT: Option<f64> = S::MOMENT;
    const SIZED: bool = S::SIZED;
    const MODIFIED: bool = true;

    #[inline(always)]
    fn axis<R: Real>(at: At<R>) -> Axis<R, N> {
        let mut axis = S::axis(at);
        let (below, above) = behind::<R, N>(axis.first, at.walls);
        for list in [&mut axis.w, &mut axis.dw] {
            // [SHP-5]
            let (first, last) = (below * list[0], above * list[N - 1]);
            list[0] = list[0] - first;
            list[1] = list[1] + first + first;
            list[2] = list[2] - first;
            list[N - 1] = list[N - 1] - last;
            list[N - 2] = list[N - 2] + last + last;
            list[N - 3] = list[N - 3] - last;
        }
        axis
    }
}

/// 1 if the first node of a stencil is behind the lower wall, and if the last is behind the upper
/// one, else 0.
#[inline(always)]
fn behind<R: Real, const N: usize>(first: R, [low, high]: [R; 2]) -> (R, R) {
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    let last = first + R::splat((N - 1) as f64);
    ((low - first).max(zero).min(one), (last - high).max(zero).min(one))
}

/// 1 where the weights at ξ are modified, else 0.
#[inline(always)]
pub fn is_modified<R: Real, S: ShapeFunction<N>, const N: usize>(xi: R, walls: [R; 2]) -> R {
    let (below, above) = behind::<R, N>((xi - R::splat(S::FIRST_OFFSET)).floor(), walls);
    below.max(above)
}
