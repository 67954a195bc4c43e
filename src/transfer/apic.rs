//! Affine particle-in-cell: v_p = Σ w v, C_p = (Σ w v ⊗ r) D⁻¹ with D = Σ w r ⊗ r.
//!
//! C. Jiang, C. Schroeder, A. Selle, J. Teran, A. Stomakhin, ACM Trans. Graph. 34 (2015) 51,
//! doi:10.1145/2766996. For quadratic splines D = h²/4, for cubic ones h²/3; for linear shapes D is
//! singular at nodes and C = Σ v ⊗ ∇w is taken instead, and so it is, along the axis in question,
//! where a wall modifies the weights.
//!
//! Taylor particle-in-cell (TPIC) takes C = Σ v ⊗ ∇w always: K. Nakamura, S. Matsumura, T.
//! Mizutani, Comput. Methods Appl. Mech. Engrg. 403 (2023) 115720, doi:10.1016/j.cma.2022.115720.
//!
//! The moving-least-squares form takes C for the velocity gradient too, and forces −Σ V σ D⁻¹ r w:
//! Y. Hu, Y. Fang, Z. Ge, Z. Qu, Y. Zhu, A. Pradhana, C. Jiang, ACM Trans. Graph. 37 (2018) 150,
//! doi:10.1145/3197517.3201293.

use super::Received;
use crate::simd::{Real, each};

/// Affine matrix of a particle. `moment` is D in units of h², `spacing` is h [m]; `modified` is 1
/// for the axes along which the weights are modified, else 0.
#[inline(always)]
pub fn affine<R: Real, const D: usize>(
    received: &Received<R, D>,
    moment: Option<f64>,
    spacing: f64,
    modified: Option<[R; D]>,
) -> [[R; D]; D] {
    let Some(moment) = moment else {
        return received.gradient;
    };
    let inverse = R::splat(1.0 / (moment * spacing * spacing));
    let c = each!(a in D, b in D => received.moment[a][b] * inverse); // [TRF-3]
    match modified {
        Some(modified) => {
            let gradient = &received.gradient;
            each!(a in D, b in D => modified[b].mul_add(gradient[a][b] - c[a][b], c[a][b]))
        }
        None => c,
    }
}
