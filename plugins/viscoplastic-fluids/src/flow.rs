//! The deviator of a fluid with a yield stress, and the flow curves.

use lahar_model_newtonian::fluid::Deviator;
use lahar_plugin::tensor::{contract, deviator};
use lahar_plugin::{elastic, math};

/// A flow curve, solved for what a step leaves of a stress beyond that of yield.
pub(crate) trait Overstress: Copy {
    /// The y > 0 with y + G Δt γ̇(y) = `trial` > 0 [Pa], γ̇ the inverse of the flow curve, and dy / d trial [-].
    fn relaxed(&self, trial: f64) -> (f64, f64);
}

/// y = μ γ̇: a fixed part remains.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Viscosity {
    share: f64,
}

impl Viscosity {
    /// From μ [Pa s] and G Δt [Pa s]. Without viscosity nothing remains.
    pub(crate) fn new(viscosity: f64, relaxation: f64) -> Self {
        let flows = viscosity > 0.0;
        Self { share: if flows { viscosity / (viscosity + relaxation) } else { 0.0 } }
    }
}

impl Overstress for Viscosity {
    #[inline(always)]
    fn relaxed(&self, trial: f64) -> (f64, f64) {
        (self.share * trial, self.share) // [VPF-2]
    }
}

/// y = K γ̇^n.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Power {
    /// 1/n [-]
    exponent: f64,
    /// ln(G Δt / K^(1/n))
    log_relaxation: f64,
}

impl Power {
    /// From K [Pa s^n], n [-] and G Δt [Pa s].
    pub(crate) fn new(consistency: f64, flow_index: f64, relaxation: f64) -> Self {
        let exponent = 1.0 / flow_index;
        Self { exponent, log_relaxation: relaxation.ln() - exponent * consistency.ln() }
    }

    /// Where Newton's method starts for the ln z of z + α z^m = 1, m = 1/n: the less of the roots without one of the terms.
    #[inline(always)]
    fn start(&self, log_alpha: f64) -> f64 {
        let other = -log_alpha / self.exponent;
        if other < 0.0 { other } else { 0.0 }
    }

    /// One of its iterations. The logarithm of the left side is a convex function of ln z with a slope between 1 and m, so that they fall to the
    /// root from above, and are near it from the start.
    #[inline(always)]
    fn nearer(&self, log_alpha: f64, u: f64) -> f64 {
        let (a, b) = (math::exp(u), math::exp(log_alpha + self.exponent * u));
        u - math::ln(a + b) * (a + b) / (a + self.exponent * b) // [VPF-3]
    }

    /// ln z after seven iterations, which is enough from the bad end of all exponents (tests). Not a loop, since that would not vectorise.
    #[inline(always)]
    fn log_part(&self, log_alpha: f64) -> f64 {
        let u = self.nearer(log_alpha, self.start(log_alpha));
        let u = self.nearer(log_alpha, self.nearer(log_alpha, u));
        let u = self.nearer(log_alpha, self.nearer(log_alpha, u));
        self.nearer(log_alpha, self.nearer(log_alpha, u))
    }
}

impl Overstress for Power {
    #[inline(always)]
    fn relaxed(&self, trial: f64) -> (f64, f64) {
        let log_alpha = self.log_relaxation + (self.exponent - 1.0) * math::ln(trial);
        let part = math::exp(self.log_part(log_alpha));
        (part * trial, part / (part + self.exponent * (1.0 - part)))
    }
}

/// Elastic up to the yield stress, then relaxing to the flow curve.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flow<O> {
    /// G [Pa]
    pub(crate) shear_modulus: f64,
    /// τ_y [Pa]
    pub(crate) yield_stress: f64,
    pub(crate) overstress: O,
}

/// An elastic trial and what becomes of it.
struct Trial {
    /// s* [Pa]
    deviator: [f64; 6],
    /// τ* [Pa]
    shear: f64,
    /// τ / τ* [-]
    scale: f64,
    /// dτ / dτ* [-]
    slope: f64,
}

