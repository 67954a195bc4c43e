//! Stage 6b, domains of contiguous-particle GIMP: edges follow the diagonal of the stretch U in F = R U.
//!
//! T. J. Charlton, W. M. Coombs, C. E. Augarde, Comput. Struct. 190 (2017) 108–125, doi:10.1016/j.compstruc.2017.05.004; a rotation leaves the
//! diagonal of U alone, unlike that of F. How it compares with other choices: W. M. Coombs, C. E. Augarde, A. J. Brennan et al., Comput. Methods
//! Appl. Mech. Engrg. 358 (2020) 112622, doi:10.1016/j.cma.2019.112622.

use super::pass::Piece;
use super::update_strain::{deformation_gradient, deformed, gradient};
use crate::simd::{Isa, Kernel, LANES, Vector};
use crate::tensor::stretch_diagonal;

/// Updates the edges of the particles of a chunk, whose deformation gradients are still those of the start.
pub fn update_domain<const D: usize>(piece: &mut Piece<'_, '_>, isa: Isa, dt: f64) {
    isa.dispatch(Domain::<D>(piece, dt));
}

struct Domain<'p, 'c, 's, const D: usize>(&'p mut Piece<'c, 's>, f64);

impl<const D: usize> Kernel for Domain<'_, '_, '_, D> {
    type Output = ();
    #[inline(always)]
    fn run<V: Vector>(self) {
        let Self(Piece { chunk, scratch, .. }, dt) = self;
        for k in (0..chunk.len).step_by(LANES) {
            let end = chunk.len.min(k + LANES);
            let l = gradient::<V, D>(scratch.velocity_gradient, scratch.stride, (k, end));
            let old = deformation_gradient(chunk, (k, end));
            let (before, after) =
                (stretch_diagonal(&old), stretch_diagonal(&deformed(&old, &l, dt)));
            for d in 0..D {
                let size = &mut chunk.column_mut(chunk.layout.size + d)[k..end];
                (V::load(size) * after[d] / before[d]).store(size); // [SHP-6]
            }
        }
    }
}
