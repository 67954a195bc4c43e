//! Stage 7, stress: the material updates a chunk at once, the engine checks the answer and commits it.
//!
//! The work of the step goes into the strain energy, U += V ½ (σ0 + σ1) : Δε, unless the model gives its own energy.

use lahar_plugin_abi::{LAHAR_POINT_FAILED, LAHAR_POINT_SMALLER_STEP, LAHAR_POINT_UNRELIABLE};

use super::pass::{Moment, Piece};
use super::time_step::Limits;
use crate::error::{Error, Place, Status};
use crate::material::{Capsule, Occasion, StressBatch};
use crate::simd::{Isa, Kernel, LANES, Vector};

/// Why a step failed, and the call of the model at the point where it did, if there is one.
#[derive(Debug)]
pub struct Failure {
    /// Why.
    pub error: Error,
    /// The call.
    pub capsule: Option<Capsule>,
}

impl Failure {
    /// Whether a point failed in the step, so that a smaller one may go.
    pub fn is_of_a_point(&self) -> bool {
        self.capsule.is_some()
    }
}

impl From<Error> for Box<Failure> {
    fn from(error: Error) -> Self {
        Self::new(Failure { error, capsule: None })
    }
}

/// What the stress updates of a step lead to.
#[derive(Debug, Default)]
pub struct Outcome {
    limits: Limits,
    wish: Option<Wish>,
    failure: Option<Box<Failure>>,
    unreliable: Option<Unreliable>,
}

/// The smallest step that a point asks for.
#[derive(Clone, Copy, Debug)]
pub struct Wish {
    /// Factor on the time step, in (0, 1) [–].
    pub factor: f64,
    /// Body of the point.
    pub body: i64,
    /// Its particle.
    pub particle: i64,
}

/// Points that a model answered for with less accuracy than it promises.
#[derive(Clone, Copy, Debug)]
pub struct Unreliable {
    /// How many.
    pub points: usize,
    /// Body of the first.
    pub body: i64,
    /// Particle of the first.
    pub particle: i64,
}

impl Outcome {
    /// Both together; of two failures the first counts.
    pub fn merge(mut self, other: Self) -> Self {
        self.add(other);
        self
    }

    /// Takes another into this one, which is the first.
    pub fn add(&mut self, other: Self) {
        self.limits = self.limits.merge(other.limits);
        self.wish = match (self.wish, other.wish) {
            (Some(a), Some(b)) => Some(if b.factor < a.factor { b } else { a }),
            (a, b) => a.or(b),
        };
        if self.failure.is_none() {
            self.failure = other.failure;
        }
        self.unreliable = match (self.unreliable, other.unreliable) {
            (Some(a), Some(b)) => Some(Unreliable { points: a.points + b.points, ..a }),
            (a, b) => a.or(b),
        };
    }

    /// The points that are less accurate than promised.
    pub fn unreliable(&self) -> Option<Unreliable> {
        self.unreliable
    }

    /// The smallest step that a point asks for.
    pub fn wish(&self) -> Option<Wish> {
        self.wish
    }

    /// The limits of the step after one of length `dt` [s], or the failure.
    pub fn limits(self, dt: f64) -> Result<Limits, Box<Failure>> {
        let wanted_dt = self.wish.map_or(f64::INFINITY, |wish| dt * wish.factor);
        let limits = Limits { wanted_dt, ..self.limits };
        self.failure.map_or(Ok(limits), Err)
    }

    fn failed(failure: impl Into<Box<Failure>>) -> Self {
        Self { failure: Some(failure.into()), ..Self::default() }
    }
}

/// Updates stress, state and energy of a chunk.
pub fn update_stress<const D: usize>(
    piece: &mut Piece<'_, '_>,
    isa: Isa,
    moment: Moment,
) -> Outcome {
    let Moment { time, step, dt } = moment;
    let mut batch = StressBatch { dt, time, step, ..piece.scratch.batch() };
    if let Err(error) = piece.material.update(&mut batch) {
        return Outcome::failed(error.at(Place { body: Some(piece.body), ..Place::default() }));
    }
    if let Some(failure) = failed_point::<D>(piece, moment) {
        return Outcome::failed(failure);
    }
    let wish = match smallest_wish(piece) {
        Ok(wish) => wish,
        Err(k) => {
            let text = "gave a factor on the time step that is not above 0";
            return Outcome::failed(fault::<D>(piece, k, moment, Status::MaterialFailed, text));
        }
    };
    let (speed, finite) = isa.dispatch(Commit::<D>(piece));
    if !finite {
        return Outcome::failed(not_finite::<D>(piece, moment));
    }
    let diffusivities = piece.scratch.diffusivity.iter().take(piece.chunk.len);
    let diffusivity = diffusivities.fold(0.0, |m: f64, d| m.max(*d));
    let limits = Limits { speed, diffusivity, ..Limits::default() };
    Outcome { limits, wish, failure: None, unreliable: unreliable(piece) }
}

