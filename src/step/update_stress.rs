//! Stage 7, stress: the material updates a chunk at once, the engine checks the answer and commits it.
//!
//! The work of the step goes into the strain energy, U += V ½ (σ0 + σ1) : Δε, unless the model gives its own energy.

use lahar_plugin_abi::{LAHAR_POINT_FAILED, LAHAR_POINT_SMALLER_STEP};

use crate::error::{Error, Place, Result, Status};
use crate::material::StressBatch;
use crate::step::time_step::{Limits, larger};
use crate::world::state::Piece;

/// What the stress updates of a step lead to.
#[derive(Debug, Default)]
pub struct Outcome {
    limits: Limits,
    failure: Option<Box<Error>>,
}

impl Outcome {
    /// Both together; of two failures the first counts.
    pub fn merge(self, other: Self) -> Self {
        Self { limits: self.limits.merge(other.limits), failure: self.failure.or(other.failure) }
    }

    /// The limits of the next step, or the failure.
    pub fn limits(self) -> Result<Limits> {
        self.failure.map_or(Ok(self.limits), |error| Err(*error))
    }
}

/// Updates stress, state and energy of a chunk.
pub fn update_stress<const D: usize>(piece: &mut Piece<'_, '_, D>, dt: f64) -> Outcome {
    let mut batch = StressBatch { dt, time: piece.time, ..piece.scratch.batch() };
    let result = piece.material.update(&mut batch);
    if let Err(error) = result.and_then(|()| check_points(piece)) {
        return Outcome { failure: Some(Box::new(error)), ..Outcome::default() };
    }
    let wanted_dt = dt * wanted_factor(piece);
    commit(piece);
    let mut limits = Limits { wanted_dt, ..limits_of_chunk(piece) };
    if !limits.speed.is_finite() {
        return Outcome { failure: Some(Box::new(not_finite(piece))), ..Outcome::default() };
    }
    limits.diffusivity =
        piece.scratch.diffusivity.iter().take(piece.chunk.len).fold(0.0, |m, d| m.max(*d));
    Outcome { limits, failure: None }
}

fn check_points<const D: usize>(piece: &Piece<'_, '_, D>) -> Result<()> {
    let failed =
        piece.scratch.status.iter().take(piece.chunk.len).position(|s| *s >= LAHAR_POINT_FAILED);
    match failed {
        Some(k) => Err(fault(piece, k, Status::MaterialFailed, "could not update")),
        None => Ok(()),
    }
}

/// Smallest factor on the time step that a point of the chunk wants; 1 if none does, infinity if the model has no wishes.
fn wanted_factor<const D: usize>(piece: &Piece<'_, '_, D>) -> f64 {
    let s = &piece.scratch;
    let n = piece.chunk.len;
    let mut factor = f64::INFINITY;
    for f in s.dt_factor.iter().take(n).filter(|f| **f > 0.0 && **f < 1.0) {
        factor = factor.min(*f);
    }
    if s.dt_factor.is_empty() && s.status.iter().take(n).any(|p| *p == LAHAR_POINT_SMALLER_STEP) {
        factor = 0.5;
    }
    factor
}

fn commit<const D: usize>(piece: &mut Piece<'_, '_, D>) {
    let (s, chunk) = (&piece.scratch, &mut piece.chunk);
    let (layout, stride, n) = (chunk.layout, s.stride, chunk.len);
    for k in 0..n {
        let [volume] = chunk.get::<1>(layout.volume, k);
        let energy = if s.energy.is_empty() {
            let mut work = 0.0;
            for c in 0..6 {
                let twice = if c < 3 { 0.5 } else { 1.0 };
                let i = c * stride + k;
                work += twice * (s.stress0[i] + s.stress1[i]) * s.strain_increment[i];
            }
            let trace = s.strain_increment[k]
                + s.strain_increment[stride + k]
                + s.strain_increment[2 * stride + k];
            chunk.column(layout.strain_energy)[k] + work * volume * (1.0 - 0.5 * trace)
        } else {
            s.energy[k] * volume
        };
        chunk.set(layout.strain_energy, k, [energy]);
    }
    for c in 0..6 {
        chunk.column_mut(layout.stress + c).copy_from_slice(&s.stress1[c * stride..][..n]);
    }
    for c in 0..layout.state_components() {
        chunk.column_mut(layout.state + c).copy_from_slice(&s.state1[c * stride..][..n]);
    }
}

/// Largest c + |v|; not a number or infinite if anything of any particle is, or if a wave speed is negative.
fn limits_of_chunk<const D: usize>(piece: &Piece<'_, '_, D>) -> Limits {
    let (chunk, layout) = (&piece.chunk, piece.chunk.layout);
    let mut limits = Limits::default();
    for k in 0..chunk.len {
        limits.speed = larger(limits.speed, magnitude(piece, k));
    }
    for c in layout.strain_energy..layout.components() {
        let worst = chunk.column(c).iter().fold(0.0, |m, v| larger(m, 0.0 * v));
        limits.speed += worst;
    }
    limits
}

/// c + |v| of particle k, plus zero times everything that must be finite.
fn magnitude<const D: usize>(piece: &Piece<'_, '_, D>, k: usize) -> f64 {
    let (chunk, layout) = (&piece.chunk, piece.chunk.layout);
    let v = chunk.get::<D>(layout.velocity, k);
    let x = chunk.get::<D>(layout.position, k);
    let stress = chunk.get::<6>(layout.stress, k);
    let [volume] = chunk.get::<1>(layout.volume, k);
    let s = &piece.scratch;
    let given = |output: &[f64]| output.get(k).map_or(0.0, |value| value.abs());
    let rest = given(s.diffusivity) + given(s.dt_factor) + volume;
    let zero = 0.0 * (stress.iter().sum::<f64>() + x.iter().sum::<f64>() + rest);
    let c = if s.wave_speed[k] >= 0.0 { s.wave_speed[k] } else { f64::NAN };
    c + v.iter().map(|c| c * c).sum::<f64>().sqrt() + zero
}

fn not_finite<const D: usize>(piece: &Piece<'_, '_, D>) -> Error {
    let layout = piece.chunk.layout;
    let bad = |k: &usize| {
        let state = |c| !piece.chunk.column(c)[*k].is_finite();
        !magnitude(piece, *k).is_finite() || (layout.strain_energy..layout.components()).any(state)
    };
    let k = (0..piece.chunk.len).find(bad).unwrap_or(0);
    fault(
        piece,
        k,
        Status::NonFinite,
        "gave or took a value that is not finite, or gave a negative wave speed,",
    )
}

fn fault<const D: usize>(piece: &Piece<'_, '_, D>, k: usize, status: Status, what: &str) -> Error {
    let (body, model) = (piece.body, piece.material.model().name);
    let particle = piece.ids[piece.chunk.first + k];
    let (chunk, layout) = (&piece.chunk, piece.chunk.layout);
    let text = format!(
        "the model `{model}` {what} at particle {particle} of body {body}: position {:?}, velocity {:?}, \
         start stress {:?}; the world is poisoned: check parameters, time step and boundaries",
        chunk.get::<D>(layout.position, k),
        chunk.get::<D>(layout.velocity, k),
        piece.scratch.stress0_of(k),
    );
    Error::new(status, text).at(Place {
        body: Some(body),
        particle: Some(particle),
        ..Place::default()
    })
}
