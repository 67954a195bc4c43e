//! Bodies: particles of one material. They are made from the host's arrays or from shapes, and
//! named by ids that are counted from 0 and never used again.

use super::arguments::{
    Grows, array3, copy_list, count, initialise, out, product, read_struct, reference, slice,
    strides,
};
use super::cells::Change;
use super::entry::{Scope, entry};
use super::material::lahar_material;
use super::status::lahar_status;
use super::world::lahar_world;
use crate::error::{Error, Result};
use crate::memory::collect;
use crate::particles::seeding::{Fill, Region};
use crate::world::host_arrays::{ParticleArrays, Strided};

/// An array of the host with any layout: component c of point k is
/// data[c * component_stride + k * point_stride].
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_array {
    /// First value; NULL: not given. Read during the call only.
    pub data: *const f64,
    /// Distance between two components of a point, in doubles. If both strides are 0, the array is
    /// interleaved: point after point.
    pub component_stride: i64,
    /// Distance between two points, in doubles.
    pub point_stride: i64,
}

/// Particles from the host's arrays. Fill it with lahar_particles_init, then set `count`,
/// `position`, `volume`, and either `mass` or `density`.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_particles {
    /// sizeof(lahar_particles); set by lahar_particles_init.
    pub struct_size: u32,
    /// Must be 0.
    pub reserved: i32,
    /// Number of particles.
    pub count: i64,
    /// Positions [m], shape [count, dimension]; at most 1e8 spacings from the grid's origin and
    /// from x = 0.
    pub position: lahar_array,
    /// Volumes [m^3], shape [count], > 0; in two dimensions areas times 1 m.
    pub volume: lahar_array,
    /// Masses [kg], shape [count], > 0; not given: `density` times volume.
    pub mass: lahar_array,
    /// Velocities [m/s], shape [count, dimension]; not given: 0.
    pub velocity: lahar_array,
    /// Cauchy stresses xx, yy, zz, xy, yz, zx [Pa], tension positive, shape [count, 6]; not given:
    /// 0. Those that the model would forget are refused by the next step, see lahar_body_write.
    pub stress: lahar_array,
    /// Mass density [kg/m^3], > 0; used if `mass` is not given.
    pub density: f64,
    /// Edge lengths of the particles' domains [m], shape [count, dimension], > 0; not given:
    /// unknown. The GIMP shape functions and tractions on the body need them.
    pub size: lahar_array,
}

// SAFETY: repr(C), begins with a u32, no padding (layout.rs), numbers and raw pointers only.
unsafe impl Grows for lahar_particles {
    const NAME: &'static str = "lahar_particles";
    const FIRST: usize = 144;
}

const NO_ARRAY: lahar_array =
    lahar_array { data: std::ptr::null(), component_stride: 0, point_stride: 0 };

const NO_PARTICLES: lahar_particles = lahar_particles {
    struct_size: 0,
    reserved: 0,
    count: 0,
    position: NO_ARRAY,
    volume: NO_ARRAY,
    mass: NO_ARRAY,
    velocity: NO_ARRAY,
    stress: NO_ARRAY,
    density: 0.0,
    size: NO_ARRAY,
};

/// How a shape is filled with particles. Fill it with lahar_fill_init, then set either `density` or
/// `mass`.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_fill {
    /// sizeof(lahar_fill); set by lahar_fill_init.
    pub struct_size: u32,
    /// Particles per cell of the grid along each axis, >= 1; default 2.
    pub particles_per_cell: i32,
    /// Mass density [kg/m^3], > 0; 0: not given. Each lattice point inside the shape is a particle
    /// with the volume of its lattice cell. The mass of the body is then exact for a box; for a
    /// sphere with a radius of one spacing it may be 10 % off.
    pub density: f64,
    /// Mass of the whole body [kg], > 0; 0: not given. Divided evenly among the particles, so that
    /// it is exact.
    pub mass: f64,
    /// Velocity of all particles [m/s], shape [3]; default 0.
    pub velocity: [f64; 3],
    /// Cauchy stress of all particles xx, yy, zz, xy, yz, zx [Pa], tension positive, shape [6];
    /// default 0. One that the model would forget is refused by the next step, see
    /// lahar_body_write.
    pub stress: [f64; 6],
}

