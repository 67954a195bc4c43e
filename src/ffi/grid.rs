//! The sparse background grid: blocks of nodes that follow the material.
//!
//! The grid shows the particles and loads as they are. After a step it holds the result of that
//! step. If particle fields, tractions or bodies were changed since, or before the first step, the
//! next query of blocks, nodes or node values maps mass, momentum and forces to the grid anew.
//! Particles may be reordered by that, so that read views opened before become stale
//! (LAHAR_ERROR_VIEW_STALE). What is written through a view counts once all write views of the
//! world are freed.
//!
//! A query that has to map the grid may also fail with LAHAR_ERROR_VIEW_OPEN (a write view is
//! open), LAHAR_ERROR_OUTSIDE_GRID, LAHAR_ERROR_OUT_OF_MEMORY or LAHAR_ERROR_THREADS, as a step
//! may. It needs the world for itself: LAHAR_ERROR_BUSY is returned also while another thread runs
//! a query. A poisoned world shows its grid as the failed call left it.

use super::arguments::{
    Grows, copy_list, count, index, out, product, reference, slice, slice_mut, struct_out, text,
};
use super::entry::entry;
use super::field::{field_info, lahar_field_info};
use super::status::lahar_status;
use super::world::lahar_world;
use crate::error::{Error, Result};
use crate::particles::FieldInfo;
use crate::world::World;
use std::ffi::c_char;

/// Size of the grid, and how the last step changed it.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_grid_statistics {
    /// sizeof(lahar_grid_statistics); set by the host.
    pub struct_size: u32,
    /// 2 or 3.
    pub dimension: i32,
    /// Nodes of a block along each axis.
    pub block_edge: i64,
    /// Number of active blocks.
    pub active_blocks: i64,
    /// Number of nodes of the active blocks.
    pub active_nodes: i64,
    /// Memory of the grid [bytes].
    pub bytes: i64,
    /// Blocks created in the last step.
    pub blocks_created: i64,
    /// Blocks removed in the last step.
    pub blocks_removed: i64,
}

// SAFETY: repr(C), begins with a u32, no padding (layout.rs), numbers only.
unsafe impl Grows for lahar_grid_statistics {
    const NAME: &'static str = "lahar_grid_statistics";
    const FIRST: usize = 56;
}

/// Statistics of the grid.
///
/// `statistics`: written; the host has set `struct_size`.
/// Thread: callback-ok
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_grid_stats(
    world: *const lahar_world,
    statistics: *mut lahar_grid_statistics,
) -> lahar_status {
    entry("lahar_grid_stats", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a writable struct.
        let (cell, target) =
            unsafe { (scope.world(world)?, struct_out(statistics, "statistics")?) };
        target.set(cell.query_grid(|w| Ok(statistics_of(w)))?);
        Ok(())
    })
}

fn statistics_of(world: &World) -> lahar_grid_statistics {
    let stats = world.grid_stats();
    lahar_grid_statistics {
        struct_size: 0,
        dimension: world.options().dimension as i32,
        block_edge: stats.block_edge,
        active_blocks: stats.active_blocks,
        active_nodes: stats.active_nodes,
        bytes: stats.bytes,
        blocks_created: stats.blocks_created,
        blocks_removed: stats.blocks_removed,
    }
}

/// Integer coordinates of the active blocks, in block order. Block b holds the nodes with the
/// indices b * block_edge to b * block_edge + block_edge - 1 along each axis; coordinates may be
/// negative.
///
/// `capacity`, `coordinates`: room for so many blocks, shape [capacity, dimension]; NULL and 0 to
/// get only the count.
/// `count`: gets the number of active blocks.
/// Thread: callback-ok
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_grid_blocks(
    world: *const lahar_world,
    capacity: i64,
    coordinates: *mut i64,
    count: *mut i64,
) -> lahar_status {
    entry("lahar_grid_blocks", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a writable integer.
        let (cell, count) = unsafe { (scope.world(world)?, out(count, "count")?) };
        let d = cell.dimension;
        cell.query_grid(|w| {
            let blocks = w.grid_stats().active_blocks as usize;
            let all = (0..blocks).flat_map(|place| w.grid_block(place).into_iter().take(d));
            let room = (coordinates, capacity);
            // SAFETY: the host passes NULL or room for `capacity` blocks.
            unsafe { copy_list((blocks, d), all, room, &count, "coordinates") }
        })
    })
}