impl<O: Overstress> Flow<O> {
    #[inline(always)]
    fn trial(&self, stress0: [f64; 6], strain: [f64; 6]) -> Trial {
        let mut s = deviator(stress0);
        for c in 0..6 {
            s[c] += 2.0 * self.shear_modulus * strain[c];
        }
        let shear = (0.5 * contract(s, s)).sqrt();
        let over = shear - self.yield_stress;
        let (remains, slope) = self.overstress.relaxed(over);
        let scale = (self.yield_stress + remains) / shear; // [VPF-1]
        // A stress that is too large for its square is not elastic either.
        let elastic = over <= 0.0;
        Trial {
            deviator: s,
            shear,
            scale: if elastic { 1.0 } else { scale },
            slope: if elastic { 1.0 } else { slope },
        }
    }
}

impl<O: Overstress> Deviator for Flow<O> {
    #[inline(always)]
    fn stress(&self, stress0: [f64; 6], strain: [f64; 6]) -> [f64; 6] {
        let trial = self.trial(stress0, strain);
        trial.deviator.map(|s| trial.scale * s)
    }

    fn tangent(&self, stress0: [f64; 6], strain: [f64; 6]) -> [[f64; 6]; 6] {
        let Trial { deviator: s, shear, scale, slope } = self.trial(stress0, strain);
        let g = self.shear_modulus;
        let mut tangent = elastic::stiffness([-2.0 / 3.0 * scale * g, scale * g]);
        if scale < 1.0 {
            for i in 0..6 {
                for j in 0..6 {
                    let places = if j < 3 { 1.0 } else { 2.0 };
                    tangent[i][j] += (slope - scale) * g * (s[i] / shear) * (s[j] / shear) * places;
                }
            }
        }
        tangent
    }

    #[inline(always)]
    fn wave_modulus(&self, bulk_modulus: f64) -> f64 {
        bulk_modulus + 4.0 / 3.0 * self.shear_modulus
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_iterations_of_a_power_end_at_round_off_for_every_exponent_and_step() {
        let (mut worst, mut change): (f64, f64) = (0.0, 0.0);
        for i in 0..400 {
            let flow_index = 0.05 * 100.0_f64.powf(f64::from(i) / 399.0);
            let power = Power::new(1.0, flow_index, 1.0);
            for j in -2000..=2000 {
                let log_alpha = f64::from(j) * 0.02 * (1.0 + f64::from((j % 10_i32).abs()));
                let u = power.log_part(log_alpha);
                let left = u.exp() + (log_alpha + power.exponent * u).exp();
                // The error of the exponent is that of ln α.
                worst = worst.max((left - 1.0).abs() / (1.0 + log_alpha.abs()));
                change = change.max((u - power.nearer(log_alpha, u)).abs() / (1.0 + u.abs()));
            }
        }
        assert!(worst < 2e-15, "{worst}");
        assert!(change < 2e-15, "{change}");
    }

    #[test]
    fn the_iterations_of_a_power_double_their_digits() {
        let power = Power::new(1.0, 0.2, 1.0);
        let mut u = power.start(0.0);
        let mut error = || {
            let error = u - power.log_part(0.0);
            u = power.nearer(0.0, u);
            error
        };
        let errors: Vec<f64> = (0..6).map(|_| error()).collect();
        // From above, each error at most a constant times the square of the one before.
        for pair in errors.windows(2).filter(|pair| pair[0] > 1e-7) {
            assert!(pair[1] > -1e-15 && pair[1] < 3.0 * pair[0] * pair[0], "{errors:?}");
        }
        assert!(errors[0] > 0.1 && errors[5].abs() < 1e-14, "{errors:?}");
    }

    #[test]
    fn a_power_of_one_is_a_viscosity() {
        for trial in [1e-3, 1.0, 1e6] {
            for relaxation in [0.0, 1e-9, 1.0, 1e9] {
                let (power, slope) = Power::new(3.0, 1.0, relaxation).relaxed(trial);
                let (part, share) = Viscosity::new(3.0, relaxation).relaxed(trial);
                assert!((power / part - 1.0).abs() < 1e-13 && (slope / share - 1.0).abs() < 1e-13);
            }
        }
    }
}