// SAFETY: repr(C), begins with a u32, no padding (layout.rs), numbers only.
unsafe impl Grows for lahar_fill {
    const NAME: &'static str = "lahar_fill";
    const FIRST: usize = 96;
}

/// Fills the struct with its defaults: no particles, no arrays.
///
/// `size`: sizeof(lahar_particles).
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_particles_init(
    particles: *mut lahar_particles,
    size: i64,
) -> lahar_status {
    entry("lahar_particles_init", |_| {
        // SAFETY: the host passes NULL or `size` writable bytes.
        unsafe { initialise((particles, "particles"), size, NO_PARTICLES) }
    })
}

/// Fills the struct with its defaults.
///
/// `size`: sizeof(lahar_fill).
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_fill_init(fill: *mut lahar_fill, size: i64) -> lahar_status {
    entry("lahar_fill_init", |_| {
        let default = lahar_fill {
            struct_size: 0,
            particles_per_cell: 2,
            density: 0.0,
            mass: 0.0,
            velocity: [0.0; 3],
            stress: [0.0; 6],
        };
        // SAFETY: the host passes NULL or `size` writable bytes.
        unsafe { initialise((fill, "fill"), size, default) }
    })
}

/// Adds a body from the host's arrays.
///
/// `particles`: read during the call only. The particles get the ids 0 to count - 1 in this order.
/// `body`: gets the id of the new body; must not be NULL.
/// Thread: owner
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_body_add_particles(
    world: *mut lahar_world,
    material: *const lahar_material,
    particles: *const lahar_particles,
    body: *mut i64,
) -> lahar_status {
    entry("lahar_body_add_particles", |scope| {
        // SAFETY: the host passes NULL or live handles, a filled struct, a writable integer.
        let (cell, material, particles, body) = unsafe {
            let material = reference(material, "material");
            (
                scope.world(world)?,
                material?,
                read_struct(particles, "particles")?,
                out(body, "body")?,
            )
        };
        // SAFETY: the host's arrays hold `count` points in their layout.
        let arrays = unsafe { particle_arrays(&particles, cell.dimension) }?;
        body.set(cell.change(Change::Bodies, |w| w.add_particles(&material.material, &arrays))?);
        Ok(())
    })
}

unsafe fn particle_arrays<'a>(
    particles: &lahar_particles,
    dimension: usize,
) -> Result<ParticleArrays<'a>> {
    if particles.reserved != 0 {
        return Err(Error::invalid(
            "`reserved` of lahar_particles must be 0; call lahar_particles_init first",
        ));
    }
    let n = count(particles.count, "count")?;
    // SAFETY: by contract of the caller each array holds `n` points in its layout, or is NULL.
    let array = |array: &lahar_array, components: usize, name: &str| unsafe {
        strided(array, n, components, name)
    };
    let optional = |a: &lahar_array, components: usize, name: &str| {
        if a.data.is_null() { Ok(None) } else { array(a, components, name).map(Some) }
    };
    Ok(ParticleArrays {
        position: array(&particles.position, dimension, "position")?,
        volume: array(&particles.volume, 1, "volume")?,
        mass: optional(&particles.mass, 1, "mass")?,
        density: particles.density,
        velocity: optional(&particles.velocity, dimension, "velocity")?,
        stress: optional(&particles.stress, 6, "stress")?,
        size: optional(&particles.size, dimension, "size")?,
    })
}

unsafe fn strided<'a>(
    array: &lahar_array,
    n: usize,
    components: usize,
    name: &str,
) -> Result<Strided<'a>> {
    let strides = strides(n, components, [array.component_stride, array.point_stride], name)?;
    // SAFETY: by contract of the caller the array holds the points of these strides.
    let data = unsafe { slice(array.data, strides.needed(), name) }?;
    Strided::new(data, strides)
}

