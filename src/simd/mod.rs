//! Eight doubles at once: the type that the kernels are written in, and the choice of instruction
//! set at run time.
//!
//! The shipped library is built for the baseline processor. A kernel is written once, generic over
//! [`Vector`]; [`Isa::dispatch`] runs the copy that was compiled for the widest instruction set
//! that the processor has and `LAHAR_SIMD` allows. Within a path results are reproducible to the
//! last bit; between paths they differ by round-off, since some fuse multiplication and addition.

pub(crate) mod environment;
mod portable;
mod table;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use table::Table;

use std::ffi::CStr;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

use crate::error::{Error, Result};

/// An array whose element i is an expression of i, in one dimension or two: `each!(i in N => …)`,
/// `each!(a in N, b in M => …)`.
///
/// In kernels it stands for `std::array::from_fn` and `map`: a closure is a function of its own,
/// which the compiler may leave outside the copy that is made for an instruction set, at twenty
/// times the cost.
macro_rules! each {
    ($i:ident in $n:expr => $value:expr) => {{
        let mut out = [$crate::simd::Real::splat(0.0); $n];
        for $i in 0..$n {
            out[$i] = $value;
        }
        out
    }};
    ($i:ident in $n:expr, $j:ident in $m:expr => $value:expr) => {{
        let mut out = [[$crate::simd::Real::splat(0.0); $m]; $n];
        for $i in 0..$n {
            for $j in 0..$m {
                out[$i][$j] = $value;
            }
        }
        out
    }};
}
pub(crate) use each;

/// Lanes of a [`Vector`].
pub const LANES: usize = 8;

/// A node of a tile: two records of four lanes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(64))]
pub struct TileNode(pub [f64; LANES]);

