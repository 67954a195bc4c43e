//! Velocities prescribed on regions of the grid, constant or by a table over time, named by ids
//! that are never used again.

use super::arguments::{Grows, initialise, optional_out, out, read_struct};
use super::cells::{Change, WorldCell};
use super::entry::entry;
use super::status::lahar_status;
use super::table::{NO_TABLE, lahar_table, to_table};
use super::world::lahar_world;
use crate::boundary::prescribed_velocity::{X, Y, Z};
use crate::boundary::{BoxRegion, PrescribedVelocity, Table};
use crate::error::Result;

/// Component of a vector: x.
pub const LAHAR_COMPONENT_X: i32 = 1;
/// Component of a vector: y.
pub const LAHAR_COMPONENT_Y: i32 = 2;
/// Component of a vector: z.
pub const LAHAR_COMPONENT_Z: i32 = 4;

// The numbers are the engine's.
const _: () = {
    assert!(LAHAR_COMPONENT_X == X);
    assert!(LAHAR_COMPONENT_Y == Y);
    assert!(LAHAR_COMPONENT_Z == Z);
};

/// A velocity that the nodes in a box have at the end of every step, whatever pulls at them. Fill
/// it with lahar_prescribed_velocity_init, then set `components`, the box, and `velocity` or
/// `table`.
///
/// The box is fixed in space and selects nodes, not particles: the velocity is prescribed to
/// whatever moves through the box. It is applied after the walls. Where boxes overlap, the one that
/// was added last counts.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_prescribed_velocity {
    /// sizeof(lahar_prescribed_velocity); set by lahar_prescribed_velocity_init.
    pub struct_size: u32,
    /// The components that are prescribed, a sum of LAHAR_COMPONENT_*; has no default. The others
    /// stay free.
    pub components: i32,
    /// Lower corner of the box [m], shape [3]; may be -infinity; has no default. Nodes on its
    /// faces, within 1e-9 spacings, are inside.
    pub box_min: [f64; 3],
    /// Upper corner of the box [m], shape [3]; may be infinity; has no default.
    pub box_max: [f64; 3],
    /// Velocity [m/s], shape [3], finite; default 0. Not used with a table.
    pub velocity: [f64; 3],
    /// Velocity over time: values [m/s], shape [count, 3]. Default: no table.
    pub table: lahar_table,
}

// SAFETY: repr(C), begins with a u32, no padding (layout.rs), numbers and raw pointers only.
unsafe impl Grows for lahar_prescribed_velocity {
    const NAME: &'static str = "lahar_prescribed_velocity";
    const FIRST: usize = 104;
}

/// Fills the struct with its defaults.
///
/// `size`: sizeof(lahar_prescribed_velocity).
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_prescribed_velocity_init(
    condition: *mut lahar_prescribed_velocity,
    size: i64,
) -> lahar_status {
    entry("lahar_prescribed_velocity_init", |_| {
        let default = lahar_prescribed_velocity {
            struct_size: 0,
            components: 0,
            box_min: [f64::NAN; 3],
            box_max: [f64::NAN; 3],
            velocity: [0.0; 3],
            table: NO_TABLE,
        };
        // SAFETY: the host passes NULL or `size` writable bytes.
        unsafe { initialise((condition, "condition"), size, default) }
    })
}

/// Adds a prescribed velocity. It limits the stable time step: a node moves at most `cfl` spacings
/// in a step.
///
/// `condition`: copied, with its table. `id`: gets the id; may be NULL.
/// Thread: owner
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_prescribed_velocity_add(
    world: *mut lahar_world,
    condition: *const lahar_prescribed_velocity,
    id: *mut i64,
) -> lahar_status {
    entry("lahar_prescribed_velocity_add", |scope| {
        // SAFETY: the host passes NULL or a live handle, a filled struct, a writable integer.
        let (cell, given, id) = unsafe {
            (scope.world(world)?, read_struct(condition, "condition")?, optional_out(id, "id")?)
        };
        // SAFETY: the table of the struct is the host's: NULL, or as long as its count says.
        let condition = unsafe { to_condition(&cell, &given) }?;
        let added = cell.change(Change::Values, |w| w.add_prescribed_velocity(condition))?;
        id.inspect(|id| id.set(added));
        Ok(())
    })
}

unsafe fn to_condition(
    cell: &WorldCell,
    given: &lahar_prescribed_velocity,
) -> Result<PrescribedVelocity> {
    let what = "a prescribed velocity";
    let vector = |row: &[f64]| cell.vector([row[0], row[1], row[2]]);
    // SAFETY: by contract of the caller.
    let velocity = match unsafe { to_table(&given.table, what, 3, vector) }? {
        Some(table) => table,
        None => Table::new(what, &[0.0], &[cell.vector(given.velocity)])?,
    };
    let region = BoxRegion { min: given.box_min, max: given.box_max };
    Ok(PrescribedVelocity { region, components: given.components, velocity })
}

/// Removes a prescribed velocity. Its id is not used again.
///
/// Thread: owner
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_prescribed_velocity_remove(
    world: *mut lahar_world,
    id: i64,
) -> lahar_status {
    entry("lahar_prescribed_velocity_remove", |scope| {
        // SAFETY: the host passes NULL or a live handle.
        let cell = unsafe { scope.world(world) }?;
        cell.change(Change::Values, |w| w.remove_prescribed_velocity(id))
    })
}

/// Force of a prescribed velocity on the material in the last step: the momentum that it added,
/// divided by the time step; 0 before the first step with it.
///
/// `force`: written [N], shape [3].
/// Thread: callback-ok
///
/// cbindgen:ptrs-as-arrays=[[force; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_prescribed_velocity_reaction(
    world: *const lahar_world,
    id: i64,
    force: *mut f64,
) -> lahar_status {
    entry("lahar_prescribed_velocity_reaction", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or three writable doubles.
        let (cell, force) =
            unsafe { (scope.world(world)?, out(force.cast::<[f64; 3]>(), "force")?) };
        force.set(cell.query(|w| w.prescribed_velocity_reaction(id))?);
        Ok(())
    })
}