/// Adds a body that fills a box.
///
/// `min`, `max`: corners [m], shape [3]. Particles are placed on a regular lattice,
/// `particles_per_cell` along each axis.
/// `fill`: density or mass, velocity, stress. `body`: gets the id of the new body; must not be
/// NULL.
/// Thread: owner
///
/// cbindgen:ptrs-as-arrays=[[min; 3], [max; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_body_add_box(
    world: *mut lahar_world,
    material: *const lahar_material,
    min: *const f64,
    max: *const f64,
    fill: *const lahar_fill,
    body: *mut i64,
) -> lahar_status {
    entry("lahar_body_add_box", |scope| {
        // SAFETY: the host passes NULL or three doubles each.
        let corners = unsafe { (array3(min, "min"), array3(max, "max")) };
        let region = |dimension| {
            Ok(Region::Box { min: flat(corners.0?, dimension), max: flat(corners.1?, dimension) })
        };
        // SAFETY: the host passes NULL or live handles, a filled struct, a writable integer.
        unsafe { add_shape(scope, (world, material, fill, body), region) }
    })
}

/// Adds a body that fills a sphere, or a disc in two dimensions.
///
/// `center`: [m], shape [3]. `radius`: [m], > 0.
/// `fill`: density or mass, velocity, stress. With `density` the mass may be 10 % off if the
/// radius is one spacing (see lahar_fill); give `mass` for an exact one.
/// `body`: gets the id of the new body; must not be NULL.
/// Thread: owner
///
/// cbindgen:ptrs-as-arrays=[[center; 3]]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_body_add_sphere(
    world: *mut lahar_world,
    material: *const lahar_material,
    center: *const f64,
    radius: f64,
    fill: *const lahar_fill,
    body: *mut i64,
) -> lahar_status {
    entry("lahar_body_add_sphere", |scope| {
        // SAFETY: the host passes NULL or three doubles.
        let center = unsafe { array3(center, "center") };
        let region = |dimension| Ok(Region::Sphere { center: flat(center?, dimension), radius });
        // SAFETY: the host passes NULL or live handles, a filled struct, a writable integer.
        unsafe { add_shape(scope, (world, material, fill, body), region) }
    })
}

/// Adds a body that fills a simple polygon; two dimensions only.
///
/// `count`: number of vertices, >= 3. `vertices`: [m], shape [count, 2], point after point,
/// clockwise or counter-clockwise.
/// `fill`: density or mass, velocity, stress. With `density` the mass is approximate (see
/// lahar_fill); give `mass` for an exact one.
/// `body`: gets the id of the new body; must not be NULL.
/// Thread: owner
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_body_add_polygon(
    world: *mut lahar_world,
    material: *const lahar_material,
    count: i64,
    vertices: *const f64,
    fill: *const lahar_fill,
    body: *mut i64,
) -> lahar_status {
    entry("lahar_body_add_polygon", |scope| {
        // SAFETY: the host passes NULL or `count` points.
        let vertices = unsafe { polygon(count, vertices) };
        let region = |_| Ok(Region::Polygon { vertices: vertices? });
        // SAFETY: the host passes NULL or live handles, a filled struct, a writable integer.
        unsafe { add_shape(scope, (world, material, fill, body), region) }
    })
}

unsafe fn polygon(n: i64, vertices: *const f64) -> Result<Vec<[f64; 2]>> {
    let n = product(count(n, "count")?, 2, "vertices")?;
    // SAFETY: by contract of the caller the points are there.
    let values = unsafe { slice(vertices, n, "vertices") }?;
    collect(values.chunks_exact(2).map(|v| [v[0], v[1]]), "the corners of a polygon")
}

fn flat(mut vector: [f64; 3], dimension: usize) -> [f64; 3] {
    vector[dimension..].fill(0.0);
    vector
}

