//! Affine particle-in-cell: v_p = Σ w v, C_p = (Σ w v ⊗ r) D⁻¹ with D = Σ w r ⊗ r.
//!
//! C. Jiang, C. Schroeder, A. Selle, J. Teran, A. Stomakhin, ACM Trans. Graph. 34 (2015) 51, doi:10.1145/2766996. For quadratic
//! splines D = h²/4; for linear shapes D is singular at nodes and C = Σ v ⊗ ∇w is taken instead.

use super::Received;
use crate::simd::{Real, each};

/// Affine matrix of a particle. `moment` is D in units of h², `spacing` is h [m].
#[inline(always)]
pub fn affine<R: Real, const D: usize>(
    received: &Received<R, D>,
    moment: Option<f64>,
    spacing: f64,
) -> [[R; D]; D] {
    match moment {
        Some(moment) => {
            let inverse = R::splat(1.0 / (moment * spacing * spacing));
            each!(a in D, b in D => received.moment[a][b] * inverse)
        }
        None => received.gradient,
    }
}
