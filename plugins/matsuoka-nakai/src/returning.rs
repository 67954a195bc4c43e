//! The return in the pressure and in the plane of the deviator.
//!
//! A deviator is the vector x = q (cos θ, sin θ) with compression positive: the largest pressure has 2/3 q cos θ, the others
//! 2/3 q cos(θ ∓ 2π/3). Flow along the gradient of q Γ(θ) leaves one equation for θ alone; everything else follows from θ.

use crate::surface::{Shape, Surface};
use lahar_plugin::root::{Root, bracketed};
use std::f64::consts::FRAC_PI_3;

/// Directions of the largest, the middle and the smallest principal pressure in the plane of x.
const AXES: [[f64; 2]; 3] = [[1.0, 0.0], [-0.5, SIN], [-0.5, -SIN]];
const SIN: f64 = 0.866_025_403_784_438_6;

/// Constants of a material.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Material {
    pub(crate) bulk: f64,
    pub(crate) shear: f64,
    pub(crate) surface: Surface,
    /// Largest mean tension [Pa].
    pub(crate) tension: f64,
}

/// Pressure and deviator [Pa].
#[derive(Clone, Copy, Debug)]
pub(crate) struct State {
    pub(crate) p: f64,
    pub(crate) x: [f64; 2],
}

/// What holds the stress at the end of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Held {
    /// Nothing: elastic.
    Nowhere,
    /// The surface.
    Surface,
    /// The mean tension, which has reached the cut-off.
    CutOff,
    /// Both.
    Both,
}

/// The end of a return.
#[derive(Clone, Copy, Debug)]
pub(crate) struct End {
    pub(crate) state: State,
    /// Equivalent plastic strain of the step [-].
    pub(crate) plastic: f64,
    /// Whether the mean tension is at the cut-off.
    pub(crate) at_cutoff: bool,
    pub(crate) converged: bool,
    held: Held,
    multiplier: f64,
    theta: f64,
}

impl End {
    pub(crate) fn is_elastic(&self) -> bool {
        self.held == Held::Nowhere
    }

    /// Whether the surface was reached.
    pub(crate) fn flows(&self) -> bool {
        matches!(self.held, Held::Surface | Held::Both)
    }
}

impl State {
    /// Of principal stresses, tension positive, the largest first.
    pub(crate) fn of(stress: [f64; 3]) -> Self {
        let [a, b, c] = [-stress[2], -stress[1], -stress[0]];
        Self { p: (a + b + c) / 3.0, x: [0.5 * ((a - b) + (a - c)), SIN * (b - c)] }
    }

    /// The inverse.
    pub(crate) fn stress(&self) -> [f64; 3] {
        let pressure = AXES.map(|axis| self.p + 2.0 / 3.0 * dot(axis, self.x));
        [-pressure[2], -pressure[1], -pressure[0]]
    }

    fn polar(&self) -> [f64; 2] {
        let theta = self.x[1].atan2(self.x[0]).clamp(0.0, FRAC_PI_3);
        [dot(self.x, self.x).sqrt(), theta]
    }
}

impl Material {
    /// The return from an elastic trial state. A point that `stays_open` keeps its pressure at the cut-off. States outside by
    /// less than `tolerance` [Pa] are inside.
    pub(crate) fn step(&self, trial: State, stays_open: bool, tolerance: f64) -> End {
        let surface = &self.surface;
        let [q, theta] = trial.polar();
        let gamma = surface.shape(theta).value;
        let beyond = stays_open || trial.p < -self.tension - tolerance;
        let outside = |p: f64| q * gamma - surface.capacity(p) > tolerance;
        if !beyond && !outside(trial.p) {
            return self.end(trial, trial, Held::Nowhere, [0.0, theta], true);
        }
        if beyond {
            // The pressure at the cut-off, if the dilation of the flow that is left there does not lift it.
            let limit = surface.capacity(-self.tension).max(0.0);
            let p = -self.tension;
            if !outside(p) {
                let end = State { p, x: trial.x };
                return self.end(trial, end, Held::CutOff, [0.0, theta], true);
            }
            let (root, multiplier) = self.solve([q, theta], limit, 0.0, |_| {});
            let lifted = trial.p + self.bulk * surface.dilation * multiplier > p;
            if stays_open || !lifted {
                let q = limit / surface.shape(root.at).value;
                return self.finish(trial, p, q, Held::Both, multiplier, root);
            }
        }
        let coupling = self.bulk * surface.slope * surface.dilation;
        let (root, multiplier) =
            self.solve([q, theta], surface.capacity(trial.p), coupling, |_| {});
        let p = trial.p + self.bulk * surface.dilation * multiplier;
        let q = surface.capacity(p).max(0.0) / surface.shape(root.at).value;
        self.finish(trial, p, q, Held::Surface, multiplier, root)
    }

