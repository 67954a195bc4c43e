//! Adding, changing and removing bodies.

use std::sync::Arc;

use crate::background::space::FARTHEST;
use crate::error::{Error, Place, Result, Status};
use crate::material::Material;
use crate::material::scratch::with_scratch;
use crate::memory::reserve;
use crate::particles::inputs::fill_start;
use crate::particles::seeding::{Fill, Region, fill};
use crate::particles::{Body, CHUNK, Carrier, Layout, Particles, Rule, Sizes};
use crate::step::options::Options;
use crate::step::parts::Parts;
use crate::tensor::Mat3;

use super::host_arrays::{ParticleArrays, Strided, Strides};

/// Most particles of a body.
const MOST: usize = u32::MAX as usize - 1;

/// Temperature of new particles if their model takes it as input [K].
const ROOM_TEMPERATURE: f64 = 293.15;

impl<const D: usize> Parts<D> {
    /// Adds a body with the given id from arrays; on error nothing changes.
    pub fn add_particles(
        &mut self,
        id: i64,
        material: &Arc<Material>,
        arrays: &ParticleArrays<'_>,
    ) -> Result<()> {
        let n = arrays.position.strides.count;
        if n == 0 || n > MOST {
            return Err(Error::invalid(format!("a body needs 1 to {MOST} particles, got {n}")));
        }
        if arrays.mass.is_none() && !(arrays.density > 0.0 && arrays.density.is_finite()) {
            return Err(Error::invalid(format!(
                "without masses the density must be positive and finite [kg/m^3], got {}",
                arrays.density
            )));
        }
        let sizes = sizes(arrays, n, D)?;
        let layout = Layout::new(&self.carrier(material, false));
        if layout.size.is_some() && matches!(sizes, Sizes::Unknown) {
            return Err(Error::invalid(
                "GIMP shape functions need the sizes of particles: give `size`, the edge lengths of their domains [m]",
            ));
        }
        let h = self.method.options.spacing;
        if let (Some(_), Some(size)) = (layout.size, &arrays.size) {
            let most = |k: usize| (0..D).fold(0.0, |most, d| f64::max(most, size.get(d, k)));
            if let Some(k) = (0..n).find(|k| most(*k) > h * (1.0 + 1e-9)) {
                return Err(Error::invalid(format!(
                    "size of particle {k} is {} m, more than the spacing of {h} m: a domain of GIMP is one cell wide at most",
                    most(k)
                )));
            }
        }
        let mut particles = Particles::new(layout, n)?;
        if let (Some(columns), Some(size)) = (layout.size, &arrays.size) {
            copy(&mut particles, columns.first, size, "size", D)?;
        }
        copy(&mut particles, layout.position, &arrays.position, "position", D)?;
        copy(&mut particles, layout.volume, &arrays.volume, "volume", 1)?;
        if let Some(velocity) = &arrays.velocity {
            copy(&mut particles, layout.velocity, velocity, "velocity", D)?;
        }
        if let Some(stress) = &arrays.stress {
            copy(&mut particles, layout.stress, stress, "stress", 6)?;
        }
        match &arrays.mass {
            Some(mass) => copy(&mut particles, layout.mass, mass, "mass", 1)?,
            None => {
                for k in 0..n {
                    particles.column_mut(layout.mass)[k] = arrays.density * arrays.volume.get(0, k);
                }
            }
        }
        if let Some(gradient) = layout.deformation_gradient {
            for c in [0, 4, 8] {
                particles.column_mut(gradient.first + c).fill(1.0);
            }
        }
        let stressed = |array: &Strided<'_>| (0..n).any(|k| (0..6).any(|c| array.get(c, k) != 0.0));
        let stress_given = arrays.stress.as_ref().is_some_and(stressed);
        let (material, runs) = (material.clone(), Vec::new());
        self.insert(Body { id, layer: 0, material, particles, runs, sizes, stress_given })
    }

