//! A world owns a grid, bodies and walls, and steps them.
//!
//! [`World`] is the façade that the C ABI wraps; [`state::State`] is what the stages of a step work on, in two or three dimensions.

pub mod bodies;
pub mod conditions;
pub mod fields;
pub mod host_arrays;
pub mod queries;
pub mod state;
pub mod statics;

pub use crate::step::{hooks, options};

use std::sync::Arc;

use crate::background::GridStats;
use crate::boundary::Wall;
use crate::context::{Context, LogLevel};
use crate::error::{Error, Place, Result, Status};
use crate::material::{Capsule, Material};
use crate::particles::FieldInfo;
use crate::particles::fields::NODE_FIELDS;
use crate::particles::seeding::{Fill, Region};
use crate::shape::WallTreatment;
use crate::step;
use crate::step::apply_tractions::apply_tractions;
use crate::step::locate::locate;
use crate::step::particles_to_grid::particles_to_grid;
use crate::step::retry::back_to_start;
use crate::step::time_step::{Limits, limits_of_state};
use crate::step::update_grid::update_grid;
use crate::step::update_stress::{Failure, Unreliable};

use hooks::{Hook, HookPoint};
use host_arrays::ParticleArrays;
use options::{Options, check_damping};
use queries::Totals;
use state::{State, Stopwatch, WallEntry};

/// A host's step may exceed the stable one by this much: its own arithmetic.
const STEP_TOLERANCE: f64 = 1.0 + 1e-9;

/// Bodies, grid, walls and time.
pub struct World {
    pub(crate) inner: Inner,
    next_body: i64,
    next_wall: i64,
    last_dt: f64,
    host_wrote: bool,
    poisoned: bool,
    told_unreliable: bool,
}

pub(crate) enum Inner {
    Two(Box<State<2>>),
    Three(Box<State<3>>),
}

