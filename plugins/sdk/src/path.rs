//! Element tests in which some components of the strain and others of the stress are prescribed.

use crate::drive::Driver;
use lahar_plugin_abi::LAHAR_POINT_FAILED;
use nalgebra::{DMatrix, DVector};

/// What is prescribed for one component of an element test, in the order xx, yy, zz, xy, yz, zx.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Control {
    /// Strain increment, tensor component [-].
    Strain(f64),
    /// Stress at the end of the step, tension positive [Pa].
    Stress(f64),
}

/// Most Newton steps.
const STEPS: usize = 60;
/// Residuals, over the largest stress of the step, at which the search ends and which is the largest accepted.
const WANTED: f64 = 1e-13;
const ACCEPTED: f64 = 1e-10;

impl Driver {
    /// One step `dt` [s] of point `k` under mixed control; its end becomes its start, other points stay as they were.
    ///
    /// The free strains are found by Newton's method with the numerical tangent and a line search. At a limit state the
    /// tangent may be singular: of all strains the step then takes the smallest. Stresses are met to 1e-10 of the largest
    /// stress of the step, mostly to 1e-13. Returns the whole strain increment. An error leaves the start state as it was.
    /// Only models that take a strain increment.
    pub fn mixed_step(
        &mut self,
        k: usize,
        control: &[Control; 6],
        dt: f64,
    ) -> Result<[f64; 6], String> {
        let mut strain = control.map(|c| if let Control::Strain(e) = c { e } else { 0.0 });
        let mut best = self.residual(k, control, strain, dt)?;
        for _ in 0..STEPS {
            if best.relative() <= WANTED {
                break;
            }
            let step = self.newton_step(k, control, strain, dt)?;
            let mut next = None;
            for halvings in 0..12 {
                let part = 0.5_f64.powi(halvings);
                let trial = std::array::from_fn(|c| strain[c] + part * step[c]);
                let found = self.residual(k, control, trial, dt)?;
                // The first that is better; if none is, the whole step, which may lead over a kink.
                if found.norm < best.norm {
                    next = Some((trial, found));
                    break;
                } else if next.is_none() && found.norm.is_finite() {
                    next = Some((trial, found));
                }
            }
            let Some((trial, found)) = next else { break };
            if found.norm >= best.norm && best.relative() <= ACCEPTED {
                break;
            }
            (strain, best) = (trial, found);
        }
        if !(best.relative() <= ACCEPTED) {
            return Err(format!(
                "no strain increment gives the prescribed stresses {control:?}: {} Pa are missing; take smaller steps",
                best.norm
            ));
        }
        self.residual(k, control, strain, dt)?;
        self.commit_point(k);
        Ok(strain)
    }

    /// One step of a triaxial test: the axial strain increment along z [-] under a constant lateral stress [Pa, tension
    /// positive]. Negative strains are those of triaxial compression, positive ones of extension. Returns the increment.
    pub fn triaxial_step(
        &mut self,
        k: usize,
        axial_strain: f64,
        lateral_stress: f64,
        dt: f64,
    ) -> Result<[f64; 6], String> {
        use Control::{Strain, Stress};
        let lateral = Stress(lateral_stress);
        let control =
            [lateral, lateral, Strain(axial_strain), Strain(0.0), Strain(0.0), Strain(0.0)];
        self.mixed_step(k, &control, dt)
    }

    /// One step in plane strain: the strain increment along y [-] under a constant stress along x [Pa, tension positive],
    /// none along z. Returns the increment.
    pub fn biaxial_step(
        &mut self,
        k: usize,
        axial_strain: f64,
        lateral_stress: f64,
        dt: f64,
    ) -> Result<[f64; 6], String> {
        use Control::{Strain, Stress};
        let [axial, none] = [Strain(axial_strain), Strain(0.0)];
        self.mixed_step(k, &[Stress(lateral_stress), axial, none, none, none, none], dt)
    }

    /// The step that makes the residual zero to first order, zero where the strain is prescribed.
    fn newton_step(
        &mut self,
        k: usize,
        control: &[Control; 6],
        strain: [f64; 6],
        dt: f64,
    ) -> Result<[f64; 6], String> {
        let free: Vec<usize> =
            (0..6).filter(|c| matches!(control[*c], Control::Stress(_))).collect();
        let size = strain.iter().fold(1e-6_f64, |size, e| size.max(e.abs()));
        let change = 1e-5 * size;
        let mut tangent = DMatrix::<f64>::zeros(free.len(), free.len());
        for (column, c) in free.iter().enumerate() {
            let mut at = |change: f64| {
                let mut changed = strain;
                changed[*c] += change;
                self.residual(k, control, changed, dt)
            };
            let [above, below] = [at(change)?, at(-change)?];
            for (row, r) in free.iter().enumerate() {
                let slope = (above.missing[*r] - below.missing[*r]) / (2.0 * change);
                tangent[(row, column)] = slope;
            }
        }
        if free.is_empty() || !tangent.iter().all(|x| x.is_finite()) {
            return Err(
                "the model fails in the element test or close to it; take smaller steps".into()
            );
        }
        let here = self.residual(k, control, strain, dt)?;
        let missing = DVector::from_iterator(free.len(), free.iter().map(|c| -here.missing[*c]));
        let svd = tangent.svd(true, true);
        let smallest = 1e-8 * svd.singular_values.max();
        let solved = svd.solve(&missing, smallest)?;
        let mut step = [0.0; 6];
        for (c, value) in free.iter().zip(solved.iter()) {
            step[*c] = *value;
        }
        Ok(step)
    }

    /// Runs the step with these strains. A point that fails is infinitely far away.
    fn residual(
        &mut self,
        k: usize,
        control: &[Control; 6],
        strain: [f64; 6],
        dt: f64,
    ) -> Result<Residual, String> {
        self.set_strain_increment(k, strain);
        self.update(dt)?;
        let (start, end) = (self.stress0(k), self.stress1(k));
        let mut residual = Residual { missing: [0.0; 6], norm: 0.0, scale: f64::MIN_POSITIVE };
        for c in 0..6 {
            if let Control::Stress(wanted) = control[c] {
                residual.missing[c] = end[c] - wanted;
                residual.scale = residual.scale.max(wanted.abs());
            }
            residual.scale = residual.scale.max(start[c].abs()).max(end[c].abs());
        }
        residual.norm = residual.missing.iter().map(|x| x * x).sum::<f64>().sqrt();
        if self.status_of(k) == LAHAR_POINT_FAILED || !residual.norm.is_finite() {
            residual.norm = f64::INFINITY;
        }
        Ok(residual)
    }
}

/// How far the stresses are from the prescribed ones [Pa].
struct Residual {
    missing: [f64; 6],
    norm: f64,
    /// The largest stress of the step.
    scale: f64,
}

impl Residual {
    fn relative(&self) -> f64 {
        self.norm / self.scale
    }
}
