//! Manufactured solutions: a motion x(X, t) is chosen, and the body force follows that a neo-Hookean body needs to move like that.
//!
//! ρ0 ẍ = Div P + ρ0 b with P = μ (F − F⁻ᵀ) + λ ln J F⁻ᵀ; all derivatives of the motion are taken automatically.

use lahar_plugin::nalgebra::{Matrix3, Vector3};
use serde::Deserialize;
use std::f64::consts::PI;

use crate::jet::Jet;

/// Motions with their bodies and materials.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(rename_all = "snake_case")]
pub enum Motion {
    /// u_i = A sin(π X_i) sin(π c t + φ_i) in the unit interval, square or cube.
    ///
    /// P. C. Wallstedt, J. E. Guilkey, J. Comput. Phys. 227 (2008) 9628–9642, doi:10.1016/j.jcp.2008.07.019.
    AxisAligned,
    /// A ring whose circles turn by α = A sin(π c t) h(R), h = 1 − 32 (R − 1)² + 256 (R − 1)⁴, for R from 3/4 to 5/4.
    ///
    /// K. Kamojjala, R. Brannon, A. Sadeghirad, J. Guilkey, Engineering with Computers 31 (2015) 199–213, doi:10.1007/s00366-013-0342-x.
    Vortex,
    /// A ring from R = 0.4 to 0.6 with u = A sin(π c t) (c3 R² + c2 R + c1) X: its edges are free of stress.
    ///
    /// P. C. Wallstedt, J. E. Guilkey, as above.
    ExpandingRing,
}

/// Constants of a body.
#[derive(Clone, Copy, Debug)]
pub struct Material {
    /// Young's modulus [Pa].
    pub youngs_modulus: f64,
    /// Poisson's ratio.
    pub poissons_ratio: f64,
    /// Density at rest [kg/m³].
    pub density: f64,
}

impl Material {
    /// Lamé's constants λ and μ [Pa].
    pub fn lame(&self) -> (f64, f64) {
        let Self { youngs_modulus: e, poissons_ratio: nu, .. } = self;
        (e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), e / (2.0 * (1.0 + nu)))
    }

    /// Speed of a wave along a thin bar, c = √(E / ρ0) [m/s].
    pub fn bar_speed(&self) -> f64 {
        (self.youngs_modulus / self.density).sqrt()
    }

    /// Speed of a wave of compression, √((λ + 2 μ) / ρ0) [m/s].
    pub fn wave_speed(&self) -> f64 {
        let (lambda, mu) = self.lame();
        ((lambda + 2.0 * mu) / self.density).sqrt()
    }
}

/// What a particle should be at a time.
pub struct Exact {
    /// Position [m].
    pub position: Vector3<f64>,
    /// Velocity [m/s].
    pub velocity: Vector3<f64>,
    /// Deformation gradient F.
    pub gradient: Matrix3<f64>,
    /// Velocity gradient Ḟ F⁻¹ [1/s].
    pub velocity_gradient: Matrix3<f64>,
    /// Cauchy stress [Pa].
    pub stress: Matrix3<f64>,
    /// Body force per mass [N/kg].
    pub body_force: Vector3<f64>,
}

impl Motion {
    /// The material of the literature.
    pub fn material(self) -> Material {
        let (youngs_modulus, poissons_ratio, density) = match self {
            Motion::AxisAligned => (1e4, 0.3, 1.0),
            Motion::Vortex => (1000.0, 0.3, 1000.0),
            Motion::ExpandingRing => (1e7, 0.0, 1000.0),
        };
        Material { youngs_modulus, poissons_ratio, density }
    }

    /// Inner and outer radius, if the body is a ring [m].
    pub fn radii(self) -> Option<[f64; 2]> {
        match self {
            Motion::AxisAligned => None,
            Motion::Vortex => Some([0.75, 1.25]),
            Motion::ExpandingRing => Some([0.4, 0.6]),
        }
    }

    /// x(X, t) with its derivatives; `axes` are those along which an axis-aligned motion goes.
    fn map(self, axes: usize, amplitude: f64, at: [Jet; 3], t: Jet) -> [Jet; 3] {
        let phase = t * (PI * self.material().bar_speed());
        let [x, y, z] = at;
        let radius = || (x * x + y * y).sqrt();
        match self {
            Motion::AxisAligned => std::array::from_fn(|axis| {
                if axis >= axes {
                    return at[axis];
                }
                let angle = phase + 2.0 * PI / 3.0 * axis as f64;
                at[axis] + (at[axis] * PI).sin() * angle.sin() * amplitude
            }),
            Motion::Vortex => {
                let r = radius() + -1.0;
                let r2 = r * r;
                let alpha = phase.sin() * (r2 * -32.0 + r2 * r2 * 256.0 + 1.0) * amplitude;
                let (s, c) = alpha.sin_cos();
                [c * x - s * y, s * x + c * y, z]
            }
            Motion::ExpandingRing => {
                let [inner, outer] = [0.4, 0.6];
                let common = outer * outer * (outer - 3.0 * inner);
                let c1 = -6.0 * inner * outer / common;
                let (c2, c3) = (3.0 * (outer + inner) / common, -2.0 / common);
                let r = radius();
                let growth = phase.sin() * (r * r * c3 + r * c2 + c1) * amplitude + 1.0;
                [growth * x, growth * y, z]
            }
        }
    }

    /// What the particle that rests at X should be at a time.
    pub fn exact(self, axes: usize, amplitude: f64, at: [f64; 3], time: f64) -> Exact {
        let variables = std::array::from_fn(|axis| Jet::variable(axis, at[axis]));
        let x = self.map(axes, amplitude, variables, Jet::variable(3, time));
        let each = |entry: fn(&Jet) -> f64| Vector3::from_fn(|i, _| entry(&x[i]));
        let f = Matrix3::from_fn(|i, j| x[i].first[j]);
        let rate = Matrix3::from_fn(|i, j| x[i].second[j][3]);
        let (lambda, mu) = self.material().lame();
        let (j, inverse) = (f.determinant(), f.try_inverse().unwrap_or_default());
        let (transposed, log) = (inverse.transpose(), j.ln());
        let p = mu * (f - transposed) + lambda * log * transposed;
        // Div P: the sum over j of column j of ∂P/∂X_j
        let mut divergence = Vector3::zeros();
        for axis in 0..3 {
            let df = Matrix3::from_fn(|i, k| x[i].second[k][axis]);
            let dp = mu * df
                + (mu - lambda * log) * transposed * df.transpose() * transposed
                + lambda * (inverse * df).trace() * transposed;
            divergence += dp.column(axis);
        }
        Exact {
            position: each(|x| x.value),
            velocity: each(|x| x.first[3]),
            gradient: f,
            velocity_gradient: rate * inverse,
            stress: p * f.transpose() / j,
            body_force: each(|x| x.second[3][3]) - divergence / self.material().density,
        }
    }
}
