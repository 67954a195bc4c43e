//! A world owns a grid, bodies and walls, and steps them.
//!
//! [`World`] is the façade that the C ABI wraps; its parts, in two or three dimensions, are in
//! [`step::parts`](crate::step::parts).

pub mod bodies;
pub mod conditions;
pub mod fields;
mod given_stress;
pub mod host_arrays;
pub mod queries;
pub mod statics;

pub use crate::step::{hooks, options};

use std::sync::Arc;

use crate::background::GridStats;
use crate::boundary::registry::not_found;
use crate::context::Context;
use crate::error::{Error, Place, Result, Status};
use crate::log::LogLevel;
use crate::material::{Capsule, Material};
use crate::particles::fields::NODE_FIELDS;
use crate::particles::seeding::{Fill, Region};
use crate::particles::{Body, FieldInfo};
use crate::step;
use crate::step::integrate::{Done, Stop, integrate};
use crate::step::parts::Parts;
use crate::step::pass::Stopwatch;
use crate::step::update_stress::{Failure, Unreliable, Wish};

use hooks::{Hook, HookPoint};
use host_arrays::ParticleArrays;
use options::{Options, check_damping};
use queries::Totals;

/// Factor by which a host's step may exceed the stable one: round-off of the host's arithmetic.
const STEP_TOLERANCE: f64 = 1.0 + 1e-9;

/// Asked after each of many steps whether to pause.
pub type Pause<'a> = &'a mut dyn FnMut() -> bool;

/// Bodies, grid, walls and time.
pub struct World {
    pub(crate) inner: Inner,
    context: Arc<Context>,
    next_body: i64,
    last_dt: f64,
    poisoned: bool,
    reported_unreliable: bool,
}

pub(crate) enum Inner {
    Two(Box<Parts<2>>),
    Three(Box<Parts<3>>),
}

/// Evaluates an expression for the parts, whatever their dimension.
macro_rules! on {
    (&$world:expr, $state:ident => $body:expr) => {
        match &$world.inner {
            $crate::world::Inner::Two($state) => $body,
            $crate::world::Inner::Three($state) => $body,
        }
    };
    (&mut $world:expr, $state:ident => $body:expr) => {
        match &mut $world.inner {
            $crate::world::Inner::Two($state) => $body,
            $crate::world::Inner::Three($state) => $body,
        }
    };
}
pub(crate) use on;

impl World {
    /// An empty world. Errors name the option that is wrong.
    pub fn new(context: &Arc<Context>, options: &Options) -> Result<World> {
        let options = options.normalised()?;
        let (isa, team) = (context.isa(), context.team());
        let inner = match options.dimension {
            2 => Inner::Two(Box::new(Parts::new(options, isa, team)?)),
            _ => Inner::Three(Box::new(Parts::new(options, isa, team)?)),
        };
        Ok(World {
            inner,
            context: Arc::clone(context),
            next_body: 0,
            last_dt: 0.0,
            poisoned: false,
            reported_unreliable: false,
        })
    }

    /// The options, with gravity and damping as they are now.
    pub fn options(&self) -> &Options {
        on!(&self, s => &s.method.options)
    }

    /// Sets local non-viscous damping from the next step on.
    pub fn set_damping(&mut self, damping: f64) -> Result<()> {
        self.check_alive()?;
        check_damping(damping)?;
        on!(&mut self, s => s.method.options.damping = damping);
        Ok(())
    }

    /// Adds a body from arrays and gives its id.
    pub fn add_particles(
        &mut self,
        material: &Arc<Material>,
        particles: &ParticleArrays<'_>,
    ) -> Result<i64> {
        self.add(|world, id| on!(&mut world, s => s.add_particles(id, material, particles)))
    }

    /// Adds a body that fills a region and gives its id.
    pub fn add_shape(
        &mut self,
        material: &Arc<Material>,
        region: &Region,
        fill: &Fill,
    ) -> Result<i64> {
        self.add(|world, id| on!(&mut world, s => s.add_region(id, material, region, fill)))
    }

    fn add(&mut self, insert: impl FnOnce(&mut Self, i64) -> Result<()>) -> Result<i64> {
        self.check_alive()?;
        let id = self.next_body;
        insert(self, id)?;
        self.next_body += 1;
        Ok(id)
    }

    /// Removes a body with its particles.
    pub fn remove_body(&mut self, body: i64) -> Result<()> {
        self.check_alive()?;
        on!(&mut self, s => {
            let at = s.body_position(body)?;
            s.bodies.remove(at);
            s.conditions.remove_body(body);
            s.particles_changed();
        });
        Ok(())
    }

