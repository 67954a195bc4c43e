//! Stage 6, strain: Δε = dt sym L, the volume, F ← (I + dt L) F, and the objective rotation of the
//! start stress. All of it goes into scratch: particles stay as they are until a
//! [`commit`](super::commit).
//!
//! The stress is turned before the material adds its increment (incrementally objective update, T.
//! J. R. Hughes, J. Winget, Int. J. Numer. Meth. Engng 15 (1980) 1862–1867,
//! doi:10.1002/nme.1620151210), as the model requires: by exp(W dt), W = skw L, instead of the
//! midpoint rule there, which makes the Jaumann rate, or by the increment of the rotation R in
//! F = R U, which makes that of A. E. Green, P. M. Naghdi, Arch. Rational Mech. Anal. 18 (1965)
//! 251–281, doi:10.1007/BF00251666. The equations: docs/book/theory/strain.md.

use super::parts::Method;
use super::pass::ChunkWork;
use super::update_domain::update_domain;
use crate::material::scratch::Scratch;
use crate::material::{Input, Kinematics, Rotation};
use crate::particles::ChunkMut;
use crate::particles::inputs::fill_inputs;
use crate::shape::ShapeKind;
use crate::simd::{Kernel, LANES, Vector, each};
use crate::tensor::{
    Rows, SYMMETRIC, determinant, exp, rotated, rotation_between, step_rotations, turned,
    turned_between,
};

/// Fills the chunk's scratch with what the material takes, and with volume and deformation gradient
/// at the end.
pub fn update_strain<const D: usize>(work: &mut ChunkWork<'_, '_>, method: &Method<D>, dt: f64) {
    let isa = method.isa;
    copy_state(work);
    match work.chunk.layout.deformation_gradient {
        None => isa.dispatch(Strain::<D, false>(work, dt)),
        Some(_) => isa.dispatch(Strain::<D, true>(work, dt)),
    }
    let objective = |rotation| rotation == Rotation::Objective;
    if work.material.model().states.iter().any(|state| objective(state.rotation)) {
        isa.dispatch(RotatedState::<D>(work, dt));
    }
    if method.options.shape == ShapeKind::ContiguousGimp {
        update_domain::<D>(work, isa);
    }
    let ChunkWork { chunk, scratch, ids, .. } = work;
    let ids = &ids[chunk.first..][..chunk.len];
    fill_inputs(scratch, &chunk.layout, |c| chunk.column(c), ids, method.options.spacing);
}

/// The velocity gradients of the points k to `end`, at most eight; in two dimensions those in the
/// plane. Lanes without a point are zero: what the scratch held there before must not matter.
#[inline(always)]
pub(super) fn gradient<V: Vector, const D: usize>(
    l: &[f64],
    stride: usize,
    (k, end): (usize, usize),
) -> Rows<V> {
    let mut rows = [[V::splat(0.0); 3]; 3];
    for a in 0..D {
        for b in 0..D {
            let first = (3 * a + b) * stride;
            rows[a][b] = V::load(&l[first + k..first + end]);
        }
    }
    if D == 2 {
        rows[2][2] = V::load(&l[8 * stride + k..8 * stride + end]); // of the hoop
    }
    rows
}

/// The deformation gradients of the points k to `end` at the start of the step.
#[inline(always)]
pub(super) fn deformation_gradient<V: Vector>(
    chunk: &ChunkMut<'_>,
    (k, end): (usize, usize),
) -> Rows<V> {
    let first = chunk.layout.deformation_gradient.map_or(0, |gradient| gradient.first);
    each!(a in 3, b in 3 => V::load(&chunk.column(first + 3 * a + b)[k..end]))
}

/// Those at its end.
#[inline(always)]
pub(super) fn deformed<V: Vector>(scratch: &Scratch<'_>, k: usize) -> Rows<V> {
    let f = &scratch.deformation_gradient;
    each!(a in 3, b in 3 => V::load(&f[(3 * a + b) * scratch.stride + k..][..LANES]))
}

/// (I + dt L) F.
#[inline(always)]
fn deformed_by<V: Vector>(f: &Rows<V>, l: &Rows<V>, dt: f64) -> Rows<V> {
    each!(a in 3, b in 3 => {
        let lf = l[a][0] * f[0][b] + l[a][1] * f[1][b] + l[a][2] * f[2][b];
        lf.mul_add(V::splat(dt), f[a][b]) // [STR-2]
    })
}

/// det(I + dt L), by which the volume of what carries F grows; not a number where a step turns a
/// particle inside out.
#[inline(always)]
fn growth<V: Vector>(l: &Rows<V>, dt: f64) -> V {
    let step = each!(a in 3, b in 3 => {
        l[a][b].mul_add(V::splat(dt), V::splat(if a == b { 1.0 } else { 0.0 }))
    });
    invalid_if_negative(determinant(&step)) // [STR-4]
}

/// x, or not a number in lanes where x is negative, since the root of x is none there.
#[inline(always)]
fn invalid_if_negative<V: Vector>(x: V) -> V {
    x.sqrt().mul_add(V::splat(0.0), x)
}

/// Strain increment, start stress and volume; `F`: for particles that carry the deformation
/// gradient.
struct Strain<'p, 'c, 's, const D: usize, const F: bool>(&'p mut ChunkWork<'c, 's>, f64);

