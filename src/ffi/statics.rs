//! Statics by dynamics: gravity by a table, the distance of a world from equilibrium, steps until
//! equilibrium is reached, initial stresses.

use super::arguments::{Grows, initialise, read_struct, struct_out};
use super::cells::Change;
use super::entry::entry;
use super::status::lahar_status;
use super::table::{lahar_table, to_table};
use super::world::lahar_world;
use crate::error::Error;
use crate::world::World;
use crate::world::statics::{Criteria, Equilibrium, STEPS_BETWEEN_CHECKS, Settled};

/// Steps between two checks of the equilibrium in lahar_world_settle.
pub const LAHAR_STEPS_BETWEEN_CHECKS: i64 = 50;

const _: () = assert!(LAHAR_STEPS_BETWEEN_CHECKS == STEPS_BETWEEN_CHECKS);

/// Sets gravity by a table over time, piecewise linear, from the next step on: for a ramp or an
/// earthquake. A step uses the value at the middle of the step; lahar_world_stable_dt uses the
/// largest value that may occur in the step. lahar_world_set_gravity replaces the table by constant
/// gravity.
///
/// `count`: number of rows, at least 1. `times`: [s], shape [count], increasing. `values`: [m/s^2],
/// shape [count, 3]. The first row also holds before its time, the last row also after its time. In
/// two dimensions values[3 * row + 2] is ignored.
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
    /// Strain energy of the particles [J], as in lahar_totals.
    pub strain_energy: f64,
    /// kinetic_energy divided by the energy of the stresses [-]. The latter is the larger of
    /// |strain_energy| and the sum of V s:s / (2 rho c^2) over the particles, with the volume V, the
    /// stress s, the density rho and the largest wave speed c; the sum includes initial stresses. 0
    /// at rest.
    pub kinetic_ratio: f64,
    /// Sum of |F| over the nodes [N]: F is the force of stresses, tractions and gravity that
    /// neither walls nor prescribed velocities take up. Damping is not included: it is 0 in
    /// equilibrium.
    pub unbalanced_force: f64,
    /// Load on the world [N]: the sum over the nodes of m |g|, plus the forces of the tractions,
    /// plus the sum over the nodes of the reactions of prescribed velocities. If all these are 0,
    /// the sum of the reactions of walls.
    pub external_force: f64,
    /// unbalanced_force divided by external_force [-]; 0 if unbalanced_force is 0.
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

/// Reports how far a world is from equilibrium. The forces are those on the grid, which shows the
/// particles and loads as they are: of the last step, or, if particle fields, tractions or bodies
/// were changed since, mapped anew. Particles may be reordered by that, so that read views opened
/// before become stale (LAHAR_ERROR_VIEW_STALE). What is written through a view counts once all
/// write views of the world are freed. Costs less than a step.
///
/// `equilibrium`: written; the host has set `struct_size`.
/// Thread: callback-ok
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_world_equilibrium(
    world: *const lahar_world,
    equilibrium: *mut lahar_equilibrium,
) -> lahar_status {
    entry("lahar_world_equilibrium", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a writable struct.
        let (cell, target) =
            unsafe { (scope.world(world)?, struct_out(equilibrium, "equilibrium")?) };
        target.set(from_equilibrium(&cell.query_grid(World::equilibrium_of_grid)?));
        Ok(())
    })
}

/// Criteria for a world to be settled. Fill it with lahar_settle_criteria_init.
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
    /// Time of the world at which to stop without equilibrium [s], later than now; default
    /// infinity.
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
    /// 1: both criteria are met; 0: `max_steps` or `until` was reached before.
    pub converged: i32,
    /// Number of committed steps.
    pub steps: i64,
    /// Time that was reached [s].
    pub time: f64,
    /// `kinetic_ratio` of lahar_equilibrium at the last check [-].
    pub kinetic_ratio: f64,
    /// `unbalanced_ratio` of lahar_equilibrium at the last check [-].
    pub unbalanced_ratio: f64,
}

// SAFETY: repr(C), begins with a u32, no padding (layout.rs), numbers only.
unsafe impl Grows for lahar_settle_result {
    const NAME: &'static str = "lahar_settle_result";
    const FIRST: usize = 40;
}

/// Makes steps of the stable length until the world is in equilibrium, or until `max_steps` or
/// `until` is reached. The latter is no error: `converged` is then 0. Equilibrium is checked every
/// LAHAR_STEPS_BETWEEN_CHECKS steps, and not accepted before the time of the last row of every
/// table in use. Set damping with lahar_world_set_damping before, for instance 0.3 to 0.7: without
/// damping the world does not come to rest.
///
/// `criteria`: copied; NULL: the defaults.
/// `result`: written, also if a step fails; the host has set `struct_size`; may be NULL.
///
/// A positive status means that no partial step was committed.
///
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
        let target = if result.is_null() {
            None
        } else {
            // SAFETY: the host passes a writable struct.
            Some(unsafe { struct_out(result, "result") }?)
        };
        let mut settled = Settled::default();
        let (steps, time, answer) = cell.advance(|w, pause| {
            let is_over = w.settle_or_pause(&criteria, &mut settled, pause);
            (settled.steps, is_over)
        })?;
        target.inspect(|target| {
            target.set(lahar_settle_result {
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

/// Sets the stresses of a body to those of level ground at rest: at the depth z below the surface
/// the stress along gravity is -unit_weight z, and along the other two axes k0 times that. Shear
/// stresses are 0, and above the surface all stresses are 0. The model derives its state variables
/// from the stress, as when a body is added; their old values are lost.
///
/// To set other initial stresses, give `stress` in lahar_particles, or write the field "stress" and
/// call lahar_body_init_state.
///
/// `surface_level`: coordinate of the surface along the axis of gravity [m].
/// `unit_weight`: [N/m^3], > 0; or 0: mass divided by volume of the whole body, times gravity at
/// the present time.
/// `k0`: ratio of horizontal to vertical stress [-], >= 0.
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

/// Makes the model of a body derive its state variables anew from the present stresses, as when the
/// body was added: for instance the volume ratio of a fluid from its pressure. The old values of
/// the state variables are lost. Call it after writing the field "stress".
///
/// Thread: owner
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_body_init_state(world: *mut lahar_world, body: i64) -> lahar_status {
    entry("lahar_body_init_state", |scope| {
        // SAFETY: the host passes NULL or a live handle.
        let cell = unsafe { scope.world(world) }?;
        cell.change(Change::Values, |w| w.init_body_state(body))
    })
}
