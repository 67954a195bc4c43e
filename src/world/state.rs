//! The state of a world in D dimensions: what the stages of a step work on.

use std::sync::Arc;

use crate::background::key::split_node;
use crate::background::{Grid, GridPolicy, Key, Run, TileNode, Tiles};
use crate::boundary::Wall;
use crate::context::Context;
use crate::error::{Error, Place, Result};
use crate::material::Material;
use crate::material::scratch::{Scratch, with_buffers};
use crate::memory::reserve;
use crate::particles::{ChunkMut, Particles, for_each_task};
use crate::shape::stencil::{At, ShapeFunction, Stencil};
use crate::shape::{ShapeKind, WallTreatment};
use crate::simd::{Isa, Real, each};
use crate::step::average_dilation::Patches;
use crate::step::filter_velocities::Filtered;
use crate::step::grid_to_particles::GatherKernel;
use crate::step::hooks::{HOOK_POINTS, Hook, HookArguments, HookPoint};
use crate::step::kernels::Kernels;
use crate::step::locate::Sorting;
use crate::step::options::Options;
use crate::step::retry::Start;
use crate::step::time_step::Limits;
use crate::step::update_stress::{Outcome, Unreliable, Wish};
use crate::transfer::TransferKind;

use super::conditions::Conditions;

/// Below this number of particles a step is serial: threads would cost more than they bring.
const SERIAL_BELOW: usize = 4096;

/// How far below an upper wall, in cells, a position on it counts to be: its stencil must not begin a cell further.
const BELOW_WALL: f64 = 1e-9;

fn below(wall: f64) -> f64 {
    if wall.is_finite() { wall - BELOW_WALL * (1.0 + wall.abs()) } else { wall }
}

/// The place of the grid in space.
#[derive(Clone, Copy, Debug)]
pub struct Space<const D: usize> {
    /// Position of node 0 [m].
    pub origin: [f64; D],
    /// Distance of nodes [m].
    pub spacing: f64,
    /// One over the distance [1/m].
    pub inverse: f64,
    /// The lowest node of a stencil is floor(ξ − first_offset).
    pub first_offset: f64,
    /// Distance, in cells, at which nodes feel a wall.
    pub wall_reach: f64,
    /// Nodes of the walls below and above along each axis, next to which shape functions are modified; infinite if they are not.
    pub walls: [[f64; 2]; D],
    /// Positions between those walls.
    inside: [[f64; 2]; D],
}

impl<const D: usize> Space<D> {
    /// Position in units of the spacing, from node 0.
    #[inline(always)]
    pub fn to_units<R: Real>(&self, x: [R; D]) -> [R; D] {
        let inverse = R::splat(self.inverse);
        each!(d in D => (x[d] - R::splat(self.origin[d])) * inverse)
    }

    /// The same; what is behind a wall that modifies shape functions counts as on it.
    #[inline(always)]
    pub fn between_walls<R: Real>(&self, x: [R; D]) -> [R; D] {
        let xi = self.to_units(x);
        each!(d in D => xi[d].max(R::splat(self.inside[d][0])).min(R::splat(self.inside[d][1])))
    }

    /// The stencil of particles with edges `size` [m].
    #[inline(always)]
    pub fn stencil<R: Real, S: ShapeFunction<N>, const N: usize>(
        &self,
        x: [R; D],
        size: [R; D],
    ) -> Stencil<R, N, D> {
        let xi = if S::MODIFIED { self.between_walls(x) } else { self.to_units(x) };
        let mut axes = [S::axis(self.at(0, xi[0], size[0])); D];
        for d in 1..D {
            axes[d] = S::axis(self.at(d, xi[d], size[d]));
        }
        Stencil { axes }
    }

    #[inline(always)]
    fn at<R: Real>(&self, d: usize, xi: R, size: R) -> At<R> {
        let [low, high] = self.walls[d];
        let half = size * R::splat(0.5 * self.inverse);
        At { xi, half, walls: [R::splat(low), R::splat(high)] }
    }

    /// Where any shape function is wanted for a point without extent.
    pub fn at_point(&self, x: [f64; D], size: [f64; D]) -> [At<f64>; D] {
        let xi = self.between_walls(x);
        std::array::from_fn(|d| self.at(d, xi[d], size[d]))
    }
}

