//! Blend of PIC and FLIP, given as a rate, so that results do not depend on the time step.
//!
//! FLIP: v_p ← v_p + Σ w Δv; PIC: v_p ← Σ w v. With the rate κ [1/s] the share of PIC in a step is
//! α = 1 − exp(−κ dt), so that n steps of dt/n damp as much as one of dt. κ = 0 is FLIP, κ = ∞ is
//! PIC. J. U. Brackbill, H. M. Ruppel, J. Comput. Phys. 65 (1986) 314–343,
//! doi:10.1016/0021-9991(86)90211-1.

use super::Received;
use crate::simd::{Real, each};

/// Share of PIC in a step of `dt` [s] at the rate `pic_rate` [1/s].
pub fn pic_share(pic_rate: f64, dt: f64) -> f64 {
    -(-pic_rate * dt).exp_m1() // [TRF-8]
}

/// New velocity of a particle that had `v`.
#[inline(always)]
pub fn velocity<R: Real, const D: usize>(
    v: [R; D],
    received: &Received<R, D>,
    pic_share: f64,
) -> [R; D] {
    let (pic, flip) = (R::splat(pic_share), R::splat(1.0 - pic_share));
    each!(a in D => flip * (v[a] + received.increment[a]) + pic * received.velocity[a]) // [TRF-2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_composes_over_steps() {
        let (once, half) = (pic_share(3.0, 0.2), pic_share(3.0, 0.1));
        assert!((1.0 - once - (1.0 - half) * (1.0 - half)).abs() < 1e-15);
        assert_eq!(pic_share(0.0, 0.1), 0.0);
        assert_eq!(pic_share(f64::INFINITY, 0.1), 1.0);
    }
}
