//! Linear shape function: w(r) = 1 − |r| on |r| < 1, r in units of the spacing.

use super::modified::hat_ramp;
use super::stencil::{At, Axis, ShapeFunction};
use crate::simd::Real;

/// Piecewise linear hat function.
pub struct Linear;

impl ShapeFunction<2> for Linear {
    const FIRST_OFFSET: f64 = 0.0;
    const MOMENT: Option<f64> = None;

    #[inline(always)]
    fn axis<R: Real>(at: At<R>) -> Axis<R, 2> {
        let (one, least) = (R::splat(1.0), R::splat(f64::EPSILON));
        let first = at.xi.floor();
        // On a node plane the far node would have no mass and hence no velocity, but its slope
        // would still count.
        let f = (at.xi - first).max(least).min(one - least);
        Axis::new(first, f, [one - f, f], [-one, one]) // [SHP-1]
    }

    #[inline(always)]
    fn ramp<R: Real>(t: R, _half: R) -> (R, R) {
        hat_ramp(t, R::splat(0.0))
    }
}
