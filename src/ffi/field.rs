//! Particle fields: position, velocity, stress and so on, and every state variable of the body's
//! model, by name. The functions of this section copy, in the order of particle ids; views give
//! access to the memory itself.

use super::arguments::{
    Grows, copy_list, count, index, out, slice, slice_mut, strides, struct_out, text,
};
use super::cells::{Change, WorldCell};
use super::entry::entry;
use super::status::lahar_status;
use super::world::lahar_world;
use crate::error::{Error, Result, Status};
use crate::particles::FieldInfo;
use crate::world::host_arrays::{Strided, StridedMut, Strides};
use std::ffi::c_char;

/// A field of particles or of nodes. The texts are static.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_field_info {
    /// sizeof(lahar_field_info); set by the host.
    pub struct_size: u32,
    /// Number of components per point.
    pub components: i32,
    /// 1: the host may write it; 0: it is read-only.
    pub writable: i32,
    /// 0.
    pub reserved: i32,
    /// Name.
    pub name: *const c_char,
    /// SI unit.
    pub unit: *const c_char,
    /// One sentence.
    pub description: *const c_char,
}

// SAFETY: repr(C), begins with a u32, no padding (layout.rs), numbers and raw pointers only.
unsafe impl Grows for lahar_field_info {
    const NAME: &'static str = "lahar_field_info";
    const FIRST: usize = 40;
}

pub(super) fn field_info(field: &FieldInfo) -> lahar_field_info {
    lahar_field_info {
        struct_size: 0,
        components: field.components as i32,
        writable: field.writable.into(),
        reserved: 0,
        name: field.name.as_ptr(),
        unit: field.unit.as_ptr(),
        description: field.description.as_ptr(),
    }
}

/// Number of fields of a body.
///
/// Thread: callback-ok
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_body_field_count(
    world: *const lahar_world,
    body: i64,
    fields: *mut i64,
) -> lahar_status {
    entry("lahar_body_field_count", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a writable integer.
        let (cell, fields) = unsafe { (scope.world(world)?, out(fields, "fields")?) };
        fields.set(cell.query(|w| w.fields(body))?.len() as i64);
        Ok(())
    })
}

/// Describes a field of a body.
///
/// `field`: 0 to lahar_body_field_count - 1.
/// `info`: written; the host has set `struct_size`.
/// Thread: callback-ok
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_body_field_info(
    world: *const lahar_world,
    body: i64,
    field: i64,
    info: *mut lahar_field_info,
) -> lahar_status {
    entry("lahar_body_field_info", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a writable struct.
        let (cell, info) = unsafe { (scope.world(world)?, struct_out(info, "info")?) };
        let fields = cell.query(|w| w.fields(body))?;
        info.set(field_info(&fields[index(field, fields.len(), "field")?]));
        Ok(())
    })
}

/// Index of the field of this name.
///
/// `field`: gets the index.
/// Thread: callback-ok
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_body_find_field(
    world: *const lahar_world,
    body: i64,
    name: *const c_char,
    field: *mut i64,
) -> lahar_status {
    entry("lahar_body_find_field", |scope| {
        // SAFETY: the host passes NULL or a live handle, a text and a writable integer.
        let (cell, name, target) =
            unsafe { (scope.world(world)?, text(name, "name")?, out(field, "field")?) };
        target.set(cell.query(|w| {
            let found = w.field_info(body, name)?;
            Ok(w.fields(body)?.iter().position(|f| f.name == found.name).map_or(-1, |i| i as i64))
        })?);
        Ok(())
    })
}

/// Layout of the host's array for a field of a body.
fn field_strides(
    cell: &WorldCell,
    body: i64,
    field: &str,
    count: i64,
    given: [i64; 2],
) -> Result<Strides> {
    cell.query(|w| {
        let components = w.field_info(body, field)?.components;
        let particles = w.particle_count(body)?;
        check_count(count, particles)?;
        strides(particles, components, given, "values")
    })
}

