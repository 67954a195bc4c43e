//! Output: sums over the particles, and files.

use super::arguments::{Grows, struct_out, text};
use super::entry::entry;
use super::status::lahar_status;
use super::world::lahar_world;
use crate::error::{Error, Result};
use crate::output::vtk;
use crate::world::queries::Totals;
use std::ffi::c_char;
use std::path::Path;

/// Stands for all bodies where the id of a body is expected.
pub const LAHAR_ALL_BODIES: i64 = -1;

/// Sums over particles.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_totals {
    /// sizeof(lahar_totals); set by the host.
    pub struct_size: u32,
    /// 0.
    pub reserved: i32,
    /// Number of particles.
    pub particles: i64,
    /// Mass [kg].
    pub mass: f64,
    /// Momentum [kg m/s], shape [3].
    pub momentum: [f64; 3],
    /// Angular momentum about the point x = 0 [kg m^2/s], shape [3].
    pub angular_momentum: [f64; 3],
    /// Kinetic energy [J].
    pub kinetic_energy: f64,
    /// Strain energy [J]: the work of the stresses, or the stored energy if the model gives it.
    pub strain_energy: f64,
    /// Potential energy, the sum of - m g . x [J], with gravity g at the present time.
    pub potential_energy: f64,
    /// Centre of mass [m], shape [3]; 0 without particles.
    pub center_of_mass: [f64; 3],
}

// SAFETY: repr(C), begins with a u32, no padding (layout.rs), numbers only.
unsafe impl Grows for lahar_totals {
    const NAME: &'static str = "lahar_totals";
    const FIRST: usize = 120;
}

/// Mass, momenta and energies of a body or of all.
///
/// `body`: an id, or LAHAR_ALL_BODIES.
/// `totals`: written; the host has set `struct_size`.
/// Thread: callback-ok
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_world_totals(
    world: *const lahar_world,
    body: i64,
    totals: *mut lahar_totals,
) -> lahar_status {
    entry("lahar_world_totals", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a writable struct.
        let (cell, target) = unsafe { (scope.world(world)?, struct_out(totals, "totals")?) };
        let totals = cell.query(|w| w.totals((body != LAHAR_ALL_BODIES).then_some(body)))?;
        target.set(from_totals(&totals));
        Ok(())
    })
}

fn from_totals(totals: &Totals) -> lahar_totals {
    lahar_totals {
        struct_size: 0,
        reserved: 0,
        particles: totals.particles,
        mass: totals.mass,
        momentum: totals.momentum,
        angular_momentum: totals.angular_momentum,
        kinetic_energy: totals.kinetic_energy,
        strain_energy: totals.strain_energy,
        potential_energy: totals.potential_energy,
        center_of_mass: totals.center_of_mass,
    }
}

/// Writes all particles with all their fields to a VTP file (XML, compressed) for ParaView.
///
/// Points are in the order of bodies and ids, whatever order they are stored in: point k of two
/// files is the same particle as long as no body came or went. The time [s] is the field data
/// `TimeValue`.
///
/// `path`: NUL-terminated, UTF-8, ends in `.vtp`. The file is written under a temporary name and
/// then renamed, so that an existing file is replaced as a whole or not at all.
/// Thread: callback-ok
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_world_write_vtp(
    world: *const lahar_world,
    path: *const c_char,
) -> lahar_status {
    entry("lahar_world_write_vtp", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a text.
        let (cell, path) = unsafe { (scope.world(world)?, text(path, "path")?) };
        let path = check_path(path)?;
        cell.query(|w| vtk::write(w, path))
    })
}

fn check_path(path: &str) -> Result<&Path> {
    if path.is_empty() {
        Err(Error::invalid("`path` is empty; expected the name of a file"))
    } else {
        Ok(Path::new(path))
    }
}
