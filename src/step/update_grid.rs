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

use crate::background::Lanes;
use crate::simd::{Kernel, LANES, Vector};
use crate::world::state::State;

/// Nodes that one thread takes at a time.
const NODES: usize = 1024;

/// Turns momentum and force into velocity (R0) and its increment (R1).
pub fn update_grid<const D: usize>(world: &mut State<D>, dt: f64) {
    let (gravity, damping) = (world.gravity(world.time + 0.5 * dt), world.options.damping); // [CND-2]
    let mut g = [0.0; LANES]; // of two nodes
    for a in 0..D {
        (g[1 + a], g[5 + a]) = (gravity[a], gravity[a]);
    }
    let isa = world.context.isa();
    let update = |((r0, r1), force): ((&mut [Lanes], &mut [Lanes]), &[Lanes])| {
        isa.dispatch(Update { r0, r1, force, g, damping, dt });
    };
    let grid = &mut world.grid;
    if world.parallel {
        let records = grid.velocity.par_chunks_mut(NODES).zip(grid.increment.par_chunks_mut(NODES));
        records.zip(grid.force.par_chunks(NODES)).for_each(update);
    } else {
        update(((&mut grid.velocity, &mut grid.increment), &grid.force));
    }
}

struct Update<'a> {
    r0: &'a mut [Lanes],
    r1: &'a mut [Lanes],
    force: &'a [Lanes],
    g: [f64; LANES],
    damping: f64,
    dt: f64,
}

impl Kernel for Update<'_> {
    type Output = ();
    #[inline(always)]
    fn run<V: Vector>(self) {
        let (g, dt) = (V::from_array(self.g), V::splat(self.dt));
        let forces = self.force.as_flattened().chunks_exact(LANES);
        let r0 = self.r0.as_flattened_mut().chunks_exact_mut(LANES);
        let r1 = self.r1.as_flattened_mut().chunks_exact_mut(LANES);
        for ((r0, r1), force) in r0.zip(r1).zip(forces) {
            let (m, n) = (r0[0], r0[4]);
            let inverse = V::halves(inverse(m), inverse(n));
            let present = V::halves(present(m), present(n));
            let before = V::load(r0) * inverse;
            let mut acceleration = V::load(force).mul_add(inverse, g * present);
            if self.damping > 0.0 {
                let sign = before / before.abs().max(V::splat(f64::MIN_POSITIVE));
                let resistance = V::splat(self.damping) * acceleration.abs() * sign;
                acceleration = acceleration - resistance; // [GRD-2]
            }
            let change = acceleration * dt;
            change.store(r1);
            (before + change).store(r0); // [GRD-1]
            (r0[0], r0[4]) = (m, n);
        }
    }
}

/// 1 / m; zero for an empty node, whose velocity is then zero too. A mass that has no inverse counts as none.
#[inline(always)]
fn inverse(m: f64) -> f64 {
    if m >= f64::MIN_POSITIVE { 1.0 / m } else { 0.0 }
}

/// 1 for a node with mass, else 0.
#[inline(always)]
fn present(m: f64) -> f64 {
    f64::from(m >= f64::MIN_POSITIVE)
}
