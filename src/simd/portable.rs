//! Eight doubles in plain Rust: the path of every processor. Where the baseline has vectors, as on
//! AArch64, the compiler uses them.

use std::array::from_fn;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

use super::{LANES, Real, TileNode, Vector};

/// An array.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct Portable([f64; LANES]);

impl Portable {
    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self(from_fn(|l| f(self.0[l])))
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self(from_fn(|l| f(self.0[l], other.0[l])))
    }
}

impl Add for Portable {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl Sub for Portable {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl Mul for Portable {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl Div for Portable {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }
}

impl Neg for Portable {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

impl AddAssign for Portable {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Real for Portable {
    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self([x; LANES])
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        self * a + b
    }
    #[inline(always)]
    fn floor(self) -> Self {
        self.map(Real::floor)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.map(f64::sqrt)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.map(f64::abs)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, Real::max)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, Real::min)
    }
}

impl Vector for Portable {
    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        match from.first_chunk::<LANES>() {
            Some(lanes) => Self(*lanes),
            None => {
                let mut lanes = [0.0; LANES];
                lanes[..from.len()].copy_from_slice(from);
                Self(lanes)
            }
        }
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        match to.first_chunk_mut::<LANES>() {
            Some(lanes) => *lanes = self.0,
            None => to.copy_from_slice(&self.0[..to.len()]),
        }
    }
    #[inline(always)]
    fn from_array(lanes: [f64; LANES]) -> Self {
        Self(lanes)
    }
    #[inline(always)]
    fn to_array(self) -> [f64; LANES] {
        self.0
    }
    #[inline(always)]
    fn load_node(node: &TileNode) -> Self {
        Self(node.0)
    }
    #[inline(always)]
    fn store_node(self, node: &mut TileNode) {
        node.0 = self.0;
    }
    #[inline(always)]
    fn join(low: &[f64; 4], high: &[f64; 4]) -> Self {
        Self(from_fn(|l| if l < 4 { low[l] } else { high[l - 4] }))
    }
    #[inline(always)]
    fn part(self, low: &mut [f64; 4], high: &mut [f64; 4]) {
        low.copy_from_slice(&self.0[..4]);
        high.copy_from_slice(&self.0[4..]);
    }
    #[inline(always)]
    fn halves(low: f64, high: f64) -> Self {
        Self([low, low, low, low, high, high, high, high])
    }
    #[inline(always)]
    fn transpose(rows: [Self; LANES]) -> [Self; LANES] {
        from_fn(|l| Self(from_fn(|r| rows[r].0[l])))
    }
    #[inline(always)]
    fn to_indices(self) -> [u32; LANES] {
        self.0.map(|x| x as i32 as u32)
    }
    #[inline(always)]
    fn less_than(self, other: Self) -> u8 {
        (0..LANES).fold(0, |bits, l| bits | u8::from(self.0[l] < other.0[l]) << l)
    }
}
