//! The return to the planes of Mohr-Coulomb and of the cut-off, their edges and vertices, for one strength.
//!
//! In principal stresses all surfaces are planes and all flow is constant, hence the return is linear once it is known which
//! planes are active. Sorted stresses leave ten sets of planes; the first is taken for which the multipliers are not negative
//! and no plane is exceeded.

use crate::strength::Strength;
use Plane::{Shear, Tension};

/// A plane of the yield surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Plane {
    /// Shear between two of the principal stresses.
    Shear(usize, usize),
    /// Largest tension along one axis.
    Tension(usize),
}

/// All planes that sorted stresses can reach.
const PLANES: [Plane; 6] =
    [Shear(0, 2), Shear(0, 1), Shear(1, 2), Tension(0), Tension(1), Tension(2)];

/// Sets of active planes: the planes, the edges, the vertices; the last is the apex.
const SETS: [&[Plane]; 10] = [
    &[Shear(0, 2)],
    &[Tension(0)],
    &[Shear(0, 2), Shear(1, 2)],
    &[Shear(0, 2), Shear(0, 1)],
    &[Tension(0), Tension(1)],
    &[Shear(0, 2), Tension(0)],
    &[Shear(0, 2), Shear(1, 2), Tension(0)],
    &[Shear(0, 2), Tension(0), Tension(1)],
    &[Shear(0, 2), Shear(0, 1), Tension(0)],
    APEX,
];
const APEX: &[Plane] = &[Tension(0), Tension(1), Tension(2)];

impl Plane {
    /// n of f = n · σ - b.
    fn normal(self, sin: f64) -> [f64; 3] {
        let mut n = [0.0; 3];
        match self {
            Shear(i, j) => (n[i], n[j]) = (1.0 + sin, sin - 1.0),
            Tension(i) => n[i] = 1.0,
        }
        n
    }

    /// Derivative of the normal (of the flow) by sin φ (by sin ψ).
    fn turn(self) -> [f64; 3] {
        let mut n = [0.0; 3];
        if let Shear(i, j) = self {
            (n[i], n[j]) = (1.0, 1.0);
        }
        n
    }

    /// b of f = n · σ - b [Pa].
    fn bound(self, strength: &Strength) -> f64 {
        match self {
            Shear(..) => strength.cohesion,
            Tension(_) => strength.tension,
        }
    }

    /// f [Pa].
    fn excess(self, strength: &Strength, stress: [f64; 3]) -> f64 {
        dot(self.normal(strength.sin_friction), stress) - self.bound(strength) // [MHC-1]
    }
}

/// How far sorted principal stresses are outside [Pa].
pub(crate) fn excess(strength: &Strength, stress: [f64; 3]) -> f64 {
    Shear(0, 2).excess(strength, stress).max(Tension(0).excess(strength, stress))
}

/// Size of the numbers in the yield functions, to which round-off is relative [Pa].
pub(crate) fn scale(strength: &Strength, stress: [f64; 3]) -> f64 {
    stress.iter().fold(strength.cohesion, |scale, s| scale.max(s.abs()))
}

/// Isotropic elasticity in principal axes: Lamé's λ and 2 G [Pa].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Elasticity {
    pub(crate) lambda: f64,
    pub(crate) two_g: f64,
}

impl Elasticity {
    pub(crate) fn stress(&self, strain: [f64; 3]) -> [f64; 3] {
        let volumetric = self.lambda * (strain[0] + strain[1] + strain[2]);
        strain.map(|e| volumetric + self.two_g * e)
    }
}

/// The end of a return.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Returned {
    /// Sorted principal stresses [Pa].
    pub(crate) stress: [f64; 3],
    /// Plastic strain increment on the same axes [-].
    pub(crate) plastic: [f64; 3],
    /// Whether all three stresses are at the cut-off.
    pub(crate) is_open: bool,
    set: &'static [Plane],
    multipliers: [f64; 3],
    inverse: [[f64; 3]; 3],
}