    /// The Lode angle at the end and the multiplier λ [-]. `capacity` is M p + k of the trial, `coupling` K M M_ψ [Pa];
    /// `watch` sees the residuals [-].
    fn solve(
        &self,
        [q, trial_angle]: [f64; 2],
        capacity: f64,
        coupling: f64,
        mut watch: impl FnMut(f64),
    ) -> (Root, f64) {
        let three_g = 3.0 * self.shear;
        // λ and its derivative by θ; the deviator does not turn around.
        let multiplier = |shape: Shape, sin: f64, cos: f64| {
            let Shape { value, first, .. } = shape;
            let below = three_g * value * value + coupling;
            let regular = (q * cos * value - capacity) / below; // [MTN-3]
            let all = q * cos / (three_g * value);
            if regular <= all {
                let above =
                    q * (sin * value + cos * first) - regular * 2.0 * three_g * value * first;
                [regular, above / below]
            } else {
                [all, q * (sin * value - cos * first) / (three_g * value * value)]
            }
        };
        let root = bracketed([0.0, FRAC_PI_3], trial_angle, 1e-13, |theta| {
            let shape = self.surface.shape(theta);
            let (sin, cos) = (trial_angle - theta).sin_cos();
            let [lambda, change] = multiplier(shape, sin, cos);
            let residual = three_g * lambda * shape.first / q - sin; // [MTN-4]
            watch(residual);
            [residual, three_g * (change * shape.first + lambda * shape.second) / q + cos]
        });
        let (sin, cos) = (trial_angle - root.at).sin_cos();
        let [lambda, _] = multiplier(self.surface.shape(root.at), sin, cos);
        (root, lambda.max(0.0))
    }

    fn finish(&self, trial: State, p: f64, q: f64, held: Held, lambda: f64, root: Root) -> End {
        let (sin, cos) = root.at.sin_cos();
        let end = State { p, x: [q * cos, q * sin] };
        self.end(trial, end, held, [lambda, root.at], root.converged)
    }

    fn end(
        &self,
        trial: State,
        state: State,
        held: Held,
        [multiplier, theta]: [f64; 2],
        converged: bool,
    ) -> End {
        let change = [trial.x[0] - state.x[0], trial.x[1] - state.x[1]];
        End {
            state,
            plastic: dot(change, change).sqrt() / (3.0 * self.shear),
            at_cutoff: matches!(held, Held::CutOff | Held::Both),
            converged,
            held,
            multiplier,
            theta,
        }
    }

    /// Derivative [Pa] of the principal stresses (rows) by the principal strains, the largest stress first. `volumetric` is
    /// that of the volumetric strain that loads the point by the whole: 1, or 0 while the point stays open.
    pub(crate) fn tangent(&self, end: &End, volumetric: f64) -> [[f64; 3]; 3] {
        let mut tangent = [[0.0; 3]; 3];
        for j in 0..3 {
            // Principal strain j belongs to principal pressure 2 - j.
            let axis = AXES[2 - j];
            let trial =
                State { p: -self.bulk * volumetric, x: axis.map(|a| -2.0 * self.shear * a) };
            let stress = self.change(end, trial).stress();
            for i in 0..3 {
                tangent[i][j] = stress[i];
            }
        }
        tangent
    }

