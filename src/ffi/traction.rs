//! Tractions on the surfaces of bodies, constant or by a table over time, named by ids that are
//! never used again.

use super::arguments::{Grows, initialise, optional_out, out, read_struct};
use super::cells::{Change, WorldCell};
use super::entry::entry;
use super::status::lahar_status;
use super::table::{NO_TABLE, lahar_table, to_table};
use super::world::lahar_world;
use crate::boundary::{BoxRegion, Table, Traction};
use crate::error::{Error, Result};

/// A traction on a plane surface of a body. Fill it with lahar_traction_init, then set `body`, the
/// normal, the box and the traction.
///
/// It is a dead load: a force per area of the surface as it was when the body was added, in a fixed
/// direction. The particles whose centres are in the box when the traction is added carry it from
/// then on, wherever they move. The box must contain only the outermost layer of particles, whose
/// centres are half a particle's edge below the surface. Each particle passes its share to the grid
/// at its outer face and not at its centre, so that the stress is right up to the last cell. In two
/// dimensions the surface is 1 m wide, or one radian with axial symmetry. The edge lengths of the
/// particles must be known: of a body that was added as a shape they are, for arrays give them in
/// `size` of lahar_particles.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_traction {
    /// sizeof(lahar_traction); set by lahar_traction_init.
    pub struct_size: u32,
    /// Axis of the outward normal: 0 x, 1 y, 2 z; default 0.
    pub axis: i32,
    /// 1: the normal points to larger coordinates (default); -1: to smaller.
    pub side: i32,
    /// Must be 0.
    pub reserved: i32,
    /// Id of the body; has no default.
    pub body: i64,
    /// Lower corner of the box [m], shape [3]; may be -infinity; has no default.
    pub box_min: [f64; 3],
    /// Upper corner of the box [m], shape [3]; may be infinity; has no default.
    pub box_max: [f64; 3],
    /// The traction vector [Pa], shape [3], finite; default 0. A pressure p on a surface whose
    /// normal points to larger y is (0, -p, 0).
    pub traction: [f64; 3],
    /// Factors of the traction over time: values [-], shape [count]. Default: no table, the factor
    /// is 1.
    pub factors: lahar_table,
}

// SAFETY: repr(C), begins with a u32, no padding (layout.rs), numbers and raw pointers only.
unsafe impl Grows for lahar_traction {
    const NAME: &'static str = "lahar_traction";
    const FIRST: usize = 120;
}

/// Fills the struct with its defaults.
///
/// `size`: sizeof(lahar_traction).
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_traction_init(
    traction: *mut lahar_traction,
    size: i64,
) -> lahar_status {
    entry("lahar_traction_init", |_| {
        let default = lahar_traction {
            struct_size: 0,
            axis: 0,
            side: 1,
            reserved: 0,
            body: -1,
            box_min: [f64::NAN; 3],
            box_max: [f64::NAN; 3],
            traction: [0.0; 3],
            factors: NO_TABLE,
        };
        // SAFETY: the host passes NULL or `size` writable bytes.
        unsafe { initialise((traction, "traction"), size, default) }
    })
}

/// Adds a traction. It is removed together with its body.
///
/// `traction`: copied, with its table. `id`: gets the id; may be NULL.
/// Thread: owner
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_traction_add(
    world: *mut lahar_world,
    traction: *const lahar_traction,
    id: *mut i64,
) -> lahar_status {
    entry("lahar_traction_add", |scope| {
        // SAFETY: the host passes NULL or a live handle, a filled struct, a writable integer.
        let (cell, given, id) = unsafe {
            (scope.world(world)?, read_struct(traction, "traction")?, optional_out(id, "id")?)
        };
        // SAFETY: the table of the struct is the host's: NULL, or as long as its count says.
        let load = unsafe { to_traction(&cell, &given) }?;
        let added = cell.change(Change::Values, |w| w.add_traction(load))?;
        id.inspect(|id| id.set(added));
        Ok(())
    })
}

unsafe fn to_traction(cell: &WorldCell, given: &lahar_traction) -> Result<Traction> {
    let what = "a traction";
    let axis = usize::try_from(given.axis)
        .map_err(|_| Error::invalid(format!("`axis` is {}; expected 0, 1 or 2", given.axis)))?;
    if given.reserved != 0 {
        let text = "`reserved` of lahar_traction must be 0; call lahar_traction_init first";
        return Err(Error::invalid(text));
    }
    let full = cell.vector(given.traction);
    let constant = Table::new(what, &[0.0], &[full])?;
    // SAFETY: by contract of the caller.
    let table = unsafe { to_table(&given.factors, what, 1, |row| full.map(|t| row[0] * t)) }?;
    Ok(Traction {
        body: given.body,
        region: BoxRegion { min: given.box_min, max: given.box_max },
        axis,
        side: given.side,
        traction: table.unwrap_or(constant),
    })
}

/// Removes a traction. Its id is not used again.
///
/// Thread: owner
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_traction_remove(world: *mut lahar_world, id: i64) -> lahar_status {
    entry("lahar_traction_remove", |scope| {
        // SAFETY: the host passes NULL or a live handle.
        let cell = unsafe { scope.world(world) }?;
        cell.change(Change::Values, |w| w.remove_traction(id))
    })
}

/// What a traction loads, and with which force.
///
/// `particles`: gets the number of particles that carry it; may be NULL.
/// `area`: gets the area of the loaded surface [m^2]; may be NULL.
/// `force`: written, the force on the body in the last step [N], shape [3]; 0 before the first step
/// with the traction. Queries of the grid do not change it.
/// Thread: callback-ok
///
/// cbindgen:ptrs-as-arrays=[[force; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_traction_force(
    world: *const lahar_world,
    id: i64,
    particles: *mut i64,
    area: *mut f64,
    force: *mut f64,
) -> lahar_status {
    entry("lahar_traction_force", |scope| {
        // SAFETY: the host passes NULL or a live handle, NULL or writable numbers, NULL or three
        // writable doubles.
        let (cell, particles, area, force) = unsafe {
            (
                scope.world(world)?,
                optional_out(particles, "particles")?,
                optional_out(area, "area")?,
                out(force.cast::<[f64; 3]>(), "force")?,
            )
        };
        let (count, loaded, vector) = cell.query(|w| w.traction_force(id))?;
        particles.inspect(|particles| particles.set(count as i64));
        area.inspect(|area| area.set(loaded));
        force.set(vector);
        Ok(())
    })
}
