//! Moving least squares: the slopes of a spline become r w / Σ w r², so that gradients of fields
//! are those of the line that fits best, and forces are −Σ V σ r w / Σ w r².
//!
//! Next to walls that modify the spline, its own slopes stay: Σ w r² is another there.
//!
//! Y. Hu, Y. Fang, Z. Ge, Z. Qu, Y. Zhu, A. Pradhana, C. Jiang, ACM Trans. Graph. 37 (2018) 150,
//! doi:10.1145/3197517.3201293.

use std::marker::PhantomData;

use super::modified::is_modified;
use super::stencil::{At, Axis, ShapeFunction};
use crate::simd::{Real, each};

/// A spline with the slopes of moving least squares.
pub struct Mls<S>(PhantomData<S>);

impl<S: ShapeFunction<N>, const N: usize> ShapeFunction<N> for Mls<S> {
    const FIRST_OFFSET: f64 = S::FIRST_OFFSET;
    const MOMENT: Option<f64> = S::MOMENT;

    const SIZED: bool = S::SIZED;
    const MODIFIED: bool = S::MODIFIED;

    #[inline(always)]
    fn axis<R: Real>(at: At<R>) -> Axis<R, N> {
        let axis = S::axis(at);
        let inverse = R::splat(const { 1.0 / S::MOMENT.expect("a spline") });
        let mut dw = each!(n in N => axis.r[n] * axis.w[n] * inverse); // [TRF-5]
        if S::MODIFIED {
            let modified = is_modified::<R, S, N>(&at);
            dw = each!(n in N => modified.mul_add(axis.dw[n] - dw[n], dw[n]));
        }
        Axis { dw, ..axis }
    }

    #[inline(always)]
    fn ramp<R: Real>(t: R, half: R) -> (R, R) {
        S::ramp(t, half)
    }
}