    /// Change of the end with a change of the trial state.
    fn change(&self, end: &End, trial: State) -> State {
        let at_cutoff = State { p: 0.0, x: trial.x };
        match end.held {
            Held::Nowhere => return trial,
            Held::CutOff => return at_cutoff,
            Held::Surface | Held::Both => {}
        }
        let surface = &self.surface;
        let shape = surface.shape(end.theta);
        let q = dot(end.state.x, end.state.x).sqrt();
        if q == 0.0 {
            return State { p: 0.0, x: [0.0; 2] };
        }
        let (sin, cos) = end.theta.sin_cos();
        let around = [-sin, cos];
        let gradient = [
            shape.value * cos + shape.first * around[0],
            shape.value * sin + shape.first * around[1],
        ];
        // (1 + 3 G λ ∇∇(q Γ))^-1 shortens what goes around the axis; ∇∇(q Γ) is (Γ + Γ'') / q there.
        let bent = 3.0 * self.shear * end.multiplier * (shape.value + shape.second) / q;
        let shorten = |a: [f64; 2]| {
            let part = bent / (1.0 + bent) * dot(around, a);
            [a[0] - part * around[0], a[1] - part * around[1]]
        };
        let (normal, three_g) = (shorten(gradient), 3.0 * self.shear);
        let (slope, dilation) = match end.held {
            Held::Both => (0.0, 0.0),
            _ => (surface.slope, surface.dilation),
        };
        let below = three_g * dot(normal, gradient) + self.bulk * slope * dilation;
        let multiplier = (dot(normal, trial.x) - slope * trial.p) / below; // [MTN-5]
        let x = shorten(std::array::from_fn(|i| trial.x[i] - three_g * multiplier * gradient[i]));
        match end.held {
            Held::Both => State { p: 0.0, x },
            _ => State { p: trial.p + self.bulk * dilation * multiplier, x },
        }
    }
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn material(dilation: f64) -> Material {
        Material { bulk: 2e7, shear: 1e7, surface: Surface::new(35.0, 5e3, dilation), tension: 2e3 }
    }

    #[test]
    fn principal_stresses_come_back_from_pressure_and_deviator() {
        for stress in [[3.0, 1.0, -4.0], [1.0, 1.0, -2.0], [2.0, -1.0, -1.0], [5.0; 3]] {
            let again = State::of(stress).stress();
            assert!((0..3).all(|i| (again[i] - stress[i]).abs() < 1e-14), "{again:?}");
            let [q, theta] = State::of(stress).polar();
            assert!(q >= 0.0 && (0.0..=FRAC_PI_3).contains(&theta));
        }
        // q is that of the invariants, the angle 0 in compression and 60 degrees in extension.
        let [q, theta] = State::of([-1.0, -1.0, -4.0]).polar();
        assert!((q - 3.0).abs() < 1e-15 && theta == 0.0);
        let [q, theta] = State::of([-1.0, -4.0, -4.0]).polar();
        assert!((q - 3.0).abs() < 1e-15 && (theta - FRAC_PI_3).abs() < 1e-15);
    }

    #[test]
    fn the_lode_angle_is_found_quadratically() {
        for dilation in [0.0, 10.0, 35.0] {
            let material = material(dilation);
            for n in 1..12 {
                for q in [150e3, 400e3, 4e6] {
                    let trial = [q, FRAC_PI_3 * f64::from(n) / 12.0];
                    let capacity = material.surface.capacity(80e3);
                    let coupling = 2e7 * material.surface.slope * material.surface.dilation;
                    let mut table = Vec::new();
                    let (root, lambda) =
                        material.solve(trial, capacity, coupling, |r| table.push(r.abs()));
                    assert!(root.converged && lambda > 0.0 && table.len() <= 12, "{table:?}");
                    // Close to the root each residual is a constant times the square of the one before; 1e-15 is round-off.
                    let close = table.iter().position(|r| *r < 1e-2).unwrap();
                    let quadratic = |pair: &[f64]| pair[1] <= 10.0 * pair[0] * pair[0] + 1e-15;
                    let table = &table[close..];
                    assert!(table.len() <= 5 && table.windows(2).all(quadratic), "{table:?}");
                    // Negative control: a linear rate of 1/1000 is not mistaken for it.
                    let linear: Vec<f64> = (0..4).map(|n| 1e-2 * 1e-3_f64.powi(n)).collect();
                    assert!(!linear.windows(2).all(quadratic));
                }
            }
        }
    }
}