    /// Switches F-bar on or off for a body (off at first), see
    /// [`average_dilation`](mod@crate::step::average_dilation).
    pub fn set_f_bar(&mut self, body: i64, on: bool) -> Result<()> {
        self.check_alive()?;
        on!(&mut self, s => s.set_f_bar(body, on))
    }

    /// Ids of the bodies, ascending.
    pub fn bodies(&self) -> Vec<i64> {
        (0..self.body_count()).map(|place| self.body_id(place)).collect()
    }

    /// Number of bodies.
    pub fn body_count(&self) -> usize {
        on!(&self, s => s.bodies.len())
    }

    /// Id of the body at a place, 0 to [`World::body_count`] - 1, in the order of ids.
    pub fn body_id(&self, place: usize) -> i64 {
        on!(&self, s => s.bodies[place].id)
    }

    /// Number of particles of a body.
    pub fn particle_count(&self, body: i64) -> Result<usize> {
        on!(&self, s => Ok(s.body(body)?.particles.len()))
    }

    /// One step, of length `dt` [s] or the stable one; gives the length.
    ///
    /// Refused with [`Status::StepTooLarge`] if `dt` exceeds the stable step. If a material fails
    /// in the middle the world is poisoned, unless the option `retries` lets steps be repeated
    /// smaller: then [`Status::SmallerStep`] says that nothing was done.
    pub fn step(&mut self, dt: Option<f64>) -> Result<f64> {
        let (stable, automatic) = (self.prepare()?, dt.is_none());
        let dt = match dt {
            Some(dt) => dt,
            None if stable.is_finite() => stable,
            None => {
                return Err(Error::invalid(
                    "the stable step is infinite (no particles, or none that carries a wave): give dt",
                ));
            }
        };
        if !(dt > 0.0 && dt.is_finite()) {
            return Err(Error::invalid(format!("dt must be positive and finite [s], got {dt}")));
        }
        if dt > stable * STEP_TOLERANCE {
            let place = Place { suggested_dt: Some(stable), ..self.place() };
            let text = format!(
                "the time step {dt:e} s exceeds the stable one, {stable:e} s (cfl {}): nothing was done; \
                 take a step of at most that, or lahar_world_step_auto",
                self.options().cfl
            );
            return Err(Error::new(Status::StepTooLarge, text).at(place));
        }
        self.integrate(dt, automatic)
    }

    /// Steps until the time `until` [s], or `max_steps` steps. Gives the number of steps that were
    /// done, and the first error.
    ///
    /// The last two steps are shortened so that `until` is met exactly.
    pub fn advance(&mut self, until: f64, max_steps: i64) -> (i64, Result<()>) {
        self.advance_or_pause(until, max_steps, &mut || false)
    }

    /// The same, but returns early if `pause` says so. To call it again with what is left of
    /// `max_steps` goes on as if there had been no pause.
    pub fn advance_or_pause(
        &mut self,
        until: f64,
        max_steps: i64,
        pause: Pause<'_>,
    ) -> (i64, Result<()>) {
        if !until.is_finite() || until < self.time() || max_steps < 0 {
            let text = format!(
                "advance needs a finite time not before now ({} s) and max_steps >= 0, got {until} and {max_steps}",
                self.time()
            );
            return (0, self.check_alive().and(Err(Error::invalid(text))));
        }
        let mut steps = 0;
        while self.time() < until && steps < max_steps {
            let stable = match self.prepare() {
                Ok(stable) => stable,
                Err(error) => return (steps, Err(error)),
            };
            let rest = until - self.time();
            let dt = if rest <= stable {
                rest
            } else if rest < 2.0 * stable {
                0.5 * rest
            } else {
                stable
            };
            match self.integrate(dt, true) {
                Ok(dt) if dt == rest => on!(&mut self, s => s.clock.time = until),
                Ok(_) => {}
                Err(error) => return (steps, Err(error)),
            }
            steps += 1;
            if pause() {
                break;
            }
        }
        (steps, Ok(()))
    }

    /// Checks what the host wrote and gives the stable step [s].
    fn prepare(&mut self) -> Result<f64> {
        self.check_alive()?;
        let place = self.place();
        on!(&mut self, s => {
            if s.freshness.must_check() {
                s.check_what_was_written().map_err(|error| Error {
                    status: Status::NonFiniteInput,
                    place: Place { step: place.step, time: place.time, ..error.place },
                    ..error
                })?;
                s.freshness.was_checked();
            }
            for body in s.bodies.iter_mut().filter(|body| body.stress_given) {
                let warning = given_stress::check(body, s.method.options.spacing)?;
                warning.iter().for_each(|text| self.context.log(LogLevel::Warning, text));
                body.stress_given = false;
            }
            let limits = s.limits()?;
            s.freshness.limits_found(limits);
        });
        self.stable_dt()
    }

