//! Worlds: a background grid with its bodies and walls, and time.
//!
//! Vectors of fixed size have three components; in two dimensions the third is ignored, or 0 in a
//! result. Any consistent units may be used; those named are SI. In two dimensions a world is plane
//! strain and 1 m thick.
//!
//! All bodies share the one velocity field of the grid: bodies that come within a cell or two of
//! each other are welded, and neither slide nor part freely. There is no contact between them yet.

use super::arguments::{Grows, array3, handle_out, initialise, optional_out, out, read_struct};
use super::cells::{Change, Steps, WorldCell};
use super::context::lahar_context;
use super::entry::{entry, quiet_entry};
use super::status::lahar_status;
use crate::background::GridPolicy;
use crate::error::{Error, Result};
use crate::shape::{ShapeKind, WallTreatment};
use crate::step::StepOrder;
use crate::step::options::{Options, wrong_dimension};
use crate::transfer::TransferKind;
use crate::world::World;
use std::sync::Arc;

/// A background grid with its bodies and walls. Freed by lahar_world_free; it lives as
/// long as one of its views.
pub struct lahar_world {
    pub(super) cell: Arc<WorldCell>,
}

/// What a world is made from. Fill it with lahar_world_options_init, then set `spacing` and what
/// differs from the defaults.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_world_options {
    /// sizeof(lahar_world_options); set by lahar_world_options_init.
    pub struct_size: u32,
    /// 2 (plane strain, or see `axisymmetric`) or 3; default 3.
    pub dimension: i32,
    /// One of LAHAR_SHAPE_*.
    pub shape: i32,
    /// One of LAHAR_TRANSFER_*.
    pub transfer: i32,
    /// One of LAHAR_ORDER_*.
    pub order: i32,
    /// One of LAHAR_GRID_*.
    pub grid_policy: i32,
    /// Distance of the grid's nodes [m], > 0; has no default. Positions further than 1e8 spacings
    /// from `origin` or from x = 0 are refused.
    pub spacing: f64,
    /// Position of the node with index (0, 0, 0) [m], shape [3]; default 0.
    pub origin: [f64; 3],
    /// Rate at which PIC replaces FLIP in LAHAR_TRANSFER_PIC_FLIP [1/s], >= 0: 0 is FLIP (default),
    /// infinity is PIC.
    pub pic_rate: f64,
    /// Courant number of the stable time step [-], in (0, 1]; default 0.4.
    pub cfl: f64,
    /// Gravity [m/s^2], shape [3]; default 0.
    pub gravity: [f64; 3],
    /// Local non-viscous damping alpha [-], in [0, 1); default 0. For statics only: it takes the
    /// part alpha of every acceleration along the velocity, so that a body in free fall falls with
    /// (1 - alpha) g.
    pub damping: f64,
    /// Lower corner of the box of LAHAR_GRID_STATIC [m], shape [3].
    pub box_min: [f64; 3],
    /// Upper corner of the box of LAHAR_GRID_STATIC [m], shape [3]. Particles on the faces are inside,
    /// and so are those that round-off, 1e-9 of the spacing, put beside them.
    pub box_max: [f64; 3],
    /// One of LAHAR_WALLS_*.
    pub wall_treatment: i32,
    /// 1: axial symmetry about the y axis, in two dimensions only: x is the radius, and volumes,
    /// masses and forces are per radian; default 0. Gravity must act along y. The axis needs a slip
    /// wall at x = 0: if a particle crosses the axis, the next step is refused.
    pub axisymmetric: i32,
    /// Terms of the filter of LAHAR_TRANSFER_XPIC and LAHAR_TRANSFER_FMPM, 1 (as PIC) to 20, or 0
    /// for the default, 2. Each term costs one more transfer to the grid and back.
    pub filter_order: i32,
    /// 1: particles carry a field `body_force` [N/kg], added to gravity; default 0.
    pub body_force: i32,
    /// How often a step is repeated with a smaller length when a material fails or asks for a
    /// smaller step, 0 (default) to 20. If the host gave the length of the step, or if the
    /// repetitions do not help, nothing is changed and LAHAR_ERROR_SMALLER_STEP is returned. Above
    /// 0 the particles are copied in each step, which costs time and memory. With 0 a failure
    /// poisons the world, and a material that asks for a smaller step shortens the next one.
    pub retries: i32,
    /// Must be 0.
    pub reserved: i32,
}

// SAFETY: repr(C), begins with a u32, no padding (layout.rs), numbers only.
unsafe impl Grows for lahar_world_options {
    const NAME: &'static str = "lahar_world_options";
    const FIRST: usize = 152;
}

