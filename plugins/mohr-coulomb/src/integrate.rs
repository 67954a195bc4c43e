//! One step in principal axes: elastic trial, return, and the implicit softening of the strength.

use crate::planes::{self, Elasticity, Returned, closest, dot};
use crate::strength::{Law, Softening};
use lahar_plugin::root::bracketed;

/// How far outside, relative to the stresses, still counts as inside: a stress that was returned to a plane stays there when
/// nothing is strained.
const INSIDE: f64 = 1e-11;

/// What a point is made of, in principal axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Material {
    pub(crate) elasticity: Elasticity,
    pub(crate) law: Law,
}

/// The end of a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    /// Sorted principal stresses [Pa].
    pub(crate) stress: [f64; 3],
    /// Equivalent plastic strain [-].
    pub(crate) kappa: f64,
    /// Volumetric strain by which the point has opened [-].
    pub(crate) opened: f64,
    /// Derivative [Pa] of the principal stresses (rows) by the principal strains.
    pub(crate) tangent: Option<[[f64; 3]; 3]>,
    /// Whether the plastic strain of the step was found.
    pub(crate) converged: bool,
    /// Whether the strength nowhere fell faster with the plastic strain than elastic unloading follows.
    pub(crate) unique: bool,
}

impl Material {
    /// The step from sorted elastic trial stresses [Pa] and the equivalent plastic strain at the start.
    pub(crate) fn step(&self, trial: [f64; 3], kappa0: f64, with_tangent: bool) -> Step {
        let [strength, _] = self.law.at(kappa0);
        let tolerance = INSIDE * planes::scale(&strength, trial);
        if planes::excess(&strength, trial) <= tolerance {
            let tangent = with_tangent.then(|| self.tangent(|_| [0.0; 3]));
            let (kappa, opened) = (kappa0, 0.0);
            return Step { stress: trial, kappa, opened, tangent, converged: true, unique: true };
        }
        if self.law.softening == Softening::None {
            let returned = closest(&self.elasticity, &strength, trial, None);
            let tangent = with_tangent.then(|| {
                self.tangent(|strain| {
                    let trial = self.elasticity.stress(strain);
                    returned.change(&self.elasticity, &strength, trial, None)
                })
            });
            let kappa = kappa0 + equivalent(returned.plastic);
            return Step {
                stress: returned.stress,
                kappa,
                opened: opened(&returned),
                tangent,
                converged: true,
                unique: true,
            };
        }
        self.soften(trial, kappa0, with_tangent, |_| {})
    }

    /// The same with softening: the equivalent plastic strain at the end is the root of its own increment in the return with
    /// the strength that it gives. `watch` sees the residuals [-].
    fn soften(
        &self,
        trial: [f64; 3],
        kappa0: f64,
        with_tangent: bool,
        mut watch: impl FnMut(f64),
    ) -> Step {
        // No return makes the deviator longer or turns it around, hence all of it is the most that can become plastic.
        let mean = (trial[0] + trial[1] + trial[2]) / 3.0;
        let most = equivalent(trial.map(|s| (s - mean) / self.elasticity.two_g));
        let tolerance = 1e-13 * most + 1e-16 * kappa0;
        let bracket = [kappa0, kappa0 + most * (1.0 + 1e-9)];
        let (mut unique, mut last) = (true, None);
        let root = bracketed(bracket, kappa0, tolerance, |kappa| {
            let [strength, slope] = self.law.at(kappa);
            let returned = closest(&self.elasticity, &strength, trial, last.as_ref());
            last = Some(returned);
            let residual = kappa - kappa0 - equivalent(returned.plastic); // [MHC-5]
            watch(residual);
            let by_kappa = returned.change(&self.elasticity, &strength, [0.0; 3], Some(&slope));
            let slope = 1.0 - growth(returned.plastic, by_kappa);
            unique &= slope > 0.0;
            [residual, slope]
        });
        let [strength, slope] = self.law.at(root.at);
        let returned = closest(&self.elasticity, &strength, trial, last.as_ref());
        let tangent = with_tangent.then(|| {
            let by_kappa = returned.change(&self.elasticity, &strength, [0.0; 3], Some(&slope));
            self.tangent(|strain| {
                let trial = self.elasticity.stress(strain);
                let direct = returned.change(&self.elasticity, &strength, trial, None);
                let kappa = growth(returned.plastic, direct) / root.slope; // [MHC-6]
                std::array::from_fn(|i| direct[i] + kappa * by_kappa[i])
            })
        });
        Step {
            stress: returned.stress,
            kappa: root.at,
            opened: opened(&returned),
            tangent,
            converged: root.converged,
            unique,
        }
    }

