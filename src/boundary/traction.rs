//! Tractions on the surfaces of bodies, and which particles carry them.

use super::{BoxRegion, Condition, Table};
use crate::error::{Error, Place, Result};
use crate::memory::{collect, reserve};
use crate::particles::Body;

/// What memory is for, if there is none.
const WHAT: &str = "the particles of a surface";

/// A dead load on a plane surface of a body: force per area of the surface as it was when the body
/// was added.
#[derive(Clone, Debug)]
pub struct Traction {
    /// Id of the body.
    pub body: i64,
    /// Where: the particles with their centres in this box; it must hold one layer of them.
    pub region: BoxRegion,
    /// Axis of the outward normal: 0, 1 or 2.
    pub axis: usize,
    /// +1: the normal points to larger coordinates; −1: to smaller ones.
    pub side: i32,
    /// The traction vector [Pa].
    pub traction: Table,
}

impl Traction {
    /// Whether the load makes sense in a world of `dimension` axes.
    pub fn check(&self, dimension: usize) -> Result<()> {
        self.region.check("a traction", dimension)?;
        if self.axis >= dimension {
            return Err(Error::invalid(format!(
                "the axis of a traction's normal must be 0 to {} in {dimension} dimensions, got {}",
                dimension - 1,
                self.axis
            )));
        }
        if self.side != 1 && self.side != -1 {
            return Err(Error::invalid(format!(
                "the side of a traction must be 1 (outward normal along +axis) or -1, got {}",
                self.side
            )));
        }
        Ok(())
    }

    /// The particles of the body that carry the load, in the order of their ids; areas are per
    /// radian if the world is `axisymmetric`.
    pub fn surface<const D: usize>(&self, body: &Body, axisymmetric: bool) -> Result<Surface> {
        let particles = &body.particles;
        let mut chosen = Vec::new();
        for k in 0..particles.len() {
            let x = particles.get::<D>(particles.layout.position, k);
            if !self.region.holds(&x, 0.0) {
                continue;
            }
            let Some(size) = body.sizes.of(particles.id[k]) else {
                return Err(Error::invalid(format!(
                    "a traction needs a surface, and the particles of body {} have no known edge lengths: give `size` in \
                     lahar_particles, or add the body as a shape",
                    body.id
                )));
            };
            reserve(&mut chosen, 1, WHAT)?;
            chosen.push(Chosen { id: particles.id[k], index: k, x, size });
        }
        if chosen.is_empty() {
            return Err(Error::invalid(format!(
                "the box of the traction holds the centre of no particle of body {}: it must hold the outermost layer \
                 of the loaded surface, half an edge of a particle inside of it",
                body.id
            )));
        }
        self.one_layer(body.id, &mut chosen)?;
        chosen.sort_unstable_by_key(|c| c.id);
        let edge = |c: &Chosen<D>| c.size.iter().product::<f64>() / c.size[self.axis];
        let outwards = if self.axis == 0 { 0.5 * f64::from(self.side) } else { 0.0 };
        let radius = |c: &Chosen<D>| {
            if axisymmetric { c.x[0] + outwards * c.size[0] } else { 1.0 }
        };
        if let Some(c) = chosen.iter().find(|c| !(radius(c) > 0.0)) {
            return Err(Error::invalid(format!(
                "the loaded face of particle {} of body {} is at the radius {}: its edge {} is too long for its place {}",
                c.id,
                body.id,
                radius(c),
                c.size[0],
                c.x[0]
            )));
        }
        let mut wanted = collect((0..particles.len()).map(|_| NONE), WHAT)?;
        for (n, c) in chosen.iter().enumerate() {
            wanted[c.id as usize] = n as u32;
        }
        Ok(Surface {
            ids: collect(chosen.iter().map(|c| c.id), WHAT)?,
            areas: collect(chosen.iter().map(|c| edge(c) * radius(c)), WHAT)?,
            edges: collect(chosen.iter().map(edge), WHAT)?,
            places: collect(chosen.iter().map(|c| c.index), WHAT)?,
            wanted,
        })
    }

    /// Refuses particles that stand right behind one another along the normal.
    fn one_layer<const D: usize>(&self, body: i64, chosen: &mut [Chosen<D>]) -> Result<()> {
        let along = usize::from(self.axis == 0); // an axis in the surface
        chosen.sort_unstable_by(|a, b| a.x[along].total_cmp(&b.x[along]).then(a.id.cmp(&b.id)));
        for (n, a) in chosen.iter().enumerate() {
            let near = |b: &&Chosen<D>| b.x[along] - a.x[along] < 0.5 * a.size[along];
            for b in chosen[n + 1..].iter().take_while(near) {
                let within = |d: usize| {
                    let reach = if d == self.axis { 1.5 } else { 0.5 };
                    (a.x[d] - b.x[d]).abs() < reach * a.size[d]
                };
                if (0..D).all(within) {
                    let place =
                        Place { body: Some(body), particle: Some(a.id), ..Place::default() };
                    return Err(Error::invalid(format!(
                        "particles {} and {} of body {body} stand behind one another along the normal: the box of a \
                         traction must hold the outermost layer alone",
                        a.id.min(b.id),
                        a.id.max(b.id)
                    ))
                    .at(place));
                }
            }
        }
        Ok(())
    }
}

struct Chosen<const D: usize> {
    id: i64,
    index: usize,
    x: [f64; D],
    size: [f64; 3],
}

/// No particle of a surface.
const NONE: u32 = u32::MAX;

/// The particles that carry a load. They are known by their ids; their indices in storage order are
/// stored, and found again in one pass over the body when a particle has moved.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Ids, ascending.
    pub ids: Vec<i64>,
    /// Area of the face of each [m²].
    pub areas: Vec<f64>,
    /// Product of its edges in the surface, 1 m thick in two dimensions [m²].
    pub edges: Vec<f64>,
    /// Indices in storage order, in the order of the ids.
    pub places: Vec<usize>,
    /// For each id of the body its number in the surface.
    wanted: Vec<u32>,
}

impl Surface {
    /// Finds the indices of the particles anew if one has moved; `ids` are those of the body, in
    /// storage order.
    pub fn look_up(&mut self, ids: &[i64]) {
        if self.places.iter().zip(&self.ids).all(|(index, id)| ids[*index] == *id) {
            return;
        }
        for (index, id) in ids.iter().enumerate() {
            let n = self.wanted[*id as usize];
            if n != NONE {
                self.places[n as usize] = index;
            }
        }
    }
}

/// A traction in a world.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The load.
    pub load: Traction,
    /// The particles that carry it.
    pub surface: Surface,
    /// Force on the body that the grid holds now [N].
    pub applied: [f64; 3],
}

impl Condition for Loaded {
    const WHAT: &'static str = "traction";

    fn end(&self) -> f64 {
        self.load.traction.end()
    }

    fn belongs_to(&self, body: i64) -> bool {
        self.load.body == body
    }
}
