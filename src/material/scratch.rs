//! Scratch of a chunk: what the stages hand to each other and to the material, one per thread.

use std::cell::RefCell;

use lahar_plugin_abi::{LAHAR_OUTPUT_DIFFUSIVITY, LAHAR_OUTPUT_DT_FACTOR, LAHAR_OUTPUT_ENERGY};

use crate::background::TileNode;
use crate::error::Result;
use crate::material::{Input, Kinematics, Material, Model, StressBatch};
use crate::memory::{Aligned, reserve_exact, stride_of};

/// What memory is for, if there is none.
const WHAT: &str = "the scratch of a chunk";

/// Points for which a thread makes room at once.
const POINTS: usize = 512;

/// Columns of a chunk; component `c` of point `k` at `[c * stride + k]`. Those that the model does
/// not ask for are empty.
pub struct Scratch<'a> {
    /// Number of points.
    pub n: usize,
    /// Distance between components.
    pub stride: usize,
    /// L [1/s], 9 components.
    pub velocity_gradient: &'a mut [f64],
    /// Δε [–], 6 components.
    pub strain_increment: &'a mut [f64],
    /// F at the end of the step [–], 9 components, if the particles carry it or the model asks for
    /// it.
    pub deformation_gradient: &'a mut [f64],
    /// Edge lengths of the domains at the end [m], if the particles carry them.
    pub size1: &'a mut [f64],
    /// Volume at the end [m³].
    pub volume1: &'a mut [f64],
    /// Strain energy at the end [J].
    pub strain_energy1: &'a mut [f64],
    /// σ at the start, rotated if the model asks for that [Pa], 6 components.
    pub stress0: &'a mut [f64],
    /// σ at the end [Pa], 6 components.
    pub stress1: &'a mut [f64],
    /// State at the start.
    pub state0: &'a mut [f64],
    /// State at the end.
    pub state1: &'a mut [f64],
    /// The inputs that the model wants.
    pub inputs: &'a mut [f64],
    /// Wave speed [m/s].
    pub wave_speed: &'a mut [f64],
    /// Kinematic diffusivity [m²/s].
    pub diffusivity: &'a mut [f64],
    /// Stored energy per volume [J/m³].
    pub energy: &'a mut [f64],
    /// Wanted factor on the time step [–].
    pub dt_factor: &'a mut [f64],
    /// Status per point.
    pub status: &'a mut [i32],
    /// The model.
    pub model: &'static Model,
}

/// What particles carry beside what their model asks for.
#[derive(Clone, Copy, Debug, Default)]
pub struct Carried {
    /// Whether they carry F.
    pub deformation_gradient: bool,
    /// Components of the sizes of their domains.
    pub sizes: usize,
}

impl Scratch<'_> {
    /// Values of an input; none if the model does not want it.
    #[inline(always)]
    pub fn input(&mut self, input: Input) -> Option<&mut [f64]> {
        let index = self.model.input(input)?;
        Some(&mut self.inputs[index * self.stride..][..self.stride])
    }

    /// The start stress of point k.
    pub fn stress0_of(&self, k: usize) -> [f64; 6] {
        std::array::from_fn(|c| self.stress0[c * self.stride + k])
    }

    /// The batch that the material sees, with `dt` and `time` zero.
    pub fn batch(&mut self) -> StressBatch<'_> {
        let asked = |wanted, slice| if wanted { slice } else { &[][..] };
        let velocity_gradient = self.model.kinematics == Kinematics::VelocityGradient;
        let gradient = self.model.kinematics == Kinematics::DeformationGradient;
        StressBatch {
            n: self.n,
            stride: self.stride,
            dt: 0.0,
            time: 0.0,
            step: -1,
            strain_increment: asked(
                self.model.kinematics.takes_strain_increment(),
                &*self.strain_increment,
            ),
            velocity_gradient: asked(velocity_gradient, &*self.velocity_gradient),
            deformation_gradient: asked(gradient, &*self.deformation_gradient),
            stress0: &*self.stress0,
            state0: &*self.state0,
            stress1: &mut *self.stress1,
            state1: &mut *self.state1,
            inputs: &*self.inputs,
            wave_speed: &mut *self.wave_speed,
            diffusivity: &mut *self.diffusivity,
            energy: &mut *self.energy,
            dt_factor: &mut *self.dt_factor,
            status: &mut *self.status,
        }
    }
}

/// Room for the scratch of a chunk and a tile, one per thread. It grows once and stays allocated.
#[derive(Default)]
pub struct Buffers {
    points: Points,
    tile: Vec<TileNode>,
}