/// Edge lengths of the domains of a body's particles when it was added [m]; in two dimensions the third is 1.
#[derive(Clone, Debug)]
pub enum Sizes {
    /// The host gave none.
    Unknown,
    /// The same for all.
    Uniform([f64; 3]),
    /// By id.
    Each(Vec<[f64; 3]>),
}

impl Sizes {
    /// Edge lengths of the particle with this id [m]; None if they are not known.
    pub fn of(&self, id: i64) -> Option<[f64; 3]> {
        match self {
            Self::Unknown => None,
            Self::Uniform(size) => Some(*size),
            Self::Each(sizes) => sizes.get(usize::try_from(id).ok()?).copied(),
        }
    }
}

/// A body: particles of one material.
pub struct Body {
    /// Id, never reused.
    pub id: i64,
    /// The material.
    pub material: Arc<Material>,
    /// The particles, sorted by block.
    pub particles: Particles,
    /// Particles of each block.
    pub runs: Vec<Run>,
    /// Edge lengths of the particles at first.
    pub sizes: Sizes,
}

impl Body {
    /// Whether the body has F-bar.
    pub fn has_f_bar(&self) -> bool {
        self.particles.layout.has_dilation()
    }
}

/// A wall with its id and the force that it put on the material in the last step [N].
#[derive(Clone, Copy, Debug)]
pub struct WallEntry {
    /// Id, never reused.
    pub id: i64,
    /// The wall.
    pub wall: Wall,
    /// Force on the material [N].
    pub reaction: [f64; 3],
}

/// A world in D dimensions.
pub struct State<const D: usize> {
    /// Threads, log and plugins.
    pub context: Arc<Context>,
    /// Options as they are now.
    pub options: Options,
    /// Kernels of the shape function.
    pub kernels: Kernels<D>,
    /// The grid.
    pub grid: Grid<D>,
    /// The tiles.
    pub tiles: Tiles,
    /// The bodies, in the order in which they were added.
    pub bodies: Vec<Body>,
    /// The walls, in the order in which they were added.
    pub walls: Vec<WallEntry>,
    /// The other conditions.
    pub conditions: Conditions,
    /// Momentum that walls gave to the nodes of each block in a step.
    pub impulses: Vec<[f64; 3]>,
    /// Velocities of nodes on their way through a filter; used by filtered transfers alone.
    pub filtered: Vec<Filtered>,
    /// Sums of F-bar.
    pub patches: Patches,
    /// What a step started from, where the host allows retries.
    pub start: Start,
    /// Buffers of the sort.
    pub sorting: Sorting<D>,
    /// Particles came or went since the last sort.
    pub regroup: bool,
    /// Positions may have changed outside a step since the last sort, without marks of moved particles.
    pub rescan: bool,
    /// Whether steps use the threads of the context.
    pub parallel: bool,
    /// What the last step's stress updates said of their accuracy.
    pub unreliable: Option<Unreliable>,
    /// The smallest step that a point asked for in the last step.
    pub wish: Option<Wish>,
    /// The grid holds a step that was taken back.
    pub stale: bool,
    /// Limits of the next time step; None if the host changed something since they were found.
    pub limits: Option<Limits>,
    /// Time [s].
    pub time: f64,
    /// Number of steps.
    pub step_count: i64,
    /// Times the stages of chunks; for benches.
    pub stopwatch: Option<Arc<Stopwatch>>,
    hooks: [Option<Hook>; HOOK_POINTS],
}

impl<const D: usize> State<D> {
    /// An empty world; a static grid has its blocks from the start. The options have been checked.
    pub fn new(context: Arc<Context>, options: Options) -> Result<Self> {
        let origin = std::array::from_fn(|d| options.origin[d]);
        let mut world = Self {
            kernels: Kernels::new(&options),
            grid: Grid::new(options.spacing, origin),
            tiles: Tiles::new(options.shape.nodes()),
            context,
            options,
            bodies: Vec::new(),
            walls: Vec::new(),
            conditions: Conditions::default(),
            impulses: Vec::new(),
            filtered: Vec::new(),
            patches: Patches::default(),
            start: Start::default(),
            sorting: Sorting::default(),
            regroup: true,
            rescan: true,
            parallel: false,
            unreliable: None,
            wish: None,
            stale: false,
            limits: None,
            time: 0.0,
            step_count: 0,
            stopwatch: None,
            hooks: [const { None }; HOOK_POINTS],
        };
        if world.options.grid_policy == GridPolicy::Static {
            let blocks = world.blocks_of_box()?;
            world.grid.set_owners(&blocks, false)?;
        }
        Ok(world)
    }

