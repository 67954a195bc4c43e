//! Statics by dynamics: gravity by a table, how far a world is from equilibrium, steps until it is reached, initial
//! stresses.

use super::arguments::{Grows, initialise, read_struct, struct_out};
use super::cells::Change;
use super::entry::entry;
use super::status::lahar_status;
use super::table::{lahar_table, to_table};
use super::world::lahar_world;
use crate::error::Error;
use crate::world::World;
use crate::world::statics::{Criteria, Equilibrium, STEPS_BETWEEN_CHECKS, Settled};

/// Steps between two looks at the equilibrium in lahar_world_settle.
pub const LAHAR_STEPS_BETWEEN_CHECKS: i64 = 50;

const _: () = assert!(LAHAR_STEPS_BETWEEN_CHECKS == STEPS_BETWEEN_CHECKS);

/// Sets gravity by a table over time, piecewise linear, from the next step on: a ramp, a shaking. A step takes it at its
/// middle, and stable_dt counts with the largest that can come in it. lahar_world_set_gravity brings constant gravity back.
///
/// `count`: number of rows, at least 1. `times`: [s], shape [count], increasing. `values`: [m/s^2], shape [count, 3].
/// Before the first row and after the last one the values of that row hold.
/// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (no rows, times that do not increase, a value that is not
/// finite; the text names the row), LAHAR_ERROR_BUSY, LAHAR_ERROR_POISONED.
/// Thread: owner
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_world_set_gravity_table(
    world: *mut lahar_world,
    count: i64,
    times: *const f64,
    values: *const f64,
) -> lahar_status {
    entry("lahar_world_set_gravity_table", |scope| {
        // SAFETY: the host passes NULL or a live handle.
        let cell = unsafe { scope.world(world) }?;
        let given = lahar_table { count, times, values };
        let vector = |row: &[f64]| cell.vector([row[0], row[1], row[2]]);
        // SAFETY: the host passes arrays of the lengths that the count says, or NULL.
        let table = unsafe { to_table(&given, "gravity", 3, vector) }?
            .ok_or_else(|| Error::invalid("the table of gravity needs at least one row, got 0"))?;
        cell.change(Change::Values, |w| w.set_gravity_table(Some(table)))
    })
}

/// How far a world is from equilibrium.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_equilibrium {
    /// sizeof(lahar_equilibrium); set by the host.
    pub struct_size: u32,
    /// 0.
    pub reserved: i32,
    /// Sum of m v^2 / 2 of the particles [J].
    pub kinetic_energy: f64,
    /// Strain energy of the particles [J], as in lahar_totals: what the stresses worked since the start.
    pub strain_energy: f64,
    /// Kinetic energy over the energy of the stresses [-]: the larger of |strain_energy| and the sum of
    /// V s:s / (2 rho c^2), with the stress s and the largest wave speed c, which knows of initial stresses too. 0 at
    /// rest.
    pub kinetic_ratio: f64,
    /// Sum over the nodes of |F| [N], with the force F of stresses, tractions and gravity that neither walls nor prescribed
    /// velocities take up. Damping is no part of it: it vanishes in equilibrium.
    pub unbalanced_force: f64,
    /// What loads the world [N]: the sum over the nodes of m |g|, the forces of the tractions, and the sum over the
    /// nodes of the reactions of prescribed velocities. If all these are 0, the sum of the reactions of walls.
    pub external_force: f64,
    /// unbalanced_force over external_force [-]. 0 if nothing is unbalanced.
    pub unbalanced_ratio: f64,
}

// SAFETY: repr(C), begins with a u32, no padding (layout.rs), numbers only.
unsafe impl Grows for lahar_equilibrium {
    const NAME: &'static str = "lahar_equilibrium";
    const FIRST: usize = 56;
}

fn from_equilibrium(e: &Equilibrium) -> lahar_equilibrium {
    lahar_equilibrium {
        struct_size: 0,
        reserved: 0,
        kinetic_energy: e.kinetic_energy,
        strain_energy: e.strain_energy,
        kinetic_ratio: e.kinetic_ratio,
        unbalanced_force: e.unbalanced_force,
        external_force: e.external_force,
        unbalanced_ratio: e.unbalanced_ratio,
    }
}

