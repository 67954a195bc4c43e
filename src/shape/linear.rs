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
        // On a node plane the far node would have no mass and hence no velocity, but its slope would still count.
        let f = (xi - first).clamp(f64::EPSILON, 1.0 - f64::EPSILON);
        Axis { first, fraction: f, w: [1.0 - f, f], dw: [-1.0, 1.0] }
    }
}
