//! Taylor particle-in-cell: v_p = Σ w v, C_p = Σ v ⊗ ∇w, for any shape function.
//!
//! K. Nakamura, S. Matsumura, T. Mizutani, Comput. Methods Appl. Mech. Engrg. 403 (2023) 115720, doi:10.1016/j.cma.2022.115720.

use super::Received;
use crate::simd::Real;

/// Affine matrix of a particle.
#[inline(always)]
pub fn affine<R: Real, const D: usize>(received: &Received<R, D>) -> [[R; D]; D] {
    received.gradient // [TRF-4]
}
