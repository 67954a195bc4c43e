//! A pass over the particles, chunk by chunk while they are in cache: stages 5 to 8.

use super::average_dilation::{share_dilation, store_rates};
use super::commit::commit;
use super::grid_to_particles::{Gather, gather};
use super::parts::Method;
use super::update_strain::update_strain;
use super::update_stress::{Answer, Failure, Outcome, update_stress};
use crate::background::{Background, TileNode};
use crate::material::Material;
use crate::material::scratch::{Carried, Points, Room, Scratch, with_buffers};
use crate::parallel::Team;
use crate::particles::{Body, ChunkMut, Layout};
use crate::shape::ShapeKind;
use crate::shape::stencil::ShapeFunction;

/// What a pass does.
#[derive(Clone, Copy, Debug)]
pub struct Pass {
    /// What particles take from the grid.
    pub gather: Gather,
    /// The step over which they move [s].
    pub dt: f64,
    /// What follows.
    pub then: Then,
}

/// What follows the gather in a pass.
#[derive(Clone, Copy, Debug)]
pub enum Then {
    /// Nothing.
    Nothing,
    /// Bodies with F-bar store the rates at which their particles grow; others are skipped.
    Rates,
    /// Strain and stress are updated.
    Stress(Moment),
}

/// When the stress is updated, and over what time.
#[derive(Clone, Copy, Debug)]
pub struct Moment {
    /// Time at the start of the step [s].
    pub time: f64,
    /// Number of steps before this one.
    pub step: i64,
    /// Time over which velocity gradients hold [s].
    pub dt: f64,
}

/// The last stage of a pass that a chunk has finished.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChunkStage {
    /// Nothing is done.
    Start,
    /// Grid to particles is done.
    Gathered,
    /// The strain is updated.
    Strained,
    /// The stress is updated.
    Stressed,
}

/// Called for each chunk after each stage, on the thread that works on it.
pub type Stopwatch = dyn Fn(ChunkStage) + Send + Sync;

/// A chunk of a body's particles in a pass, with what its stages read and write.
pub struct ChunkWork<'c, 's> {
    /// The particles.
    pub chunk: &'s mut ChunkMut<'c>,
    /// What one stage leaves for the next.
    pub scratch: Scratch<'s>,
    /// Id of the body.
    pub body: i64,
    /// Ids of all particles of the body, in storage order.
    pub ids: &'s [i64],
    /// The material.
    pub material: &'s Material,
}

/// The copy of the grid around a block from which its particles gather, and the slot of the block,
/// if there is one already.
pub struct Copied<'a> {
    /// The copy.
    pub tile: &'a mut [TileNode],
    /// The slot.
    pub block: Option<u32>,
}

/// Whole-stage entry of the kernel table: a pass over all bodies.
pub fn pass<S: ShapeFunction<N>, const N: usize, const D: usize>(
    bodies: &mut [Body],
    background: &Background<D>,
    method: &Method<D>,
    team: &Team,
    pass: &Pass,
) -> Outcome {
    let tile_nodes = background.tiles.tile_nodes(D);
    let mut outcome = Outcome::default();
    for body in bodies {
        if matches!(pass.then, Then::Rates) && !body.has_f_bar() {
            continue;
        }
        let Body { id, material, particles, runs, .. } = body;
        let (ids, all) = particles.ids_and_chunk();
        let carried = carried::<D>(&all.layout, method);
        let on_task = |task: ChunkMut<'_>| {
            with_buffers(tile_nodes, |points: &mut Points, tile| {
                let mut of_task = Outcome::default();
                let mut copied = Copied { tile, block: None };
                task.for_each_chunk(|chunk| {
                    let scratch = points.scratch(material, chunk.len, carried);
                    let work = &mut ChunkWork { chunk, scratch, body: *id, ids, material };
                    method.lap(ChunkStage::Start);
                    gather::<S, N, D>(work, (background, runs), &mut copied, method, pass);
                    of_task.add(after_gather::<D>(work, method, pass));
                });
                of_task
            })
        };
        outcome.add(team.fold(all, &on_task, &Outcome::merge));
    }
    outcome
}

/// What the particles of a body carry beside what their model asks for.
fn carried<const D: usize>(layout: &Layout, method: &Method<D>) -> Carried {
    Carried {
        deformation_gradient: layout.deformation_gradient.is_some(),
        sizes: if method.options.shape == ShapeKind::ContiguousGimp { D } else { 0 },
    }
}

/// The room that a thread needs in a pass over all bodies.
pub fn room<const D: usize>(
    bodies: &[Body],
    background: &Background<D>,
    method: &Method<D>,
) -> Room {
    let tile_nodes = background.tiles.tile_nodes(D);
    let of =
        |body: &Body| Room::of(&body.material, carried(&body.particles.layout, method), tile_nodes);
    bodies.iter().map(of).fold(Room::default(), Room::or)
}

/// The stages of a pass that do not depend on the shape function.
fn after_gather<const D: usize>(
    work: &mut ChunkWork<'_, '_>,
    method: &Method<D>,
    pass: &Pass,
) -> Outcome {
    method.lap(ChunkStage::Gathered);
    match pass.then {
        Then::Nothing => Outcome::default(),
        Then::Rates => {
            store_rates(work);
            Outcome::default()
        }
        Then::Stress(moment) => {
            share_dilation::<D>(work, method.options.axisymmetric);
            let outcome = match evaluate::<D>(work, method, moment) {
                Ok(answer) => commit::<D>(work, method.isa, moment, answer),
                Err(failure) => Outcome::failed(failure),
            };
            method.lap(ChunkStage::Stressed);
            outcome
        }
    }
}

/// Strain and stress of a chunk over a moment, in scratch: what an implicit solver calls as often
/// as it likes.
pub fn evaluate<const D: usize>(
    work: &mut ChunkWork<'_, '_>,
    method: &Method<D>,
    moment: Moment,
) -> Result<Answer, Box<Failure>> {
    update_strain::<D>(work, method, moment.dt);
    method.lap(ChunkStage::Strained);
    update_stress::<D>(work, moment)
}

impl<const D: usize> Method<D> {
    /// Reports to the stopwatch, if there is one, that a chunk has finished a stage.
    #[inline]
    fn lap(&self, stage: ChunkStage) {
        if let Some(stopwatch) = &self.stopwatch {
            stopwatch(stage);
        }
    }
}
