//! Stage 6, strain: Δε = dt sym L, V ← V exp(dt tr L), F ← (I + dt L) F, and the objective rotation of the start stress.
//!
//! The stress is rotated by R = exp(W dt), W = skw L, before the material adds its increment (incrementally objective update,
//! T. J. R. Hughes, J. Winget, Int. J. Numer. Meth. Engng 15 (1980) 1862–1867, doi:10.1002/nme.1620151210, with the exact
//! exponential instead of the midpoint rule).

use crate::material::{Kinematics, Rotation};
use crate::tensor::{Mat3, rotate, step_rotation, symmetric_part};
use crate::world::state::Piece;

/// Fills the chunk's scratch with what the material takes, and updates volume and deformation gradient.
pub fn update_strain<const D: usize>(piece: &mut Piece<'_, '_, D>, dt: f64) {
    let Piece { chunk, scratch, material, .. } = piece;
    let layout = chunk.layout;
    let stride = scratch.stride;
    let rotates = material.model().kinematics == Kinematics::StrainIncrement;
    for k in 0..chunk.len {
        let l = Mat3::from_fn(|a, b| scratch.velocity_gradient[(3 * a + b) * stride + k]);
        let increment = symmetric_part(&(l * dt));
        for c in 0..6 {
            scratch.strain_increment[c * stride + k] = increment[c];
        }
        let mut stress = chunk.get::<6>(layout.stress, k);
        if rotates {
            stress = rotate(&step_rotation(&l, dt), stress);
        }
        for c in 0..6 {
            scratch.stress0[c * stride + k] = stress[c];
        }
        let [volume] = chunk.get::<1>(layout.volume, k);
        let volume = volume * (increment[0] + increment[1] + increment[2]).exp();
        chunk.set(layout.volume, k, [volume]);
        let [mass] = chunk.get::<1>(layout.mass, k);
        scratch.set_inputs(k, mass / volume, piece.space.spacing);
    }
    update_deformation_gradient(piece, dt);
    copy_state(piece, dt);
}

fn update_deformation_gradient<const D: usize>(piece: &mut Piece<'_, '_, D>, dt: f64) {
    let Piece { chunk, scratch, .. } = piece;
    let (layout, stride) = (chunk.layout, scratch.stride);
    if layout.state == layout.deformation_gradient {
        return;
    }
    for k in 0..chunk.len {
        let l = Mat3::from_fn(|a, b| scratch.velocity_gradient[(3 * a + b) * stride + k]);
        let f = chunk.get::<9>(layout.deformation_gradient, k);
        let f = (Mat3::identity() + l * dt) * Mat3::from_row_slice(&f);
        for a in 0..3 {
            for b in 0..3 {
                scratch.deformation_gradient[(3 * a + b) * stride + k] = f[(a, b)];
                chunk.column_mut(layout.deformation_gradient + 3 * a + b)[k] = f[(a, b)];
            }
        }
    }
}

/// Copies the start state into the scratch; variables that rotate with the material are rotated as the stress is.
fn copy_state<const D: usize>(piece: &mut Piece<'_, '_, D>, dt: f64) {
    let Piece { chunk, scratch, material, .. } = piece;
    let (layout, stride, n) = (chunk.layout, scratch.stride, chunk.len);
    for c in 0..layout.state_components() {
        scratch.state0[c * stride..][..n].copy_from_slice(chunk.column(layout.state + c));
    }
    let mut first = 0;
    for state in &material.model().states {
        let components = state.kind.components();
        if state.rotation == Rotation::Objective {
            for k in 0..n {
                let l = Mat3::from_fn(|a, b| scratch.velocity_gradient[(3 * a + b) * stride + k]);
                let r = step_rotation(&l, dt);
                let mut value = [0.0; 9];
                for c in 0..components {
                    value[c] = scratch.state0[(first + c) * stride + k];
                }
                let value = rotate_state(&r, value, components);
                for c in 0..components {
                    scratch.state0[(first + c) * stride + k] = value[c];
                }
            }
        }
        first += components;
    }
}

/// A vector (3), symmetric (6) or general (9) tensor, rotated; a scalar as it is.
fn rotate_state(r: &Mat3, value: [f64; 9], components: usize) -> [f64; 9] {
    let mut out = value;
    match components {
        3 => {
            let v = r * nalgebra::Vector3::new(value[0], value[1], value[2]);
            out[..3].copy_from_slice(v.as_slice());
        }
        6 => out[..6].copy_from_slice(&rotate(r, std::array::from_fn(|c| value[c]))),
        9 => {
            let m = r * Mat3::from_row_slice(&value) * r.transpose();
            out = std::array::from_fn(|c| m[(c / 3, c % 3)]);
        }
        _ => {}
    }
    out
}
