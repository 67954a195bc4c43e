//! Eight doubles in two AVX2 registers or one AVX-512 register.
//!
//! The types are private to `simd`, and only `Isa::dispatch` makes kernels use them, with an `Isa`
//! that the processor supports: that is why every intrinsic below is sound. Pointers come from
//! slices and arrays whose length has been checked beside the call.

use std::arch::x86_64::*;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

use super::{Kernel, LANES, Real, TileNode, Vector};

/// Calls an intrinsic.
macro_rules! with {
    ($call:expr) => {
        // SAFETY: the processor has the instruction (see the module), and pointers are checked
        // beside the call.
        unsafe { $call }
    };
}

pub(super) fn has_avx2() -> bool {
    is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")
}

pub(super) fn has_avx512() -> bool {
    has_avx2()
        && is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512vl")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512bw")
}

/// # Safety
///
/// [`has_avx2`] holds.
#[target_feature(enable = "avx2,fma")]
pub(super) unsafe fn with_avx2<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<Avx2>()
}

/// # Safety
///
/// [`has_avx512`] holds.
#[target_feature(enable = "avx2,fma,avx512f,avx512vl,avx512dq,avx512bw")]
pub(super) unsafe fn with_avx512<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<Avx512>()
}

/// Prefetches the cache line of an address, which may be any.
#[inline(always)]
pub(super) fn prefetch<T>(address: *const T) {
    with!(_mm_prefetch::<_MM_HINT_T0>(address.cast()));
}

/// Two registers of four lanes.
#[derive(Clone, Copy)]
pub(super) struct Avx2(__m256d, __m256d);

/// One register of eight lanes.
#[derive(Clone, Copy)]
pub(super) struct Avx512(__m512d);

/// An operator of both types.
macro_rules! operator {
    ($trait:ident, $name:ident, $four:ident, $eight:ident) => {
        impl $trait for Avx2 {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                with!(Self($four(self.0, other.0), $four(self.1, other.1)))
            }
        }
        impl $trait for Avx512 {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                with!(Self($eight(self.0, other.0)))
            }
        }
    };
}
operator!(Add, add, _mm256_add_pd, _mm512_add_pd);
operator!(Sub, sub, _mm256_sub_pd, _mm512_sub_pd);
operator!(Mul, mul, _mm256_mul_pd, _mm512_mul_pd);
operator!(Div, div, _mm256_div_pd, _mm512_div_pd);

impl Neg for Avx2 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let sign = with!(_mm256_set1_pd(-0.0));
        with!(Self(_mm256_xor_pd(self.0, sign), _mm256_xor_pd(self.1, sign)))
    }
}

impl Neg for Avx512 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        with!(Self(_mm512_xor_pd(self.0, _mm512_set1_pd(-0.0))))
    }
}

