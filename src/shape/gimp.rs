//! Generalised interpolation: the linear shape function averaged over the particle's domain, a box
//! of edges 2 l.
//!
//! With r in units of the spacing: 1 − (r² + l²) / 2l on |r| < l, 1 − |r| up to 1 − l,
//! (1 + l − |r|)² / 4l up to 1 + l. S. G. Bardenhagen, E. M. Kober, CMES 5 (2004) 477–496,
//! doi:10.3970/cmes.2004.005.477. Whether the domains keep their size (uniform GIMP) or follow the
//! stretch (contiguous-particle GIMP) is not decided here: the weights depend on the size alone. A
//! domain counts as one cell wide at most, since it would reach a fourth node otherwise.

use super::modified::hat_ramp;
use super::stencil::{At, Axis, ShapeFunction};
use crate::simd::Real;

/// Hat function averaged over the particle.
pub struct Gimp;

/// Least half edge, in units of the spacing: a particle of no extent has the linear weights.
const LEAST: f64 = 1e-9;

impl ShapeFunction<3> for Gimp {
    const FIRST_OFFSET: f64 = 0.5;
    const MOMENT: Option<f64> = None;
    const SIZED: bool = true;

    #[inline(always)]
    fn axis<R: Real>(at: At<R>) -> Axis<R, 3> {
        let half = R::splat(0.5);
        let l = at.half.max(R::splat(LEAST)).min(half);
        let inverse = half / l; // 1 / 2l
        let first = (at.xi - half).floor();
        let f = at.xi - first; // in [½, 3/2)
        let (low, low_slope) = weight(f, l, inverse);
        let (middle, _) = weight((f - R::splat(1.0)).abs(), l, inverse);
        let (high, high_slope) = weight(R::splat(2.0) - f, l, inverse);
        let high_slope = -high_slope;
        let w = [low, middle, high];
        let dw = [low_slope, -(low_slope + high_slope), high_slope];
        Axis::new(first, f, w, dw)
    }

    #[inline(always)]
    fn ramp<R: Real>(t: R, half: R) -> (R, R) {
        hat_ramp(t, half.min(R::splat(0.5)))
    }
}

/// Weight, and slope with respect to |r|, at the distance |r|; `inverse` is 1 / 2l.
#[inline(always)]
fn weight<R: Real>(r: R, l: R, inverse: R) -> (R, R) {
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    // how much of the domain's far edge is under the hat
    let outer = (one + l - r).max(zero).min(l + l);
    let inner = (l - r).max(zero); // how far the domain reaches over its top
    let slant = (one - l - r).max(zero);
    let w = inverse * (R::splat(0.5) * outer * outer - inner * inner) + slant; // [SHP-2]
    (w, inverse * (inner + inner - outer))
}
