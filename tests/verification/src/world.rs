//! What drivers share: contexts, materials, worlds, fields.

use lahar::boundary::{Wall, WallKind};
use lahar::context::Context;
use lahar::error::{Error, Result, Status};
use lahar::material::Material;
use lahar::particles::seeding::{Fill, Region};
use lahar::shape::{ShapeKind, WallTreatment};
use lahar::step::StepOrder;
use lahar::transfer::TransferKind;
use lahar::world::World;
use lahar::world::host_arrays::{ParticleArrays, Strided, StridedMut, Strides};
use lahar::world::options::Options;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};
use std::sync::Arc;

/// The choices of the method that every family takes: key `method` of a set-up.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Method {
    /// Shape function.
    #[serde(deserialize_with = "shape")]
    pub shape: ShapeKind,
    /// Transfer scheme.
    pub transfer: Transfer,
    /// Rate at which PIC damps FLIP [1/s].
    pub pic_rate: f64,
    /// Order of the stages.
    pub order: StepOrder,
    /// Courant number.
    pub cfl: f64,
    /// What shape functions do next to walls.
    pub walls: Walls,
    /// How far the nodes stand from the walls at multiples of the spacing, in units of it.
    pub grid_offset: f64,
    /// Terms of the filter of XPIC and FMPM.
    pub filter_order: i32,
}

impl Default for Method {
    fn default() -> Self {
        Self {
            shape: ShapeKind::QuadraticBspline,
            transfer: Transfer::Of(TransferKind::PicFlip),
            pic_rate: 0.0,
            order: StepOrder::Musl,
            cfl: 0.4,
            walls: Walls::Of(WallTreatment::Modified),
            grid_offset: 0.0,
            filter_order: 2,
        }
    }
}

/// A shape function by its key; splines by their degree alone.
fn shape<'de, D: Deserializer<'de>>(source: D) -> std::result::Result<ShapeKind, D::Error> {
    let key = String::deserialize(source)?;
    match key.as_str() {
        "quadratic" => Ok(ShapeKind::QuadraticBspline),
        "cubic" => Ok(ShapeKind::CubicBspline),
        key => ShapeKind::from_key(key).map_err(D::Error::custom),
    }
}

/// What holds shapes back at walls, and where walls stand.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(try_from = "String")]
pub enum Walls {
    /// Plain, and walls on node planes whatever the shape: the nodes on them and behind are held.
    PlainOnNodes,
    /// A treatment of the engine; where walls stand, see [`Method::wall_shift`].
    Of(WallTreatment),
}

impl TryFrom<String> for Walls {
    type Error = Error;

    fn try_from(key: String) -> Result<Self> {
        match key.as_str() {
            "plain_on_nodes" => Ok(Self::PlainOnNodes),
            key => WallTreatment::from_key(key).map(Self::Of),
        }
    }
}

/// Transfer schemes by name.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(try_from = "String")]
pub enum Transfer {
    /// PIC alone.
    Pic,
    /// A scheme of the engine; PIC replaces FLIP at `pic_rate`.
    Of(TransferKind),
}

impl TryFrom<String> for Transfer {
    type Error = Error;

    fn try_from(key: String) -> Result<Self> {
        match key.as_str() {
            "pic" => Ok(Self::Pic),
            "flip" => Ok(Self::Of(TransferKind::PicFlip)),
            key => TransferKind::from_key(key).map(Self::Of),
        }
    }
}

impl Method {
    /// Options of a plane world with this method.
    pub fn options(&self, spacing: f64) -> Options {
        let (transfer, pic_rate) = match self.transfer {
            Transfer::Pic => (TransferKind::PicFlip, f64::INFINITY),
            Transfer::Of(TransferKind::PicFlip) => (TransferKind::PicFlip, self.pic_rate),
            Transfer::Of(other) => (other, 0.0),
        };
        Options {
            dimension: 2,
            spacing,
            shape: self.shape,
            transfer,
            pic_rate,
            order: self.order,
            cfl: self.cfl,
            wall_treatment: match self.walls {
                Walls::PlainOnNodes => WallTreatment::Plain,
                Walls::Of(treatment) => treatment,
            },
            filter_order: self.filter_order,
            ..Options::default()
        }
    }