impl AddAssign for Avx2 {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl AddAssign for Avx512 {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Real for Avx2 {
    #[inline(always)]
    fn splat(x: f64) -> Self {
        let four = with!(_mm256_set1_pd(x));
        Self(four, four)
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        with!(Self(_mm256_fmadd_pd(self.0, a.0, b.0), _mm256_fmadd_pd(self.1, a.1, b.1)))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        with!(Self(_mm256_floor_pd(self.0), _mm256_floor_pd(self.1)))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        with!(Self(_mm256_sqrt_pd(self.0), _mm256_sqrt_pd(self.1)))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        let sign = with!(_mm256_set1_pd(-0.0));
        with!(Self(_mm256_andnot_pd(sign, self.0), _mm256_andnot_pd(sign, self.1)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        with!(Self(_mm256_max_pd(self.0, other.0), _mm256_max_pd(self.1, other.1)))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        with!(Self(_mm256_min_pd(self.0, other.0), _mm256_min_pd(self.1, other.1)))
    }
}

/// Four rows of four, transposed.
#[inline(always)]
fn transpose4([a, b, c, d]: [__m256d; 4]) -> [__m256d; 4] {
    with!({
        let (ab0, ab1) = (_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
        let (cd0, cd1) = (_mm256_unpacklo_pd(c, d), _mm256_unpackhi_pd(c, d));
        [
            _mm256_permute2f128_pd::<0x20>(ab0, cd0),
            _mm256_permute2f128_pd::<0x20>(ab1, cd1),
            _mm256_permute2f128_pd::<0x31>(ab0, cd0),
            _mm256_permute2f128_pd::<0x31>(ab1, cd1),
        ]
    })
}

/// All bits set in the first `n` of eight lanes.
#[inline(always)]
fn masks(n: usize) -> (__m256i, __m256i) {
    with!({
        let n = _mm256_set1_epi64x(n as i64);
        let low = _mm256_set_epi64x(3, 2, 1, 0);
        let high = _mm256_set_epi64x(7, 6, 5, 4);
        (_mm256_cmpgt_epi64(n, low), _mm256_cmpgt_epi64(n, high))
    })
}

impl Vector for Avx2 {
    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        let base = from.as_ptr();
        if from.len() >= LANES {
            return with!(Self(_mm256_loadu_pd(base), _mm256_loadu_pd(base.add(4))));
        }
        let (low, high) = masks(from.len());
        // masked lanes are not read, so the second base may lie behind the slice
        with!(Self(_mm256_maskload_pd(base, low), _mm256_maskload_pd(base.wrapping_add(4), high)))
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        let base = to.as_mut_ptr();
        if to.len() >= LANES {
            with!({
                _mm256_storeu_pd(base, self.0);
                _mm256_storeu_pd(base.add(4), self.1);
            });
            return;
        }
        let (low, high) = masks(to.len());
        with!({
            _mm256_maskstore_pd(base, low, self.0);
            _mm256_maskstore_pd(base.wrapping_add(4), high, self.1);
        });
    }
    #[inline(always)]
    fn from_array(lanes: [f64; LANES]) -> Self {
        Self::load(&lanes)
    }
    #[inline(always)]
    fn to_array(self) -> [f64; LANES] {
        let mut lanes = [0.0; LANES];
        self.store(&mut lanes);
        lanes
    }
    #[inline(always)]
    fn load_node(node: &TileNode) -> Self {
        let base = node.0.as_ptr(); // aligned to 64 bytes
        with!(Self(_mm256_load_pd(base), _mm256_load_pd(base.add(4))))
    }
    #[inline(always)]
    fn store_node(self, node: &mut TileNode) {
        let base = node.0.as_mut_ptr(); // aligned to 64 bytes
        with!({
            _mm256_store_pd(base, self.0);
            _mm256_store_pd(base.add(4), self.1);
        });
    }
    #[inline(always)]
    fn join(low: &[f64; 4], high: &[f64; 4]) -> Self {
        with!(Self(_mm256_loadu_pd(low.as_ptr()), _mm256_loadu_pd(high.as_ptr())))
    }
    #[inline(always)]
    fn part(self, low: &mut [f64; 4], high: &mut [f64; 4]) {
        with!({
            _mm256_storeu_pd(low.as_mut_ptr(), self.0);
            _mm256_storeu_pd(high.as_mut_ptr(), self.1);
        });
    }
    #[inline(always)]
    fn halves(low: f64, high: f64) -> Self {
        with!(Self(_mm256_set1_pd(low), _mm256_set1_pd(high)))
    }
    #[inline(always)]
    fn transpose(r: [Self; LANES]) -> [Self; LANES] {
        let a = transpose4([r[0].0, r[1].0, r[2].0, r[3].0]);
        let b = transpose4([r[0].1, r[1].1, r[2].1, r[3].1]);
        let c = transpose4([r[4].0, r[5].0, r[6].0, r[7].0]);
        let d = transpose4([r[4].1, r[5].1, r[6].1, r[7].1]);
        [
            Self(a[0], c[0]),
            Self(a[1], c[1]),
            Self(a[2], c[2]),
            Self(a[3], c[3]),
            Self(b[0], d[0]),
            Self(b[1], d[1]),
            Self(b[2], d[2]),
            Self(b[3], d[3]),
        ]
    }
    #[inline(always)]
    fn to_indices(self) -> [u32; LANES] {
        let mut indices = [0; LANES];
        let base = indices.as_mut_ptr();
        with!({
            _mm_storeu_si128(base.cast(), _mm256_cvttpd_epi32(self.0));
            _mm_storeu_si128(base.add(4).cast(), _mm256_cvttpd_epi32(self.1));
        });
        indices
    }
    #[inline(always)]
    fn less_than(self, other: Self) -> u8 {
        with!({
            let low = _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(self.0, other.0));
            let high = _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(self.1, other.1));
            (low | high << 4) as u8
        })
    }
}

impl Real for Avx512 {
    #[inline(always)]
    fn splat(x: f64) -> Self {
        with!(Self(_mm512_set1_pd(x)))
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        with!(Self(_mm512_fmadd_pd(self.0, a.0, b.0)))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        with!(Self(_mm512_roundscale_pd::<0x01>(self.0)))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        with!(Self(_mm512_sqrt_pd(self.0)))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        with!(Self(_mm512_abs_pd(self.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        with!(Self(_mm512_max_pd(self.0, other.0)))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        with!(Self(_mm512_min_pd(self.0, other.0)))
    }
}

/// One bit for each of the first `n` lanes, n < 8.
#[inline(always)]
fn bits(n: usize) -> u8 {
    ((1_u32 << n) - 1) as u8
}

impl Vector for Avx512 {
    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        let base = from.as_ptr();
        if from.len() >= LANES {
            return with!(Self(_mm512_loadu_pd(base)));
        }
        with!(Self(_mm512_maskz_loadu_pd(bits(from.len()), base)))
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        let base = to.as_mut_ptr();
        if to.len() >= LANES {
            with!(_mm512_storeu_pd(base, self.0));
            return;
        }
        with!(_mm512_mask_storeu_pd(base, bits(to.len()), self.0));
    }
    #[inline(always)]
    fn from_array(lanes: [f64; LANES]) -> Self {
        with!(Self(_mm512_loadu_pd(lanes.as_ptr())))
    }
    #[inline(always)]
    fn to_array(self) -> [f64; LANES] {
        let mut lanes = [0.0; LANES];
        with!(_mm512_storeu_pd(lanes.as_mut_ptr(), self.0));
        lanes
    }
    #[inline(always)]
    fn load_node(node: &TileNode) -> Self {
        with!(Self(_mm512_load_pd(node.0.as_ptr()))) // aligned to 64 bytes
    }
    #[inline(always)]
    fn store_node(self, node: &mut TileNode) {
        with!(_mm512_store_pd(node.0.as_mut_ptr(), self.0)); // aligned to 64 bytes
    }
    #[inline(always)]
    fn join(low: &[f64; 4], high: &[f64; 4]) -> Self {
        with!({
            let low = _mm512_castpd256_pd512(_mm256_loadu_pd(low.as_ptr()));
            Self(_mm512_insertf64x4::<1>(low, _mm256_loadu_pd(high.as_ptr())))
        })
    }
    #[inline(always)]
    fn part(self, low: &mut [f64; 4], high: &mut [f64; 4]) {
        with!({
            _mm256_storeu_pd(low.as_mut_ptr(), _mm512_castpd512_pd256(self.0));
            _mm256_storeu_pd(high.as_mut_ptr(), _mm512_extractf64x4_pd::<1>(self.0));
        });
    }
    #[inline(always)]
    fn halves(low: f64, high: f64) -> Self {
        with!(Self(_mm512_mask_broadcastsd_pd(_mm512_set1_pd(low), 0xF0, _mm_set_sd(high))))
    }
    #[inline(always)]
    fn transpose(r: [Self; LANES]) -> [Self; LANES] {
        with!({
            // columns 0, 2, 4, 6 and 1, 3, 5, 7
            let (mut even, mut odd) = ([r[0].0; 4], [r[0].0; 4]);
            for p in 0..4 {
                even[p] = _mm512_unpacklo_pd(r[2 * p].0, r[2 * p + 1].0);
                odd[p] = _mm512_unpackhi_pd(r[2 * p].0, r[2 * p + 1].0);
            }
            let mut columns = [r[0]; LANES];
            for (first, t) in [(0, even), (1, odd)] {
                let a = _mm512_shuffle_f64x2::<0x88>(t[0], t[1]); // 0 and 4 of rows 0 to 3
                let b = _mm512_shuffle_f64x2::<0xDD>(t[0], t[1]); // 2 and 6
                let c = _mm512_shuffle_f64x2::<0x88>(t[2], t[3]); // of rows 4 to 7
                let d = _mm512_shuffle_f64x2::<0xDD>(t[2], t[3]);
                columns[first] = Self(_mm512_shuffle_f64x2::<0x88>(a, c));
                columns[first + 2] = Self(_mm512_shuffle_f64x2::<0x88>(b, d));
                columns[first + 4] = Self(_mm512_shuffle_f64x2::<0xDD>(a, c));
                columns[first + 6] = Self(_mm512_shuffle_f64x2::<0xDD>(b, d));
            }
            columns
        })
    }
    #[inline(always)]
    fn to_indices(self) -> [u32; LANES] {
        let mut indices = [0; LANES];
        with!(_mm256_storeu_si256(indices.as_mut_ptr().cast(), _mm512_cvttpd_epi32(self.0)));
        indices
    }
    #[inline(always)]
    fn less_than(self, other: Self) -> u8 {
        with!(_mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, other.0))
    }
}
