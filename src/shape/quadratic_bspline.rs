//! Quadratic B-spline: w(r) = ¾ − r² on |r| < ½ and ½ (3/2 − |r|)² on ½ ≤ |r| < 3/2, r in units of the spacing.
//!
//! M. Steffen, R. M. Kirby, M. Berzins, Int. J. Numer. Meth. Engng 76 (2008) 922–948, doi:10.1002/nme.2360.

use super::stencil::{Axis, ShapeFunction, floor};

/// Quadratic B-spline.
pub struct QuadraticBspline;

impl ShapeFunction<3> for QuadraticBspline {
    const FIRST_OFFSET: f64 = 0.5;
    const MOMENT: Option<f64> = Some(0.25);

    #[inline(always)]
    fn axis(xi: f64) -> Axis<3> {
        let first = floor(xi - Self::FIRST_OFFSET);
        let f = xi - first; // in [½, 3/2)
        let (a, b, c) = (1.5 - f, f - 1.0, f - 0.5);
        Axis {
            first,
            fraction: f,
            w: [0.5 * a * a, 0.75 - b * b, 0.5 * c * c],
            dw: [-a, -2.0 * b, c],
        }
    }
}
