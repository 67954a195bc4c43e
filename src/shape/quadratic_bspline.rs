//! Quadratic B-spline: w(r) = ¾ − r² on |r| < ½ and ½ (3/2 − |r|)² on ½ ≤ |r| < 3/2, r in units of
//! the spacing.
//!
//! M. Steffen, R. M. Kirby, M. Berzins, Int. J. Numer. Meth. Engng 76 (2008) 922–948,
//! doi:10.1002/nme.2360.

use super::modified::hat_ramp;
use super::stencil::{At, Axis, ShapeFunction};
use crate::simd::Real;

/// Quadratic B-spline.
pub struct QuadraticBspline;

impl ShapeFunction<3> for QuadraticBspline {
    const FIRST_OFFSET: f64 = 0.5;
    const MOMENT: Option<f64> = Some(0.25);

    #[inline(always)]
    fn axis<R: Real>(at: At<R>) -> Axis<R, 3> {
        let half = R::splat(0.5);
        let first = (at.xi - half).floor();
        let f = at.xi - first; // in [½, 3/2)
        let (a, b, c) = (R::splat(1.5) - f, f - R::splat(1.0), f - half);
        let w = [half * a * a, R::splat(0.75) - b * b, half * c * c]; // [SHP-3]
        let dw = [-a, -(b + b), c];
        Axis::new(first, f, w, dw)
    }

    #[inline(always)]
    fn ramp<R: Real>(t: R, _half: R) -> (R, R) {
        hat_ramp(t, R::splat(0.5))
    }
}