    /// Derivative of the principal stresses from the plastic strain of each unit strain.
    fn tangent(&self, plastic: impl Fn([f64; 3]) -> [f64; 3]) -> [[f64; 3]; 3] {
        let mut tangent = [[0.0; 3]; 3];
        for j in 0..3 {
            let mut strain = [0.0; 3];
            strain[j] = 1.0;
            let plastic = plastic(strain);
            let elastic = std::array::from_fn(|i| strain[i] - plastic[i]);
            let stress = self.elasticity.stress(elastic);
            for i in 0..3 {
                tangent[i][j] = stress[i];
            }
        }
        tangent
    }
}

/// The volumetric strain that opens a point which is at the cut-off along all axes [-].
fn opened(returned: &Returned) -> f64 {
    let volumetric = returned.plastic.iter().sum::<f64>();
    if returned.is_open && volumetric > 0.0 { volumetric } else { 0.0 }
}

fn deviator(a: [f64; 3]) -> [f64; 3] {
    let mean = (a[0] + a[1] + a[2]) / 3.0;
    a.map(|x| x - mean)
}

/// sqrt(2/3 e : e) of the deviator of a strain [-].
pub(crate) fn equivalent(strain: [f64; 3]) -> f64 {
    let e = deviator(strain);
    (2.0 / 3.0 * dot(e, e)).sqrt()
}

/// Change of the equivalent strain with a change of the strain [-].
fn growth(strain: [f64; 3], change: [f64; 3]) -> f64 {
    let size = equivalent(strain);
    if size > 0.0 { 2.0 / 3.0 * dot(deviator(strain), change) / size } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strength::Angles;

    fn material(softening: Softening, softening_strain: f64) -> Material {
        let radians = |friction: f64, dilation: f64, cohesion| Angles {
            friction: friction.to_radians(),
            cohesion,
            dilation: dilation.to_radians(),
        };
        Material {
            elasticity: Elasticity { lambda: 6e6, two_g: 8e6 },
            law: Law {
                softening,
                peak: radians(35.0, 12.0, 10e3),
                residual: radians(25.0, 2.0, 1e3),
                tension_cutoff: 5e3,
                softening_strain,
            },
        }
    }

    #[test]
    fn the_plastic_strain_of_softening_is_found_quadratically() {
        // Trial stresses that return to the shear plane, both its edges, the cut-off and where it meets the shear plane.
        let trials = [
            [-50e3, -200e3, -500e3],
            [-50e3, -51e3, -500e3],
            [-50e3, -499e3, -500e3],
            [90e3, -5e3, -20e3],
            [90e3, -50e3, -200e3],
        ];
        let material = material(Softening::Exponential, 0.02);
        for trial in trials {
            let mut table = Vec::new();
            let step = material.soften(trial, 0.01, false, |residual| table.push(residual.abs()));
            assert!(step.converged && step.unique && step.kappa > 0.01, "{trial:?}");
            assert!((4..=7).contains(&table.len()), "{table:?}");
            // The curvature of an exponential makes the constant about half the inverse of its strain; 2e-17 is round-off.
            let quadratic = |pair: &[f64]| pair[1] <= 0.5 / 0.02 * pair[0] * pair[0] + 2e-17;
            assert!(table.windows(2).all(quadratic), "{trial:?}: {table:?}");
            // Negative control: a linear rate, even one as fast as 1/1000, is not mistaken for it.
            let linear: Vec<f64> = (0..4).map(|n| table[0] * 1e-3_f64.powi(n)).collect();
            assert!(!linear.windows(2).all(quadratic));
        }
    }

    #[test]
    fn a_strength_that_falls_faster_than_the_stress_can_is_told() {
        for softening in [Softening::Exponential, Softening::Linear] {
            for n in 1..100 {
                let trial = [-50e3, -200e3, -300e3 - 1e3 * f64::from(n)];
                let slow = material(softening, 0.05).step(trial, 0.0, false);
                assert!(slow.converged && slow.unique);
                let fast = material(softening, 1e-3).step(trial, 0.0, false);
                assert!(fast.converged && (fast.unique == (fast.kappa == 0.0)), "{fast:?}");
                // The stress is on the yield surface of the strength that is left, all the same.
                let [strength, _] = material(softening, 1e-3).law.at(fast.kappa);
                assert!(planes::excess(&strength, fast.stress) < 1e-7);
            }
        }
    }

    #[test]
    fn equivalent_strain_of_uniaxial_isochoric_flow_is_the_axial_strain() {
        assert!((equivalent([-0.5, -0.5, 1.0]) - 1.0).abs() < 1e-15);
        assert_eq!(equivalent([0.3, 0.3, 0.3]), 0.0);
    }
}
