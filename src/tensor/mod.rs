//! Small tensors: the order of symmetric components and the objective rotation.
//!
//! Symmetric tensors are stored as xx, yy, zz, xy, yz, zx (tensor components, not engineering shears), gradients row-major.
//! Two-dimensional worlds use the same shapes with zeros out of the plane.

use nalgebra::Matrix3;

/// A 3x3 matrix.
pub type Mat3 = Matrix3<f64>;

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

/// Rotation of a step: R = exp(W dt) with the spin W = skw L, by Rodrigues' formula
/// R = I + a W dt + b (W dt)², a = sin(θ)/θ, b = (1 − cos θ)/θ².
///
/// `l` is the velocity gradient [1/s], `dt` the step [s]. Angles of a step are small: up to 0.03 rad both coefficients are
/// taken from their series, whose next term is below the round-off.
#[inline]
pub fn step_rotation(l: &Mat3, dt: f64) -> Mat3 {
    let w = (l - l.transpose()) * (0.5 * dt);
    let t = w[(0, 1)] * w[(0, 1)] + w[(1, 2)] * w[(1, 2)] + w[(0, 2)] * w[(0, 2)];
    let (a, b) = if t < 1e-3 {
        (
            1.0 - t / 6.0 * (1.0 - t / 20.0 * (1.0 - t / 42.0)),
            0.5 - t / 24.0 * (1.0 - t / 30.0 * (1.0 - t / 56.0)),
        )
    } else {
        let (theta, half) = (t.sqrt(), 0.5 * t.sqrt());
        (theta.sin() / theta, 0.5 * (half.sin() / half).powi(2))
    };
    Mat3::identity() + w * a + w * w * b
}

/// R s Rᵀ of a symmetric tensor given by its six components.
#[inline]
pub fn rotate(r: &Mat3, s: [f64; 6]) -> [f64; 6] {
    let m = r * symmetric(s) * r.transpose();
    SYMMETRIC.map(|(a, b)| m[(a, b)])
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

    #[test]
    fn a_symmetric_tensor_survives_packing() {
        let s = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        assert_eq!(symmetric_part(&symmetric(s)), s);
        assert_eq!(rotate(&Mat3::identity(), s), s);
    }
}