    /// A point asked for a smaller step than that which was made.
    pub fn wished(&self) -> Error {
        let text = "a material asks for a smaller step";
        let Some(Wish { factor, body, particle }) = self.wish else { return Error::invalid(text) };
        let model = self.body(body).map_or("?", |b| b.material.model().name);
        let text = format!(
            "{text}: `{model}` for particle {particle} of body {body}, by the factor {factor:e}"
        );
        let place = Place { body: Some(body), particle: Some(particle), ..self.place() };
        Error::invalid(text).at(place)
    }

    /// Origin, spacing and the two figures of the shape function.
    pub fn space(&self) -> Space<D> {
        let modified = self.options.modifies_shapes();
        let mut walls = [[f64::NEG_INFINITY, f64::INFINITY]; D];
        for Wall { axis, side, position, .. } in self.walls.iter().map(|entry| entry.wall) {
            if modified {
                let node = ((position - self.grid.origin[axis]) / self.options.spacing).round();
                walls[axis][usize::from(side < 0)] = node;
            }
        }
        Space {
            origin: self.grid.origin,
            spacing: self.options.spacing,
            inverse: 1.0 / self.options.spacing,
            first_offset: self.options.shape.first_offset(),
            wall_reach: match self.options.wall_treatment {
                WallTreatment::Plain => self.options.shape.wall_reach(),
                WallTreatment::Modified => 0.0,
            },
            walls,
            inside: walls.map(|[low, high]| [low, below(high)]),
        }
    }

    /// Whether a position lies in the box of a static grid; true for other grids.
    pub fn inside_box(&self, x: &[f64; D]) -> bool {
        let (min, max) = (&self.options.box_min, &self.options.box_max);
        self.options.grid_policy != GridPolicy::Static
            || (0..D).all(|d| min[d] <= x[d] && x[d] <= max[d])
    }

    /// Blocks that particles in the box of a static grid may stand in.
    fn blocks_of_box(&self) -> Result<Vec<Key<D>>> {
        let space = self.space();
        let block = |corner: [f64; 3]| -> [i64; D] {
            let xi = space.to_units(std::array::from_fn(|d| corner[d]));
            xi.map(|x| split_node((x - space.first_offset).floor() as i64).0)
        };
        let (low, high) = (block(self.options.box_min), block(self.options.box_max));
        let count: [i64; D] = std::array::from_fn(|d| high[d] - low[d] + 1);
        let all: i64 = count.iter().product();
        let mut blocks = Vec::new();
        reserve(&mut blocks, all as usize, "the blocks of a static grid")?;
        blocks.extend((0..all).map(|flat| {
            let mut rest = flat;
            let mut key = [0; D];
            for d in (0..D).rev() {
                key[d] = (low[d] + rest % count[d]) as i32;
                rest /= count[d];
            }
            key
        }));
        Ok(blocks)
    }

    /// Number and step of what happens now, for errors.
    pub fn place(&self) -> Place {
        Place { step: Some(self.step_count), time: Some(self.time), ..Place::default() }
    }

    /// Number of particles of all bodies.
    pub fn particle_count(&self) -> usize {
        self.bodies.iter().map(|b| b.particles.len()).sum()
    }

    /// Whether a step of this world uses the threads of the context.
    pub fn parallel(&self) -> bool {
        self.parallel
    }

    /// To be called when particles came or went.
    pub fn particles_changed(&mut self) {
        (self.regroup, self.rescan) = (true, true);
        self.limits = None;
        self.parallel = self.context.threads() > 1 && self.particle_count() >= SERIAL_BELOW;
    }

