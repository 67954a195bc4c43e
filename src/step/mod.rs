//! One explicit step of the material point method: read this file and you have read the algorithm.
//!
//! | stage | produces | file |
//! |---|---|---|
//! | how far may we go | dt | [`time_step`] |
//! | sort particles into blocks | runs, tiles, active blocks | [`locate`](mod@locate) |
//! | keep the start | a copy of the particles, where retries are allowed | [`retry`] |
//! | particles to grid | m_i, (mv)_i, f_i | [`particles_to_grid`](mod@particles_to_grid) |
//! | add the tractions | f_i | [`apply_tractions`](mod@apply_tractions) |
//! | update the grid | v_i, Δv_i | [`update_grid`](mod@update_grid) |
//! | apply the boundaries | v_i, Δv_i, reactions | [`apply_boundaries`](mod@apply_boundaries) |
//! | filter the velocities | the velocities that particles take in XPIC and FMPM | [`filter_velocities`](mod@filter_velocities) |
//! | grid to particles | v_p, x_p, ∇v_p | [`grid_to_particles`](mod@grid_to_particles) |
//! | average the dilation | tr L_p of bodies with F-bar | [`average_dilation`](mod@average_dilation) |
//! | update the strain | Δε_p, V_p, rotated σ_p | [`update_strain`](mod@update_strain) |
//! | update the stress | σ_p, state, wave speed | [`update_stress`](mod@update_stress) |
//!
//! The last three go over a chunk of particles while it is in cache. [`naive`] is the same step as the textbook writes it.

pub mod apply_boundaries;
pub mod apply_tractions;
pub mod average_dilation;
pub mod filter_velocities;
pub mod grid_to_particles;
pub mod hooks;
pub mod kernels;
pub mod locate;
pub mod naive;
pub mod options;
pub mod order;
pub mod particles_to_grid;
pub mod retry;
pub mod time_step;
pub mod update_domain;
pub mod update_grid;
pub mod update_strain;
pub mod update_stress;

use crate::step::hooks::HookPoint;
use crate::world::state::{Piece, State};

pub use order::StepOrder;

use apply_boundaries::{apply_boundaries, apply_boundaries_again};
use apply_tractions::apply_tractions;
use average_dilation::{average_dilation, share_dilation};
use filter_velocities::{filter_again, filter_start, filter_velocities};
use grid_to_particles::{Gather, grid_to_particles};
use locate::{check_radii, locate};
use particles_to_grid::{Scattered, particles_to_grid, velocities_to_grid};
use retry::keep_start;
use time_step::Limits;
use update_grid::update_grid;
use update_strain::update_strain;
use update_stress::{Failure, Outcome, update_stress};

/// One step of length `dt` [s]. On success gives the limits of the next time step.
pub fn step<const D: usize>(world: &mut State<D>, dt: f64) -> Result<Limits, Box<Failure>> {
    check_radii(world)?;
    locate(world)?;
    world.stale = false;
    if world.options.retries > 0 {
        keep_start(world)?;
    }
    world.hook(HookPoint::Start, dt);
    let outcome = match world.options.order {
        StepOrder::Usl => usl(world, dt),     // [ORD-1]
        StepOrder::Musl => musl(world, dt),   // [ORD-2]
        StepOrder::Usf => usf(world, dt),     // [ORD-3]
        StepOrder::Usavg => usavg(world, dt), // [ORD-4]
    };
    world.hook(HookPoint::End, dt);
    (world.unreliable, world.wish) = (outcome.unreliable(), outcome.wish());
    outcome.limits(dt)
}

/// From particles to the new velocities of the grid: what all orders have in common.
fn move_grid<const D: usize>(world: &mut State<D>, dt: f64) {
    particles_to_grid(world);
    apply_tractions(world, dt);
    world.hook(HookPoint::AfterScatter, dt);
    update_grid(world, dt);
    apply_boundaries(world, dt);
    world.hook(HookPoint::AfterBoundaries, dt);
    filter_velocities(world);
}

/// Update stress last. D. Sulsky, Z. Chen, H. L. Schreyer, Comput. Methods Appl. Mech. Engrg. 118 (1994) 179–196,
/// doi:10.1016/0045-7825(94)90112-0.
fn usl<const D: usize>(world: &mut State<D>, dt: f64) -> Outcome {
    move_grid(world, dt);
    average_dilation(world, Gather::Gradient);
    world.for_each_chunk(|piece| {
        grid_to_particles(piece, Gather::Everything, dt);
        strain(piece, dt)
    })
}

/// Modified update stress last: the new particle velocities, with their affine part, are mapped to the grid again, and the velocity
/// gradient is taken of those. (Without the affine part the gradient would come of a field filtered twice and positions of one filtered
/// once: sand would swell by 2 to 3 % in a collapse.) D. Sulsky, S.-J. Zhou, H. L. Schreyer, Comput. Phys. Commun. 87 (1995) 236–252, doi:10.1016/0010-4655(94)00170-7.
fn musl<const D: usize>(world: &mut State<D>, dt: f64) -> Outcome {
    move_grid(world, dt);
    world.for_each_chunk(|piece| {
        grid_to_particles(piece, Gather::Velocity, dt);
        Outcome::default()
    });
    velocities_to_grid(world, Scattered::Momentum);
    apply_boundaries_again(world);
    filter_again(world);
    average_dilation(world, Gather::SecondGradient);
    world.for_each_chunk(|piece| {
        grid_to_particles(piece, Gather::PositionAndGradient, dt);
        strain(piece, dt)
    })
}

/// Update stress first, from the velocities at the start. S. G. Bardenhagen, J. Comput. Phys. 180 (2002) 383–403, doi:10.1006/jcph.2002.7103.
fn usf<const D: usize>(world: &mut State<D>, dt: f64) -> Outcome {
    let outcome = stress_of_start(world, dt);
    move_grid(world, dt);
    world.for_each_chunk(|piece| {
        grid_to_particles(piece, Gather::Motion, dt);
        Outcome::default()
    });
    outcome
}

/// Half a stress update from the velocities at the start, half from those at the end. J. A. Nairn, CMES 4 (2003) 649–664, doi:10.3970/cmes.2003.004.649.
fn usavg<const D: usize>(world: &mut State<D>, dt: f64) -> Outcome {
    let outcome = stress_of_start(world, 0.5 * dt);
    move_grid(world, dt);
    average_dilation(world, Gather::Gradient);
    outcome.merge(world.for_each_chunk(|piece| {
        grid_to_particles(piece, Gather::Everything, dt);
        strain(piece, 0.5 * dt)
    }))
}

/// Updates the stress over `dt` from the velocities that the particles have.
fn stress_of_start<const D: usize>(world: &mut State<D>, dt: f64) -> Outcome {
    particles_to_grid(world);
    update_grid(world, 0.0);
    apply_boundaries(world, dt);
    filter_start(world);
    average_dilation(world, Gather::Gradient);
    world.for_each_chunk(|piece| {
        grid_to_particles(piece, Gather::Gradient, dt);
        strain(piece, dt)
    })
}

/// From the velocity gradients of a chunk to its stresses.
fn strain<const D: usize>(piece: &mut Piece<'_, '_, D>, dt: f64) -> Outcome {
    share_dilation(piece);
    update_strain(piece, dt);
    update_stress(piece, dt)
}
