//! Linear shape function: w(r) = 1 − |r| on |r| < 1, r in units of the spacing.

use super::stencil::{Axis, ShapeFunction, floor};

/// Piecewise linear hat function.
pub struct Linear;

impl ShapeFunction<2> for Linear {
    const FIRST_OFFSET: f64 = 0.0;
    const MOMENT: Option<f64> = None;

    #[inline(always)]
    fn axis(xi: f64) -> Axis<2> {
        let first = floor(xi);
        let f = xi - first;
        Axis { first, fraction: f, w: [1.0 - f, f], dw: [-1.0, 1.0] }
    }
}
