//! Stage 7, stress: the material updates a chunk at once, in scratch, and the engine checks the
//! answer.

use lahar_plugin_abi::{LAHAR_POINT_FAILED, LAHAR_POINT_SMALLER_STEP, LAHAR_POINT_UNRELIABLE};

use super::pass::{ChunkWork, Moment};
use super::time_step::Limits;
use crate::error::{Error, Place, Status};
use crate::material::{Capsule, Occasion, StressBatch};

/// Why a step failed, and the call of the model at the point where it did, if a point did.
#[derive(Debug)]
pub struct Failure {
    /// Why.
    pub error: Error,
    /// Whether a point failed, so that a smaller step may go.
    pub of_a_point: bool,
    /// The call, if there was memory for it.
    pub capsule: Option<Capsule>,
}

impl From<Error> for Box<Failure> {
    fn from(error: Error) -> Self {
        Self::new(Failure { error, of_a_point: false, capsule: None })
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

/// The smallest step that a point requests.
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

    /// The smallest step that a point requests.
    pub fn wish(&self) -> Option<Wish> {
        self.wish
    }

    /// The limits of the step after one of length `dt` [s], or the failure.
    pub fn limits(self, dt: f64) -> Result<Limits, Box<Failure>> {
        let wanted_dt = self.wish.map_or(f64::INFINITY, |wish| dt * wish.factor);
        let limits = Limits { wanted_dt, ..self.limits };
        self.failure.map_or(Ok(limits), Err)
    }

    /// A failure.
    pub fn failed(failure: Box<Failure>) -> Self {
        Self { failure: Some(failure), ..Self::default() }
    }

    /// A success.
    pub fn of(limits: Limits, answer: Answer) -> Self {
        let Answer { wish, unreliable } = answer;
        Self { limits, wish, unreliable, failure: None }
    }
}

/// What a material answered for a chunk, beside what stands in scratch.
#[derive(Clone, Copy, Debug)]
pub struct Answer {
    wish: Option<Wish>,
    unreliable: Option<Unreliable>,
}

/// Calls the material for a chunk. Particles stay as they are.
pub fn update_stress<const D: usize>(
    work: &mut ChunkWork<'_, '_>,
    moment: Moment,
) -> Result<Answer, Box<Failure>> {
    let Moment { time, step, dt } = moment;
    let mut batch = StressBatch { dt, time, step, ..work.scratch.batch() };
    if let Err(error) = work.material.update(&mut batch) {
        return Err(error.at(Place { body: Some(work.body), ..Place::default() }).into());
    }
    if let Some(failure) = failed_point::<D>(work, moment) {
        return Err(failure);
    }
    let wish = smallest_wish(work).map_err(|k| {
        let text = "gave a factor on the time step that is not above 0";
        fault::<D>(work, k, moment, Status::MaterialFailed, text)
    })?;
    Ok(Answer { wish, unreliable: unreliable(work) })
}

fn failed_point<const D: usize>(work: &ChunkWork<'_, '_>, moment: Moment) -> Option<Box<Failure>> {
    let status = &work.scratch.status[..work.chunk.len];
    if status.iter().fold(0, |worst, s| worst.max(*s)) < LAHAR_POINT_FAILED {
        return None;
    }
    let k = status.iter().position(|s| *s >= LAHAR_POINT_FAILED).unwrap_or(0);
    Some(fault::<D>(work, k, moment, Status::MaterialFailed, "could not update"))
}

fn unreliable(work: &ChunkWork<'_, '_>) -> Option<Unreliable> {
    let status = &work.scratch.status[..work.chunk.len];
    let points = status.iter().fold(0, |n, s| n + usize::from(*s == LAHAR_POINT_UNRELIABLE));
    if points == 0 {
        return None;
    }
    let k = status.iter().position(|s| *s == LAHAR_POINT_UNRELIABLE).unwrap_or(0);
    Some(Unreliable { points, body: work.body, particle: work.ids[work.chunk.first + k] })
}

/// The smallest step that a point of the chunk requests; the error is the index of a point whose
/// factor is not above 0.
fn smallest_wish(work: &ChunkWork<'_, '_>) -> Result<Option<Wish>, usize> {
    let s = &work.scratch;
    let n = work.chunk.len;
    let (mut factor, mut point) = (1.0, None);
    for (k, f) in s.dt_factor.iter().take(n).enumerate() {
        if *f <= 0.0 {
            return Err(k);
        }
        if *f < factor {
            (factor, point) = (*f, Some(k));
        }
    }
    let smaller = |s: &i32| *s == LAHAR_POINT_SMALLER_STEP;
    if point.is_none() && s.status[..n].iter().fold(false, |any, s| any | smaller(s)) {
        (factor, point) = (0.5, s.status[..n].iter().position(smaller));
    }
    let id = |k: usize| work.ids[work.chunk.first + k];
    Ok(point.map(|k| Wish { factor, body: work.body, particle: id(k) }))
}

/// The failure that a material does something wrong at point k.
pub(super) fn fault<const D: usize>(
    work: &ChunkWork<'_, '_>,
    k: usize,
    Moment { time, step, dt }: Moment,
    status: Status,
    what: &str,
) -> Box<Failure> {
    let (body, model) = (work.body, work.material.model().name);
    let particle = work.ids[work.chunk.first + k];
    let (chunk, layout) = (&work.chunk, work.chunk.layout);
    let text = format!(
        "the model `{model}` {what} at particle {particle} of body {body}: position {:?}, velocity {:?}, \
         start stress {:?}; check parameters, time step and boundaries",
        chunk.get::<D>(layout.position, k),
        chunk.get::<D>(layout.velocity, k),
        work.scratch.stress0_of(k),
    );
    let place = Place { body: Some(body), particle: Some(particle), ..Place::default() };
    let occasion = Occasion { body, particle, step, time, dt };
    let capsule = Capsule::of_point(work.material, &work.scratch, k, occasion).ok();
    Box::new(Failure { error: Error::new(status, text).at(place), of_a_point: true, capsule })
}