/// The return of sorted elastic trial stresses that are outside. The set of `last`, a return from the same stresses with another
/// strength, is tried first.
pub(crate) fn closest(
    elasticity: &Elasticity,
    strength: &Strength,
    trial: [f64; 3],
    last: Option<&Returned>,
) -> Returned {
    let round_off = 1e-13 * scale(strength, trial);
    let mut best = None;
    let mut least = f64::INFINITY;
    for set in last.map(|last| last.set).into_iter().chain(SETS) {
        let Some(returned) = onto(elasticity, strength, trial, set) else { continue };
        let negative = returned.multipliers.iter().fold(0.0_f64, |worst, l| worst.max(-l));
        let violation = PLANES.iter().fold(elasticity.two_g * negative, |worst, plane| {
            worst.max(plane.excess(strength, returned.stress))
        });
        if violation <= round_off {
            return returned.at_apex(strength, 10.0 * round_off); // [MHC-3]
        }
        // At the border of two regions round-off may refuse both: the better one is as good as exact.
        if violation < least {
            (best, least) = (Some(returned), violation);
        }
    }
    match best {
        Some(best) => best.at_apex(strength, 10.0 * round_off),
        None => Returned {
            stress: [f64::NAN; 3],
            plastic: [f64::NAN; 3],
            is_open: false,
            set: APEX,
            multipliers: [0.0; 3],
            inverse: [[0.0; 3]; 3],
        },
    }
}

/// The return to the intersection of the planes of a set.
fn onto(
    elasticity: &Elasticity,
    strength: &Strength,
    trial: [f64; 3],
    set: &'static [Plane],
) -> Option<Returned> {
    // n_a · D r_b, with the identity below for sets of fewer than three planes.
    let mut matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for (b, flow) in set.iter().enumerate() {
        let relaxation = elasticity.stress(flow.normal(strength.sin_dilation));
        for (a, plane) in set.iter().enumerate() {
            matrix[a][b] = dot(plane.normal(strength.sin_friction), relaxation);
        }
    }
    let inverse = invert(matrix)?;
    let mut excess = [0.0; 3];
    for (a, plane) in set.iter().enumerate() {
        excess[a] = plane.excess(strength, trial);
    }
    let multipliers = apply(inverse, excess);
    let plastic = flow(set, multipliers, |plane| plane.normal(strength.sin_dilation)); // [MHC-2]
    let relaxation = elasticity.stress(plastic);
    let stress = std::array::from_fn(|i| trial[i] - relaxation[i]);
    Some(Returned { stress, plastic, is_open: false, set, multipliers, inverse })
}

impl Returned {
    /// The same; exactly at the cut-off in all directions if the smallest stress is. Without cohesion shear planes too end
    /// there, so the set does not show it.
    fn at_apex(mut self, strength: &Strength, round_off: f64) -> Self {
        self.is_open = self.stress[2] >= strength.tension - round_off;
        if self.is_open {
            self.stress = [strength.tension; 3];
        }
        self
    }

    /// Change of the plastic strain with the trial stress and, along `softening`, the derivative of the strength.
    pub(crate) fn change(
        &self,
        elasticity: &Elasticity,
        strength: &Strength,
        trial: [f64; 3],
        softening: Option<&Strength>,
    ) -> [f64; 3] {
        let mut right = [0.0; 3];
        let mut turned = [0.0; 3];
        if let Some(slope) = softening {
            turned = flow(self.set, self.multipliers, |plane| {
                plane.turn().map(|x| x * slope.sin_dilation)
            });
        }
        let relaxation = elasticity.stress(turned);
        for (a, plane) in self.set.iter().enumerate() {
            let moved: [f64; 3] = std::array::from_fn(|i| trial[i] - relaxation[i]);
            right[a] = dot(plane.normal(strength.sin_friction), moved);
            if let Some(slope) = softening {
                right[a] += slope.sin_friction * dot(plane.turn(), self.stress);
                right[a] -= plane.bound(slope);
            }
        }
        let change = apply(self.inverse, right);
        let straight = flow(self.set, change, |plane| plane.normal(strength.sin_dilation));
        std::array::from_fn(|i| straight[i] + turned[i])
    }
}

/// The sum of directions times multipliers over a set.
fn flow(set: &[Plane], multipliers: [f64; 3], direction: impl Fn(&Plane) -> [f64; 3]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (plane, multiplier) in set.iter().zip(multipliers) {
        let direction = direction(plane);
        for i in 0..3 {
            sum[i] += multiplier * direction[i];
        }
    }
    sum
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn apply(m: [[f64; 3]; 3], x: [f64; 3]) -> [f64; 3] {
    m.map(|row| dot(row, x))
}

/// The inverse, if there is one.
fn invert([a, b, c]: [[f64; 3]; 3]) -> Option<[[f64; 3]; 3]> {
    let columns = [cross(b, c), cross(c, a), cross(a, b)];
    let factor = 1.0 / dot(a, columns[0]);
    let inverse: [[f64; 3]; 3] =
        std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i] * factor));
    inverse.iter().flatten().all(|x| x.is_finite()).then_some(inverse)
}