/// Refuses an array of the host whose count is not the number of particles.
fn check_count(given: i64, particles: usize) -> Result<()> {
    let n = count(given, "count")?;
    match n.cmp(&particles) {
        std::cmp::Ordering::Equal => Ok(()),
        std::cmp::Ordering::Less => Err(Error::new(
            Status::BufferTooSmall,
            format!("`count` is {n}, but the body has {particles} particles"),
        )),
        std::cmp::Ordering::Greater => Err(Error::invalid(format!(
            "`count` is {n}; expected the number of particles of the body, {particles}"
        ))),
    }
}

/// Copies a field to the host, in the order of particle ids.
///
/// `count`: number of particles of the body.
/// `values`: component c of particle k is written to values[c * component_stride + k *
/// point_stride], in the unit of the field. If both strides are 0, the array is interleaved, shape
/// [count, components].
/// Thread: callback-ok
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_body_read(
    world: *const lahar_world,
    body: i64,
    field: *const c_char,
    count: i64,
    values: *mut f64,
    component_stride: i64,
    point_stride: i64,
) -> lahar_status {
    entry("lahar_body_read", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a text.
        let (cell, field) = unsafe { (scope.world(world)?, text(field, "field")?) };
        let strides = field_strides(&cell, body, field, count, [component_stride, point_stride])?;
        // SAFETY: the host passes NULL or an array of these strides.
        let mut target =
            StridedMut::new(unsafe { slice_mut(values, strides.needed(), "values") }?, strides)?;
        cell.query(|w| w.read_field(body, field, &mut target))
    })
}

/// Copies a field from the host, in the order of particle ids.
///
/// A value that is not finite is refused by this call, and nothing is written. Masses and volumes
/// that are not positive and positions outside the grid are found by the next step, which returns
/// LAHAR_ERROR_NON_FINITE_INPUT until the host writes valid ones.
///
/// A stress that the model would forget is found by the next step too: that of a hyperelastic solid
/// follows from `deformation_gradient`, that of a fluid from its state, that of a gas from
/// `strain_energy`. The step returns LAHAR_ERROR_MATERIAL_REFUSED until the stress that was given
/// (here, in a view, or when the body was added) is the one that follows; the message says what to
/// write or call. A stress beyond the yield surface is returned to it, with a warning in the log.
/// The viscous stress of a body that moves is not checked.
///
/// `count`, `values`, strides: as in lahar_body_read.
/// Thread: owner
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_body_write(
    world: *mut lahar_world,
    body: i64,
    field: *const c_char,
    count: i64,
    values: *const f64,
    component_stride: i64,
    point_stride: i64,
) -> lahar_status {
    entry("lahar_body_write", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a text.
        let (cell, field) = unsafe { (scope.world(world)?, text(field, "field")?) };
        let strides = field_strides(&cell, body, field, count, [component_stride, point_stride])?;
        // SAFETY: the host passes NULL or an array of these strides.
        let source = Strided::new(unsafe { slice(values, strides.needed(), "values") }?, strides)?;
        cell.change(Change::Values, |w| w.write_field(body, field, &source))
    })
}

/// Ids of a body's particles in storage order, the order of views: the k-th value of a view belongs
/// to ids[k]. If bodies were added or removed since the last step, the particles are first mapped
/// to the grid and may be reordered by that.
///
/// `capacity`, `ids`: room for so many ids; NULL and 0 to get only the count.
/// `count`: gets the number of particles.
/// Thread: callback-ok
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_body_ids(
    world: *const lahar_world,
    body: i64,
    capacity: i64,
    ids: *mut i64,
    count: *mut i64,
) -> lahar_status {
    entry("lahar_body_ids", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a writable integer.
        let (cell, count) = unsafe { (scope.world(world)?, out(count, "count")?) };
        cell.query_order(|w| {
            let list = w.ids(body)?;
            let copied = list.iter().copied();
            // SAFETY: the host passes NULL or `capacity` writable integers.
            unsafe { copy_list((list.len(), 1), copied, (ids, capacity), &count, "ids") }
        })
    })
}