    /// Makes a step of `dt` [s], or a smaller one; gives the length of the step that was made.
    fn integrate(&mut self, dt: f64, shorter: bool) -> Result<f64> {
        match on!(&mut self, s => integrate(s, dt, shorter)) {
            Ok(Done { dt, unreliable }) => {
                self.log_unreliable_points(unreliable);
                self.last_dt = dt;
                Ok(dt)
            }
            Err(Stop::Failed(failure)) => {
                let mut error = self.error_of(*failure);
                self.poisoned = (error.status as i32) < 0;
                if self.poisoned {
                    error.message += "; the world is poisoned";
                }
                Err(error)
            }
            Err(Stop::TakenBack { dt, wanted, failure, wish }) => {
                let why = match failure {
                    Some(failure) => self.error_of(*failure),
                    None => self.wished(wish),
                };
                let text = format!(
                    "the step of {dt:e} s was taken back, nothing was done: {}; take {wanted:e} s or less, or find the cause",
                    why.message
                );
                let place = Place { suggested_dt: Some(wanted), ..why.place };
                Err(Error::new(Status::SmallerStep, text).at(place))
            }
        }
    }

    /// Logs once in a world's life that a model answered with less accuracy than it promises.
    fn log_unreliable_points(&mut self, found: Option<Unreliable>) {
        let Some(found) = found.filter(|_| !self.reported_unreliable) else {
            return;
        };
        self.reported_unreliable = true;
        let Unreliable { points, body, particle } = found;
        let text = format!(
            "in step {} the model `{}` answered for {points} points with less accuracy than it promises, first for particle \
             {particle} of body {body}; smaller steps may help; this is reported once",
            self.step_count() - 1,
            self.model_of(body)
        );
        self.context.log(LogLevel::Warning, &text);
    }

