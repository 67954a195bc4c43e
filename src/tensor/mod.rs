//! Small tensors: the order of symmetric components and the objective rotation.
//!
//! Symmetric tensors are stored as xx, yy, zz, xy, yz, zx (tensor components, not engineering
//! shears), gradients row-major. Two-dimensional worlds use the same shapes with zeros out of the
//! plane. The formulas are written for one tensor or for eight.

mod polar;

pub use polar::{determinant, polar_rotation, rotation_between, stretch_diagonal, turned_between};

use nalgebra::Matrix3;

use crate::simd::{LANES, Real, Vector, each};

/// A 3x3 matrix.
pub type Mat3 = Matrix3<f64>;

/// Rows of a 3x3 matrix, or of eight.
pub type Rows<R> = [[R; 3]; 3];

/// Row and column of the six stored components of a symmetric tensor.
pub const SYMMETRIC: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)];

/// Position of component (a, b) of a symmetric tensor among the six stored ones.
pub const SYMMETRIC_INDEX: [[usize; 3]; 3] = [[0, 3, 5], [3, 1, 4], [5, 4, 2]];

/// The symmetric tensor with the given six components.
#[inline]
pub fn symmetric(s: [f64; 6]) -> Mat3 {
    Mat3::from_fn(|a, b| s[SYMMETRIC_INDEX[a][b]])
}

/// The six components of the symmetric part of `m`.
#[inline]
pub fn symmetric_part(m: &Mat3) -> [f64; 6] {
    SYMMETRIC.map(|(a, b)| 0.5 * (m[(a, b)] + m[(b, a)]))
}

/// Angles of a step are small: up to √(1e-3) rad, the coefficients of the rotation come from their
/// series, whose next term is below the round-off.
const SMALL: f64 = 1e-3;

/// Rotation of a step: R = exp(W dt) with the spin W = skw L, by Rodrigues' formula
/// R = I + a W dt + b (W dt)², a = sin(θ)/θ, b = (1 − cos θ)/θ².
///
/// `l` is the velocity gradient [1/s], `dt` the step [s].
pub fn step_rotation(l: &Mat3, dt: f64) -> Mat3 {
    let w = spin(&std::array::from_fn(|a| std::array::from_fn(|b| l[(a, b)])), dt);
    let t = square(&w);
    let r = rodrigues(&w, if t < SMALL { series(t) } else { closed_form(t) });
    Mat3::from_fn(|a, b| r[a][b])
}

/// The same for eight velocity gradients.
#[inline(always)]
pub fn step_rotations<V: Vector>(l: &Rows<V>, dt: f64) -> Rows<V> {
    let w = spin(l, V::splat(dt));
    rodrigues(&w, factors(square(&w))) // [STR-5]
}

/// R s Rᵀ of eight symmetric tensors with the rotations of a step; in two dimensions those about z,
/// for a third of the cost.
#[inline(always)]
pub fn turned<V: Vector, const D: usize>(l: &Rows<V>, dt: f64, s: [V; 6]) -> [V; 6] {
    if D == 3 {
        return rotated(&step_rotations(l, dt), s);
    }
    let [w, ..] = spin(l, V::splat(dt));
    let (a, b) = factors(w * w);
    turned_in_plane((V::splat(1.0) - b * w * w, a * w), s)
}

/// R s Rᵀ with R = [cos, sin; −sin, cos] about z.
#[inline(always)]
fn turned_in_plane<V: Vector>((cos, sin): (V, V), s: [V; 6]) -> [V; 6] {
    let (cc, ss, cs) = (cos * cos, sin * sin, cos * sin);
    let [xx, yy, zz, xy, yz, zx] = s;
    let shear = (cs + cs) * xy;
    let plane =
        [cc * xx + shear + ss * yy, ss * xx - shear + cc * yy, cs * (yy - xx) + (cc - ss) * xy];
    [plane[0], plane[1], zz, plane[2], cos * yz - sin * zx, cos * zx + sin * yz]
}

/// The two coefficients of eight rotations by angles whose squares are `t`.
#[inline(always)]
fn factors<V: Vector>(t: V) -> (V, V) {
    if t.less_than(V::splat(SMALL)) == u8::MAX {
        return series(t);
    }
    let factors = t.to_array().map(|t| if t < SMALL { series(t) } else { closed_form(t) });
    (V::from_array(factors.map(|f| f.0)), V::from_array(factors.map(|f| f.1)))
}

/// Components (0, 1), (1, 2) and (0, 2) of W dt.
#[inline(always)]
fn spin<R: Real>(l: &Rows<R>, dt: R) -> [R; 3] {
    let half = R::splat(0.5) * dt;
    [(l[0][1] - l[1][0]) * half, (l[1][2] - l[2][1]) * half, (l[0][2] - l[2][0]) * half]
}

/// θ², the square of the angle.
#[inline(always)]
fn square<R: Real>(w: &[R; 3]) -> R {
    w[0] * w[0] + w[1] * w[1] + w[2] * w[2]
}

