//! Functions of one double without branches and calls, for loops that are to vectorise. The standard library's call
//! the system's mathematical library one value at a time.
//!
//! Errors are below 2 units in the last place. Values that are not finite are those of the standard library.

/// 1.5 * 2^52: adding it rounds to a whole number, which then stands in the low bits.
const ROUND: f64 = 6_755_399_441_055_744.0;
/// ln 2 in two parts; products of the first with whole numbers below 2^20 are exact.
const LN2_HIGH: f64 = f64::from_bits(0x3fe6_2e42_fee0_0000);
const LN2_LOW: f64 = f64::from_bits(0x3dea_39ef_3579_3c76);

/// 1/3!, 1/4!, ..., 1/14!: with the first three terms the series of exp is exact to 1e-18 up to ln 2 / 2.
const INVERSE_FACTORIALS: [f64; 12] = {
    let (mut values, mut factorial, mut i) = ([0.0; 12], 2.0, 0);
    while i < 12 {
        factorial *= (i + 3) as f64;
        values[i] = 1.0 / factorial;
        i += 1;
    }
    values
};

/// e^x = 2^k (1 + f): f = e^r - 1 with |r| at most ln 2 / 2, and two factors whose product is 2^k (one alone could
/// overflow or be zero).
struct Exponential {
    fraction: f64,
    scale: [f64; 2],
    inverse_of_second: f64,
}

impl Exponential {
    #[inline(always)]
    fn of(x: f64) -> Self {
        // Beyond these the result is 0 or infinite; written so that NaN stays.
        let x = if x < -746.0 { -746.0 } else { x };
        let x = if x > 710.0 { 710.0 } else { x };
        let rounded = x * std::f64::consts::LOG2_E + ROUND;
        let k = rounded - ROUND;
        let r = (x - k * LN2_HIGH) - k * LN2_LOW;
        let square = r * r;
        let a = INVERSE_FACTORIALS;
        let odd = a[0]
            + square
                * (a[2] + square * (a[4] + square * (a[6] + square * (a[8] + square * a[10]))));
        let even = a[1]
            + square
                * (a[3] + square * (a[5] + square * (a[7] + square * (a[9] + square * a[11]))));
        let fraction = r + square * (0.5 + r * (odd + r * even));
        // The bits of `rounded` are those of ROUND plus k. Halves of k + 2048 are exponents of the two factors.
        let shifted = rounded.to_bits().wrapping_sub(ROUND.to_bits()).wrapping_add(2048);
        let first = shifted >> 1;
        let second = shifted.wrapping_sub(first);
        let power = |exponent: u64| f64::from_bits(exponent.wrapping_sub(1) << 52); // of 2, less 1024
        Self {
            fraction,
            scale: [power(first), power(second)],
            inverse_of_second: power(2048_u64.wrapping_sub(second)),
        }
    }
}

/// e^x.
#[inline(always)]
pub fn exp(x: f64) -> f64 {
    let Exponential { fraction, scale, .. } = Exponential::of(x);
    (scale[0] + scale[0] * fraction) * scale[1]
}

/// e^x - 1, accurate for small x too.
#[inline(always)]
pub fn exp_m1(x: f64) -> f64 {
    let Exponential { fraction, scale, inverse_of_second } = Exponential::of(x);
    ((scale[0] - inverse_of_second) + scale[0] * fraction) * scale[1]
}

