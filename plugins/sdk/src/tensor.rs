//! Small helpers for symmetric tensors stored as xx, yy, zz, xy, yz, zx.

use nalgebra::Matrix3;

/// The tensor as a 3x3 matrix.
pub fn to_matrix(a: [f64; 6]) -> Matrix3<f64> {
    let [xx, yy, zz, xy, yz, zx] = a;
    Matrix3::new(xx, xy, zx, xy, yy, yz, zx, yz, zz)
}

/// The symmetric part of a 3x3 matrix.
pub fn from_matrix(a: &Matrix3<f64>) -> [f64; 6] {
    let mean = |i, j| 0.5 * (a[(i, j)] + a[(j, i)]);
    [a[(0, 0)], a[(1, 1)], a[(2, 2)], mean(0, 1), mean(1, 2), mean(2, 0)]
}

/// det F of a tensor given row by row.
#[inline(always)]
pub fn determinant(f: [f64; 9]) -> f64 {
    let [a, b, c, d, e, g, h, i, j] = f;
    a * (e * j - g * i) + b * (g * h - d * j) + c * (d * i - e * h)
}

/// The left Cauchy-Green tensor b = F Fᵀ of a deformation gradient given row by row.
#[inline(always)]
pub fn left_cauchy_green(f: [f64; 9]) -> [f64; 6] {
    let [a, b, c, d, e, g, h, i, j] = f;
    [
        a * a + b * b + c * c,
        d * d + e * e + g * g,
        h * h + i * i + j * j,
        a * d + b * e + c * g,
        d * h + e * i + g * j,
        a * h + b * i + c * j,
    ]
}

/// a_xx + a_yy + a_zz.
#[inline(always)]
pub fn trace(a: [f64; 6]) -> f64 {
    a[0] + a[1] + a[2]
}

/// a - tr(a)/3 I.
#[inline(always)]
pub fn deviator(a: [f64; 6]) -> [f64; 6] {
    let m = trace(a) / 3.0;
    [a[0] - m, a[1] - m, a[2] - m, a[3], a[4], a[5]]
}

/// a : b, off-diagonal components counted twice.
#[inline(always)]
pub fn contract(a: [f64; 6], b: [f64; 6]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + 2.0 * (a[3] * b[3] + a[4] * b[4] + a[5] * b[5])
}

/// Whether every value is finite. Without branches: 0 times what is not finite is not a number.
#[inline(always)]
pub fn is_finite<const N: usize>(a: [f64; N]) -> bool {
    a.iter().fold(0.0, |sum, x| sum + 0.0 * x) == 0.0
}
