//! Stage 8, commit: what strain and stress stages left in scratch becomes that of the particles, if
//! all of it is finite.
//!
//! The work of the step goes into the strain energy, U += V ½ (σ0 + σ1) : Δε, unless the model
//! gives its own energy.

use super::pass::{ChunkWork, Moment};
use super::time_step::Limits;
use super::update_stress::{Answer, Failure, Outcome, fault};
use crate::error::Status;
use crate::material::scratch::Scratch;
use crate::particles::{Columns, Layout};
use crate::simd::{Isa, Kernel, LANES, Vector};

/// Takes over what stands in scratch: volume, stress, energy, sizes, deformation gradient and state
/// of a chunk.
pub fn commit<const D: usize>(
    work: &mut ChunkWork<'_, '_>,
    isa: Isa,
    moment: Moment,
    answer: Answer,
) -> Outcome {
    let (speed, finite) = isa.dispatch(Check::<D>(work));
    if !finite {
        return Outcome::failed(not_finite::<D>(work, moment));
    }
    let ChunkWork { chunk, scratch, .. } = work;
    for (columns, from) in ends(&chunk.layout, scratch) {
        for c in 0..columns.count {
            let to = chunk.column_mut(columns.first + c);
            to.copy_from_slice(&from[c * scratch.stride..][..to.len()]);
        }
    }
    let diffusivities = scratch.diffusivity.iter().take(chunk.len);
    let diffusivity = diffusivities.fold(0.0, |m: f64, d| m.max(*d));
    Outcome::of(Limits { speed, diffusivity, ..Limits::default() }, answer)
}

/// Columns of particles, and where their values at the end of the step stand in scratch.
#[inline(always)]
fn ends<'s>(layout: &Layout, scratch: &'s Scratch<'_>) -> [(Columns, &'s [f64]); 6] {
    let none = Columns { first: 0, count: 0 };
    let columns = |first, count| Columns { first, count };
    let sizes = layout.size.filter(|_| !scratch.size1.is_empty());
    [
        (columns(layout.volume, 1), &*scratch.volume1),
        (columns(layout.stress, 6), &*scratch.stress1),
        (columns(layout.strain_energy, 1), &*scratch.strain_energy1),
        (sizes.unwrap_or(none), &*scratch.size1),
        (layout.deformation_gradient.unwrap_or(none), &*scratch.deformation_gradient),
        (layout.state, &*scratch.state1),
    ]
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

    /// Sees a column.
    #[inline(always)]
    fn see_all(&mut self, values: &[f64]) {
        for k in (0..values.len()).step_by(LANES) {
            self.see(V::load(&values[k..]));
        }
    }

    #[inline(always)]
    fn all(self) -> bool {
        self.0.sum().is_finite()
    }
}

/// Finds the energy at the end. Gives the largest c + |v|, and whether everything is finite and no
/// wave speed negative.
struct Check<'p, 'c, 's, const D: usize>(&'p mut ChunkWork<'c, 's>);

impl<const D: usize> Kernel for Check<'_, '_, '_, D> {
    type Output = (f64, bool);
    #[inline(always)]
    fn run<V: Vector>(self) -> (f64, bool) {
        let Self(ChunkWork { chunk, scratch: s, .. }) = self;
        let (layout, stride, n) = (chunk.layout, s.stride, chunk.len);
        let velocity: [&[f64]; D] = chunk.columns(layout.velocity);
        let energy0 = chunk.column(layout.strain_energy);
        let zero = V::splat(0.0);
        let (mut speed, mut finite, mut negative) = (zero, Finite::new(), 0);
        for k in (0..n).step_by(LANES) {
            let end = n.min(k + LANES);
            let (mut work, mut trace) = (zero, zero);
            for c in 0..6 {
                let at = c * stride + k..c * stride + end;
                let stress = V::load(&s.stress1[at.clone()]);
                let strain = V::load(&s.strain_increment[at.clone()]);
                let twice = (V::load(&s.stress0[at]) + stress) * strain;
                work = twice.mul_add(V::splat(if c < 3 { 0.5 } else { 1.0 }), work);
                trace = if c < 3 { trace + strain } else { trace };
            }
            let volume = V::load(&s.volume1[k..end]);
            let energy = if s.energy.is_empty() {
                let change = work * volume * (V::splat(1.0) - V::splat(0.5) * trace); // [STS-1]
                V::load(&energy0[k..end]) + change
            } else {
                V::load(&s.energy[k..end]) * volume // [STS-2]
            };
            energy.store(&mut s.strain_energy1[k..][..LANES]);
            let mut square = zero;
            for d in 0..D {
                let v = V::load(&velocity[d][k..end]);
                square = v.mul_add(v, square);
            }
            let c = V::load(&s.wave_speed[k..end]);
            negative |= c.less_than(zero);
            let total = c + square.sqrt();
            speed = speed.max(total);
            finite.see(total);
        }
        for d in 0..D {
            finite.see_all(chunk.column(layout.position + d));
        }
        for columns in layout.optional() {
            for c in 0..columns.count {
                finite.see_all(chunk.column(columns.first + c));
            }
        }
        for (columns, values) in ends(&layout, s) {
            for c in 0..columns.count {
                finite.see_all(&values[c * stride..][..n]);
            }
        }
        for output in [&*s.diffusivity, &*s.dt_factor] {
            finite.see_all(&output[..n.min(output.len())]);
        }
        (speed.largest(), negative == 0 && finite.all())
    }
}

fn not_finite<const D: usize>(work: &ChunkWork<'_, '_>, moment: Moment) -> Box<Failure> {
    let (chunk, s) = (&work.chunk, &work.scratch);
    let given = |output: &[f64], k: usize| output.get(k).is_none_or(|value| value.is_finite());
    let ends = ends(&chunk.layout, s);
    let good = |k: &usize| {
        let end = |(columns, values): &(Columns, &[f64])| {
            (0..columns.count).all(|c| values[c * s.stride + k].is_finite())
        };
        (0..chunk.layout.components()).all(|c| chunk.column(c)[*k].is_finite())
            && ends.iter().all(end)
            && s.wave_speed[*k] >= 0.0
            && s.wave_speed[*k].is_finite()
            && given(s.diffusivity, *k)
            && given(s.dt_factor, *k)
    };
    let k = (0..chunk.len).find(|k| !good(k));
    fault::<D>(
        work,
        k.unwrap_or(0),
        moment,
        Status::NonFinite,
        "gave or took a value that is not finite, or gave a negative wave speed,",
    )
}
