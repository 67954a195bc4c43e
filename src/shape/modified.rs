//! Shape functions between walls: the first node in front of a wall moves back onto it, and fields
//! continue linearly behind it, so that linear fields are reproduced up to the wall and the value on
//! it is that of its node.
//!
//! All shape functions here are hat functions that a window smooths: the field is piecewise linear
//! between the nodes x_n, and its kink at a node is rounded. With the slopes s_n between nodes n
//! and n + 1, v = v_b + s_a (t − R(t)) + s_b R(t), t = x − x_b, where one kink is in reach, and R
//! the ramp max(t, 0) averaged over the window: half a cell to either side for quadratic splines,
//! the particle's domain for GIMP, a hat for cubic splines, nothing for linear functions. Written
//! so, nodes may stand anywhere, and nodes at equal distances give the functions that the other
//! modules have. There is no kink at a wall: the field is that of a natural spline. Its functions
//! are positive, they sum to 1, and Σ w x_n = x.
//!
//! Functions that are modified at the boundary are an idea of M. Steffen, R. M. Kirby, M. Berzins,
//! Int. J. Numer. Meth. Engng 76 (2008) 922–948, doi:10.1002/nme.2360, who build the first functions
//! on knots that end at the wall instead.

use std::marker::PhantomData;

use super::stencil::{At, Axis, ShapeFunction};
use crate::simd::{Real, each};

/// A shape function between walls.
pub struct Modified<S>(PhantomData<S>);

impl<S: ShapeFunction<N>, const N: usize> ShapeFunction<N> for Modified<S> {
    const FIRST_OFFSET: f64 = S::FIRST_OFFSET;
    const MOMENT: Option<f64> = S::MOMENT;
    const SIZED: bool = S::SIZED;
    const MODIFIED: bool = true;

    #[inline(always)]
    fn axis<R: Real>(at: At<R>) -> Axis<R, N> {
        let mut at = at;
        at.xi = at.fit.inside(at.xi);
        if N == 4 {
            at.xi = at.xi.min(R::splat(at.fit.walls[1] - SECOND));
        }
        let first = at.fit.start(at.xi, S::FIRST_OFFSET).floor();
        let fraction = at.xi - first;
        let mut axis = Axis::new(first, fraction, [R::splat(0.0); N], [R::splat(0.0); N]);
        let mut inverse = [R::splat(1.0); 3];
        if at.fit.moves() {
            inverse = move_nodes(&mut axis, &at);
        }
        let (w, dw) = weights::<R, S, N>(&axis, &at, &inverse);
        Axis { w, dw, ..axis } // [SHP-5]
    }

    #[inline(always)]
    fn ramp<R: Real>(t: R, half: R) -> (R, R) {
        S::ramp(t, half)
    }
}

/// Moves the nodes of walls onto them, and gives 1 / h of the cells of the stencil.
#[inline(always)]
fn move_nodes<R: Real, const N: usize>(axis: &mut Axis<R, N>, at: &At<R>) -> [R; 3] {
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    let by = at.fit.moved();
    for n in 0..N {
        for w in 0..2 {
            let far = (axis.first + R::splat(n as f64) - R::splat(at.fit.nodes[w])).abs();
            axis.r[n] = R::splat(by[w]).mul_add((one - far).max(zero), axis.r[n]);
        }
    }
    each!(n in 3 => if n + 1 < N { one / (axis.r[n + 1] - axis.r[n]) } else { one })
}

/// Weights and slopes of the nodes at the distances r.
#[inline(always)]
fn weights<R: Real, S: ShapeFunction<N>, const N: usize>(
    axis: &Axis<R, N>,
    at: &At<R>,
    inverse: &[R; 3],
) -> ([R; N], [R; N]) {
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    let mut w = [zero; 4];
    let mut dw = [zero; 4];
    let rest = 1; // gets what the others leave: of the function 1, and of its slope 0
    if N == 2 {
        let least = R::splat(f64::EPSILON); // see `linear`
        w[1] = (-axis.r[0] * inverse[0]).max(least).min(one - least);
        (w[0], dw[0], dw[1]) = (one - w[1], -inverse[0], inverse[0]);
        return (each!(n in N => w[n]), each!(n in N => dw[n]));
    }
    let ([b, slope_b], [below, falling]) = ramps::<R, S, N>(axis, at, 1);
    (w[0], dw[0]) = (below * inverse[0], -falling * inverse[0]);
    let (mut c, mut slope_c) = (zero, zero);
    if N == 4 {
        [c, slope_c] = ramps::<R, S, N>(axis, at, 2).0;
        (w[3], dw[3]) = (c * inverse[2], slope_c * inverse[2]);
    }
    w[2] = (b - c) * inverse[1] - w[3];
    dw[2] = (slope_b - slope_c) * inverse[1] - dw[3];
    w[rest] = one - w[0] - w[2] - w[3];
    dw[rest] = zero - dw[0] - dw[2] - dw[3];
    (each!(n in N => w[n]), each!(n in N => dw[n]))
}

/// R of node n and its slope, and the same of R − t, which is R(−t): neither is of round-off where it
/// should be zero.
#[inline(always)]
fn ramps<R: Real, S: ShapeFunction<N>, const N: usize>(
    axis: &Axis<R, N>,
    at: &At<R>,
    n: usize,
) -> ([R; 2], [R; 2]) {
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    let t = -axis.r[n];
    let node = axis.first + R::splat(n as f64);
    let (low, high) = (R::splat(at.fit.nodes[0] + 1.0), R::splat(at.fit.nodes[1] - 1.0));
    // at a wall, the slope is that on the side of the material, up to any distance
    let (low, high) = ((low - node).max(zero).min(one), (node - high).max(zero).min(one));
    let ((above, rising), (below, falling)) = (S::ramp(t, at.half), S::ramp(-t, at.half));
    let up = [low.mul_add(t - above, above), low.mul_add(one - rising, rising)];
    let down = [high.mul_add(-t - below, below), high.mul_add(one - falling, falling)];
    ([up[0] * (one - high), up[1] * (one - high)], [down[0] * (one - low), down[1] * (one - low)])
}

/// Least distance of cubic splines from an upper wall, in units of the spacing: on it, the second
/// node of four had no weight, which kernels take from those of the others.
const SECOND: f64 = 1e-7;

/// 1 where weights or nodes are other than far from walls, else 0.
#[inline(always)]
pub fn is_modified<R: Real, S: ShapeFunction<N>, const N: usize>(at: &At<R>) -> R {
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    let first = at.fit.start(at.xi, S::FIRST_OFFSET).floor();
    let last = first + R::splat((N - 1) as f64);
    let wide = f64::from(at.fit.moves()); // then the wall's node counts itself
    let [low, high] = [at.fit.nodes[0] + wide, at.fit.nodes[1] - wide];
    let (low, high) = (R::splat(low) - first, last - R::splat(high));
    low.max(high).max(zero).min(one)
}

/// The ramp max(t, 0) averaged over ±l, and its slope.
#[inline(always)]
pub fn hat_ramp<R: Real>(t: R, l: R) -> (R, R) {
    let (zero, l) = (R::splat(0.0), l.max(R::splat(LEAST)));
    let inverse = R::splat(0.5) / l;
    let part = (t + l).max(zero).min(l + l);
    let slope = part * inverse;
    (R::splat(0.5) * part * slope + (t - l).max(zero), slope)
}

/// Least half edge of a window, in units of the spacing.
const LEAST: f64 = 1e-9;