    /// Adds a body that fills a region.
    pub fn add_region(
        &mut self,
        id: i64,
        material: &Arc<Material>,
        region: &Region,
        how: &Fill,
    ) -> Result<()> {
        let given = (how.density != 0.0, how.mass != 0.0);
        if given.0 == given.1 {
            return Err(Error::invalid(format!(
                "give either the density or the total mass of the body, got density {} and mass {}",
                how.density, how.mass
            )));
        }
        let (points, size) = fill::<D>(
            region,
            how.particles_per_cell,
            self.method.options.spacing,
            self.background.space.origin,
        )?;
        let n = points.len();
        let area: f64 = size.iter().product();
        let uniform = [area];
        let (mut of_each, mut whole) = (Vec::new(), area * n as f64);
        if self.method.options.axisymmetric {
            reserve(&mut of_each, n, "the volumes of particles")?;
            of_each.extend(points.iter().map(|x| x[0] * area)); // [AXI-3]
            whole = of_each.iter().sum();
        }
        let density = if given.0 { how.density } else { how.mass / whole };
        if !(density > 0.0 && density.is_finite()) {
            return Err(Error::invalid(format!(
                "density [kg/m^3] or mass [kg] must be positive and finite, got {density} kg/m^3"
            )));
        }
        self.add_particles(
            id,
            material,
            &ParticleArrays {
                position: Strided::interleaved(points.as_flattened(), D)?,
                volume: match of_each.is_empty() {
                    true => Strided::constant(&uniform, n),
                    false => Strided::interleaved(&of_each, 1)?,
                },
                size: Some(Strided::constant(&size, n)),
                mass: None,
                density,
                velocity: Some(Strided::constant(&how.velocity[..D], n)),
                stress: Some(Strided::constant(&how.stress, n)),
            },
        )
    }

    /// The options that decide which fields a body of this world and a material has.
    fn carrier<'a>(&self, material: &'a Material, f_bar: bool) -> Carrier<'a> {
        let Options { shape, transfer, body_force, .. } = self.method.options;
        Carrier { dimension: D, shape, transfer, body_force, f_bar, model: material.model() }
    }

    /// Switches F-bar on or off for a body.
    pub fn set_f_bar(&mut self, id: i64, on: bool) -> Result<()> {
        let at = self.body_position(id)?;
        let body = &self.bodies[at];
        if body.has_f_bar() == on {
            return Ok(());
        }
        let new = Layout::new(&self.carrier(&body.material, on));
        let pairs = body.particles.layout.shared_with(&new, D);
        let particles = body.particles.with_layout(new, pairs)?;
        self.bodies[at].particles = particles;
        Ok(())
    }

    fn insert(&mut self, mut body: Body) -> Result<()> {
        let layout = body.particles.layout;
        if let Some(temperature) = layout.temperature {
            body.particles.column_mut(temperature.first).fill(ROOM_TEMPERATURE);
        }
        self.check_particles(&body)?;
        init_state(&mut body, self.method.options.spacing)?;
        self.check_particles(&body)?;
        reserve(&mut self.bodies, 1, "the bodies")?;
        self.bodies.push(body);
        self.particles_changed();
        Ok(())
    }

    /// Checks the particles of all bodies.
    pub fn check_what_was_written(&self) -> Result<()> {
        self.bodies.iter().try_for_each(|body| self.check_particles(body))
    }

    /// Checks everything that a host may have written: finite, masses and volumes positive,
    /// positions inside the grid.
    pub fn check_particles(&self, body: &Body) -> Result<()> {
        let particles = &body.particles;
        let layout = particles.layout;
        let place = |k: usize| Place {
            body: Some(body.id),
            particle: Some(particles.id[k]),
            ..self.clock.place()
        };
        for (columns, rule, name) in layout.rules(D) {
            let good = |v: &f64| v.is_finite() && (rule == Rule::Finite || *v > 0.0);
            for column in (0..columns.count).map(|c| particles.column(columns.first + c)) {
                if let Some(k) = column.iter().position(|v| !good(v)) {
                    let text = format!(
                        "{} of particle {} must be {}, got {}",
                        name.to_string_lossy(),
                        particles.id[k],
                        rule.text(),
                        column[k]
                    );
                    return Err(Error::invalid(text).at(place(k)));
                }
            }
        }
        let space = &self.background.space;
        for k in 0..particles.len() {
            let x = particles.get::<D>(layout.position, k);
            let near = |d: usize| {
                let in_cells = (x[d] / space.spacing).abs().max(space.to_units(x)[d].abs());
                in_cells < FARTHEST
            };
            let far = !(0..D).all(near);
            if let Some(gradient) = layout.deformation_gradient {
                let f = particles.get::<9>(gradient.first, k);
                let det = Mat3::from_row_slice(&f).determinant();
                if !(det > 0.0) {
                    let text = format!(
                        "deformation_gradient of particle {} must have a positive determinant, got {det} of {f:?}",
                        particles.id[k]
                    );
                    return Err(Error::invalid(text).at(place(k)));
                }
            }
            if self.method.options.axisymmetric && x[0] <= 0.0 {
                let text = format!(
                    "particle {} at {x:?} must have a positive radius x: this world is axisymmetric about x = 0",
                    particles.id[k]
                );
                return Err(Error::invalid(text).at(place(k)));
            }
            if far || !self.method.options.holds(&x) {
                let text = format!(
                    "particle {} at {x:?} is outside the grid (1e8 cells around its origin and that of space, or the box of a static grid)",
                    particles.id[k]
                );
                return Err(Error::invalid(text).at(place(k)));
            }
            let behind = |d: usize| {
                let xi = (x[d] - space.origin[d]) * space.inverse;
                !(space.fits[d].walls[0] - 1e-6 <= xi && xi <= space.fits[d].walls[1] + 1e-6)
            };
            if (0..D).any(behind) {
                let text = format!(
                    "particle {} at {x:?} is behind a wall, where modified shape functions have no nodes: \
                     move it in front, or use wall_treatment plain",
                    particles.id[k]
                );
                return Err(Error::invalid(text).at(place(k)));
            }
        }
        Ok(())
    }
}