impl<const D: usize, const F: bool> Kernel for Strain<'_, '_, '_, D, F> {
    type Output = ();
    #[inline(always)]
    fn run<V: Vector>(self) {
        let Self(work, dt) = self;
        let ChunkWork { chunk, scratch, material, .. } = work;
        let (layout, stride) = (chunk.layout, scratch.stride);
        let kinematics = material.model().kinematics;
        let stresses: [&[f64]; 6] = chunk.columns(layout.stress);
        let [masses, volumes] = [layout.mass, layout.volume].map(|c| chunk.column(c));
        for k in (0..chunk.len).step_by(LANES) {
            let end = chunk.len.min(k + LANES);
            let l = gradient::<V, D>(scratch.velocity_gradient, stride, (k, end));
            let half = V::splat(0.5 * dt);
            let increment = each!(c in 6 => {
                let (a, b) = SYMMETRIC[c];
                half * (l[a][b] + l[b][a]) // [STR-1]
            });
            let mut stress = each!(c in 6 => V::load(&stresses[c][k..end]));
            if F {
                let old = deformation_gradient::<V>(chunk, (k, end));
                let new = deformed_by(&old, &l, dt);
                for c in 0..9 {
                    let to = &mut scratch.deformation_gradient[c * stride + k..][..LANES];
                    new[c / 3][c % 3].store(to);
                }
                if kinematics == Kinematics::GreenNaghdi {
                    stress = turned_between::<V, D>(&old, &new, stress);
                }
            }
            if kinematics == Kinematics::StrainIncrement {
                stress = turned::<V, D>(&l, dt, stress);
            }
            for c in 0..6 {
                increment[c].store(&mut scratch.strain_increment[c * stride + k..][..LANES]);
                stress[c].store(&mut scratch.stress0[c * stride + k..][..LANES]);
            }
            let mass = V::load(&masses[k..end]);
            let trace = increment[0] + increment[1] + increment[2];
            let ratio = if F { growth(&l, dt) } else { exp(trace) }; // [STR-3]
            let new = V::load(&volumes[k..end]) * ratio;
            new.store(&mut scratch.volume1[k..][..LANES]);
            if let Some(density) = scratch.input(Input::Density) {
                (mass / new).store(&mut density[k..][..LANES]);
            }
        }
    }
}

/// Copies the start state into the scratch.
fn copy_state(work: &mut ChunkWork<'_, '_>) {
    let ChunkWork { chunk, scratch, .. } = work;
    let (layout, stride, n) = (chunk.layout, scratch.stride, chunk.len);
    for c in 0..layout.state.count {
        scratch.state0[c * stride..][..n].copy_from_slice(chunk.column(layout.state.first + c));
    }
}

/// Rotates the state variables that turn with the material, as the stress is.
struct RotatedState<'p, 'c, 's, const D: usize>(&'p mut ChunkWork<'c, 's>, f64);

impl<const D: usize> Kernel for RotatedState<'_, '_, '_, D> {
    type Output = ();
    #[inline(always)]
    fn run<V: Vector>(self) {
        let Self(ChunkWork { chunk, scratch, material, .. }, dt) = self;
        let stride = scratch.stride;
        let mut first = 0;
        for state in &material.model().states {
            let components = state.kind.components();
            if state.rotation == Rotation::Objective {
                for k in (0..chunk.len).step_by(LANES) {
                    let end = chunk.len.min(k + LANES);
                    let l = gradient::<V, D>(scratch.velocity_gradient, stride, (k, end));
                    let r = match material.model().kinematics {
                        Kinematics::GreenNaghdi => {
                            let old = deformation_gradient(chunk, (k, end));
                            rotation_between(&old, &deformed(scratch, k))
                        }
                        _ => step_rotations(&l, dt),
                    };
                    let at = |c: usize| (first + c) * stride + k;
                    let mut value = [V::splat(0.0); 9];
                    for c in 0..components {
                        value[c] = V::load(&scratch.state0[at(c)..][..LANES]);
                    }
                    let value = rotated_state(&r, value, components);
                    for c in 0..components {
                        value[c].store(&mut scratch.state0[at(c)..][..LANES]);
                    }
                }
            }
            first += components;
        }
    }
}

/// A vector (3), symmetric (6) or general (9) tensor, rotated; a scalar as it is.
#[inline(always)]
fn rotated_state<V: Vector>(r: &Rows<V>, value: [V; 9], components: usize) -> [V; 9] {
    let mut out = value;
    match components {
        3 => {
            for a in 0..3 {
                out[a] = r[a][0] * value[0] + r[a][1] * value[1] + r[a][2] * value[2];
            }
        }
        6 => {
            let six = rotated(r, each!(c in 6 => value[c]));
            out = each!(c in 9 => if c < 6 { six[c] } else { value[c] });
        }
        9 => {
            let m: Rows<V> = each!(a in 3, b in 3 => {
                r[a][0] * value[b] + r[a][1] * value[3 + b] + r[a][2] * value[6 + b]
            });
            for a in 0..3 {
                for b in 0..3 {
                    out[3 * a + b] = m[a][0] * r[b][0] + m[a][1] * r[b][1] + m[a][2] * r[b][2];
                }
            }
        }
        _ => {}
    }
    out
}