#[inline(always)]
fn series<R: Real>(t: R) -> (R, R) {
    let one = R::splat(1.0);
    let c = each!(n in 6 => t * R::splat(1.0 / [6.0, 20.0, 42.0, 24.0, 30.0, 56.0][n]));
    let a = one - c[0] * (one - c[1] * (one - c[2]));
    let b = R::splat(0.5) - c[3] * (one - c[4] * (one - c[5]));
    (a, b)
}

#[cold]
fn closed_form(t: f64) -> (f64, f64) {
    let (theta, half) = (t.sqrt(), 0.5 * t.sqrt());
    (theta.sin() / theta, 0.5 * (half.sin() / half).powi(2))
}

#[inline(always)]
fn rodrigues<R: Real>(w: &[R; 3], (a, b): (R, R)) -> Rows<R> {
    let one = R::splat(1.0);
    let [x, y, z] = *w; // (0, 1), (1, 2), (0, 2)
    let (xx, yy, zz) = (x * x, y * y, z * z);
    let (xy, yz, xz) = (b * x * y, b * y * z, b * x * z);
    let (ax, ay, az) = (a * x, a * y, a * z);
    [
        [one - b * (xx + zz), ax - yz, az + xy],
        [-ax - yz, one - b * (xx + yy), ay - xz],
        [xy - az, -ay - xz, one - b * (yy + zz)],
    ]
}

/// R s Rᵀ of a symmetric tensor given by its six components.
#[inline]
pub fn rotate(r: &Mat3, s: [f64; 6]) -> [f64; 6] {
    rotated(&std::array::from_fn(|a| std::array::from_fn(|b| r[(a, b)])), s)
}

/// The same for one tensor or eight.
#[inline(always)]
pub fn rotated<R: Real>(r: &Rows<R>, s: [R; 6]) -> [R; 6] {
    let s = each!(a in 3, b in 3 => s[SYMMETRIC_INDEX[a][b]]);
    let m = each!(a in 3, b in 3 => product(r[a], s[b]));
    each!(c in 6 => product(m[SYMMETRIC[c].0], r[SYMMETRIC[c].1]))
}

#[inline(always)]
fn product<R: Real>(x: [R; 3], y: [R; 3]) -> R {
    x[2].mul_add(y[2], x[1].mul_add(y[1], x[0] * y[0]))
}

/// e^x; within round-off, and fast where |x| < ¼ in all lanes. A lane does not depend on the
/// others.
#[inline(always)]
pub fn exp<V: Vector>(x: V) -> V {
    // Taylor's series up to x^12 / 12!
    let mut sum = V::splat(1.0);
    for n in 0..12 {
        sum = (x * V::splat(1.0 / f64::from(12 - n))).mul_add(sum, V::splat(1.0));
    }
    let small = x.abs().less_than(V::splat(0.25));
    if small == u8::MAX {
        return sum;
    }
    let (mut lanes, x) = (sum.to_array(), x.to_array());
    for l in 0..LANES {
        if small >> l & 1 == 0 {
            lanes[l] = x[l].exp();
        }
    }
    V::from_array(lanes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotation_of_a_step_is_the_rotation_by_its_angle() {
        for angle in [0.0, 1e-9, 1e-3, 0.031, 0.032, 0.7] {
            let l = Mat3::new(0.0, -angle, 0.0, angle, 0.0, 0.0, 0.0, 0.0, 0.0);
            let r = step_rotation(&l, 1.0);
            let (s, c) = f64::sin_cos(angle);
            let expected = Mat3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0);
            assert!((r - expected).abs().max() < 1e-15);
            assert!((r * r.transpose() - Mat3::identity()).abs().max() < 1e-15);
        }
    }

    /// Rotations in the plane, of eight tensors at once, against those in space.
    struct InThePlane;

    impl crate::simd::Kernel for InThePlane {
        type Output = ();
        #[inline(always)]
        fn run<V: Vector>(self) {
            let s = [3.0, -1.0, 0.5, 2.0, -0.7, 1.1];
            for angle in [1e-3, 0.02, 0.4, -2.0] {
                let mut l = [[V::splat(0.0); 3]; 3];
                (l[0][1], l[1][0]) = (V::splat(-1.5 * angle), V::splat(0.5 * angle));
                let turned = turned::<V, 2>(&l, 1.0, s.map(V::splat));
                let expected = super::turned::<V, 3>(&l, 1.0, s.map(V::splat));
                for c in 0..6 {
                    assert!((turned[c] - expected[c]).abs().largest() < 1e-14, "component {c}");
                }
            }
        }
    }

    #[test]
    fn a_turn_in_the_plane_is_a_rotation_about_z() {
        crate::simd::Isa::all().for_each(|isa| isa.dispatch(InThePlane));
    }

    #[test]
    fn a_symmetric_tensor_survives_packing() {
        let s = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        assert_eq!(symmetric_part(&symmetric(s)), s);
        assert_eq!(rotate(&Mat3::identity(), s), s);
    }
}
