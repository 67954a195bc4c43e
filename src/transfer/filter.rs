//! Filtered transfers: the velocity that particles take, v_p = Σ w u, comes from a grid field u without the noise that particles can carry
//! and the grid can not see, and without the smoothing of PIC.
//!
//! With S⁺ S, grid to particles and back with masses, the filter of order m is
//! F_m(v) = Σ_{l=1..m} (−1)^{l+1} C(m, l) (S⁺ S)^{l−1} v; each term comes from the last, times −(m − l + 1)/l.
//! * XPIC(m): u = Δv + F_m(v^n). C. C. Hammerquist, J. A. Nairn, Comput. Methods Appl. Mech. Engrg. 318 (2017) 724–738,
//!   doi:10.1016/j.cma.2017.01.035. In lahar positions move with v^{n+1}, the velocity at the middle of the step in leapfrog.
//! * FMPM(k): u = F_k(v^{n+1}), which approaches the inverse of the full mass matrix; positions and velocity gradients take u
//!   too. J. A. Nairn, C. C. Hammerquist, Comput. Methods Appl. Mech. Engrg. 377 (2021) 113667, doi:10.1016/j.cma.2021.113667.
//!
//! Both are PIC for order 1. An order costs an additional gather and scatter per step and unit.

/// Most terms of a filter: beyond, the binomials amplify round-off.
pub const MOST: i32 = 20;

/// The factor from term l − 1 to term l (l ≥ 2) of the filter of order m.
pub fn factor(m: i32, l: i32) -> f64 {
    -f64::from(m - l + 1) / f64::from(l) // [TRF-7]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_factors_make_binomials_of_alternating_sign() {
        let mut term = 5.0;
        let terms = [2, 3, 4, 5].map(|l| {
            term *= factor(5, l);
            term
        });
        assert_eq!(terms, [-10.0, 10.0, -5.0, 1.0]);
    }
}