/// Room for the scratch of a chunk.
#[derive(Default)]
pub struct Points {
    doubles: Aligned,
    status: Vec<i32>,
}

thread_local! {
    static BUFFERS: RefCell<Buffers> = RefCell::default();
}

/// Calls `work` with this thread's scratch for `n` points of a material.
pub fn with_scratch<R>(
    material: &Material,
    n: usize,
    work: impl FnOnce(&mut Scratch<'_>) -> Result<R>,
) -> Result<R> {
    let carried = Carried::default();
    make_room(Room { components: components(material, carried), tile_nodes: 0 })?;
    with_buffers(0, |points, _| work(&mut points.scratch(material, n, carried)))
}

/// How much room a thread needs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Room {
    /// Columns of a chunk.
    pub components: usize,
    /// Nodes of a tile.
    pub tile_nodes: usize,
}

impl Room {
    /// What is enough for both.
    pub fn or(self, other: Self) -> Self {
        Self {
            components: self.components.max(other.components),
            tile_nodes: self.tile_nodes.max(other.tile_nodes),
        }
    }

    /// Room for the chunks of a material.
    pub fn of(material: &Material, carried: Carried, tile_nodes: usize) -> Self {
        Self { components: components(material, carried), tile_nodes }
    }
}

/// Makes room on this thread, for chunks of any length.
pub fn make_room(room: Room) -> Result<()> {
    BUFFERS.with_borrow_mut(|Buffers { points, tile }| {
        reserve_exact(tile, room.tile_nodes, WHAT)?;
        points.make_room(room.components * stride_of(POINTS), stride_of(POINTS))
    })
}

/// Components of all columns of a chunk.
fn components(material: &Material, carried: Carried) -> usize {
    columns(material.model(), carried).iter().sum()
}

/// Components of the columns of a chunk, in the order of [`Scratch`].
fn columns(model: &Model, carried: Carried) -> [usize; 15] {
    let state = model.state_components();
    let gives = |output| usize::from(model.outputs & output != 0);
    let asked = model.kinematics == Kinematics::DeformationGradient;
    let gradient = if asked || carried.deformation_gradient { 9 } else { 0 };
    [
        9,
        6,
        gradient,
        carried.sizes,
        1,
        1,
        6,
        6,
        state,
        state,
        model.inputs.len(),
        1,
        gives(LAHAR_OUTPUT_DIFFUSIVITY),
        gives(LAHAR_OUTPUT_ENERGY),
        gives(LAHAR_OUTPUT_DT_FACTOR),
    ]
}

/// Calls `work` with this thread's room for points and for a tile of `tile_nodes` nodes.
pub fn with_buffers<R>(
    tile_nodes: usize,
    work: impl FnOnce(&mut Points, &mut [TileNode]) -> R,
) -> R {
    BUFFERS.with_borrow_mut(|Buffers { points, tile }| {
        if tile.len() < tile_nodes {
            tile.resize(tile_nodes, TileNode::default());
        }
        work(points, &mut tile[..tile_nodes])
    })
}

impl Points {
    fn make_room(&mut self, doubles: usize, points: usize) -> Result<()> {
        if self.doubles.as_slice().len() < doubles {
            self.doubles = Aligned::zeroed(doubles.max(64 * POINTS))?;
        }
        if self.status.len() < points {
            let points = points.max(POINTS + 8);
            reserve_exact(&mut self.status, points, WHAT)?;
            self.status.resize(points, 0);
        }
        Ok(())
    }

    /// The scratch for `n` points of a material.
    pub fn scratch(&mut self, material: &Material, n: usize, carried: Carried) -> Scratch<'_> {
        let model = material.model();
        let stride = stride_of(n);
        let sizes = columns(model, carried);
        let needed = sizes.iter().sum::<usize>() * stride;
        self.make_room(needed, stride).expect("room was made before");
        let mut rest = self.doubles.as_mut_slice();
        let mut sizes = sizes.into_iter();
        let mut take = || {
            let doubles = sizes.next().unwrap_or(0) * stride;
            rest.split_off_mut(..doubles).unwrap_or_default()
        };
        let status = &mut self.status[..stride];
        status.fill(0);
        Scratch {
            n,
            stride,
            velocity_gradient: take(),
            strain_increment: take(),
            deformation_gradient: take(),
            size1: take(),
            volume1: take(),
            strain_energy1: take(),
            stress0: take(),
            stress1: take(),
            state0: take(),
            state1: take(),
            inputs: take(),
            wave_speed: take(),
            diffusivity: take(),
            energy: take(),
            dt_factor: take(),
            status,
            model,
        }
    }
}
