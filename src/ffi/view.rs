//! Views: the memory of a particle field itself, in storage order (see lahar_body_ids). The host
//! frees each view.

use super::arguments::{Grows, handle_out, reference, struct_out, text};
use super::cells::{Change, OpenView, WorldCell};
use super::entry::{entry, quiet_entry};
use super::status::lahar_status;
use super::world::lahar_world;
use crate::error::{Error, Result, Status};
use std::ffi::c_char;
use std::sync::Arc;

/// Access of a view: read. The view becomes stale when particles may have been reordered: by a
/// step, or by a query that maps the grid anew.
pub const LAHAR_ACCESS_READ: i32 = 0;
/// Access of a view: read and write. No step is possible while it is open.
pub const LAHAR_ACCESS_WRITE: i32 = 1;

/// A view of a field. Freed by lahar_view_free; the world lives at least as long.
pub struct lahar_view {
    open: OpenView,
    data: *mut f64,
    components: usize,
    count: usize,
    stride: usize,
    generation: i64,
}

/// The data of a view.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_view_info {
    /// sizeof(lahar_view_info); set by the host.
    pub struct_size: u32,
    /// Number of components per particle.
    pub components: i32,
    /// Component c of particle k, in storage order, is data[c * stride + k], in the unit of the
    /// field (lahar_field_info). Must not be written through a view with LAHAR_ACCESS_READ. The
    /// memory stays valid until the view is freed.
    pub data: *mut f64,
    /// Number of particles.
    pub count: i64,
    /// Distance of two components, in doubles.
    pub stride: i64,
    /// Grows whenever the storage order may have changed; equal numbers mean the same order.
    pub generation: i64,
}

// SAFETY: repr(C), begins with a u32, no padding (layout.rs), numbers and raw pointers only.
unsafe impl Grows for lahar_view_info {
    const NAME: &'static str = "lahar_view_info";
    const FIRST: usize = 40;
}

/// Opens a view of a field of a body.
///
/// While any view is open, bodies cannot be added or removed; while a write view is open, the world
/// cannot step, and a query of the grid is refused if it would have to map the grid anew. What is
/// written through a view counts once all write views of the world are freed; it is checked before
/// the next step. If bodies were added or removed since the last step, opening a view first maps
/// the particles to the grid; they may be reordered by that.
///
/// `access`: LAHAR_ACCESS_READ or LAHAR_ACCESS_WRITE.
/// `view`: set to the new handle, or to NULL on failure; the host frees it with lahar_view_free.
/// Thread: owner
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_body_view(
    world: *mut lahar_world,
    body: i64,
    field: *const c_char,
    access: i32,
    view: *mut *mut lahar_view,
) -> lahar_status {
    entry("lahar_body_view", |scope| {
        // SAFETY: the host passes NULL or a writable pointer, a live handle, a text.
        let (target, cell, field) =
            unsafe { (handle_out(view, "view")?, scope.world(world)?, text(field, "field")?) };
        target.set(Box::into_raw(Box::new(open(&cell, body, field, access)?)));
        Ok(())
    })
}

fn open(cell: &Arc<WorldCell>, body: i64, field: &str, access: i32) -> Result<lahar_view> {
    match access {
        LAHAR_ACCESS_READ => open_read(cell, body, field),
        LAHAR_ACCESS_WRITE => open_write(cell, body, field),
        _ => Err(Error::invalid(format!("`access` is {access}; expected 0 (read) or 1 (write)"))),
    }
}

fn open_read(cell: &Arc<WorldCell>, body: i64, field: &str) -> Result<lahar_view> {
    cell.query_order(|w| {
        let slice = w.field_data(body, field)?;
        Ok(lahar_view {
            open: OpenView::new(cell, false),
            data: slice.data.as_ptr().cast_mut(),
            components: slice.components,
            count: slice.count,
            stride: slice.stride,
            generation: cell.generation(),
        })
    })
}

fn open_write(cell: &Arc<WorldCell>, body: i64, field: &str) -> Result<lahar_view> {
    cell.query_order(|_| Ok(()))?;
    cell.change(Change::Values, |w| {
        let slice = w.field_view_mut(body, field)?;
        Ok(lahar_view {
            open: OpenView::new(cell, true),
            data: slice.data.as_mut_ptr(),
            components: slice.components,
            count: slice.count,
            stride: slice.stride,
            generation: cell.generation(),
        })
    })
}

/// Address and layout of the data of a view.
///
/// `info`: written; the host has set `struct_size`.
/// Thread: callback-ok
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_view_data(
    view: *const lahar_view,
    info: *mut lahar_view_info,
) -> lahar_status {
    entry("lahar_view_data", |scope| {
        // SAFETY: the host passes NULL or a live handle.
        let view = unsafe { reference(view, "view") }?;
        scope.attach_world(&view.open.cell);
        // SAFETY: the host passes NULL or a writable struct.
        let info = unsafe { struct_out(info, "info") }?;
        info.set(view.open.cell.query(|_| view_info(view))?);
        Ok(())
    })
}

fn view_info(view: &lahar_view) -> Result<lahar_view_info> {
    if !view.open.is_write() && view.generation != view.open.cell.generation() {
        let text = "particles may have been reordered since the view was opened; free it and open a new one";
        return Err(Error::new(Status::ViewStale, text));
    }
    Ok(lahar_view_info {
        struct_size: 0,
        components: view.components as i32,
        data: view.data,
        count: view.count as i64,
        stride: view.stride as i64,
        generation: view.generation,
    })
}

/// Closes the view and frees the handle. Its data must not be used any more. NULL is ignored.
/// Thread: callback-ok
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_view_free(view: *mut lahar_view) {
    quiet_entry(|| {
        if !view.is_null() {
            // SAFETY: the handle came from Box::into_raw in lahar_body_view and is freed once.
            drop(unsafe { Box::from_raw(view) });
        }
    });
}
