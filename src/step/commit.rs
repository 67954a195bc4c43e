//! Stage 8, commit: what strain and stress stages left in scratch becomes that of the particles, if all of it is finite.
//!
//! The work of the step goes into the strain energy, U += V ½ (σ0 + σ1) : Δε, unless the model gives its own energy.

use super::pass::{Moment, Piece};
use super::time_step::Limits;
use super::update_stress::{Answer, Failure, Outcome, fault};
use crate::error::Status;
use crate::simd::{Isa, Kernel, LANES, Vector};

/// Copies volume, deformation gradient, sizes, stress, state and energy of a chunk from scratch to its particles.
pub fn commit<const D: usize>(
    piece: &mut Piece<'_, '_>,
    isa: Isa,
    moment: Moment,
    answer: Answer,
) -> Outcome {
    copy_shapes(piece);
    let (speed, finite) = isa.dispatch(Commit::<D>(piece));
    if !finite {
        return Outcome::failed(not_finite::<D>(piece, moment));
    }
    let diffusivities = piece.scratch.diffusivity.iter().take(piece.chunk.len);
    let diffusivity = diffusivities.fold(0.0, |m: f64, d| m.max(*d));
    Outcome::of(Limits { speed, diffusivity, ..Limits::default() }, answer)
}

/// Copies deformation gradients and sizes, where particles carry them.
fn copy_shapes(piece: &mut Piece<'_, '_>) {
    let Piece { chunk, scratch, .. } = piece;
    let layout = chunk.layout;
    let sizes = layout.size.filter(|_| !scratch.size1.is_empty());
    for (columns, from) in
        [(layout.deformation_gradient, &*scratch.deformation_gradient), (sizes, &*scratch.size1)]
    {
        let Some(columns) = columns else { continue };
        for c in 0..columns.count {
            let to = chunk.column_mut(columns.first + c);
            to.copy_from_slice(&from[c * scratch.stride..][..to.len()]);
        }
    }
}

/// A number that is finite only if all that it has seen are.
struct Finite<V>(V);

impl<V: Vector> Finite<V> {
    #[inline(always)]
    fn new() -> Self {
        Self(V::splat(0.0))
    }

    /// Sees some more: zero times what is not finite is not a number.
    #[inline(always)]
    fn see(&mut self, values: V) {
        self.0 = values.mul_add(V::splat(0.0), self.0);
    }

    #[inline(always)]
    fn all(self) -> bool {
        self.0.sum().is_finite()
    }
}

/// Writes energy, stress and state into the columns. Gives the largest c + |v|, and whether everything is finite and no wave speed
/// negative.
struct Commit<'p, 'c, 's, const D: usize>(&'p mut Piece<'c, 's>);

impl<const D: usize> Kernel for Commit<'_, '_, '_, D> {
    type Output = (f64, bool);
    #[inline(always)]
    fn run<V: Vector>(self) -> (f64, bool) {
        let Self(Piece { chunk, scratch: s, .. }) = self;
        let (layout, stride, n) = (chunk.layout, s.stride, chunk.len);
        let zero = V::splat(0.0);
        let (mut speed, mut finite, mut negative) = (zero, Finite::new(), 0);
        for k in (0..n).step_by(LANES) {
            let end = n.min(k + LANES);
            let (mut work, mut trace) = (zero, zero);
            for c in 0..6 {
                let at = c * stride + k..c * stride + end;
                let stress = V::load(&s.stress1[at.clone()]);
                stress.store(&mut chunk.column_mut(layout.stress + c)[k..end]);
                let strain = V::load(&s.strain_increment[at.clone()]);
                let twice = (V::load(&s.stress0[at]) + stress) * strain;
                work = twice.mul_add(V::splat(if c < 3 { 0.5 } else { 1.0 }), work);
                trace = if c < 3 { trace + strain } else { trace };
                finite.see(stress);
            }
            let volume = V::load(&s.volume1[k..end]);
            volume.store(&mut chunk.column_mut(layout.volume)[k..end]);
            let energy = if s.energy.is_empty() {
                let change = work * volume * (V::splat(1.0) - V::splat(0.5) * trace); // [STS-1]
                V::load(&chunk.column(layout.strain_energy)[k..end]) + change
            } else {
                V::load(&s.energy[k..end]) * volume // [STS-2]
            };
            energy.store(&mut chunk.column_mut(layout.strain_energy)[k..end]);
            let mut square = zero;
            for d in 0..D {
                let v = V::load(&chunk.column(layout.velocity + d)[k..end]);
                square = v.mul_add(v, square);
                finite.see(V::load(&chunk.column(layout.position + d)[k..end]));
            }
            let c = V::load(&s.wave_speed[k..end]);
            negative |= c.less_than(zero);
            let total = c + square.sqrt();
            speed = speed.max(total);
            finite.see(total + volume + energy);
            for c in layout.strain_energy + 1..layout.state.first {
                finite.see(V::load(&chunk.column(c)[k..end]));
            }
            for c in 0..layout.state.count {
                let state = V::load(&s.state1[c * stride + k..c * stride + end]);
                state.store(&mut chunk.column_mut(layout.state.first + c)[k..end]);
                finite.see(state);
            }
            for output in [&*s.diffusivity, &*s.dt_factor] {
                if !output.is_empty() {
                    finite.see(V::load(&output[k..end]));
                }
            }
        }
        (speed.largest(), negative == 0 && finite.all())
    }
}

fn not_finite<const D: usize>(piece: &Piece<'_, '_>, moment: Moment) -> Box<Failure> {
    let (chunk, s) = (&piece.chunk, &piece.scratch);
    let given = |output: &[f64], k: usize| output.get(k).is_none_or(|value| value.is_finite());
    let good = |k: &usize| {
        (0..chunk.layout.components()).all(|c| chunk.column(c)[*k].is_finite())
            && s.wave_speed[*k] >= 0.0
            && s.wave_speed[*k].is_finite()
            && given(s.diffusivity, *k)
            && given(s.dt_factor, *k)
    };
    let k = (0..chunk.len).find(|k| !good(k));
    fault::<D>(
        piece,
        k.unwrap_or(0),
        moment,
        Status::NonFinite,
        "gave or took a value that is not finite, or gave a negative wave speed,",
    )
}