/// What formulas are written in: one double, or eight.
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
{
    /// The number in every lane.
    fn splat(x: f64) -> Self;
    /// self · a + b, with one rounding where the processor has the instruction.
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// The largest whole number not above, for |x| < 2^51; not finite if x is not.
    fn floor(self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Magnitude.
    fn abs(self) -> Self;
    /// The larger number; either if one is not a number.
    fn max(self, other: Self) -> Self;
    /// The smaller number; either if one is not a number.
    fn min(self, other: Self) -> Self;
}

/// Eight doubles.
pub trait Vector: Real {
    /// The first eight numbers; zeros where there are fewer.
    fn load(from: &[f64]) -> Self;
    /// Writes the first eight numbers, or as many as there is room for.
    fn store(self, to: &mut [f64]);
    /// The lanes as they stand.
    fn from_array(lanes: [f64; LANES]) -> Self;
    /// The lanes as they stand.
    fn to_array(self) -> [f64; LANES];
    /// Both records of a node.
    fn load_node(node: &TileNode) -> Self;
    /// Writes both records of a node.
    fn store_node(self, node: &mut TileNode);
    /// `low` in the first four lanes, `high` in the last four.
    fn join(low: &[f64; 4], high: &[f64; 4]) -> Self;
    /// Writes the first four lanes to `low`, the last four to `high`.
    fn part(self, low: &mut [f64; 4], high: &mut [f64; 4]);
    /// `low` in the first four lanes, `high` in the last four.
    fn halves(low: f64, high: f64) -> Self;
    /// Lane l of row r becomes lane r of row l.
    fn transpose(rows: [Self; LANES]) -> [Self; LANES];
    /// Whole numbers from 0 to 2^31 − 1; anything else gives any numbers.
    fn to_indices(self) -> [u32; LANES];
    /// Bit l is set where lane l is less than that of `other`.
    fn less_than(self, other: Self) -> u8;

    /// The largest lane.
    #[inline(always)]
    fn largest(self) -> f64 {
        self.to_array().into_iter().fold(f64::NEG_INFINITY, f64::max)
    }

    /// The sum of the lanes.
    #[inline(always)]
    fn sum(self) -> f64 {
        let [a, b, c, d, e, f, g, h] = self.to_array();
        ((a + b) + (c + d)) + ((e + f) + (g + h))
    }
}

/// Prefetches the cache line of element `index`, which may lie behind the end.
#[inline(always)]
pub fn prefetch<T>(list: &[T], index: usize) {
    #[cfg(target_arch = "x86_64")]
    x86::prefetch(list.as_ptr().wrapping_add(index));
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (list, index);
}

/// The whole number nearest to x, for |x| < 2^51: doubles around 1.5 · 2^52 are whole, so that
/// adding it rounds.
#[inline(always)]
fn nearest_whole(x: f64) -> f64 {
    const ONLY_WHOLE: f64 = 6_755_399_441_055_744.0; // 1.5 · 2^52
    (x + ONLY_WHOLE) - ONLY_WHOLE
}

impl Real for f64 {
    #[inline(always)]
    fn splat(x: f64) -> Self {
        x
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        self * a + b // without the instruction a fused product is a slow call
    }
    /// The baseline instruction set has no rounding instruction, and the library call costs more
    /// than the rest of a weight.
    #[inline(always)]
    fn floor(self) -> Self {
        let nearest = nearest_whole(self);
        if nearest > self { nearest - 1.0 } else { nearest }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
}

/// Work that is compiled once per instruction set. `run` must be `#[inline(always)]`, and so must
/// what it calls with vectors; that excludes closures (see [`each`]).
pub trait Kernel {
    /// The result of the work.
    type Output;
    /// Does the work with vectors `V`.
    fn run<V: Vector>(self) -> Self::Output;
}

/// An instruction set that this processor has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Isa(Level); // private: whoever holds one may use its instructions

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Level {
    Scalar,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

/// All levels of this build, the best last.
const LEVELS: &[Level] = &[
    Level::Scalar,
    #[cfg(target_arch = "x86_64")]
    Level::Avx2,
    #[cfg(target_arch = "x86_64")]
    Level::Avx512,
];

impl Level {
    fn is_supported(self) -> bool {
        match self {
            Self::Scalar => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => x86::has_avx2(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => x86::has_avx512(),
        }
    }

    fn name(self) -> &'static CStr {
        match self {
            Self::Scalar => c"scalar",
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => c"avx2",
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => c"avx512",
        }
    }
}

impl Isa {
    /// The best that this processor has.
    pub fn best() -> Self {
        let best = LEVELS.iter().rev().find(|level| level.is_supported());
        Self(best.copied().unwrap_or(Level::Scalar))
    }

    /// Every one that this processor has, the best last.
    pub fn all() -> impl Iterator<Item = Self> {
        LEVELS.iter().copied().filter(|level| level.is_supported()).map(Self)
    }

    /// The one with this name, or an error if it is unknown or the processor lacks it.
    pub fn named(name: &str) -> Result<Self> {
        let list = |levels: &mut dyn Iterator<Item = Self>| {
            levels.map(Self::name).collect::<Vec<_>>().join(", ")
        };
        let mut known = LEVELS.iter().copied().map(Self);
        let Some(Self(level)) = known.clone().find(|isa| isa.name() == name) else {
            let list = list(&mut known);
            return Err(Error::invalid(format!("LAHAR_SIMD must be one of {list}, got `{name}`")));
        };
        if !level.is_supported() {
            let list = list(&mut Self::all());
            return Err(Error::invalid(format!(
                "LAHAR_SIMD asks for `{name}`, which this processor does not have (it has {list})"
            )));
        }
        Ok(Self(level))
    }

    /// The one that `LAHAR_SIMD` names, or the best where it is not set. Errors as for
    /// [`Isa::named`].
    pub fn of_environment() -> Result<Self> {
        match std::env::var_os("LAHAR_SIMD") {
            None => Ok(Self::best()),
            Some(name) => Self::named(name.to_string_lossy().trim()),
        }
    }

    /// "scalar", "avx2" or "avx512".
    pub fn name(self) -> &'static str {
        self.name_c().to_str().unwrap_or_default()
    }

    /// The same.
    pub fn name_c(self) -> &'static CStr {
        self.0.name()
    }

    /// Runs the copy of the work that was compiled for this instruction set.
    #[inline]
    pub fn dispatch<K: Kernel>(self, kernel: K) -> K::Output {
        match self.0 {
            Level::Scalar => kernel.run::<portable::Portable>(),
            #[cfg(target_arch = "x86_64")]
            // SAFETY: an `Isa` of this level is only made if the processor supports it.
            Level::Avx2 => unsafe { x86::with_avx2(kernel) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Level::Avx512 => unsafe { x86::with_avx512(kernel) },
        }
    }
}

#[cfg(test)]
mod tests;
