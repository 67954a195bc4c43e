//! Automatic differentiation: a number with its first and second derivatives with respect to X, Y, Z and t.

use std::ops::{Add, Mul, Neg, Sub};

/// Independent variables: three coordinates and the time.
pub const VARIABLES: usize = 4;

/// Value, gradient and second derivatives.
#[derive(Clone, Copy, Debug)]
pub struct Jet {
    /// f.
    pub value: f64,
    /// ∂f/∂x_a.
    pub first: [f64; VARIABLES],
    /// ∂²f/∂x_a∂x_b.
    pub second: [[f64; VARIABLES]; VARIABLES],
}

impl Jet {
    /// A constant.
    pub fn constant(value: f64) -> Self {
        Self { value, first: [0.0; VARIABLES], second: [[0.0; VARIABLES]; VARIABLES] }
    }

    /// The variable with this number.
    pub fn variable(number: usize, value: f64) -> Self {
        let mut jet = Self::constant(value);
        jet.first[number] = 1.0;
        jet
    }

    /// f(self) from f, f′ and f″ at the value.
    fn chain(self, [f, df, ddf]: [f64; 3]) -> Self {
        let g = self.first;
        let second = |a: usize, b: usize| df * self.second[a][b] + ddf * g[a] * g[b];
        Self { value: f, first: g.map(|g| df * g), second: table(second) }
    }

    /// Sine and cosine.
    pub fn sin_cos(self) -> (Self, Self) {
        let (s, c) = self.value.sin_cos();
        (self.chain([s, c, -s]), self.chain([c, -s, -c]))
    }

    /// Sine.
    pub fn sin(self) -> Self {
        self.sin_cos().0
    }

    /// Square root of a positive number.
    pub fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain([root, 0.5 / root, -0.25 / (root * self.value)])
    }
}

fn table(entry: impl Fn(usize, usize) -> f64) -> [[f64; VARIABLES]; VARIABLES] {
    std::array::from_fn(|a| std::array::from_fn(|b| entry(a, b)))
}

impl Add for Jet {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            first: std::array::from_fn(|a| self.first[a] + other.first[a]),
            second: table(|a, b| self.second[a][b] + other.second[a][b]),
        }
    }
}

impl Mul for Jet {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        product(&self, &other)
    }
}

/// The product rule.
fn product(f: &Jet, g: &Jet) -> Jet {
    let mixed = |a: usize, b: usize| f.first[a] * g.first[b] + f.first[b] * g.first[a];
    let own = |a: usize, b: usize| f.value * g.second[a][b] + g.value * f.second[a][b];
    Jet {
        value: f.value * g.value,
        first: std::array::from_fn(|a| f.value * g.first[a] + g.value * f.first[a]),
        second: table(|a, b| own(a, b) + mixed(a, b)),
    }
}

impl Neg for Jet {
    type Output = Self;
    fn neg(self) -> Self {
        self * -1.0
    }
}

impl Sub for Jet {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Add<f64> for Jet {
    type Output = Self;
    fn add(self, number: f64) -> Self {
        Self { value: self.value + number, ..self }
    }
}

impl Mul<f64> for Jet {
    type Output = Self;
    fn mul(self, number: f64) -> Self {
        Self {
            value: self.value * number,
            first: self.first.map(|f| f * number),
            second: self.second.map(|row| row.map(|f| f * number)),
        }
    }
}