/// Number of the node with an integer index. The number is the position of the node's block in
/// block order times block_edge^dimension, plus the position of the node inside its block. It is
/// valid until the next step, and until the grid is mapped anew.
///
/// `index`: shape [3]; the node is at origin + index * spacing [m]. In two dimensions index[2] is
/// ignored.
/// `node`: gets the number, or -1 if the node is not active.
/// Thread: callback-ok
///
/// cbindgen:ptrs-as-arrays=[[index; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_grid_find_node(
    world: *const lahar_world,
    index: *const i64,
    node: *mut i64,
) -> lahar_status {
    entry("lahar_grid_find_node", |scope| {
        // SAFETY: the host passes NULL or a live handle, three integers, a writable integer.
        let (cell, index, node) = unsafe {
            (
                scope.world(world)?,
                *reference(index.cast::<[i64; 3]>(), "index")?,
                out(node, "node")?,
            )
        };
        let mut index = index;
        index[cell.dimension..].fill(0);
        node.set(cell.query_grid(|w| Ok(w.grid_find_node(index)))?.unwrap_or(-1));
        Ok(())
    })
}

/// Integer index of the node with a number: the inverse of lahar_grid_find_node.
///
/// `node`: number of the node. `index`: written, shape [3]; in two dimensions index[2] is 0.
/// Thread: callback-ok
///
/// cbindgen:ptrs-as-arrays=[[index; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_grid_node_index(
    world: *const lahar_world,
    node: i64,
    index: *mut i64,
) -> lahar_status {
    entry("lahar_grid_node_index", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or three writable integers.
        let (cell, target) =
            unsafe { (scope.world(world)?, out(index.cast::<[i64; 3]>(), "index")?) };
        target.set(cell.query_grid(|w| w.grid_node_index(node).ok_or_else(|| no_node(w, node)))?);
        Ok(())
    })
}

fn node_count(world: &World) -> usize {
    world.grid_stats().active_nodes as usize
}

fn no_node(world: &World, node: i64) -> Error {
    index(node, node_count(world), "node")
        .err()
        .unwrap_or_else(|| Error::invalid(format!("no node {node}")))
}

/// Number of node fields.
///
/// `fields`: gets the number.
/// Thread: callback-ok
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_grid_field_count(
    world: *const lahar_world,
    fields: *mut i64,
) -> lahar_status {
    entry("lahar_grid_field_count", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a writable integer.
        let (cell, fields) = unsafe { (scope.world(world)?, out(fields, "fields")?) };
        fields.set(cell.query(|w| Ok(w.node_fields().len()))? as i64);
        Ok(())
    })
}

/// Describes a node field. The number of components is that of this world's dimension.
///
/// `field`: 0 to lahar_grid_field_count - 1.
/// `info`: written; the host has set `struct_size`.
/// Thread: callback-ok
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_grid_field_info(
    world: *const lahar_world,
    field: i64,
    info: *mut lahar_field_info,
) -> lahar_status {
    entry("lahar_grid_field_info", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a writable struct.
        let (cell, info) = unsafe { (scope.world(world)?, struct_out(info, "info")?) };
        let fields = cell.query(|w| Ok(w.node_fields()))?;
        info.set(field_info(&fields[index(field, fields.len(), "field")?]));
        Ok(())
    })
}