fn failed_point<const D: usize>(piece: &Piece<'_, '_>, moment: Moment) -> Option<Box<Failure>> {
    let status = &piece.scratch.status[..piece.chunk.len];
    if status.iter().fold(0, |worst, s| worst.max(*s)) < LAHAR_POINT_FAILED {
        return None;
    }
    let k = status.iter().position(|s| *s >= LAHAR_POINT_FAILED).unwrap_or(0);
    Some(fault::<D>(piece, k, moment, Status::MaterialFailed, "could not update"))
}

fn unreliable(piece: &Piece<'_, '_>) -> Option<Unreliable> {
    let status = &piece.scratch.status[..piece.chunk.len];
    let points = status.iter().fold(0, |n, s| n + usize::from(*s == LAHAR_POINT_UNRELIABLE));
    if points == 0 {
        return None;
    }
    let k = status.iter().position(|s| *s == LAHAR_POINT_UNRELIABLE).unwrap_or(0);
    Some(Unreliable { points, body: piece.body, particle: piece.ids[piece.chunk.first + k] })
}

/// The smallest step that a point of the chunk asks for; the place of a point whose factor makes no sense.
fn smallest_wish(piece: &Piece<'_, '_>) -> Result<Option<Wish>, usize> {
    let s = &piece.scratch;
    let n = piece.chunk.len;
    let (mut factor, mut place) = (1.0, None);
    for (k, f) in s.dt_factor.iter().take(n).enumerate() {
        if *f <= 0.0 {
            return Err(k);
        }
        if *f < factor {
            (factor, place) = (*f, Some(k));
        }
    }
    let smaller = |s: &i32| *s == LAHAR_POINT_SMALLER_STEP;
    if place.is_none() && s.status[..n].iter().fold(false, |any, s| any | smaller(s)) {
        (factor, place) = (0.5, s.status[..n].iter().position(smaller));
    }
    let id = |k: usize| piece.ids[piece.chunk.first + k];
    Ok(place.map(|k| Wish { factor, body: piece.body, particle: id(k) }))
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
        // zero times everything that must be finite
        let (mut speed, mut nothing, mut negative) = (zero, zero, 0);
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
                nothing = stress.mul_add(zero, nothing);
            }
            let volume = V::load(&chunk.column(layout.volume)[k..end]);
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
                nothing =
                    V::load(&chunk.column(layout.position + d)[k..end]).mul_add(zero, nothing);
            }
            let c = V::load(&s.wave_speed[k..end]);
            negative |= c.less_than(zero);
            let total = c + square.sqrt();
            speed = speed.max(total);
            nothing = (total + volume + energy).mul_add(zero, nothing);
            for c in layout.strain_energy + 1..layout.state {
                nothing = V::load(&chunk.column(c)[k..end]).mul_add(zero, nothing);
            }
            for c in 0..layout.state_components() {
                let state = V::load(&s.state1[c * stride + k..c * stride + end]);
                state.store(&mut chunk.column_mut(layout.state + c)[k..end]);
                nothing = state.mul_add(zero, nothing);
            }
            for output in [&*s.diffusivity, &*s.dt_factor] {
                if !output.is_empty() {
                    nothing = V::load(&output[k..end]).mul_add(zero, nothing);
                }
            }
        }
        (speed.largest(), negative == 0 && nothing.sum().is_finite())
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

fn fault<const D: usize>(
    piece: &Piece<'_, '_>,
    k: usize,
    Moment { time, step, dt }: Moment,
    status: Status,
    what: &str,
) -> Box<Failure> {
    let (body, model) = (piece.body, piece.material.model().name);
    let particle = piece.ids[piece.chunk.first + k];
    let (chunk, layout) = (&piece.chunk, piece.chunk.layout);
    let text = format!(
        "the model `{model}` {what} at particle {particle} of body {body}: position {:?}, velocity {:?}, \
         start stress {:?}; check parameters, time step and boundaries",
        chunk.get::<D>(layout.position, k),
        chunk.get::<D>(layout.velocity, k),
        piece.scratch.stress0_of(k),
    );
    let place = Place { body: Some(body), particle: Some(particle), ..Place::default() };
    let occasion = Occasion { body, particle, step, time, dt };
    let capsule = Capsule::of_point(piece.material, &piece.scratch, k, occasion);
    Box::new(Failure { error: Error::new(status, text).at(place), capsule: Some(capsule) })
}