/// Fills the options with their defaults.
///
/// `size`: sizeof(lahar_world_options).
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_world_options_init(
    options: *mut lahar_world_options,
    size: i64,
) -> lahar_status {
    entry("lahar_world_options_init", |_| {
        // SAFETY: the host passes NULL or `size` writable bytes.
        unsafe { initialise((options, "options"), size, from_options(&Options::default())) }
    })
}

fn from_options(options: &Options) -> lahar_world_options {
    lahar_world_options {
        struct_size: 0,
        dimension: options.dimension as i32,
        shape: options.shape.number(),
        transfer: options.transfer.number(),
        order: options.order.number(),
        grid_policy: options.grid_policy.number(),
        spacing: options.spacing,
        origin: options.origin,
        pic_rate: options.pic_rate,
        cfl: options.cfl,
        gravity: options.gravity,
        damping: options.damping,
        box_min: options.box_min,
        box_max: options.box_max,
        wall_treatment: options.wall_treatment.number(),
        axisymmetric: i32::from(options.axisymmetric),
        filter_order: options.filter_order,
        body_force: i32::from(options.body_force),
        retries: options.retries,
        reserved: 0,
    }
}

fn to_options(options: &lahar_world_options) -> Result<Options> {
    if options.reserved != 0 {
        let text = format!("`reserved` of the options is {}; expected 0", options.reserved);
        return Err(Error::invalid(text));
    }
    let dimension = options.dimension;
    Ok(Options {
        dimension: usize::try_from(dimension).map_err(|_| wrong_dimension(dimension))?,
        spacing: options.spacing,
        origin: options.origin,
        shape: ShapeKind::from_i32(options.shape)?,
        transfer: TransferKind::from_i32(options.transfer)?,
        pic_rate: options.pic_rate,
        order: StepOrder::from_i32(options.order)?,
        cfl: options.cfl,
        gravity: options.gravity,
        damping: options.damping,
        grid_policy: GridPolicy::from_i32(options.grid_policy)?,
        box_min: options.box_min,
        box_max: options.box_max,
        wall_treatment: WallTreatment::from_i32(options.wall_treatment)?,
        axisymmetric: flag(options.axisymmetric, "axisymmetric")?,
        filter_order: options.filter_order,
        body_force: flag(options.body_force, "body_force")?,
        retries: options.retries,
    })
}

fn flag(value: i32, name: &str) -> Result<bool> {
    match value {
        0 => Ok(false),
        1 => Ok(true),
        other => Err(Error::invalid(format!("`{name}` is {other}; expected 0 (no) or 1 (yes)"))),
    }
}

/// Makes an empty world at time 0.
///
/// `options`: copied.
/// `world`: set to the new handle, or to NULL on failure; the host frees it with lahar_world_free.
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_world_create(
    context: *mut lahar_context,
    options: *const lahar_world_options,
    world: *mut *mut lahar_world,
) -> lahar_status {
    entry("lahar_world_create", |scope| {
        // SAFETY: the host passes NULL or a writable pointer, a live handle, a filled struct.
        let (target, context, options) = unsafe {
            (handle_out(world, "world")?, scope.context(context)?, read_struct(options, "options")?)
        };
        let world = World::new(&context.context, &to_options(&options)?)?;
        target.set(Box::into_raw(Box::new(lahar_world { cell: WorldCell::new(context, world) })));
        Ok(())
    })
}

/// Frees the handle. The memory is freed together with the last view. NULL is ignored.
/// Thread: owner
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_world_free(world: *mut lahar_world) {
    quiet_entry(|| {
        if !world.is_null() {
            // SAFETY: the handle came from Box::into_raw in lahar_world_create and is freed once.
            drop(unsafe { Box::from_raw(world) });
        }
    });
}

/// Sets constant gravity from the next step on. It also replaces gravity by a table, see
/// lahar_world_set_gravity_table.
///
/// `gravity`: [m/s^2], shape [3], finite.
/// Thread: owner
///
/// cbindgen:ptrs-as-arrays=[[gravity; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_world_set_gravity(
    world: *mut lahar_world,
    gravity: *const f64,
) -> lahar_status {
    entry("lahar_world_set_gravity", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or three doubles.
        let (cell, gravity) = unsafe { (scope.world(world)?, array3(gravity, "gravity")?) };
        cell.change(Change::Values, |w| w.set_gravity(gravity))
    })
}

/// Sets the local non-viscous damping from the next step on. It slows all motion, free fall too:
/// set it back to 0 before dynamics.
///
/// `damping`: [-], in [0, 1).
/// Thread: owner
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_world_set_damping(
    world: *mut lahar_world,
    damping: f64,
) -> lahar_status {
    entry("lahar_world_set_damping", |scope| {
        // SAFETY: the host passes NULL or a live handle.
        let cell = unsafe { scope.world(world) }?;
        cell.change(Change::Values, |w| w.set_damping(damping))
    })
}

