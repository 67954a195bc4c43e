//! Numbers that carry their derivatives, so that one source gives the stress, the matrix of Newton's method and the
//! consistent tangent. Values are those of plain doubles, bit for bit.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A double, or one with derivatives.
pub(crate) trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
{
    /// A constant.
    fn of(value: f64) -> Self;
    fn value(self) -> f64;
    fn exp(self) -> Self;
    fn ln(self) -> Self;
    fn sqrt(self) -> Self;
    fn powf(self, exponent: f64) -> Self;

    fn max(self, least: f64) -> Self {
        if self.value() > least { self } else { Self::of(least) }
    }

    fn min(self, most: f64) -> Self {
        if self.value() < most { self } else { Self::of(most) }
    }

    fn abs(self) -> Self {
        if self.value() < 0.0 { -self } else { self }
    }
}

impl Real for f64 {
    fn of(value: f64) -> Self {
        value
    }

    fn value(self) -> f64 {
        self
    }

    fn exp(self) -> Self {
        f64::exp(self)
    }

    fn ln(self) -> Self {
        f64::ln(self)
    }

    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    fn powf(self, exponent: f64) -> Self {
        f64::powf(self, exponent)
    }
}

/// A value and its derivatives by `N` variables.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dual<const N: usize> {
    value: f64,
    pub(crate) derivatives: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// Variable `i`.
    pub(crate) fn variable(value: f64, i: usize) -> Self {
        let mut derivatives = [0.0; N];
        derivatives[i] = 1.0;
        Self { value, derivatives }
    }

    /// f(self) from its value and its slope.
    fn chain(self, value: f64, slope: f64) -> Self {
        Self { value, derivatives: self.derivatives.map(|d| slope * d) }
    }

    fn join(self, other: Self, value: f64, [a, b]: [f64; 2]) -> Self {
        let mut derivatives = [0.0; N];
        for (i, d) in derivatives.iter_mut().enumerate() {
            *d = a * self.derivatives[i] + b * other.derivatives[i];
        }
        Self { value, derivatives }
    }
}

impl<const N: usize> Real for Dual<N> {
    fn of(value: f64) -> Self {
        Self { value, derivatives: [0.0; N] }
    }

    fn value(self) -> f64 {
        self.value
    }

    fn exp(self) -> Self {
        let e = self.value.exp();
        self.chain(e, e)
    }

    fn ln(self) -> Self {
        self.chain(self.value.ln(), 1.0 / self.value)
    }

    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, if root > 0.0 { 0.5 / root } else { 0.0 })
    }

    fn powf(self, exponent: f64) -> Self {
        let slope = if exponent == 0.0 { 0.0 } else { exponent * self.value.powf(exponent - 1.0) };
        self.chain(self.value.powf(exponent), slope)
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    fn neg(self) -> Self {
        self.chain(-self.value, -1.0)
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.join(other, self.value + other.value, [1.0, 1.0])
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.join(other, self.value - other.value, [1.0, -1.0])
    }
}

impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.join(other, self.value * other.value, [other.value, self.value])
    }
}

impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let ratio = self.value / other.value;
        self.join(other, ratio, [1.0 / other.value, -ratio / other.value])
    }
}

impl<const N: usize> Add<f64> for Dual<N> {
    type Output = Self;
    fn add(self, other: f64) -> Self {
        self.chain(self.value + other, 1.0)
    }
}

impl<const N: usize> Sub<f64> for Dual<N> {
    type Output = Self;
    fn sub(self, other: f64) -> Self {
        self.chain(self.value - other, 1.0)
    }
}

impl<const N: usize> Mul<f64> for Dual<N> {
    type Output = Self;
    fn mul(self, other: f64) -> Self {
        self.chain(self.value * other, other)
    }
}

impl<const N: usize> Div<f64> for Dual<N> {
    type Output = Self;
    fn div(self, other: f64) -> Self {
        self.chain(self.value / other, 1.0 / other)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample<T: Real>(x: T, y: T) -> T {
        let product = x * y - y / x + (x * 0.3).exp() * (y + 2.0).ln();
        (product * product + 1.0).sqrt() * (-(x - 3.0)).powf(0.7) / 2.0 - y.abs().max(0.1).min(9.0)
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        let (x, y, h) = (1.3, -0.4, 1e-6);
        let dual = sample(Dual::<2>::variable(x, 0), Dual::variable(y, 1));
        assert_eq!(dual.value(), sample(x, y));
        let by_x = (sample(x + h, y) - sample(x - h, y)) / (2.0 * h);
        let by_y = (sample(x, y + h) - sample(x, y - h)) / (2.0 * h);
        assert!((dual.derivatives[0] - by_x).abs() < 1e-8);
        assert!((dual.derivatives[1] - by_y).abs() < 1e-8);
    }
}