/// Evaluates an expression for the state, whatever its dimension.
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
        options.check()?;
        let (context, options) = (context.clone(), options.clone());
        let inner = match options.dimension {
            2 => Inner::Two(Box::new(State::new(context, options)?)),
            _ => Inner::Three(Box::new(State::new(context, options)?)),
        };
        Ok(World {
            inner,
            next_body: 0,
            next_wall: 0,
            last_dt: 0.0,
            host_wrote: false,
            poisoned: false,
            told_unreliable: false,
        })
    }

    /// The options, with gravity and damping as they are now.
    pub fn options(&self) -> &Options {
        on!(&self, s => &s.options)
    }

    /// Sets local non-viscous damping from the next step on.
    pub fn set_damping(&mut self, damping: f64) -> Result<()> {
        self.check_alive()?;
        check_damping(damping)?;
        on!(&mut self, s => s.options.damping = damping);
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

    /// Switches F-bar on or off for a body (off at first), see [`average_dilation`](mod@crate::step::average_dilation).
    pub fn set_f_bar(&mut self, body: i64, on: bool) -> Result<()> {
        self.check_alive()?;
        on!(&mut self, s => s.set_f_bar(body, on))
    }

    /// Ids of the bodies, ascending.
    pub fn bodies(&self) -> Vec<i64> {
        on!(&self, s => s.bodies.iter().map(|b| b.id).collect())
    }

    /// Number of particles of a body.
    pub fn particle_count(&self, body: i64) -> Result<usize> {
        on!(&self, s => Ok(s.body(body)?.particles.len()))
    }

    /// Adds a wall and gives its id.
    pub fn add_wall(&mut self, wall: &Wall) -> Result<i64> {
        self.check_alive()?;
        wall.check(self.options().dimension)?;
        on!(&self, s => s.check_wall(wall))?;
        let id = self.next_wall;
        self.next_wall += 1;
        on!(&mut self, s => s.walls.push(WallEntry { id, wall: *wall, reaction: [0.0; 3] }));
        self.walls_changed();
        Ok(id)
    }

    /// Removes a wall.
    pub fn remove_wall(&mut self, wall: i64) -> Result<()> {
        self.check_alive()?;
        on!(&mut self, s => {
            let at = s.wall_position(wall)?;
            s.walls.remove(at);
        });
        self.walls_changed();
        Ok(())
    }

    /// Where walls modify shape functions, particles are sorted anew, and checked to stand between them.
    fn walls_changed(&mut self) {
        if self.options().wall_treatment == WallTreatment::Modified {
            self.host_wrote = true;
            on!(&mut self, s => s.particles_changed());
        }
    }

    /// Force of a wall on the material in the last step [N]; the force on the wall is the opposite.
    pub fn wall_reaction(&self, wall: i64) -> Result<[f64; 3]> {
        on!(&self, s => Ok(s.walls[s.wall_position(wall)?].reaction))
    }

    /// One step, of length `dt` [s] or the stable one; gives the length.
    ///
    /// Refused with [`Status::StepTooLarge`] if `dt` exceeds the stable step. If a material fails in the middle the world is
    /// poisoned, unless the option `retries` lets steps be repeated smaller: then [`Status::SmallerStep`] says that nothing was done.
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
            let mut place = on!(&self, s => s.place());
            place.suggested_dt = Some(stable);
            let text = format!(
                "the time step {dt:e} s exceeds the stable one, {stable:e} s (cfl {}): nothing was done; \
                 take a step of at most that, or lahar_world_step_auto",
                self.options().cfl
            );
            return Err(Error::new(Status::StepTooLarge, text).at(place));
        }
        let dt = self.commit(dt, automatic)?;
        on!(&mut self, s => s.time += dt);
        Ok(dt)
    }

    /// Steps until the time `until` [s], or `max_steps` steps. Gives the number of steps that were done, and the first error.
    ///
    /// The last two steps are shortened so that `until` is met exactly.
    pub fn advance(&mut self, until: f64, max_steps: i64) -> (i64, Result<()>) {
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
            let dt = match self.commit(dt, true) {
                Ok(dt) => dt,
                Err(error) => return (steps, Err(error)),
            };
            on!(&mut self, s => s.time = if dt == rest { until } else { s.time + dt });
            steps += 1;
        }
        (steps, Ok(()))
    }

    /// Checks what the host wrote and gives the stable step [s].
    fn prepare(&mut self) -> Result<f64> {
        self.check_alive()?;
        if self.host_wrote {
            on!(&mut self, s => {
                for body in &s.bodies {
                    s.check_particles(body).map_err(|error| Error {
                        status: Status::NonFiniteInput,
                        ..error
                    })?;
                }
            });
            self.host_wrote = false;
        }
        on!(&mut self, s => if s.limits.is_none() {
            s.limits = Some(limits_of_state(s)?);
        });
        self.stable_dt()
    }

    /// Makes a step of `dt` [s], or a smaller one if a material wants that, `shorter` allows it, and the host lets steps be repeated.
    /// Gives the length of the step that was made.
    fn commit(&mut self, mut dt: f64, shorter: bool) -> Result<f64> {
        let retries = self.options().retries;
        let mut left = if shorter { retries } else { 0 };
        loop {
            if self.time() + dt == self.time() {
                return Err(Error::invalid(format!(
                    "a step of {dt:e} s does not change the time, {} s: something is too fast or too stiff for the spacing, or a \
                     material asks for smaller and smaller steps",
                    self.time()
                )));
            }
            let result = self.attempt(dt);
            let (wanted, why) = match result {
                Ok(limits) if retries == 0 || limits.wanted_dt >= dt => {
                    on!(&mut self, s => {
                        s.limits = Some(limits);
                        s.step_count += 1;
                    });
                    self.tell_of_unreliable_points();
                    self.last_dt = dt;
                    return Ok(dt);
                }
                Ok(limits) => (limits.wanted_dt, None),
                Err(failure) if retries > 0 && failure.is_of_a_point() => (0.5 * dt, Some(failure)),
                Err(failure) => {
                    let mut error = self.told(*failure);
                    self.poisoned = (error.status as i32) < 0;
                    if self.poisoned {
                        error.message += "; the world is poisoned";
                    }
                    return Err(error);
                }
            };
            on!(&mut self, s => back_to_start(s));
            if left == 0 {
                let why = why.map(|failure| self.told(*failure));
                return Err(self.refused(dt, wanted, why));
            }
            left -= 1;
            dt = wanted;
        }
    }

    fn attempt(&mut self, dt: f64) -> std::result::Result<Limits, Box<Failure>> {
        on!(&mut self, s => {
            let place = s.place();
            let result = if s.parallel {
                let context = s.context.clone();
                context.install(|| step::step(&mut **s, dt))
            } else {
                step::step(&mut **s, dt)
            };
            result.map_err(|mut failure| {
                let at = &mut failure.error.place;
                (at.step, at.time) = (place.step, place.time);
                failure
            })
        })
    }

    /// Says once in a world's life that a model answered with less accuracy than it promises.
    fn tell_of_unreliable_points(&mut self) {
        let Some(found) = on!(&self, s => s.unreliable).filter(|_| !self.told_unreliable) else {
            return;
        };
        self.told_unreliable = true;
        on!(&self, s => {
            let Unreliable { points, body, particle } = found;
            let model = s.body(body).map_or("?", |b| b.material.model().name);
            let text = format!(
                "in step {} the model `{model}` answered for {points} points with less accuracy than it promises, first for particle \
                 {particle} of body {body}; smaller steps may help; this is told once",
                s.step_count - 1
            );
            s.context.log(LogLevel::Warning, &text);
        });
    }

    /// The error of a failure that counts; the call that failed is kept if the host asked for that.
    fn told(&self, failure: Failure) -> Error {
        let Failure { mut error, capsule } = failure;
        if let Some(capsule) = capsule {
            error.message.push_str(&keep(on!(&self, s => &s.context), capsule));
        }
        error
    }

    /// A step that was taken back, and will not be repeated.
    fn refused(&self, dt: f64, wanted: f64, why: Option<Error>) -> Error {
        let why = why.unwrap_or_else(|| on!(&self, s => s.wished()));
        let text = format!(
            "the step of {dt:e} s was taken back, nothing was done: {}; take {wanted:e} s or less, or find the cause",
            why.message
        );
        Error::new(Status::SmallerStep, text).at(Place { suggested_dt: Some(wanted), ..why.place })
    }

    /// The stable time step [s]; infinity without particles.
    pub fn stable_dt(&self) -> Result<f64> {
        on!(&self, s => {
            let limits = match s.limits {
                Some(limits) => limits,
                None => limits_of_state(s)?,
            };
            Ok(s.stable_dt(&limits))
        })
    }

    /// Time [s].
    pub fn time(&self) -> f64 {
        on!(&self, s => s.time)
    }

    /// Number of steps.
    pub fn step_count(&self) -> i64 {
        on!(&self, s => s.step_count)
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

    /// Whether particles are sorted and the grid is built.
    pub fn is_fresh(&self) -> bool {
        on!(&self, s => !s.regroup && !s.stale)
    }

    /// Sorts particles that came or went into blocks, and maps mass and momentum to the grid.
    pub fn refresh(&mut self) -> Result<()> {
        on!(&mut self, s => if s.regroup || s.stale {
            let context = s.context.clone();
            context.install(|| {
                locate(&mut **s)?;
                particles_to_grid(&mut **s);
                apply_tractions(&mut **s, 0.0);
                update_grid(&mut **s, 0.0);
                s.stale = false;
                Ok(())
            })
        } else {
            Ok(())
        })
    }

    /// Sets a hook into the step, or takes it away.
    pub fn set_hook(&mut self, point: HookPoint, hook: Option<Hook>) {
        on!(&mut self, s => s.set_hook(point, hook));
    }

    /// Sets who is told about the stages of every chunk, on the thread that works on it; a call per chunk and stage.
    pub fn set_stopwatch(&mut self, stopwatch: Option<Arc<Stopwatch>>) {
        on!(&mut self, s => s.stopwatch = stopwatch);
    }

    /// Numbers of blocks and nodes, and their memory.
    pub fn grid_stats(&self) -> GridStats {
        on!(&self, s => s.grid_stats())
    }

    /// Integer coordinates of the active blocks; z is 0 in two dimensions.
    pub fn grid_blocks(&self) -> Vec<[i64; 3]> {
        on!(&self, s => s.grid.order().iter().map(|slot| {
            let mut out = [0; 3];
            s.grid.keys()[*slot as usize].iter().zip(&mut out).for_each(|(k, o)| *o = i64::from(*k));
            out
        }).collect())
    }

    /// Number of the node with this integer index, if its block is active.
    pub fn grid_find_node(&self, index: [i64; 3]) -> Option<i64> {
        on!(&self, s => s.grid.find_node(std::array::from_fn(|d| index[d])).map(|n| n as i64))
    }

    /// Integer index of the node with this number.
    pub fn grid_node_index(&self, node: i64) -> Option<[i64; 3]> {
        on!(&self, s => {
            let index = s.grid.node_index(usize::try_from(node).ok()?)?;
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

impl<const D: usize> State<D> {
    /// Place of a body among the bodies.
    pub fn body_position(&self, id: i64) -> Result<usize> {
        let found = self.bodies.iter().position(|b| b.id == id);
        found.ok_or_else(|| not_found("body", id, self.bodies.iter().map(|b| b.id)))
    }

    /// The body with this id.
    pub fn body(&self, id: i64) -> Result<&state::Body> {
        Ok(&self.bodies[self.body_position(id)?])
    }

    /// Refuses a wall that the shape functions can not be modified for.
    fn check_wall(&self, wall: &Wall) -> Result<()> {
        if self.options.wall_treatment != WallTreatment::Modified {
            return Ok(());
        }
        let (h, origin) = (self.options.spacing, self.grid.origin[wall.axis]);
        let node = ((wall.position - origin) / h).round();
        if ((wall.position - origin) / h - node).abs() > 1e-6 {
            return Err(Error::new(
                Status::Unsupported,
                format!(
                    "with wall_treatment modified a wall stands on a node plane; {} is between two, the nearest is at {}",
                    wall.position,
                    origin + node * h
                ),
            ));
        }
        let same = |w: &&WallEntry| (w.wall.axis, w.wall.side) == (wall.axis, wall.side);
        if let Some(other) = self.walls.iter().find(same) {
            return Err(Error::new(
                Status::Unsupported,
                format!(
                    "with wall_treatment modified an axis has one wall on each side; wall {} stands at {} already: remove it first",
                    other.id, other.wall.position
                ),
            ));
        }
        Ok(())
    }

    fn wall_position(&self, id: i64) -> Result<usize> {
        let found = self.walls.iter().position(|w| w.id == id);
        found.ok_or_else(|| not_found("wall", id, self.walls.iter().map(|w| w.id)))
    }
}

/// Writes the call at a point that failed where the host wants it, and says where; a file that can not be written is for the log.
fn keep(context: &Context, mut capsule: Capsule) -> String {
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

fn not_found(what: &str, id: i64, known: impl Iterator<Item = i64>) -> Error {
    let known: Vec<String> = known.take(24).map(|k| k.to_string()).collect();
    let list = if known.is_empty() { "there is none".into() } else { known.join(", ") };
    Error::new(Status::NotFound, format!("no {what} has the id {id} (known: {list})"))
}
