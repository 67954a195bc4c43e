//! One explicit step of the material point method: read this file and you have read the algorithm.
//!
//! | | stage | produces | file |
//! |---|---|---|---|
//! | 0 | time step | the stable dt, before the step | [`time_step`] |
//! | 1 | locate | runs, tiles, active blocks | [`locate`] |
//! | 1b | save the start | a copy of the particles, where retries are allowed | [`retry`] |
//! | 2 | particles to grid | m_i, (mv)_i, f_i | [`particles_to_grid`] |
//! | 2b | apply the tractions | f_i | [`apply_tractions`] |
//! | 3 | update the grid | v_i, Δv_i | [`update_grid`] |
//! | 4 | apply the boundaries | v_i, Δv_i, reactions | [`apply_boundaries`] |
//! | 4a | damp the grid | v_i, Δv_i | [`update_grid`] |
//! | 4b | filter the velocities | velocities of particles in XPIC, FMPM | [`filter_velocities`] |
//! | 4c | average the dilation | the mean tr L_p, of bodies with F-bar | [`average_dilation`] |
//! | 5 | grid to particles | v_p, x_p, ∇v_p | [`grid_to_particles`] |
//! | 6 | update the strain | Δε_p, V_p, F_p, rotated σ_p, in scratch | [`update_strain`] |
//! | 6b | update the domain | edges of contiguous-particle GIMP, in scratch | [`update_domain`] |
//! | 7 | update the stress | σ_p, state, wave speed, in scratch | [`update_stress`] |
//! | 8 | commit | particles take over what 6, 6b and 7 left in scratch | [`commit`] |
//!
//! Stages 5 to 8 work on a chunk of particles while it is in cache, in one [`pass`](mod@pass). The
//! orders below are the only functions that see all [`parts`] of a world; a stage takes those that
//! it reads and writes. [`naive`] is the same step as the textbook writes it.
//!
//! Three words for groups of particles: a *run* is the particles of one body in one block;
//! a *chunk* is up to 512 particles, which go through a pass together; a *batch* is up to 32
//! particles of a run, which go through a kernel together, and also the points of one call of a
//! model.
//!
//! [`locate`]: mod@locate
//! [`particles_to_grid`]: mod@particles_to_grid
//! [`apply_tractions`]: mod@apply_tractions
//! [`update_grid`]: mod@update_grid
//! [`apply_boundaries`]: mod@apply_boundaries
//! [`filter_velocities`]: mod@filter_velocities
//! [`average_dilation`]: mod@average_dilation
//! [`grid_to_particles`]: mod@grid_to_particles
//! [`update_strain`]: mod@update_strain
//! [`update_domain`]: mod@update_domain
//! [`update_stress`]: mod@update_stress
//! [`commit`]: mod@commit

pub mod apply_boundaries;
pub mod apply_tractions;
pub mod average_dilation;
pub mod commit;
pub mod filter_velocities;
pub mod freshness;
pub mod grid_to_particles;
pub mod hooks;
pub mod integrate;
pub mod kernels;
pub mod locate;
pub mod naive;
pub mod options;
pub mod order;
pub mod particles_to_grid;
pub mod parts;
pub mod pass;
pub mod retry;
pub mod time_step;
pub mod update_domain;
pub mod update_grid;
pub mod update_strain;
pub mod update_stress;

pub use order::StepOrder;

use crate::error::Result;
use crate::material::scratch;
use crate::memory::reserve_exact;

use apply_boundaries::{apply_boundaries, apply_boundaries_again, hold_velocities};
use apply_tractions::{apply_tractions, report_tractions};
use average_dilation::average_dilation;
use filter_velocities::Filter;
use grid_to_particles::Gather;
use hooks::HookPoint;
use locate::{check_radii, locate};
use particles_to_grid::{Scattered, particles_to_grid, velocities_to_grid};
use parts::{Buffers, Parts};
use pass::{Moment, Pass, Then};
use retry::save_start;
use update_grid::{damp_grid, update_grid};
use update_stress::Outcome;