/// Tells how far a world is from equilibrium, by the forces of the last step; before the first step, and after an initial
/// stress was set, by those of the particles as they are. Costs about as much as a part of a step.
///
/// `equilibrium`: written; the host has set `struct_size`.
/// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_INVALID_ARGUMENT (a model has no wave speed for the
/// present state), LAHAR_ERROR_OUTSIDE_GRID, LAHAR_ERROR_OUT_OF_MEMORY, LAHAR_ERROR_VIEW_OPEN (an open write view while particles
/// have to be sorted), LAHAR_ERROR_BUSY.
/// Thread: callback-ok
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_world_equilibrium(
    world: *const lahar_world,
    equilibrium: *mut lahar_equilibrium,
) -> lahar_status {
    entry("lahar_world_equilibrium", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a writable struct.
        let (cell, place) =
            unsafe { (scope.world(world)?, struct_out(equilibrium, "equilibrium")?) };
        place.set(from_equilibrium(&cell.query_grid(World::equilibrium_of_grid)?));
        Ok(())
    })
}

/// When a world counts as settled. Fill it with lahar_settle_criteria_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_settle_criteria {
    /// sizeof(lahar_settle_criteria); set by lahar_settle_criteria_init.
    pub struct_size: u32,
    /// Must be 0.
    pub reserved: i32,
    /// Largest `kinetic_ratio` of lahar_equilibrium [-], > 0; default 1e-4.
    pub kinetic_ratio: f64,
    /// Largest `unbalanced_ratio` of lahar_equilibrium [-], > 0; default 1e-3.
    pub unbalanced_ratio: f64,
    /// Most steps, >= 1; default 1000000.
    pub max_steps: i64,
    /// Time of the world at which to give up [s], after the present one; default infinity.
    pub until: f64,
}

// SAFETY: repr(C), begins with a u32, no padding (layout.rs), numbers only.
unsafe impl Grows for lahar_settle_criteria {
    const NAME: &'static str = "lahar_settle_criteria";
    const FIRST: usize = 40;
}

/// Fills the criteria with their defaults.
///
/// `size`: sizeof(lahar_settle_criteria).
/// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE.
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_settle_criteria_init(
    criteria: *mut lahar_settle_criteria,
    size: i64,
) -> lahar_status {
    entry("lahar_settle_criteria_init", |_| {
        let default = Criteria::default();
        let default = lahar_settle_criteria {
            struct_size: 0,
            reserved: 0,
            kinetic_ratio: default.kinetic_ratio,
            unbalanced_ratio: default.unbalanced_ratio,
            max_steps: default.max_steps,
            until: default.until,
        };
        // SAFETY: the host passes NULL or `size` writable bytes.
        unsafe { initialise((criteria, "criteria"), size, default) }
    })
}

/// What lahar_world_settle did.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_settle_result {
    /// sizeof(lahar_settle_result); set by the host.
    pub struct_size: u32,
    /// 1: both criteria hold; 0: steps or time ran out before.
    pub converged: i32,
    /// Number of committed steps.
    pub steps: i64,
    /// Time that was reached [s].
    pub time: f64,
    /// `kinetic_ratio` of lahar_equilibrium at the last look [-].
    pub kinetic_ratio: f64,
    /// `unbalanced_ratio` of lahar_equilibrium at the last look [-].
    pub unbalanced_ratio: f64,
}

// SAFETY: repr(C), begins with a u32, no padding (layout.rs), numbers only.
unsafe impl Grows for lahar_settle_result {
    const NAME: &'static str = "lahar_settle_result";
    const FIRST: usize = 40;
}