fn copy(
    particles: &mut Particles,
    first: usize,
    array: &Strided<'_>,
    name: &str,
    components: usize,
) -> Result<()> {
    let n = particles.len();
    let (count, has) = (array.strides.count, array.strides.components);
    if count != n || has != components {
        return Err(Error::invalid(format!(
            "{name} must hold {components} components of {n} particles, got {has} of {count}"
        )));
    }
    for c in 0..components {
        for (k, to) in particles.column_mut(first + c).iter_mut().enumerate() {
            *to = array.get(c, k);
        }
    }
    Ok(())
}

/// Edge lengths of the particles, if the host gave them.
fn sizes(arrays: &ParticleArrays<'_>, n: usize, dimension: usize) -> Result<Sizes> {
    let Some(array) = &arrays.size else {
        return Ok(Sizes::Unknown);
    };
    let Strides { count, components, point, .. } = array.strides;
    if count != n || components != dimension {
        return Err(Error::invalid(format!(
            "size must hold {dimension} components of {n} particles, got {components} of {count}"
        )));
    }
    let size = |k: usize| {
        let mut size = [1.0; 3];
        for d in 0..dimension {
            size[d] = array.get(d, k);
        }
        size
    };
    let good = |size: &[f64; 3]| size.iter().all(|edge| *edge > 0.0 && edge.is_finite());
    if let Some(k) = (0..n).find(|k| !good(&size(*k))) {
        return Err(Error::invalid(format!(
            "size of particle {k} must be positive and finite [m], got {:?}",
            &size(k)[..dimension]
        )));
    }
    if point == 0 {
        return Ok(Sizes::Uniform(size(0)));
    }
    let mut all = Vec::new();
    reserve(&mut all, n, "the sizes of particles")?;
    all.extend((0..n).map(size));
    Ok(Sizes::Each(all))
}

/// Fills the state with initial values and lets the model derive it from stress and density.
pub(super) fn init_state(body: &mut Body, spacing: f64) -> Result<()> {
    let Body { material, particles, .. } = body;
    let layout = particles.layout;
    let mut first = layout.state.first;
    for state in &material.model().states {
        for _ in 0..state.kind.components() {
            particles.column_mut(first).fill(state.initial);
            first += 1;
        }
    }
    for start in (0..particles.len()).step_by(CHUNK) {
        let n = CHUNK.min(particles.len() - start);
        with_scratch(material, n, |s| {
            fill_start(s, particles, start, spacing);
            s.state1.copy_from_slice(s.state0);
            material.init_state(&mut s.batch()).map_err(|error| match error.status {
                Status::MaterialFailed => Error { status: Status::MaterialRefused, ..error },
                _ => error,
            })?;
            for c in 0..layout.state.count {
                particles.column_mut(layout.state.first + c)[start..start + n]
                    .copy_from_slice(&s.state1[c * s.stride..][..n]);
            }
            Ok(())
        })?;
    }
    Ok(())
}