/// One step of length `dt` [s]. An error means that nothing was done.
pub fn step<const D: usize>(world: &mut Parts<D>, dt: f64) -> Result<Outcome> {
    world.background.blocks.no_change();
    sort(world)?;
    if world.method.options.retries > 0 {
        save_start(&world.bodies, &mut world.conditions, &mut world.buffers.start)?;
    }
    make_room(world)?;
    world.hook(HookPoint::Start, dt);
    let outcome = match world.method.options.order {
        StepOrder::Usl => usl(world, dt),     // [ORD-1]
        StepOrder::Musl => musl(world, dt),   // [ORD-2]
        StepOrder::Usf => usf(world, dt),     // [ORD-3]
        StepOrder::Usavg => usavg(world, dt), // [ORD-4]
    };
    world.hook(HookPoint::End, dt);
    Ok(outcome)
}

/// Maps particles and loads to the grid, as they are now.
pub fn map<const D: usize>(world: &mut Parts<D>) -> Result<()> {
    sort(world)?;
    make_room(world)?;
    scatter(world, world.clock.time);
    update(world, 0.0);
    let Parts { background, conditions, buffers, team, .. } = world;
    hold_velocities(background, conditions, &mut buffers.impulses, team, None);
    world.freshness.mapped_at(world.clock.time);
    Ok(())
}

/// Sorts every particle into the run of its block.
fn sort<const D: usize>(world: &mut Parts<D>) -> Result<()> {
    let Parts { bodies, background, method, buffers, freshness, team, .. } = world;
    check_radii(bodies, &method.options)?;
    locate(bodies, background, &method.options, &mut buffers.sorting, freshness, team)
}

/// Makes room for all that the stages after the sort need: they cannot stop for want of memory.
fn make_room<const D: usize>(world: &mut Parts<D>) -> Result<()> {
    let Parts { bodies, background, method, conditions, buffers, team, .. } = world;
    buffers.filtering.make_room(method, &background.nodes)?;
    buffers.patches.make_room::<D>(bodies, &background.blocks)?;
    let impulses = conditions.walls.len() * background.blocks.keys().len();
    reserve_exact(&mut buffers.impulses, impulses, "the impulses of walls")?;
    let room = pass::room(bodies, background, method);
    if !team.is_together() {
        return scratch::make_room(room);
    }
    let all = buffers.room.or(room);
    if all != buffers.room {
        team.on_each_thread(|| scratch::make_room(all))?;
        buffers.room = all;
    }
    Ok(())
}

/// Maps mass, momentum and force to the grid, with the loads of the time `at` [s].
fn scatter<const D: usize>(world: &mut Parts<D>, at: f64) {
    let Parts { bodies, background, method, conditions, team, .. } = world;
    particles_to_grid(background, bodies, method, team);
    apply_tractions(&mut conditions.tractions, bodies, background, method, at);
}

/// Updates the grid to the velocities at the end of the step.
fn update<const D: usize>(world: &mut Parts<D>, dt: f64) {
    let gravity = world.gravity(world.clock.time + 0.5 * dt); // [CND-2]
    let Parts { background, method, team, .. } = world;
    update_grid(&mut background.nodes, gravity, method, team, dt);
}

/// Applies walls and prescribed velocities, then damps what they leave.
fn hold<const D: usize>(world: &mut Parts<D>, dt: f64) {
    let Parts { background, conditions, method, buffers, team, clock, .. } = world;
    let when = (clock.time, dt);
    apply_boundaries(background, conditions, method, &mut buffers.impulses, team, when);
    damp_grid::<D>(&mut background.nodes, method.options.damping, team);
}

/// What filters the velocities of XPIC and FMPM; other transfers have nothing to filter.
fn filter<const D: usize>(world: &mut Parts<D>) -> Filter<'_, D> {
    let Parts { bodies, background, method, conditions, buffers, team, .. } = world;
    let Buffers { filtering, impulses, .. } = buffers;
    Filter { bodies, background, method, conditions, filtering, impulses, team }
}

/// From particles to the new velocities of the grid: what all orders have in common.
fn move_grid<const D: usize>(world: &mut Parts<D>, dt: f64) {
    scatter(world, world.clock.time + 0.5 * dt);
    report_tractions(&mut world.conditions.tractions);
    world.hook(HookPoint::AfterScatter, dt);
    update(world, dt);
    hold(world, dt);
    world.hook(HookPoint::AfterBoundaries, dt);
    filter(world).velocities(dt);
}