/// Steps of the stable length until the world is in equilibrium, or until steps or time have run out, which is no error:
/// `converged` tells. It looks every LAHAR_STEPS_BETWEEN_CHECKS steps, and does not stop before the last row of every table in
/// use has passed. Set lahar_world_set_damping before, for instance to 0.3 to 0.7, or nothing comes to rest.
///
/// `criteria`: copied; NULL: the defaults. `result`: written, on failure too; the host has set `struct_size`; may be NULL.
/// Errors: as lahar_world_step; LAHAR_ERROR_INVALID_ARGUMENT also for criteria that are not positive, and if the stable step
/// is infinite and `until` too. A positive status means that no partial step was committed.
/// Thread: owner
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_world_settle(
    world: *mut lahar_world,
    criteria: *const lahar_settle_criteria,
    result: *mut lahar_settle_result,
) -> lahar_status {
    entry("lahar_world_settle", |scope| {
        // SAFETY: the host passes NULL or a live handle.
        let cell = unsafe { scope.world(world) }?;
        let criteria = if criteria.is_null() {
            Criteria::default()
        } else {
            // SAFETY: the host passes a filled struct.
            to_criteria(&unsafe { read_struct(criteria, "criteria") }?)?
        };
        let place = if result.is_null() {
            None
        } else {
            // SAFETY: the host passes a writable struct.
            Some(unsafe { struct_out(result, "result") }?)
        };
        let mut settled = Settled::default();
        let (steps, time, answer) = cell.advance(|w| {
            let answer;
            (settled, answer) = w.settle(&criteria);
            (settled.steps, w.time(), answer)
        })?;
        place.inspect(|place| {
            place.set(lahar_settle_result {
                struct_size: 0,
                converged: i32::from(settled.converged),
                steps,
                time,
                kinetic_ratio: settled.equilibrium.kinetic_ratio,
                unbalanced_ratio: settled.equilibrium.unbalanced_ratio,
            });
        });
        answer
    })
}

fn to_criteria(given: &lahar_settle_criteria) -> Result<Criteria, Error> {
    if given.reserved != 0 {
        return Err(Error::invalid(
            "`reserved` of lahar_settle_criteria must be 0; call lahar_settle_criteria_init first",
        ));
    }
    Ok(Criteria {
        kinetic_ratio: given.kinetic_ratio,
        unbalanced_ratio: given.unbalanced_ratio,
        max_steps: given.max_steps,
        until: given.until,
    })
}

/// Gives the particles of a body the stress of level ground at rest: at the depth z below the surface the stress along
/// gravity is -unit_weight z, along the other two axes k0 times that; shear is 0, and so is all stress above the surface.
/// The model derives its state from the stress, as when a body is added, so that what it remembered is lost.
///
/// A field of the host's own: give `stress` in lahar_particles, or write the field "stress" and call
/// lahar_body_init_state.
///
/// `surface_level`: coordinate of the surface along the axis of gravity [m].
/// `unit_weight`: [N/m^3], > 0; or 0: mass over volume of the whole body, times gravity at the present time.
/// `k0`: ratio of horizontal to vertical stress [-], >= 0.
/// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_NOT_FOUND, LAHAR_ERROR_INVALID_ARGUMENT (gravity is 0 at the present time or
/// not along an axis; a value out of its range; the model refuses the stress), LAHAR_ERROR_UNSUPPORTED (the stress of the
/// model follows from the deformation gradient), LAHAR_ERROR_BUSY, LAHAR_ERROR_POISONED.
/// Thread: owner
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_body_set_k0_stress(
    world: *mut lahar_world,
    body: i64,
    surface_level: f64,
    unit_weight: f64,
    k0: f64,
) -> lahar_status {
    entry("lahar_body_set_k0_stress", |scope| {
        // SAFETY: the host passes NULL or a live handle.
        let cell = unsafe { scope.world(world) }?;
        let unit_weight = (unit_weight != 0.0).then_some(unit_weight);
        cell.change(Change::Values, |w| w.set_k0_stress(body, surface_level, unit_weight, k0))
    })
}

/// Lets the model of a body derive its state variables anew from the present stresses, as when the body was added: for
/// instance the volume ratio of a fluid from its pressure. What it remembered is lost. To be called after the host wrote
/// the field "stress".
///
/// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_NOT_FOUND, LAHAR_ERROR_INVALID_ARGUMENT (the model refuses the stress; the old
/// state stays), LAHAR_ERROR_BUSY, LAHAR_ERROR_POISONED.
/// Thread: owner
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_body_init_state(world: *mut lahar_world, body: i64) -> lahar_status {
    entry("lahar_body_init_state", |scope| {
        // SAFETY: the host passes NULL or a live handle.
        let cell = unsafe { scope.world(world) }?;
        cell.change(Change::Values, |w| w.init_body_state(body))
    })
}