    /// Sets the hook of a point.
    pub fn set_hook(&mut self, point: HookPoint, hook: Option<Hook>) {
        self.hooks[point as usize] = hook;
    }

    /// Runs the hook of a point, if there is one.
    pub fn hook(&mut self, point: HookPoint, dt: f64) {
        if let Some(hook) = &mut self.hooks[point as usize] {
            hook(HookArguments { time: self.time, dt, nodes: &mut self.grid });
        }
    }

    /// Runs the last stages of a step on every chunk of every body.
    pub fn for_each_chunk(
        &mut self,
        work: impl Fn(&mut Piece<'_, '_, D>) -> Outcome + Sync,
    ) -> Outcome {
        let space = self.space();
        let tile_nodes = self.tiles.tile_nodes(D);
        let Self { bodies, grid, options, kernels, context, time, parallel, stopwatch, .. } = self;
        let step = self.step_count;
        let mut outcome = Outcome::default();
        for body in bodies {
            let Body { id, material, particles, runs, .. } = body;
            let (ids, all) = particles.ids_and_chunk();
            let on_task = |task: ChunkMut<'_>| {
                if *parallel {
                    context.mark_worker();
                }
                with_buffers(tile_nodes, |points, tile| {
                    let (mut of_task, mut loaded) = (Outcome::default(), None);
                    task.for_each_chunk(|chunk| {
                        let piece = &mut Piece {
                            scratch: points.scratch(material, chunk.len),
                            chunk,
                            tile,
                            loaded: &mut loaded,
                            body: *id,
                            ids,
                            material,
                            runs,
                            grid,
                            isa: context.isa(),
                            space,
                            gather: kernels.gather,
                            transfer: options.transfer,
                            pic_rate: options.pic_rate,
                            axisymmetric: options.axisymmetric,
                            resize: options.shape == ShapeKind::ContiguousGimp,
                            time: *time,
                            step,
                            stopwatch: stopwatch.as_deref(),
                        };
                        piece.lap(ChunkStage::Start);
                        let of_chunk = work(piece);
                        of_task = std::mem::take(&mut of_task).merge(of_chunk);
                    });
                    of_task
                })
            };
            let of_body = for_each_task(all, *parallel, &on_task, &Outcome::merge);
            outcome = outcome.merge(of_body);
        }
        outcome
    }
}

/// Where in the last stages of a step a chunk has arrived.
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

/// Who is told about each chunk and stage, on the thread that works on it.
pub type Stopwatch = dyn Fn(ChunkStage) + Send + Sync;

/// A chunk of particles on its way through the last stages of a step.
pub struct Piece<'c, 's, const D: usize> {
    /// The particles.
    pub chunk: &'s mut ChunkMut<'c>,
    /// What the stages hand to each other.
    pub scratch: Scratch<'s>,
    /// Room for a copy of the grid around a block.
    pub tile: &'s mut [TileNode],
    /// The block whose nodes stand in the tile.
    pub loaded: &'s mut Option<u32>,
    /// Id of the body.
    pub body: i64,
    /// Ids of all particles of the body, in storage order.
    pub ids: &'s [i64],
    /// The material.
    pub material: &'s Material,
    /// The runs of the body.
    pub runs: &'s [Run],
    /// The grid.
    pub grid: &'s Grid<D>,
    /// The instruction set.
    pub isa: Isa,
    /// Origin and spacing.
    pub space: Space<D>,
    /// The gather of the shape function.
    pub gather: GatherKernel<D>,
    /// The transfer scheme.
    pub transfer: TransferKind,
    /// Rate of PIC [1/s].
    pub pic_rate: f64,
    /// Whether x is a radius.
    pub axisymmetric: bool,
    /// Whether the domains of particles follow their stretch.
    pub resize: bool,
    /// Time at the start of the step [s].
    pub time: f64,
    /// Number of steps before this one.
    pub step: i64,
    stopwatch: Option<&'s Stopwatch>,
}

impl<const D: usize> Piece<'_, '_, D> {
    /// Tells the stopwatch, if there is one, that a stage is done.
    #[inline]
    pub fn lap(&self, stage: ChunkStage) {
        if let Some(stopwatch) = self.stopwatch {
            stopwatch(stage);
        }
    }
}