/// A pass over the particles; `strained` is the time over which gradients strain them [s], if they
/// do.
fn take<const D: usize>(
    world: &mut Parts<D>,
    gather: Gather,
    dt: f64,
    strained: Option<f64>,
) -> Outcome {
    let Parts { bodies, background, method, team, clock, .. } = world;
    let moment = |dt| Moment { time: clock.time, step: clock.step, dt };
    let then = strained.map_or(Then::Nothing, |dt| Then::Stress(moment(dt)));
    (method.kernels.pass)(bodies, background, method, team, &Pass { gather, dt, then })
}

/// Averages the rates of volume of bodies with F-bar.
fn average<const D: usize>(world: &mut Parts<D>, gather: Gather) {
    let Parts { bodies, background, method, buffers, team, .. } = world;
    average_dilation(bodies, background, method, &mut buffers.patches, team, gather);
}

/// Update stress last. D. Sulsky, Z. Chen, H. L. Schreyer, Comput. Methods Appl. Mech. Engrg. 118
/// (1994) 179–196, doi:10.1016/0045-7825(94)90112-0.
fn usl<const D: usize>(world: &mut Parts<D>, dt: f64) -> Outcome {
    move_grid(world, dt);
    average(world, Gather::Gradient);
    take(world, Gather::Everything, dt, Some(dt))
}

/// Modified update stress last: the new particle velocities, with their affine part, are mapped to
/// the grid again, and the velocity gradient is taken of those. (Without the affine part the
/// gradient would come of a field filtered twice and positions of one filtered once: sand would
/// swell by 2 to 3 % in a collapse.) D. Sulsky, S.-J. Zhou, H. L. Schreyer, Comput. Phys. Commun.
/// 87 (1995) 236–252, doi:10.1016/0010-4655(94)00170-7.
fn musl<const D: usize>(world: &mut Parts<D>, dt: f64) -> Outcome {
    move_grid(world, dt);
    take(world, Gather::Velocity, dt, None);
    let Parts { bodies, background, method, conditions, buffers, team, .. } = world;
    velocities_to_grid(background, bodies, method, team, Scattered::Momentum);
    apply_boundaries_again(background, conditions, &mut buffers.impulses, team);
    filter(world).again();
    average(world, Gather::SecondGradient);
    take(world, Gather::PositionAndGradient, dt, Some(dt))
}

/// Update stress first, from the velocities at the start. S. G. Bardenhagen, J. Comput. Phys. 180
/// (2002) 383–403, doi:10.1006/jcph.2002.7103.
fn usf<const D: usize>(world: &mut Parts<D>, dt: f64) -> Outcome {
    let outcome = stress_of_start(world, dt, 1.0);
    move_grid(world, dt);
    take(world, Gather::Motion, dt, None);
    outcome
}

/// Half a stress update from the velocities at the start, half from those at the end. J. A. Nairn,
/// CMES 4 (2003) 649–664, doi:10.3970/cmes.2003.004.649.
fn usavg<const D: usize>(world: &mut Parts<D>, dt: f64) -> Outcome {
    let first = stress_of_start(world, dt, 0.5);
    move_grid(world, dt);
    average(world, Gather::Gradient);
    first.merge(take(world, Gather::Everything, dt, Some(0.5 * dt)))
}

/// Updates the stress over a share of the step from the velocities that the particles have.
fn stress_of_start<const D: usize>(world: &mut Parts<D>, dt: f64, share: f64) -> Outcome {
    let gravity = world.gravity(world.clock.time + 0.5 * dt); // [CND-2]
    scatter(world, world.clock.time);
    update(world, 0.0);
    let Parts { background, conditions, buffers, team, .. } = world;
    hold_velocities(background, conditions, &mut buffers.impulses, team, Some((gravity, dt)));
    filter(world).start();
    average(world, Gather::Gradient);
    take(world, Gather::Gradient, dt, Some(share * dt))
}