/// One step of the given length.
///
/// `dt`: [s], > 0 and not above lahar_world_stable_dt.
///
/// If an error poisons the world, lahar_last_error_info gives the body, the particle, the step and
/// the time.
///
/// Thread: owner
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_world_step(world: *mut lahar_world, dt: f64) -> lahar_status {
    entry("lahar_world_step", |scope| {
        // SAFETY: the host passes NULL or a live handle.
        let cell = unsafe { scope.world(world) }?;
        cell.change(Change::Step, |w| w.step(Some(dt)))?;
        Ok(())
    })
}

/// One step of the stable length.
///
/// `dt`: gets the length of the step [s]; may be NULL.
/// Thread: owner
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_world_step_auto(
    world: *mut lahar_world,
    dt: *mut f64,
) -> lahar_status {
    entry("lahar_world_step_auto", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a writable double.
        let (cell, dt) = unsafe { (scope.world(world)?, optional_out(dt, "dt")?) };
        let used = cell.change(Change::Step, |w| w.step(None))?;
        dt.inspect(|dt| dt.set(used));
        Ok(())
    })
}

/// Makes steps of the stable length until a time is reached; the last two are shortened to reach it
/// exactly.
///
/// `until`: time to reach [s], not before the present one.
/// `max_steps`: largest number of steps, >= 0; INT64_MAX for no limit. To stop early for this
/// reason is no error.
/// `steps_done`: gets the number of committed steps, also if a step fails; may be NULL.
/// `time`: gets the time that was reached [s], also if a step fails; may be NULL.
///
/// A positive status means that no partial step was committed.
///
/// Thread: owner
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_world_advance(
    world: *mut lahar_world,
    until: f64,
    max_steps: i64,
    steps_done: *mut i64,
    time: *mut f64,
) -> lahar_status {
    entry("lahar_world_advance", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or writable numbers.
        let (cell, steps_out, time_out) = unsafe {
            (
                scope.world(world)?,
                optional_out(steps_done, "steps_done")?,
                optional_out(time, "time")?,
            )
        };
        let (done, now, result) = advance(&cell, until, max_steps)?;
        steps_out.inspect(|steps| steps.set(done));
        time_out.inspect(|time| time.set(now));
        result
    })
}

fn advance(cell: &WorldCell, until: f64, max_steps: i64) -> Result<Steps> {
    let mut done = 0;
    cell.advance(|w, pause| {
        let (steps, result) = w.advance_or_pause(until, max_steps - done, pause);
        done += steps;
        (done, result.map(|()| done >= max_steps || w.time() >= until))
    })
}

/// Longest step that is stable now.
///
/// `dt`: gets the length [s]; infinity without particles. It is the largest dt, over all particles,
/// with (c + |v| + |g| dt) dt <= cfl h and dt <= cfl h^2 / (2 D nu), and not longer than the step
/// that the materials ask for; c is the wave speed, v the velocity of the particle, g gravity, h
/// the spacing, D the dimension, nu the kinematic viscosity. Of gravity by a table the largest
/// value in the step is used. A prescribed velocity V adds the condition |V| dt <= cfl h.
/// Thread: callback-ok
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_world_stable_dt(
    world: *const lahar_world,
    dt: *mut f64,
) -> lahar_status {
    entry("lahar_world_stable_dt", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a writable double.
        let (cell, dt) = unsafe { (scope.world(world)?, out(dt, "dt")?) };
        dt.set(cell.query(World::stable_dt)?);
        Ok(())
    })
}

/// Time of the world.
///
/// `time`: gets the time [s].
/// Thread: callback-ok
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_world_time(
    world: *const lahar_world,
    time: *mut f64,
) -> lahar_status {
    entry("lahar_world_time", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a writable double.
        let (cell, time) = unsafe { (scope.world(world)?, out(time, "time")?) };
        time.set(cell.query(|w| Ok(w.time()))?);
        Ok(())
    })
}

/// Number of committed steps.
///
/// `steps`: gets the number.
/// Thread: callback-ok
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_world_step_count(
    world: *const lahar_world,
    steps: *mut i64,
) -> lahar_status {
    entry("lahar_world_step_count", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a writable integer.
        let (cell, steps) = unsafe { (scope.world(world)?, out(steps, "steps")?) };
        steps.set(cell.query(|w| Ok(w.step_count()))?);
        Ok(())
    })
}

/// Length of the last committed step.
///
/// `dt`: gets the length [s]; 0 before the first step.
/// Thread: callback-ok
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_world_last_dt(
    world: *const lahar_world,
    dt: *mut f64,
) -> lahar_status {
    entry("lahar_world_last_dt", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a writable double.
        let (cell, dt) = unsafe { (scope.world(world)?, out(dt, "dt")?) };
        dt.set(cell.query(|w| Ok(w.last_dt()))?);
        Ok(())
    })
}