    /// Name of the model of a body.
    fn model_of(&self, body: i64) -> &'static str {
        on!(&self, s => s.body(body).map_or("?", |b| b.material.model().name))
    }

    /// A point asked for a smaller step than that which was made.
    fn wished(&self, wish: Option<Wish>) -> Error {
        let text = "a material asks for a smaller step";
        let Some(Wish { factor, body, particle }) = wish else { return Error::invalid(text) };
        let text = format!(
            "{text}: `{}` for particle {particle} of body {body}, by the factor {factor:e}",
            self.model_of(body)
        );
        let place = Place { body: Some(body), particle: Some(particle), ..self.place() };
        Error::invalid(text).at(place)
    }

    /// The error of a failure; the call that failed is written to a file if the host asked for
    /// that.
    fn error_of(&self, failure: Failure) -> Error {
        let Failure { mut error, capsule, .. } = failure;
        if let Some(capsule) = capsule {
            error.message.push_str(&write_capsule(&self.context, capsule));
        }
        error
    }

    /// Number and time of the present step, for errors.
    fn place(&self) -> Place {
        on!(&self, s => s.clock.place())
    }

    /// The stable time step [s]; infinity without particles.
    pub fn stable_dt(&self) -> Result<f64> {
        on!(&self, s => s.stable_dt())
    }

    /// Time [s].
    pub fn time(&self) -> f64 {
        on!(&self, s => s.clock.time)
    }

    /// Number of steps.
    pub fn step_count(&self) -> i64 {
        on!(&self, s => s.clock.step)
    }

    /// Length of the last step [s]; 0 before the first.
    pub fn last_dt(&self) -> f64 {
        self.last_dt
    }

    /// Whether a step failed in the middle.
    pub fn is_poisoned(&self) -> bool {
        self.poisoned
    }

    fn check_alive(&self) -> Result<()> {
        if !self.poisoned {
            return Ok(());
        }
        let text = "a step of this world failed in the middle; it answers queries and can be freed";
        Err(Error::new(Status::Poisoned, text))
    }

    /// Totals of one body or of all.
    pub fn totals(&self, body: Option<i64>) -> Result<Totals> {
        on!(&self, s => {
            if let Some(body) = body {
                s.body_position(body)?;
            }
            Ok(s.totals(body))
        })
    }

    /// Whether all particles are sorted into blocks, so that only a step or a refresh changes their
    /// order.
    pub fn is_sorted(&self) -> bool {
        on!(&self, s => s.freshness.is_grouped())
    }

    /// How often particles were sorted so far; what only reads or is refused leaves it as it is.
    pub fn sorts(&self) -> u64 {
        on!(&self, s => s.freshness.sorts())
    }

    /// Whether the grid is that of the last step, and nothing has been changed since that it should
    /// show.
    pub fn is_fresh(&self) -> bool {
        on!(&self, s => s.freshness.mapped().is_some())
    }

    /// Makes the grid show the particles and loads as they are: sorts particles that came, went or
    /// were moved into blocks, and maps mass, momentum and force. Nothing is done if that is so
    /// already.
    pub fn refresh(&mut self) -> Result<()> {
        if self.is_fresh() {
            return Ok(());
        }
        let place = self.place();
        let context = Arc::clone(&self.context);
        let mapped = context.install(|| on!(&mut self, s => step::map(s)));
        mapped.map_err(|error| Error {
            place: Place { step: place.step, time: place.time, ..error.place },
            ..error
        })
    }

    /// Views for writing were closed: the grid does not show what was written through them.
    pub fn views_closed(&mut self) {
        on!(&mut self, s => s.freshness.fields_closed());
    }

    /// Sets a hook into the step, or takes it away.
    pub fn set_hook(&mut self, point: HookPoint, hook: Option<Hook>) {
        on!(&mut self, s => s.hooks.set(point, hook));
    }

    /// Sets the stopwatch that is called for every chunk and stage, on the thread that works on it.
    pub fn set_stopwatch(&mut self, stopwatch: Option<Arc<Stopwatch>>) {
        on!(&mut self, s => s.method.stopwatch = stopwatch);
    }

    /// Numbers of blocks and nodes, and their memory.
    pub fn grid_stats(&self) -> GridStats {
        on!(&self, s => s.background.stats())
    }

    /// Integer coordinates of the active blocks; z is 0 in two dimensions.
    pub fn grid_blocks(&self) -> Vec<[i64; 3]> {
        let blocks = on!(&self, s => s.background.blocks.order().len());
        (0..blocks).map(|place| self.grid_block(place)).collect()
    }

    /// Integer coordinates of the active block at a place in block order.
    pub fn grid_block(&self, place: usize) -> [i64; 3] {
        on!(&self, s => {
            let blocks = &s.background.blocks;
            let key = blocks.keys()[blocks.order()[place] as usize];
            let mut out = [0; 3];
            key.at.iter().zip(&mut out).for_each(|(k, o)| *o = i64::from(*k));
            out
        })
    }

    /// Number of the node with this integer index, if its block is active.
    pub fn grid_find_node(&self, index: [i64; 3]) -> Option<i64> {
        on!(&self, s => {
            let index = std::array::from_fn(|d| index[d]);
            s.background.blocks.find_node(0, index).map(|n| n as i64)
        })
    }

    /// Integer index of the node with this number.
    pub fn grid_node_index(&self, node: i64) -> Option<[i64; 3]> {
        on!(&self, s => {
            let index = s.background.blocks.node_index(usize::try_from(node).ok()?)?;
            let mut out = [0; 3];
            out[..index.len()].copy_from_slice(&index);
            Some(out)
        })
    }

    /// Fields of nodes.
    pub fn node_fields(&self) -> [FieldInfo; 4] {
        NODE_FIELDS(self.options().dimension)
    }

    /// Value of a node field at the node with this number.
    pub fn node_value(&self, field: &str, node: i64, out: &mut [f64]) -> Result<()> {
        on!(&self, s => s.node_value(field, node, out))
    }

    /// Mass-weighted mean of a node field at a point; false and zeros where there is no material.
    pub fn sample(&self, field: &str, point: &[f64], out: &mut [f64]) -> Result<bool> {
        on!(&self, s => s.sample(field, point, out))
    }
}

impl<const D: usize> Parts<D> {
    /// Index of a body among the bodies.
    pub fn body_position(&self, id: i64) -> Result<usize> {
        let found = self.bodies.iter().position(|b| b.id == id);
        found.ok_or_else(|| not_found("body", id, self.bodies.iter().map(|b| b.id)))
    }

    /// The body with this id.
    pub fn body(&self, id: i64) -> Result<&Body> {
        Ok(&self.bodies[self.body_position(id)?])
    }
}

/// Writes the call at a point that failed to the host's folder, and gives a text with its path. If
/// the file cannot be written, that is logged.
fn write_capsule(context: &Context, mut capsule: Capsule) -> String {
    let Some(folder) = context.capsule_folder() else { return String::new() };
    if let Some(plugin) = context.model(&capsule.model).ok().and_then(|m| context.plugin_of(m)) {
        capsule.plugin_version = plugin.version.into();
        capsule.plugin_path = plugin.path.display().to_string();
    }
    match capsule.write(&folder) {
        Ok(path) => format!("; the call at this point is kept in {}", path.display()),
        Err(error) => {
            context.log(LogLevel::Error, &error.message);
            String::new()
        }
    }
}

#[cfg(test)]
mod tests;
