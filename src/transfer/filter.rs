//! Filtered transfers: the velocity that particles take, v_p = Σ w u, comes from a grid field u
//! without the noise that particles can carry and the grid can not see, and without the smoothing
//! of PIC.
//!
//! With S⁺ S, grid to particles and back with masses, the filter of order m is F_m = Σ_{l<m}
//! (1 − S⁺ S)^l, the start of the series of the inverse of S⁺ S. It is summed as u ← v + u − S⁺ S u
//! from u = v, where walls hold every u: then S⁺ S F_m amplifies nothing, with walls or without.
//! (The papers write powers of S⁺ S with binomials, which is the same without walls.)
//! * XPIC(m): u = Δv + F_m(v^n). C. C. Hammerquist, J. A. Nairn, Comput. Methods Appl. Mech. Engrg.
//!   318 (2017) 724–738, doi:10.1016/j.cma.2017.01.035. In lahar positions move with v^{n+1}, the
//!   velocity at the middle of the step in leapfrog.
//! * FMPM(k): u = F_k(v^{n+1}), which approaches the inverse of the full mass matrix; positions and
//!   velocity gradients take u too. Where MUSL and USF take gradients of velocities that came from
//!   the particles again, those go through F as well. J. A. Nairn, C. C. Hammerquist, Comput.
//!   Methods Appl. Mech. Engrg. 377 (2021) 113667, doi:10.1016/j.cma.2021.113667.
//!
//! Both are PIC for order 1. An order costs an additional gather and scatter per step and unit.

/// Most terms of a filter: those beyond change next to nothing.
pub const MOST: i32 = 20;

/// The sum u of l terms with the next one: v + u − S⁺ S u.
pub fn add_term(u: f64, v: f64, back: f64) -> f64 {
    u + (v - back) // [TRF-7]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_filter_approaches_the_inverse() {
        let (eigenvalue, v) = (0.25, 3.0);
        for m in 1..=MOST {
            let u = (1..m).fold(v, |u, _| add_term(u, v, eigenvalue * u));
            let left = (1.0_f64 - eigenvalue).powi(m);
            assert!((eigenvalue * u - (1.0 - left) * v).abs() < 1e-14, "{m}: {u}");
        }
    }
}