type ShapeArguments = (*mut lahar_world, *const lahar_material, *const lahar_fill, *mut i64);

unsafe fn add_shape(
    scope: &mut Scope,
    (world, material, fill, body): ShapeArguments,
    region: impl FnOnce(usize) -> Result<Region>,
) -> Result<()> {
    // SAFETY: by contract of the caller each is NULL or a live handle, a filled struct, a writable
    // integer.
    let (cell, material, fill, body) = unsafe {
        let material = reference(material, "material");
        (scope.world(world)?, material?, read_struct(fill, "fill")?, out(body, "body")?)
    };
    let region = region(cell.dimension)?;
    let fill = Fill {
        particles_per_cell: fill.particles_per_cell,
        density: fill.density,
        mass: fill.mass,
        velocity: cell.vector(fill.velocity),
        stress: fill.stress,
    };
    body.set(cell.change(Change::Bodies, |w| w.add_shape(&material.material, &region, &fill))?);
    Ok(())
}

/// Removes a body. Its id is not used again.
///
/// Thread: owner
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_body_remove(world: *mut lahar_world, body: i64) -> lahar_status {
    entry("lahar_body_remove", |scope| {
        // SAFETY: the host passes NULL or a live handle.
        let cell = unsafe { scope.world(world) }?;
        cell.change(Change::Bodies, |w| w.remove_body(body))
    })
}

/// Switches F-bar on or off for a body; it is off at first.
///
/// With F-bar the particles in a cell of the grid have the same rate of volume change: the trace of
/// the velocity gradient is averaged, weighted by volume. Nearly incompressible and plastic
/// materials then do not lock. F-bar costs one more transfer from the grid to the particles in each
/// step.
///
/// `on`: 1 or 0.
/// Thread: owner
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_body_set_f_bar(
    world: *mut lahar_world,
    body: i64,
    on: i32,
) -> lahar_status {
    entry("lahar_body_set_f_bar", |scope| {
        // SAFETY: the host passes NULL or a live handle.
        let cell = unsafe { scope.world(world) }?;
        let on = match on {
            0 => false,
            1 => true,
            other => {
                return Err(Error::invalid(format!("`on` must be 0 or 1, got {other}")));
            }
        };
        cell.change(Change::Bodies, |w| w.set_f_bar(body, on))
    })
}

/// Number of bodies.
///
/// Thread: callback-ok
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_world_body_count(
    world: *const lahar_world,
    bodies: *mut i64,
) -> lahar_status {
    entry("lahar_world_body_count", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a writable integer.
        let (cell, bodies) = unsafe { (scope.world(world)?, out(bodies, "bodies")?) };
        bodies.set(cell.query(|w| Ok(w.body_count()))? as i64);
        Ok(())
    })
}

/// Ids of the bodies, ascending.
///
/// `capacity`, `ids`: room for so many ids; NULL and 0 to get only the count.
/// `count`: gets the number of bodies.
/// Thread: callback-ok
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_world_bodies(
    world: *const lahar_world,
    capacity: i64,
    ids: *mut i64,
    count: *mut i64,
) -> lahar_status {
    entry("lahar_world_bodies", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a writable integer.
        let (cell, count) = unsafe { (scope.world(world)?, out(count, "count")?) };
        cell.query(|w| {
            let bodies = (0..w.body_count()).map(|place| w.body_id(place));
            // SAFETY: the host passes NULL or `capacity` writable integers.
            unsafe { copy_list((w.body_count(), 1), bodies, (ids, capacity), &count, "ids") }
        })
    })
}

/// Number of particles of a body.
///
/// Thread: callback-ok
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_body_particle_count(
    world: *const lahar_world,
    body: i64,
    particles: *mut i64,
) -> lahar_status {
    entry("lahar_body_particle_count", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a writable integer.
        let (cell, particles) = unsafe { (scope.world(world)?, out(particles, "particles")?) };
        particles.set(cell.query(|w| w.particle_count(body))? as i64);
        Ok(())
    })
}
