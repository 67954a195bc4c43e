//! Queries of a world: totals, grid, samples.

use crate::background::Background;
use crate::background::space::FARTHEST;
use crate::error::{Error, Result};
use crate::particles::Body;
use crate::particles::fields::NODE_FIELDS;
use crate::shape::stencil::at_point;
use crate::step::parts::Parts;

/// Sums over particles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    /// Number of particles.
    pub particles: i64,
    /// Mass [kg].
    pub mass: f64,
    /// Momentum [kg m/s].
    pub momentum: [f64; 3],
    /// Angular momentum about the origin of space [kg m²/s], the affine part included.
    pub angular_momentum: [f64; 3],
    /// Kinetic energy Σ ½ m v² [J].
    pub kinetic_energy: f64,
    /// Strain energy [J].
    pub strain_energy: f64,
    /// Potential energy −Σ m g·x [J].
    pub potential_energy: f64,
    /// Centre of mass [m]; zero without particles.
    pub center_of_mass: [f64; 3],
}

/// Particles that are summed one after the other; longer sums are pairwise.
const LEAF: usize = 4096;
const SUMS: usize = 13;

impl<const D: usize> Parts<D> {
    /// Totals of one body or of all. The order of the sums does not depend on the number of
    /// threads.
    pub fn totals(&self, body: Option<i64>) -> Totals {
        let mut sums = [0.0; SUMS];
        let mut particles = 0;
        for b in self.bodies.iter().filter(|b| body.is_none_or(|id| id == b.id)) {
            particles += b.particles.len();
            let of_body = pairwise(0, b.particles.len(), &|k| self.contribution(b, k));
            for s in 0..SUMS {
                sums[s] += of_body[s];
            }
        }
        let [mass, px, py, pz, lx, ly, lz, kinetic, strain, potential, mx, my, mz] = sums;
        Totals {
            particles: particles as i64,
            mass,
            momentum: [px, py, pz],
            angular_momentum: [lx, ly, lz],
            kinetic_energy: kinetic,
            strain_energy: strain,
            potential_energy: potential,
            center_of_mass: if mass > 0.0 { [mx / mass, my / mass, mz / mass] } else { [0.0; 3] },
        }
    }

    fn contribution(&self, body: &Body, k: usize) -> [f64; SUMS] {
        let (p, layout) = (&body.particles, body.particles.layout);
        let [m] = p.get::<1>(layout.mass, k);
        let (mut x, mut v) = ([0.0; 3], [0.0; 3]);
        x[..D].copy_from_slice(&p.get::<D>(layout.position, k));
        v[..D].copy_from_slice(&p.get::<D>(layout.velocity, k));
        let affine = self.affine_spin(body, k);
        let g = self.gravity(self.clock.time);
        let cross = |a: usize, b: usize| m * (x[a] * v[b] - x[b] * v[a]);
        [
            m,
            m * v[0],
            m * v[1],
            m * v[2],
            cross(1, 2) + m * affine[0],
            cross(2, 0) + m * affine[1],
            cross(0, 1) + m * affine[2],
            0.5 * m * v.iter().map(|c| c * c).sum::<f64>(),
            p.column(layout.strain_energy)[k],
            -m * (0..D).map(|d| g[d] * x[d]).sum::<f64>(),
            m * x[0],
            m * x[1],
            m * x[2],
        ]
    }