    /// How far the origin of the grid is shifted, in units of the spacing: by `grid_offset`, and where functions are not
    /// modified so that walls at multiples of the spacing hold no free node's function back, which is half a cell for quadratic splines.
    pub fn wall_shift(&self) -> f64 {
        let shifted = (ShapeKind::QuadraticBspline, Walls::Of(WallTreatment::Plain));
        self.grid_offset + if (self.shape, self.walls) == shifted { 0.5 } else { 0.0 }
    }
}

/// A context of one thread with the plugin of a model, `linear_elastic` for example.
///
/// The shared library is looked for beside the running program and one folder above, where cargo puts it.
pub fn context(model: &str) -> Result<Arc<Context>> {
    let context = Context::new(Some(1))?;
    let exe = std::env::current_exe().unwrap_or_default();
    let file = format!("liblahar_{model}.so");
    let found =
        exe.ancestors().skip(1).take(2).map(|folder| folder.join(&file)).find(|p| p.is_file());
    context.load_plugin(
        found.and_then(|p| p.to_str().map(String::from)).as_deref().unwrap_or(&file),
    )?;
    Ok(context)
}

/// Models of elasticity by name.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Elastic {
    /// Strain increments and their rotation.
    #[default]
    LinearElastic,
    /// From the deformation gradient.
    NeoHookean,
}

impl Elastic {
    /// A material and its context.
    pub fn material(
        self,
        youngs_modulus: f64,
        poissons_ratio: f64,
    ) -> Result<(Arc<Context>, Arc<Material>)> {
        let model = match self {
            Self::LinearElastic => "linear_elastic",
            Self::NeoHookean => "neo_hookean",
        };
        let values = [("youngs_modulus", youngs_modulus), ("poissons_ratio", poissons_ratio)];
        material(model, &values)
    }
}

/// A material of any shipped model and its context.
pub fn material(model: &str, values: &[(&str, f64)]) -> Result<(Arc<Context>, Arc<Material>)> {
    let context = context(model)?;
    let material = Material::new(&context, model, values)?;
    Ok((context, material))
}

/// Adds a wall: `axis` 0 is x, `side` +1 if the material is on the side of larger coordinates.
pub fn wall(
    world: &mut World,
    kind: WallKind,
    axis: usize,
    side: i32,
    position: f64,
) -> Result<i64> {
    world.add_wall(&Wall { axis, side, position, kind, friction: 0.0 })
}

/// A body in a region.
pub fn fill(
    world: &mut World,
    material: &Arc<Material>,
    region: &Region,
    density: f64,
    particles_per_cell: i32,
) -> Result<i64> {
    world.add_shape(material, region, &Fill { density, particles_per_cell, ..Fill::default() })
}

/// Steps that no run needs: a world that comes to them has become too fast or too stiff for its grid.
const MOST_STEPS: i64 = 1_000_000;

/// Steps until a time; too many steps are an error, since a run that has blown up takes ever smaller ones.
pub fn advance(world: &mut World, until: f64) -> Result<()> {
    world.advance(until, MOST_STEPS - world.step_count()).1?;
    if world.time() < until {
        let text = format!("{MOST_STEPS} steps have not reached {until} s but {} s", world.time());
        return Err(Error::new(Status::StepTooLarge, text));
    }
    Ok(())
}

/// An axis-aligned box of the plane.
pub fn rectangle(min: [f64; 2], max: [f64; 2]) -> Region {
    Region::Box { min: [min[0], min[1], 0.0], max: [max[0], max[1], 0.0] }
}

/// A disc.
pub fn disc(center: [f64; 2], radius: f64) -> Region {
    Region::Sphere { center: [center[0], center[1], 0.0], radius }
}