/// Natural logarithm; minus infinity at 0, not a number below.
#[inline(always)]
pub fn ln(x: f64) -> f64 {
    // Subnormal numbers are made normal first.
    let subnormal = x < f64::MIN_POSITIVE;
    let (normal, bias) =
        if subnormal { (x * 18_014_398_509_481_984.0, 1023.0 + 54.0) } else { (x, 1023.0) };
    // x = 2^k m with m in [sqrt(1/2), sqrt(2)).
    const SQRT_HALF: u64 = 0x3fe6_a09e_667f_3bcd;
    const ONE: u64 = 0x3ff0_0000_0000_0000;
    let bits = normal.to_bits();
    let exponent = bits.wrapping_add(ONE - SQRT_HALF) >> 52;
    let m = f64::from_bits(bits.wrapping_sub(exponent << 52).wrapping_add(ONE));
    // A whole number below 2^52 in the low bits of 2^52.
    let k = f64::from_bits(exponent | 0x4330_0000_0000_0000) - 4_503_599_627_370_496.0 - bias;
    // ln(1 + f) = f - f^2/2 + s (f^2/2 + R(s^2)), s = f / (2 + f); R of the FreeBSD library (Sun Microsystems, 1993).
    let f = m - 1.0;
    let s = f / (2.0 + f);
    let z = s * s;
    let r = z
        * (6.666_666_666_666_735e-1
            + z * (3.999_999_999_940_942e-1
                + z * (2.857_142_874_366_239e-1
                    + z * (2.222_219_843_214_978_4e-1
                        + z * (1.818_357_216_161_805e-1
                            + z * (1.531_383_769_920_937_3e-1
                                + z * 1.479_819_860_511_658_6e-1))))));
    let half_square = 0.5 * f * f;
    let finite = k * LN2_HIGH - ((half_square - (s * (half_square + r) + k * LN2_LOW)) - f);
    // Also infinity and NaN, which are their own logarithms.
    let value = if x < f64::INFINITY { finite } else { x };
    let value = if x == 0.0 { f64::NEG_INFINITY } else { value };
    if x < 0.0 { f64::NAN } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distance in units in the last place of `expected`.
    fn ulps(value: f64, expected: f64) -> f64 {
        if value == expected || (value.is_nan() && expected.is_nan()) {
            return 0.0;
        }
        let unit = f64::from_bits(expected.abs().to_bits() + 1) - expected.abs();
        (value - expected).abs() / unit
    }

    fn worst(f: fn(f64) -> f64, exact: fn(f64) -> f64, values: impl Iterator<Item = f64>) -> f64 {
        values.map(|x| ulps(f(x), exact(x))).fold(0.0, |a, b| if b <= a { a } else { b })
    }

    /// Numbers of both signs whose magnitudes run evenly over the exponents from `low` to `high`.
    fn scattered(low: f64, high: f64) -> impl Iterator<Item = f64> {
        (0..200_000).flat_map(move |i| {
            let t = f64::from(i) / 2e5 + f64::from(i % 97) * 1e-7;
            let x = (low.ln() + t * (high / low).ln()).exp();
            [x, -x]
        })
    }

    #[test]
    fn exponentials_are_those_of_the_standard_library() {
        for (low, high) in [(1e-300, 1e-3), (1e-3, 1.0), (1.0, 700.0)] {
            let e = worst(exp, f64::exp, scattered(low, high));
            let m = worst(exp_m1, f64::exp_m1, scattered(low, high));
            assert!(e <= 2.0 && m <= 2.0, "{low} to {high}: {e} and {m}");
        }
        // Results that are subnormal are rounded twice, still within a unit of the smallest number.
        let steps = (0..50_000).map(|i| -700.0 - f64::from(i) * 1e-3);
        assert!(worst(exp, f64::exp, steps) <= 2.0);
        assert!(worst(exp, f64::exp, (0..1000).map(|i| 709.0 + f64::from(i) * 1e-3)) <= 2.0);
    }

    #[test]
    fn logarithms_are_those_of_the_standard_library() {
        for (low, high) in [(5e-324, 1e-300), (1e-300, 0.5), (0.5, 2.0), (2.0, 1.7e308)] {
            let e = worst(ln, f64::ln, scattered(low, high).filter(|x| *x > 0.0));
            assert!(e <= 2.0, "{low} to {high}: {e}");
        }
        let near_one = (-100_000..100_000).map(|i| 1.0 + f64::from(i) * 1e-9);
        assert!(worst(ln, f64::ln, near_one) <= 2.0);
    }

    #[test]
    fn what_is_not_an_ordinary_number_gives_what_the_standard_library_gives() {
        let values = [
            0.0,
            -0.0,
            1.0,
            -1.0,
            5e-324,
            -5e-324,
            f64::MIN_POSITIVE,
            f64::MAX,
            f64::MIN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::NAN,
            -745.2,
            -745.0,
            709.79,
            709.78,
            710.0,
            1e300,
            -1e300,
        ];
        for x in values {
            assert!(ulps(exp(x), x.exp()) <= 1.0, "exp {x}: {} {}", exp(x), x.exp());
            assert!(ulps(exp_m1(x), x.exp_m1()) <= 1.0, "exp_m1 {x}: {}", exp_m1(x));
            assert!(ulps(ln(x), x.ln()) <= 1.0, "ln {x}: {} {}", ln(x), x.ln());
        }
    }
}
