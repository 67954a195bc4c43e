//! Stage 3, the grid: v_i = (mv)_i / m_i + dt (f_i / m_i + g), with local non-viscous damping.
//!
//! Every node with any mass takes part, however light: m_i and (mv)_i carry the same small weight, so that their quotient is as good as
//! any, and a cut-off would leave holes in the velocity gradient of a body that flies by. The quotient f_i / m_i of a light node
//! does grow, as ∇w / w. Quadratic shapes bear it, since their gradient vanishes with the weight; linear ones do not, and
//! want FLIP with MUSL, whose second mapping takes the light nodes out of the velocity gradient.
//!
//! Damping takes α |F| from every component of the force F = f + m g, against the velocity: F ← F − α |F| sgn(v).
//! P. A. Cundall, in: E. T. Brown (ed.), Analytical and Computational Methods in Engineering Rock Mechanics (1987) 129–163.

use rayon::prelude::*;

use crate::grid::Lanes;
use crate::world::state::State;

/// Turns momentum and force into velocity (R0) and its increment (R1).
pub fn update_grid<const D: usize>(world: &mut State<D>, dt: f64) {
    let (gravity, damping) = (world.options.gravity, world.options.damping);
    let node = |((r0, r1), force): ((&mut Lanes, &mut Lanes), &Lanes)| {
        let mass = r0[0];
        if mass == 0.0 {
            (*r0, *r1) = ([0.0; 4], [0.0; 4]);
            return;
        }
        for a in 1..=D {
            let before = r0[a] / mass;
            let mut acceleration = force[a] / mass + gravity[a - 1];
            if damping > 0.0 && before != 0.0 {
                acceleration -= damping * acceleration.abs() * before.signum();
            }
            r1[a] = dt * acceleration;
            r0[a] = before + r1[a];
        }
    };
    let grid = &mut world.grid;
    if world.parallel {
        let records = grid.velocity.par_iter_mut().zip(&mut grid.increment).zip(&grid.force);
        records.with_min_len(4096).for_each(node);
    } else {
        let records = grid.velocity.iter_mut().zip(&mut grid.increment).zip(&grid.force);
        records.for_each(node);
    }
}
