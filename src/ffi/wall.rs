//! Walls: planes on the grid at any position along an axis, named by ids that are never used again.

use super::arguments::{Grows, initialise, optional_out, out, read_struct};
use super::cells::Change;
use super::entry::entry;
use super::status::lahar_status;
use super::world::lahar_world;
use crate::boundary::{Wall, WallKind};
use crate::error::{Error, Result};

/// A plane wall. Fill it with lahar_wall_init, then set what differs from the defaults.
///
/// A wall acts where it stands, at any position on the grid, and the material should be in front of
/// it; the whole half-space behind is held. Of several walls on a side of an axis the innermost
/// counts; two that face each other must be half a cell apart. The order in which walls are added
/// does not matter. (With LAHAR_WALLS_PLAIN a wall acts on every node whose signed distance from
/// it, positive on the side of the material, is at most 0 for linear shapes and GIMP, h/2 for
/// quadratic and h for cubic splines, with the spacing h: right on node planes for linear shapes
/// and between two for quadratic ones, up to h too late elsewhere.)
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_wall {
    /// sizeof(lahar_wall); set by lahar_wall_init.
    pub struct_size: u32,
    /// Axis of the normal: 0 x, 1 y, 2 z; default 0.
    pub axis: i32,
    /// 1: the material is at larger coordinates (default); -1: at smaller.
    pub side: i32,
    /// One of LAHAR_WALL_*; default LAHAR_WALL_STICKY.
    pub kind: i32,
    /// Coordinate of the plane [m]; default 0.
    pub position: f64,
    /// Coefficient of friction of LAHAR_WALL_FRICTION [-], >= 0; default 0.
    pub friction: f64,
}

// SAFETY: repr(C), begins with a u32, no padding (layout.rs), numbers only.
unsafe impl Grows for lahar_wall {
    const NAME: &'static str = "lahar_wall";
    const FIRST: usize = 32;
}

/// Fills the struct with its defaults.
///
/// `size`: sizeof(lahar_wall).
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_wall_init(wall: *mut lahar_wall, size: i64) -> lahar_status {
    entry("lahar_wall_init", |_| {
        let default = lahar_wall {
            struct_size: 0,
            axis: 0,
            side: 1,
            kind: WallKind::Sticky.number(),
            position: 0.0,
            friction: 0.0,
        };
        // SAFETY: the host passes NULL or `size` writable bytes.
        unsafe { initialise((wall, "wall"), size, default) }
    })
}

/// Adds a wall.
///
/// `wall`: copied. `id`: gets the id of the wall; may be NULL.
/// Thread: owner
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_wall_add(
    world: *mut lahar_world,
    wall: *const lahar_wall,
    id: *mut i64,
) -> lahar_status {
    entry("lahar_wall_add", |scope| {
        // SAFETY: the host passes NULL or a live handle, a filled struct, a writable integer.
        let (cell, wall, id) =
            unsafe { (scope.world(world)?, read_struct(wall, "wall")?, optional_out(id, "id")?) };
        let wall = to_wall(&wall)?;
        let added = cell.change(Change::Values, |w| w.add_wall(&wall))?;
        id.inspect(|id| id.set(added));
        Ok(())
    })
}

fn to_wall(wall: &lahar_wall) -> Result<Wall> {
    let axis = usize::try_from(wall.axis)
        .map_err(|_| Error::invalid(format!("`axis` is {}; expected 0, 1 or 2", wall.axis)))?;
    let kind = WallKind::from_i32(wall.kind)?;
    Ok(Wall { axis, side: wall.side, position: wall.position, kind, friction: wall.friction })
}

/// Removes a wall. Its id is not used again.
///
/// Thread: owner
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_wall_remove(world: *mut lahar_world, id: i64) -> lahar_status {
    entry("lahar_wall_remove", |scope| {
        // SAFETY: the host passes NULL or a live handle.
        let cell = unsafe { scope.world(world) }?;
        cell.change(Change::Values, |w| w.remove_wall(id))
    })
}

/// Force of a wall on the material in the last step; 0 before the first step with the wall.
///
/// `force`: written [N], shape [3].
/// Thread: callback-ok
///
/// cbindgen:ptrs-as-arrays=[[force; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_wall_reaction(
    world: *const lahar_world,
    id: i64,
    force: *mut f64,
) -> lahar_status {
    entry("lahar_wall_reaction", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or three writable doubles.
        let (cell, force) =
            unsafe { (scope.world(world)?, out(force.cast::<[f64; 3]>(), "force")?) };
        force.set(cell.query(|w| w.wall_reaction(id))?);
        Ok(())
    })
}