    /// Σ w r × (C r) of a particle [m²/s]: the spin in its affine matrix.
    fn affine_spin(&self, body: &Body, k: usize) -> [f64; 3] {
        let (p, layout) = (&body.particles, body.particles.layout);
        let mut spin = [0.0; 3];
        let Some(affine) = layout.affine else {
            return spin;
        };
        let h2 = self.method.options.spacing.powi(2);
        let size = layout.size.map_or([0.0; D], |size| p.get::<D>(size.first, k));
        let at = at_point(&self.background.space, p.get::<D>(layout.position, k), size);
        let moment = at.map(|at| h2 * (self.method.kernels.moment)(at));
        let c = |a: usize, b: usize| p.column(affine.first + a * D + b)[k] * moment[b];
        for (axis, a, b) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
            if a < D && b < D {
                spin[axis] = c(b, a) - c(a, b); // [TRF-9]
            }
        }
        spin
    }

    /// Value of a node field at an active node.
    pub fn node_value(&self, field: &str, node: i64, out: &mut [f64]) -> Result<()> {
        let Background { blocks, nodes, .. } = &self.background;
        let count = blocks.node_count();
        let node = usize::try_from(node).ok().filter(|n| *n < count).ok_or_else(|| {
            Error::invalid(format!("node numbers go from 0 to {}, got {node}", count as i64 - 1))
        })?;
        let components = node_field_components::<D>(field)?;
        if out.len() != components {
            let n = out.len();
            return Err(Error::invalid(format!(
                "{field} has {components} components, room is for {n}"
            )));
        }
        let node = blocks.record(node);
        let (record, force) = (&nodes.velocity[node], &nodes.force[node]);
        match field {
            "mass" => out[0] = record.mass(),
            "velocity" => (0..D).for_each(|a| out[a] = record.component(a)),
            "force" => (0..D).for_each(|a| out[a] = force.component(a)),
            _ => (0..D).for_each(|a| out[a] = record.mass() * record.component(a)),
        }
        Ok(())
    }

    /// Mass-weighted mean Σ w m q / Σ w m of a node field at a point; false and zeros where there
    /// is no mass.
    pub fn sample(&self, field: &str, point: &[f64], out: &mut [f64]) -> Result<bool> {
        let components = node_field_components::<D>(field)?;
        if point.len() != D || out.len() != components {
            return Err(Error::invalid(format!(
                "a sample of {field} takes {D} coordinates and gives {components} components, got room for {} and {}",
                point.len(),
                out.len()
            )));
        }
        if !point.iter().all(|x| x.is_finite()) {
            return Err(Error::invalid(format!("points must be finite [m], got {point:?}")));
        }
        out.fill(0.0);
        let at = at_point(&self.background.space, std::array::from_fn(|d| point[d]), [0.0; D]);
        if at.iter().any(|at| at.xi.abs() >= FARTHEST) {
            return Ok(false);
        }
        let mut mass = 0.0;
        let mut value = [0.0; 3];
        let value = &mut value[..components];
        let mut sum = [0.0; 3];
        let mut failed = None;
        let Background { blocks, nodes, .. } = &self.background;
        (self.method.kernels.nodes_at)(blocks, 0, at, &mut |node, w| {
            if let Err(error) = self.node_value(field, node as i64, value) {
                failed = Some(error);
            }
            let wm = w * nodes.velocity[blocks.record(node)].mass();
            mass += wm;
            for (sum, value) in sum.iter_mut().zip(&*value) {
                *sum += wm * value;
            }
        });
        if let Some(error) = failed {
            return Err(error);
        }
        if mass == 0.0 {
            return Ok(false);
        }
        for (out, sum) in out.iter_mut().zip(sum) {
            *out = sum / mass;
        }
        Ok(true)
    }
}

fn node_field_components<const D: usize>(field: &str) -> Result<usize> {
    let fields = NODE_FIELDS(D);
    let found = fields.iter().find(|f| f.name.to_bytes() == field.as_bytes());
    found.map(|f| f.components).ok_or_else(|| {
        let names = fields.iter().filter_map(|f| f.name.to_str().ok());
        Error::unknown_name("node field", field, names)
    })
}

fn pairwise(first: usize, end: usize, term: &impl Fn(usize) -> [f64; SUMS]) -> [f64; SUMS] {
    if end - first <= LEAF {
        let mut sums = [0.0; SUMS];
        for k in first..end {
            let t = term(k);
            for s in 0..SUMS {
                sums[s] += t[s];
            }
        }
        return sums;
    }
    let mid = first + ((end - first) / 2).next_multiple_of(LEAF);
    let (a, b) = (pairwise(first, mid, term), pairwise(mid, end, term));
    std::array::from_fn(|s| a[s] + b[s])
}
