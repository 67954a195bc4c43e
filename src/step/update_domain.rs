//! Stage 6b, domains of contiguous-particle GIMP: edges follow the diagonal of the stretch U in
//! F = R U.
//!
//! T. J. Charlton, W. M. Coombs, C. E. Augarde, Comput. Struct. 190 (2017) 108–125,
//! doi:10.1016/j.compstruc.2017.05.004; a rotation leaves the diagonal of U alone, unlike that of
//! F. How it compares with other choices: W. M. Coombs, C. E. Augarde, A. J. Brennan et al.,
//! Comput. Methods Appl. Mech. Engrg. 358 (2020) 112622, doi:10.1016/j.cma.2019.112622.

use super::pass::ChunkWork;
use super::update_strain::{deformation_gradient, deformed};
use crate::simd::{Isa, Kernel, LANES, Vector};
use crate::tensor::stretch_diagonal;

/// Finds the edges of the particles of a chunk at the end of the step, of which the deformation
/// gradients are known.
pub fn update_domain<const D: usize>(work: &mut ChunkWork<'_, '_>, isa: Isa) {
    isa.dispatch(Domain::<D>(work));
}

struct Domain<'p, 'c, 's, const D: usize>(&'p mut ChunkWork<'c, 's>);

impl<const D: usize> Kernel for Domain<'_, '_, '_, D> {
    type Output = ();
    #[inline(always)]
    fn run<V: Vector>(self) {
        let Self(ChunkWork { chunk, scratch, .. }) = self;
        let first = chunk.layout.size.map_or(0, |size| size.first);
        for k in (0..chunk.len).step_by(LANES) {
            let end = chunk.len.min(k + LANES);
            let old = deformation_gradient(chunk, (k, end));
            let (before, after) =
                (stretch_diagonal(&old), stretch_diagonal::<V>(&deformed(scratch, k)));
            for d in 0..D {
                let size = V::load(&chunk.column(first + d)[k..end]);
                let to = &mut scratch.size1[d * scratch.stride + k..][..LANES];
                (size * after[d] / before[d]).store(to); // [SHP-6]
            }
        }
    }
}
