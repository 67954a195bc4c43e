//! Return of a trial stress along its own deviator: what models share that yield by q = sqrt(3/2 s : s) alone.

use crate::elastic::{self, stiffness};
use crate::tensor::{contract, deviator, trace};

/// The elastic trial stress of a step.
#[derive(Clone, Copy, Debug)]
pub struct Trial {
    /// Trial stress [Pa].
    pub stress: [f64; 6],
    /// Its deviator s [Pa].
    pub deviator: [f64; 6],
    /// Its mean tr σ / 3 [Pa].
    pub mean: f64,
    /// sqrt(3/2 s : s) [Pa].
    pub q: f64,
}

impl Trial {
    /// Isotropic elasticity with Lamé's constants [Pa] from a start stress [Pa] by a strain increment [-].
    #[inline(always)]
    pub fn new(lame: [f64; 2], stress0: [f64; 6], strain: [f64; 6]) -> Self {
        let stress = elastic::stress(lame, stress0, strain);
        let s = deviator(stress);
        Self { stress, deviator: s, mean: trace(stress) / 3.0, q: (1.5 * contract(s, s)).sqrt() }
    }

    /// The stress with the same mean and direction whose q is `q1` [Pa]; the trial needs a deviator.
    #[inline(always)]
    pub fn returned(&self, q1: f64) -> [f64; 6] {
        let scale = q1 / self.q;
        let [xx, yy, zz, xy, yz, zx] = self.deviator;
        let m = self.mean;
        [m + scale * xx, m + scale * yy, m + scale * zz, scale * xy, scale * yz, scale * zx]
    }

    /// The consistent tangent [Pa] of the return to `q1` [Pa], of which `slope` [-] is the derivative by the trial's q;
    /// counted as the extension `lahar.tangent` does.
    pub fn tangent(&self, [lambda, mu]: [f64; 2], q1: f64, slope: f64) -> [[f64; 6]; 6] {
        let ratio = q1 / self.q;
        let mu1 = mu * ratio;
        let mut c = stiffness([lambda + 2.0 / 3.0 * (mu - mu1), mu1]);
        let direction = self.deviator.map(|s| s / self.q);
        for i in 0..6 {
            for j in 0..6 {
                let places = if j < 3 { 1.0 } else { 2.0 };
                let along = 3.0 * mu * (slope - ratio); // 2 G of the unit tensor sqrt(3/2) s / q
                c[i][j] += along * direction[i] * direction[j] * places; // [VMS-4]
            }
        }
        c
    }
}
