//! What the tests of a model need beside a [`Driver`]: random numbers, differences for tangents, points without and with bad values.

use crate::drive::Driver;
use crate::tensor::{contract, deviator, to_matrix, trace};
use lahar_plugin_abi::{LAHAR_POINT_FAILED, LAHAR_POINT_OK};
use nalgebra::{Matrix3, SymmetricEigen};

/// A stream of random numbers that a seed determines: a linear congruential generator of 64 bits (Knuth, The Art of Computer
/// Programming 2, 3.3.4), of which the upper 53 bits are used.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// The stream of this seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// A number from 0 to less than 1.
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A number from `low` to less than `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Six components of a symmetric tensor, each between `-size` and `size`: a strain or a stress.
    pub fn symmetric(&mut self, size: f64) -> [f64; 6] {
        std::array::from_fn(|_| self.between(-size, size))
    }
}

/// A tangent next to the central differences of the stress; made by [`Driver::compare_tangent`].
#[derive(Clone, Copy, Debug)]
pub struct TangentComparison {
    /// What the model says [Pa].
    pub tangent: [[f64; 6]; 6],
    /// Largest difference between the two in each column [Pa], one column per strain component.
    pub errors: [f64; 6],
    /// Largest difference between the two one-sided differences in each column [Pa]. Where it is not small beside the moduli,
    /// the stress has a kink, and no derivative is to be expected.
    pub bends: [f64; 6],
}

impl TangentComparison {
    /// Largest error of all columns [Pa].
    pub fn error(&self) -> f64 {
        largest(&self.errors)
    }

    /// Largest bend of all columns [Pa].
    pub fn bend(&self) -> f64 {
        largest(&self.bends)
    }

    /// Largest component of the tangent [Pa].
    pub fn size(&self) -> f64 {
        largest(self.tangent.as_flattened())
    }
}

/// Largest magnitude; NaN if there is one.
fn largest(values: &[f64]) -> f64 {
    values
        .iter()
        .fold(0.0, |most: f64, x| if most.is_nan() || x.abs() <= most { most } else { x.abs() })
}

impl Driver {
    /// Compares the tangent of point `k` in the step `dt` [s] by `strain` [-] with central differences of the stress over
    /// `change` [-]: about 1e-5 of the strain, since their error is of second order in it and round-off grows as it falls.
    /// Leaves the strain increment and its end as if it alone had been run. Errors: those of the model.
    pub fn compare_tangent(
        &mut self,
        k: usize,
        strain: [f64; 6],
        change: f64,
        dt: f64,
    ) -> Result<TangentComparison, String> {
        self.set_strain_increment(k, strain);
        let tangent = self.tangent(k, dt)?;
        self.update(dt)?;
        let here = self.stress1(k);
        let (mut errors, mut bends) = ([0.0; 6], [0.0; 6]);
        for j in 0..6 {
            let mut at = |change: f64| {
                let mut changed = strain;
                changed[j] += change;
                self.set_strain_increment(k, changed);
                self.update(dt)?;
                Ok::<_, String>(self.stress1(k))
            };
            let (above, below) = (at(change)?, at(-change)?);
            let error = |i: usize| tangent[i][j] - (above[i] - below[i]) / (2.0 * change);
            let bend = |i: usize| (above[i] - 2.0 * here[i] + below[i]) / change;
            errors[j] = largest(&std::array::from_fn::<_, 6, _>(error));
            bends[j] = largest(&std::array::from_fn::<_, 6, _>(bend));
        }
        self.set_strain_increment(k, strain);
        self.update(dt)?;
        Ok(TangentComparison { tangent, errors, bends })
    }

    /// The same driver with all points under an isotropic pressure [Pa].
    pub fn confined(mut self, pressure: f64) -> Self {
        for k in 0..self.n() {
            self.set_stress(k, [-pressure, -pressure, -pressure, 0.0, 0.0, 0.0]);
        }
        self
    }

    /// A triaxial test of point `k`: `steps` steps of the axial strain increment along z [-] under a
    /// confining pressure [Pa]. Returns the axial stress at the end, compression positive [Pa], and
    /// the last strain increment [-].
    pub fn triaxial_test(
        &mut self,
        k: usize,
        axial_strain: f64,
        confinement: f64,
        steps: usize,
    ) -> Result<(f64, [f64; 6]), String> {
        let mut last = [0.0; 6];
        for _ in 0..steps {
            last = self.triaxial_step(k, axial_strain, -confinement, 1.0)?;
        }
        Ok((-self.stress0(k)[2], last))
    }

    /// One step of such a test whose lateral strain is found with the model's own tangent. Returns
    /// the strain increment [-]. Error: the tangent does not lead to the confining pressure, to
    /// 1e-10 of it, within 30 iterations.
    pub fn triaxial_step_by_tangent(
        &mut self,
        k: usize,
        axial_strain: f64,
        confinement: f64,
    ) -> Result<[f64; 6], String> {
        let mut lateral = -0.3 * axial_strain;
        for _ in 0..30 {
            let strain = [lateral, lateral, axial_strain, 0.0, 0.0, 0.0];
            self.set_strain_increment(k, strain);
            self.update(1.0)?;
            if self.status_of(k) != LAHAR_POINT_OK {
                return Err(format!("the point has the status {}", self.status_of(k)));
            }
            let residual = self.stress1(k)[0] + confinement;
            if residual.abs() < 1e-10 * confinement {
                self.commit_point(k);
                return Ok(strain);
            }
            let tangent = self.tangent(k, 1.0)?;
            lateral -= residual / (tangent[0][0] + tangent[0][1]);
        }
        Err("the tangent does not lead to the confining pressure".into())
    }

    /// The points whose stress or whose first `states` state components the last update has changed by a bit. After an update
    /// without strain there should be none.
    pub fn changed_points(&self, states: usize) -> Vec<usize> {
        let same = |k: usize| {
            self.stress1(k) == self.stress0(k)
                && (0..states).all(|c| self.state1(k, c) == self.state0(k, c))
        };
        (0..self.n()).filter(|k| !same(*k)).collect()
    }

    /// The points that the last update failed, if all others are `LAHAR_POINT_OK`. Error: the point and its status. To be
    /// compared with the points that were given bad values, so that no other point suffers from them.
    pub fn failed_points(&self) -> Result<Vec<usize>, String> {
        let other = |k: &usize| ![LAHAR_POINT_OK, LAHAR_POINT_FAILED].contains(&self.status_of(*k));
        if let Some(k) = (0..self.n()).find(other) {
            return Err(format!("point {k} has the status {}", self.status_of(k)));
        }
        Ok((0..self.n()).filter(|k| self.status_of(*k) == LAHAR_POINT_FAILED).collect())
    }

    /// The first point that is neither failed nor has a finite stress after the last update: a model must not have one,
    /// whatever it is given.
    pub fn silent_point(&self) -> Option<usize> {
        let finite = |k: usize| self.stress1(k).iter().all(|s| s.is_finite());
        (0..self.n()).find(|k| !finite(*k) && self.status_of(*k) != LAHAR_POINT_FAILED)
    }
}

/// The parameters `usual` with those of `named` in their places.
pub fn with<'a>(usual: &[(&'a str, f64)], named: &[(&'a str, f64)]) -> Vec<(&'a str, f64)> {
    let others = usual.iter().filter(|(key, _)| named.iter().all(|(name, _)| name != key));
    others.chain(named).copied().collect()
}

/// Pressure -tr σ / 3 and equivalent stress q = sqrt(3/2 s : s) of a stress [Pa].
pub fn invariants(stress: [f64; 6]) -> (f64, f64) {
    let s = deviator(stress);
    (-trace(stress) / 3.0, (1.5 * contract(s, s)).sqrt())
}

/// Principal values of a symmetric tensor, the largest first, and their axes in columns: by an algorithm other than that of
/// [`principal`](crate::principal()), which models use.
pub fn principal_axes(tensor: [f64; 6]) -> ([f64; 3], Matrix3<f64>) {
    let eigen = SymmetricEigen::new(to_matrix(tensor));
    let mut order = [0, 1, 2];
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    let axes = Matrix3::from_columns(&order.map(|i| eigen.eigenvectors.column(i).into_owned()));
    (order.map(|i| eigen.eigenvalues[i]), axes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn random_numbers_are_spread_evenly_and_repeat_with_the_seed() {
        let mut random = Random::new(1);
        let mut counts = [0; 10];
        (0..100_000).for_each(|_| counts[(10.0 * random.unit()) as usize] += 1);
        assert!(counts.iter().all(|n| (9_500..10_500).contains(n)), "{counts:?}");
        let [a, b] = [Random::new(7), Random::new(7)].map(|mut r| r.symmetric(2.0));
        assert!(a == b && a.iter().all(|x| x.abs() <= 2.0) && a[0] != a[1]);
        assert_ne!(Random::new(8).symmetric(2.0), a);
    }

    #[test]
    fn the_largest_of_values_with_nan_is_nan() {
        assert_eq!(largest(&[1.0, -3.0, 2.0]), 3.0);
        for values in [[f64::NAN, 1.0], [1.0, f64::NAN]] {
            assert!(largest(&values).is_nan());
        }
    }

    #[test]
    fn named_values_replace_the_usual_ones() {
        let found = with(&[("a", 1.0), ("b", 2.0)], &[("c", 4.0), ("a", 3.0)]);
        assert_eq!(found, [("b", 2.0), ("c", 4.0), ("a", 3.0)]);
    }
}
