//! The equations of NorSand: elasticity, critical state, yield, dilatancy and hardening.

use crate::dual::Real;

/// Elasticity whose moduli grow with a power of the pressure, and are constant below the minimum pressure.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Elasticity {
    /// p_min [Pa]
    pub(crate) minimum: f64,
    /// K at the minimum pressure [Pa]
    pub(crate) bulk: f64,
    /// G / K [-]
    pub(crate) shear_ratio: f64,
    /// m [-]
    pub(crate) exponent: f64,
}

impl Elasticity {
    /// K(p) [Pa].
    pub(crate) fn bulk_modulus<T: Real>(&self, p: T) -> T {
        (p / self.minimum).max(1.0).powf(self.exponent) * self.bulk // [NRS-1]
    }

    /// Elastic compression between the minimum pressure and p, ∫ dp/K [-].
    pub(crate) fn strain<T: Real>(&self, p: T) -> T {
        let (ratio, unit) = (p / self.minimum, self.minimum / self.bulk);
        let n = 1.0 - self.exponent;
        if ratio.value() < 1.0 {
            (ratio - 1.0) * unit
        } else if n < 1e-6 {
            ratio.ln() * unit
        } else {
            (ratio.powf(n) - 1.0) * (unit / n)
        }
    }

    /// The pressure [Pa] of an elastic compression.
    pub(crate) fn pressure<T: Real>(&self, strain: T) -> T {
        let z = strain * (self.bulk / self.minimum);
        let n = 1.0 - self.exponent;
        let ratio = if z.value() < 0.0 {
            z + 1.0
        } else if n < 1e-6 {
            z.exp()
        } else {
            (z * n + 1.0).powf(1.0 / n)
        };
        ratio * self.minimum
    }

    /// Secant shear modulus between two pressures with their strains [Pa].
    pub(crate) fn secant_shear<T: Real>(&self, [p0, u0]: [T; 2], [p1, u1]: [T; 2]) -> T {
        let near = (p1 - p0).value().abs() < 1e-5 * p0.value().abs().max(self.minimum);
        let bulk = if near { self.bulk_modulus((p0 + p1) * 0.5) } else { (p1 - p0) / (u1 - u0) };
        bulk * self.shear_ratio // [NRS-2]
    }
}

/// The constants of an instance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Law {
    pub(crate) elastic: Elasticity,
    /// M_tc [-]
    pub(crate) critical_ratio: f64,
    /// (M_te / M_tc)^4 [-]
    pub(crate) extension: f64,
    /// Void ratio of the critical state at the minimum pressure [-]
    pub(crate) critical_void_ratio: f64,
    /// λ [-]
    pub(crate) critical_slope: f64,
    /// N [-]
    pub(crate) coupling: f64,
    /// χ [-]
    pub(crate) dilatancy: f64,
    /// H [-]
    pub(crate) hardening: f64,
}

/// What the image pressure and the density say of strength and dilatancy.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Image<T> {
    /// M_i / M [-]
    pub(crate) softened: T,
    /// Least ln(p / p_i) towards which shear drives a point: χ ψ_i / M_i,tc [-]
    pub(crate) limit: T,
}

/// Least M_i / M, and bounds of the limit: states far off the critical one keep a strength and a yield surface.
const LEAST_SOFTENED: f64 = 0.5;
const LIMITS: [f64; 2] = [-3.0, 0.9];

impl Law {
    /// `image`: ln(p_i / p_min).
    pub(crate) fn state_parameter<T: Real>(&self, void_ratio: T, image: T) -> T {
        void_ratio - self.critical_void_ratio + image * self.critical_slope // [NRS-3]
    }

    pub(crate) fn image<T: Real>(&self, void_ratio: T, image: T) -> Image<T> {
        let psi = self.state_parameter(void_ratio, image);
        let fall = psi.abs() * (self.coupling * self.dilatancy / self.critical_ratio);
        let softened = (-fall + 1.0).max(LEAST_SOFTENED); // [NRS-4]
        let limit = psi * (self.dilatancy / self.critical_ratio) / softened; // [NRS-7]
        Image { softened, limit: limit.max(LIMITS[0]).min(LIMITS[1]) }
    }

    /// M of the Lode angle of a deviator with its q; M_tc without a deviator.
    pub(crate) fn critical_ratio_of<T: Real>(&self, s: [T; 6], q: T) -> T {
        if q.value() <= 0.0 {
            return T::of(self.critical_ratio);
        }
        let [xx, yy, zz, xy, yz, zx] = s.map(|x| x / q);
        let determinant =
            xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * zx) + zx * (xy * yz - yy * zx);
        let sine = (determinant * -13.5).max(-1.0).min(1.0);
        let a = self.extension;
        let fourth = (sine * (a - 1.0) + (1.0 + a)).powf(-0.25);
        fourth * ((2.0 * a).powf(0.25) * self.critical_ratio) // [NRS-5]
    }

    /// The yield function q - M_i p (1 - x) [Pa], x = ln(p / p_i).
    pub(crate) fn excess<T: Real>(&self, q: T, p: T, ratio: T, image: T, void_ratio: T) -> T {
        let x = (p / self.elastic.minimum).ln() - image;
        let mi = ratio * self.image(void_ratio, image).softened;
        q - mi * p * (-x + 1.0) // [NRS-6]
    }
}
