//! Cubic B-spline: w(r) = ½ |r|³ − r² + 2/3 on |r| < 1 and (2 − |r|)³ / 6 on 1 ≤ |r| < 2, r in
//! units of the spacing.
//!
//! M. Steffen, R. M. Kirby, M. Berzins, Int. J. Numer. Meth. Engng 76 (2008) 922–948,
//! doi:10.1002/nme.2360.

use super::stencil::{At, Axis, ShapeFunction};
use crate::simd::{Real, each};

/// Cubic B-spline.
pub struct CubicBspline;

impl ShapeFunction<4> for CubicBspline {
    const FIRST_OFFSET: f64 = 1.0;
    const MOMENT: Option<f64> = Some(1.0 / 3.0);

    #[inline(always)]
    fn axis<R: Real>(at: At<R>) -> Axis<R, 4> {
        let (half, one, sixth) = (R::splat(0.5), R::splat(1.0), R::splat(1.0 / 6.0));
        let first = (at.xi - one).floor();
        let f = at.xi - first; // in [1, 2)
        let b = f - one; // above the second node
        let a = one - b; // below the third
        let (aa, bb) = (a * a, b * b);
        let near = each!(n in 2 => {
            let (r, rr) = [(b, bb), (a, aa)][n];
            (half * r - one).mul_add(rr, R::splat(2.0 / 3.0))
        });
        let inner = each!(n in 2 => {
            let (r, rr) = [(b, bb), (a, aa)][n];
            R::splat(1.5) * rr - (r + r)
        });
        let w = [sixth * aa * a, near[0], near[1], sixth * bb * b]; // [SHP-4]
        let dw = [-(half * aa), inner[0], -inner[1], half * bb];
        Axis::new(first, f, w, dw)
    }

    #[inline(always)]
    fn ramp<R: Real>(t: R, _half: R) -> (R, R) {
        let (zero, one) = (R::splat(0.0), R::splat(1.0));
        let (a, b, c) = ((t + one).max(zero), t.max(zero), (t - one).max(zero));
        let (aa, bb, cc) = (a * a, b * b, c * c);
        let sum = aa * a - (bb + bb) * b + cc * c;
        (R::splat(1.0 / 6.0) * sum, R::splat(0.5) * (aa - bb - bb + cc))
    }
}