/// Copies a node field.
///
/// `count`, `nodes`: numbers of nodes; NULL: all nodes of the active blocks, in block order, and
/// `count` is `active_nodes` of lahar_grid_statistics.
/// `values`: written, shape [count, components], in the unit of the field.
/// Thread: callback-ok
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_grid_read(
    world: *const lahar_world,
    field: *const c_char,
    count: i64,
    nodes: *const i64,
    values: *mut f64,
) -> lahar_status {
    entry("lahar_grid_read", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a text.
        let (cell, field) = unsafe { (scope.world(world)?, text(field, "field")?) };
        // SAFETY: the host passes NULL or `count` nodes, and NULL or room for the values of so
        // many.
        cell.query_grid(|w| unsafe { read_nodes(w, field, (count, nodes), values) })
    })
}

unsafe fn read_nodes(
    world: &World,
    field: &str,
    (n, nodes): (i64, *const i64),
    values: *mut f64,
) -> Result<()> {
    let components = node_field(world, field)?.components;
    let n = count(n, "count")?;
    let total = node_count(world);
    let named = if nodes.is_null() {
        if n != total {
            return Err(Error::invalid(format!(
                "`count` is {n}; without `nodes` it must be {total}, all active nodes"
            )));
        }
        None
    } else {
        // SAFETY: by contract of the caller `n` nodes stand there.
        Some(unsafe { slice(nodes, n, "nodes") }?)
    };
    for node in named.unwrap_or_default() {
        index(*node, total, "node")?;
    }
    // SAFETY: by contract of the caller there is room for the values of `n` nodes.
    let values = unsafe { slice_mut(values, product(n, components, "values")?, "values") }?;
    for (k, out) in values.chunks_exact_mut(components).enumerate() {
        world.node_value(field, named.map_or(k as i64, |nodes| nodes[k]), out)?;
    }
    Ok(())
}

/// The field of this name.
fn node_field(world: &World, field: &str) -> Result<FieldInfo> {
    let fields = world.node_fields();
    let names = || fields.iter().filter_map(|f| f.name.to_str().ok());
    let found = fields.iter().find(|f| f.name.to_bytes() == field.as_bytes());
    found.copied().ok_or_else(|| Error::unknown_name("node field", field, names()))
}

/// Samples a node field q at points: sum of w m q over the nodes divided by the sum of w m, with
/// the shape function w and the mass m of a node.
///
/// `count`, `points`: [m], shape [count, dimension].
/// `values`: written, shape [count, components], in the unit of the field; zeros where there is no
/// material.
/// `inside`: written, shape [count]: 1 where there is material, else 0; may be NULL.
/// Thread: callback-ok
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_grid_sample(
    world: *const lahar_world,
    field: *const c_char,
    count: i64,
    points: *const f64,
    values: *mut f64,
    inside: *mut i32,
) -> lahar_status {
    entry("lahar_grid_sample", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a text.
        let (cell, field) = unsafe { (scope.world(world)?, text(field, "field")?) };
        // SAFETY: the host passes NULL or `count` points, and NULL or room for the results of so
        // many.
        cell.query_grid(|w| unsafe { sample(w, field, (count, points), (values, inside)) })
    })
}

unsafe fn sample(
    world: &World,
    field: &str,
    (n, points): (i64, *const f64),
    (values, inside): (*mut f64, *mut i32),
) -> Result<()> {
    let components = node_field(world, field)?.components;
    let (n, d) = (count(n, "count")?, world.options().dimension);
    // SAFETY: by contract of the caller `n` points stand there, and there is room for the results
    // of `n`.
    let (points, values, mut inside) = unsafe {
        let points = slice(points, product(n, d, "points")?, "points")?;
        let values = slice_mut(values, product(n, components, "values")?, "values")?;
        let flags = if inside.is_null() { None } else { Some(slice_mut(inside, n, "inside")?) };
        (points, values, flags)
    };
    if let Some(k) = points.iter().position(|x| !x.is_finite()) {
        return Err(Error::invalid(format!("point {} has a coordinate that is not finite", k / d)));
    }
    for (k, (point, out)) in
        points.chunks_exact(d).zip(values.chunks_exact_mut(components)).enumerate()
    {
        let found = world.sample(field, point, out)?;
        if let Some(flags) = &mut inside {
            flags[k] = found.into();
        }
    }
    Ok(())
}
