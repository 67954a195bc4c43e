//! Pressure as a function of the volume ratio, in forms that vectorise.

use lahar_plugin::math;

/// Tait's equation p = K/γ (J^-γ - 1).
pub(crate) trait Pressure {
    /// p / K, tension included, and the tangent -J dp/dJ / K at the volume ratio `j` [-].
    fn relative(&self, j: f64) -> (f64, f64);
}

/// A whole exponent: J^-γ - 1 = (1 - J) (1 + J + ... + J^(γ-1)) / J^γ has no difference of nearly equal numbers.
pub(crate) struct Whole<const EXPONENT: usize>;

impl<const EXPONENT: usize> Pressure for Whole<EXPONENT> {
    #[inline(always)]
    fn relative(&self, j: f64) -> (f64, f64) {
        let (mut sum, mut power) = (1.0, j);
        for _ in 1..EXPONENT {
            sum = 1.0 + j * sum;
            power *= j;
        }
        let tangent = 1.0 / power;
        ((1.0 - j) * sum * tangent * (1.0 / EXPONENT as f64), tangent) // [NWT-1]
    }
}

/// Any exponent.
pub(crate) struct Real {
    pub(crate) exponent: f64,
}

impl Pressure for Real {
    #[inline(always)]
    fn relative(&self, j: f64) -> (f64, f64) {
        let power_minus_one = math::exp_m1(-self.exponent * math::ln(j));
        (power_minus_one / self.exponent, power_minus_one + 1.0) // [NWT-1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_whole_exponent_and_the_same_as_a_real_number_agree() {
        for i in 0..2000 {
            let j = 0.5 + f64::from(i) * 1e-3 + 1e-7;
            for (whole, exponent) in [(Whole::<1>.relative(j), 1.0), (Whole::<7>.relative(j), 7.0)]
            {
                let real = Real { exponent }.relative(j);
                let exact = (-exponent * j.ln()).exp_m1() / exponent;
                // The error of ln J, at most a few units in the last place of its argument, times the exponent.
                let bound = 2e-15 * (1.0 + exact.abs() * exponent);
                assert!((whole.0 - exact).abs() < bound, "{j}: {} {exact}", whole.0);
                assert!((real.0 - exact).abs() < bound, "{j}: {} {exact}", real.0);
                assert!((whole.1 - real.1).abs() < 7.0 * bound);
            }
        }
    }

    #[test]
    fn volumes_that_cannot_be_have_no_finite_wave_speed_or_pressure() {
        for j in [0.0, f64::NAN, 1e-300] {
            for (p, tangent) in [Whole::<7>.relative(j), Real { exponent: 7.0 }.relative(j)] {
                assert!(!(p.is_finite() && tangent.is_finite()), "{j}");
            }
        }
    }
}
