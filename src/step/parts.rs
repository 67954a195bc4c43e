//! A world in parts. A stage takes the parts that it reads and writes; the orders alone see the
//! whole.

use std::sync::Arc;

use super::average_dilation::Patches;
use super::filter_velocities::Filtering;
use super::freshness::Freshness;
use super::hooks::{HOOK_POINTS, Hook, HookArguments, HookPoint};
use super::kernels::Kernels;
use super::locate::Sorting;
use super::options::Options;
use super::pass::Stopwatch;
use super::retry::Start;
use super::time_step::{Limits, limits_of_state, stable_dt};
use crate::background::key::split_node;
use crate::background::{Background, Key, Space};
use crate::boundary::Conditions;
use crate::error::{Place, Result};
use crate::material::scratch::Room;
use crate::memory::reserve;
use crate::parallel::Team;
use crate::particles::Body;
use crate::shape::WallTreatment;
use crate::simd::Isa;

/// How a world computes.
pub struct Method<const D: usize> {
    /// Options as they are now.
    pub options: Options,
    /// Kernels of the options.
    pub kernels: Kernels<D>,
    /// The instruction set.
    pub isa: Isa,
    /// Times the stages of chunks; for benches.
    pub stopwatch: Option<Arc<Stopwatch>>,
}

/// Time and steps.
#[derive(Clone, Copy, Debug, Default)]
pub struct Clock {
    /// Time [s].
    pub time: f64,
    /// Number of steps.
    pub step: i64,
}

impl Clock {
    /// Number and time of what happens now, for errors.
    pub fn place(&self) -> Place {
        Place { step: Some(self.step), time: Some(self.time), ..Place::default() }
    }
}

/// Buffers of the stages, reused from step to step so that they do not allocate.
#[derive(Default)]
pub struct Buffers<const D: usize> {
    /// Of the sort.
    pub sorting: Sorting<D>,
    /// Of the filter of XPIC and FMPM.
    pub filtering: Filtering,
    /// Of F-bar.
    pub patches: Patches,
    /// What a step started from, where the host allows retries.
    pub start: Start,
    /// Momentum that walls gave to the nodes of each block.
    pub impulses: Vec<[f64; 3]>,
    /// Room that all threads of the team have made, as far as they have worked together.
    pub room: Room,
}

/// Hooks of Rust callers.
#[derive(Default)]
pub struct Hooks([Option<Hook>; HOOK_POINTS]);

impl Hooks {
    /// Sets the hook of a point.
    pub fn set(&mut self, point: HookPoint, hook: Option<Hook>) {
        self.0[point as usize] = hook;
    }
}

/// A world in D dimensions.
pub struct Parts<const D: usize> {
    /// The grid.
    pub background: Background<D>,
    /// The bodies, in the order in which they were added.
    pub bodies: Vec<Body>,
    /// Walls, prescribed velocities, tractions, gravity.
    pub conditions: Conditions,
    /// How it computes.
    pub method: Method<D>,
    /// Who computes.
    pub team: Team,
    /// Time and steps.
    pub clock: Clock,
    /// What is current.
    pub freshness: Freshness,
    /// Buffers of the stages.
    pub buffers: Buffers<D>,
    /// Hooks into the step.
    pub hooks: Hooks,
}

impl<const D: usize> Parts<D> {
    /// An empty world; a static grid has its blocks from the start. The options have been checked.
    pub fn new(options: Options, isa: Isa, team: Team) -> Result<Self> {
        let space = options.space();
        let mut background = Background::new(space, options.shape.nodes());
        if let Some(limits) = options.limits() {
            background.set_owners(&blocks_of_box(limits, &options, &space)?, false)?;
            background.blocks.no_change();
        }
        let kernels = Kernels::new(&options, false);
        Ok(Self {
            background,
            bodies: Vec::new(),
            conditions: Conditions::default(),
            method: Method { options, kernels, isa, stopwatch: None },
            team,
            clock: Clock::default(),
            freshness: Freshness::default(),
            buffers: Buffers::default(),
            hooks: Hooks::default(),
        })
    }

    /// Number of particles of all bodies.
    pub fn particle_count(&self) -> usize {
        particle_count(&self.bodies)
    }

    /// Runs the hook of a point, if there is one.
    pub fn hook(&mut self, point: HookPoint, dt: f64) {
        if let Some(hook) = &mut self.hooks.0[point as usize] {
            hook(HookArguments { time: self.clock.time, dt, nodes: &mut self.background });
        }
    }

    /// Gravity at a time [m/s²].
    pub fn gravity(&self, time: f64) -> [f64; 3] {
        self.conditions.gravity(self.method.options.gravity, time)
    }

    /// What limits the next step; the materials compute it if no step left it.
    pub fn limits(&self) -> Result<Limits> {
        match self.freshness.limits() {
            Some(limits) => Ok(limits),
            None => limits_of_state::<D>(&self.bodies, self.method.options.spacing),
        }
    }

    /// The stable time step [s]; infinity without particles.
    pub fn stable_dt(&self) -> Result<f64> {
        if self.particle_count() == 0 {
            return Ok(f64::INFINITY);
        }
        let limits = self.limits()?;
        Ok(stable_dt(&limits, &self.method.options, &self.conditions, self.clock.time))
    }

    /// To be called when particles came or went.
    pub fn particles_changed(&mut self) {
        self.freshness.particles_came_or_went();
        self.team.fit(particle_count(&self.bodies));
    }

    /// To be called when walls came or went.
    pub fn walls_changed(&mut self) {
        if self.method.options.wall_treatment == WallTreatment::Modified {
            let walls = self.conditions.walls.iter().map(|entry| &entry.condition);
            let walls = walls.map(|wall| (wall.axis, wall.side, wall.position));
            self.background.space = self.background.space.with_walls(walls);
            let any = !self.conditions.walls.is_empty();
            self.method.kernels = Kernels::new(&self.method.options, any);
            self.freshness.shapes_changed();
        }
    }
}

/// Number of particles of all bodies.
pub fn particle_count(bodies: &[Body]) -> usize {
    bodies.iter().map(|b| b.particles.len()).sum()
}

/// Blocks that particles within the limits of a static grid may stand in.
fn blocks_of_box<const D: usize>(
    [min, max]: [[f64; 3]; 2],
    options: &Options,
    space: &Space<D>,
) -> Result<Vec<Key<D>>> {
    let margin = f64::from(options.wall_treatment == WallTreatment::Modified); // of walls to come
    let block = |corner: [f64; 3], margin: f64| -> [i64; D] {
        let xi = space.to_units(std::array::from_fn(|d| corner[d]));
        xi.map(|x| split_node((x - space.first_offset + margin).floor() as i64).0)
    };
    let (low, high) = (block(min, -margin), block(max, margin));
    let count: [i64; D] = std::array::from_fn(|d| high[d] - low[d] + 1);
    let all: i64 = count.iter().product();
    let mut blocks = Vec::new();
    reserve(&mut blocks, all as usize, "the blocks of a static grid")?;
    blocks.extend((0..all).map(|flat| {
        let mut rest = flat;
        let mut at = [0; D];
        for d in (0..D).rev() {
            at[d] = (low[d] + rest % count[d]) as i32;
            rest /= count[d];
        }
        Key { layer: 0, at }
    }));
    Ok(blocks)
}