/// A field of a body in the order of the ids, point after point.
pub fn read(world: &World, body: i64, field: &str) -> Result<Vec<f64>> {
    let info = world.field_info(body, field)?;
    let n = world.particle_count(body)?;
    let mut out = vec![0.0; n * info.components];
    let strides = Strides::new(n, info.components, 0, 0)?;
    world.read_field(body, field, &mut StridedMut::new(&mut out, strides)?)?;
    Ok(out)
}

/// Sets a field of a body in the order of the ids, point after point.
pub fn write(world: &mut World, body: i64, field: &str, data: &[f64]) -> Result<()> {
    let components = world.field_info(body, field)?.components;
    world.write_field(body, field, &Strided::interleaved(data, components)?)
}

/// Sets the velocities of a body, and their gradients [xx, xy, yx, yy] if its particles carry an affine matrix.
pub fn write_flow(
    world: &mut World,
    body: i64,
    flow: impl Fn(&[f64; 2]) -> ([f64; 2], [f64; 4]),
) -> Result<()> {
    let (v, gradient): (Vec<[f64; 2]>, Vec<[f64; 4]>) =
        positions(world, body)?.iter().map(flow).unzip();
    write(world, body, "velocity", v.as_flattened())?;
    if world.options().transfer.is_affine() {
        write(world, body, "affine", gradient.as_flattened())?;
    }
    Ok(())
}

/// Positions in the plane, in the order of the ids.
pub fn positions(world: &World, body: i64) -> Result<Vec<[f64; 2]>> {
    Ok(read(world, body, "position")?.as_chunks().0.to_vec())
}

/// A body from the positions, volumes, masses and stresses of its particles.
pub struct Cloud {
    /// Positions [m].
    pub position: Vec<[f64; 2]>,
    /// Volumes [m³].
    pub volume: Vec<f64>,
    /// Masses [kg].
    pub mass: Vec<f64>,
    /// Cauchy stress, xx, yy, zz, xy, yz, zx [Pa].
    pub stress: Vec<[f64; 6]>,
}

impl Cloud {
    /// Points on the lattice of a rectangle from `min`, with a pitch; the volume at rest is that of the lattice.
    ///
    /// `pressure(y)` is the pressure [Pa], which with a bulk modulus compresses a fluid of p = K (V0 / V − 1).
    pub fn fluid_at_rest(
        min: [f64; 2],
        count: [usize; 2],
        pitch: f64,
        (density, bulk): (f64, f64),
        pressure: impl Fn(f64) -> f64,
    ) -> Self {
        let position = lattice(min, count, pitch);
        let p: Vec<f64> = position.iter().map(|x| pressure(x[1])).collect();
        Self {
            volume: p.iter().map(|p| pitch * pitch / (1.0 + p / bulk)).collect(),
            mass: vec![density * pitch * pitch; p.len()],
            stress: p.iter().map(|p| [-p, -p, -p, 0.0, 0.0, 0.0]).collect(),
            position,
        }
    }

    /// Adds the body to a world.
    pub fn add(&self, world: &mut World, material: &Arc<Material>) -> Result<i64> {
        let arrays = ParticleArrays {
            position: Strided::interleaved(self.position.as_flattened(), 2)?,
            volume: Strided::interleaved(&self.volume, 1)?,
            mass: Some(Strided::interleaved(&self.mass, 1)?),
            density: 0.0,
            velocity: None,
            stress: Some(Strided::interleaved(self.stress.as_flattened(), 6)?),
            size: None,
        };
        world.add_particles(material, &arrays)
    }
}

/// Centres of the squares of a lattice, row after row.
pub fn lattice(min: [f64; 2], count: [usize; 2], pitch: f64) -> Vec<[f64; 2]> {
    let at = |n: usize, from: f64| from + (n as f64 + 0.5) * pitch;
    (0..count[1]).flat_map(|j| (0..count[0]).map(move |i| [at(i, min[0]), at(j, min[1])])).collect()
}
