//! The polar decomposition F = R U of deformation gradients: the rotation R and the diagonal of the
//! stretch U.

use super::{Rows, product, rotated, turned_in_plane};
use crate::simd::{Real, Vector, each};

/// Steps of the iteration, of which the first are scaled: for ratios of stretches up to 25, seven
/// reach round-off; one to spare.
const STEPS: usize = 8;
const SCALED: usize = 5;

/// R of F = R U, for one deformation gradient or eight; det F must be positive.
///
/// Newton's iteration X ← (g X + X⁻ᵀ / g) / 2 from X = F, with g = √(|X⁻¹| / |X|) in the Frobenius
/// norm while X is far from R: N. J. Higham, SIAM J. Sci. Stat. Comput. 7 (1986) 1160–1174,
/// doi:10.1137/0907079. The number of steps is fixed, so that lanes do not depend on each other.
/// Components that are zero, as those out of the plane, stay zero.
#[inline(always)]
pub fn polar_rotation<R: Real>(f: &Rows<R>) -> Rows<R> {
    let (half, one) = (R::splat(0.5), R::splat(1.0));
    let mut x = *f;
    for step in 0..STEPS {
        let cofactor = cofactors(&x);
        let inverse = one / determinant_of(&x, &cofactor);
        let y = each!(a in 3, b in 3 => cofactor[a][b] * inverse); // X⁻ᵀ
        let (mut g, mut h) = (half, half);
        if step < SCALED {
            let scale = (squares(&y) / squares(&x)).sqrt().sqrt();
            g = half * scale;
            h = half / scale;
        }
        x = each!(a in 3, b in 3 => g * x[a][b] + h * y[a][b]); // [STR-6]
    }
    x
}

/// Cosine and sine of the R of F = R U where F leaves the z axis alone:
/// tan θ = (F_yx − F_xy) / (F_xx + F_yy), for one deformation gradient or eight.
#[inline(always)]
fn polar_angle<R: Real>(f: &Rows<R>) -> (R, R) {
    let (c, s) = (f[0][0] + f[1][1], f[1][0] - f[0][1]);
    let inverse = R::splat(1.0) / (c * c + s * s).sqrt();
    (c * inverse, s * inverse)
}

/// The diagonal of U = Rᵀ F [–]: by how much the edges of a box that lies along the axes become
/// longer, its rotation set aside.
#[inline(always)]
pub fn stretch_diagonal<R: Real>(f: &Rows<R>) -> [R; 3] {
    let r = polar_rotation(f);
    each!(a in 3 => r[0][a] * f[0][a] + r[1][a] * f[1][a] + r[2][a] * f[2][a]) // [STR-7]
}

/// R(F₁) R(F₀)ᵀ, the increment of the rotation between two deformation gradients, or eight pairs.
#[inline(always)]
pub fn rotation_between<R: Real>(old: &Rows<R>, new: &Rows<R>) -> Rows<R> {
    let (old, new) = (polar_rotation(old), polar_rotation(new));
    each!(a in 3, b in 3 => product(new[a], old[b])) // [STR-8]
}

/// Q s Qᵀ of eight symmetric tensors with Q = R(F₁) R(F₀)ᵀ; in two dimensions in closed form.
#[inline(always)]
pub fn turned_between<V: Vector, const D: usize>(
    old: &Rows<V>,
    new: &Rows<V>,
    s: [V; 6],
) -> [V; 6] {
    if D == 3 {
        return rotated(&rotation_between(old, new), s);
    }
    let ((c0, s0), (c1, s1)) = (polar_angle(old), polar_angle(new));
    turned_in_plane((c1 * c0 + s1 * s0, c1 * s0 - s1 * c0), s)
}

/// det A.
#[inline(always)]
pub fn determinant<R: Real>(a: &Rows<R>) -> R {
    determinant_of(a, &cofactors(a))
}

#[inline(always)]
fn determinant_of<R: Real>(a: &Rows<R>, cofactor: &Rows<R>) -> R {
    a[0][0] * cofactor[0][0] + a[0][1] * cofactor[0][1] + a[0][2] * cofactor[0][2]
}

/// det(A) A⁻ᵀ.
#[inline(always)]
fn cofactors<R: Real>(a: &Rows<R>) -> Rows<R> {
    each!(i in 3, j in 3 => {
        let (k, l, m, n) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
        a[k][m] * a[l][n] - a[k][n] * a[l][m]
    })
}

/// Sum of the squares of all components.
#[inline(always)]
fn squares<R: Real>(a: &Rows<R>) -> R {
    let rows = each!(i in 3 => a[i][0] * a[i][0] + a[i][1] * a[i][1] + a[i][2] * a[i][2]);
    rows[0] + rows[1] + rows[2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{Isa, Kernel, LANES};
    use nalgebra::{Matrix3, Rotation3, Vector3};

    /// Eight deformation gradients R U with known R, whose principal stretches reach from 0.2 to 5
    /// along turned axes.
    fn samples(round: usize, plane: bool) -> [(Matrix3<f64>, Matrix3<f64>); LANES] {
        std::array::from_fn(|l| {
            let angle = |c: usize| 3.0 * ((17 * round + 5 * l + 3 * c + 1) as f64).sin();
            let turn = |c: usize| {
                let axis = match plane {
                    true => Vector3::new(0.0, 0.0, angle(c)),
                    false => Vector3::new(angle(c), angle(c + 1), angle(c + 2)),
                };
                Rotation3::new(axis).into_inner()
            };
            let stretch = |c: usize| 5f64.powf(((7 * round + 11 * l + 13 * c) as f64).cos());
            let third = if plane { 1.0 } else { stretch(2) };
            let mut principal = Vector3::new(stretch(0), stretch(1), third);
            match (round + l) % 5 {
                0 => principal = Vector3::new(0.2, 5.0, third),
                1 => principal = Vector3::new(5.0, 5.0, if plane { 1.0 } else { 0.2 }),
                2 => principal = Vector3::repeat(1.0),
                _ => {}
            }
            let (r, q) = (turn(0), turn(4));
            (r, r * q * Matrix3::from_diagonal(&principal) * q.transpose())
        })
    }

    fn rows<V: Vector>(m: &[Matrix3<f64>; LANES]) -> Rows<V> {
        each!(a in 3, b in 3 => V::from_array(m.map(|m| m[(a, b)])))
    }

    struct AgainstNalgebra;

    impl Kernel for AgainstNalgebra {
        type Output = f64;
        fn run<V: Vector>(self) -> f64 {
            let mut worst = 0.0_f64;
            for (round, plane) in (0..100).flat_map(|round| [(round, false), (round, true)]) {
                let samples = samples(round, plane);
                let f = rows::<V>(&samples.map(|s| s.1));
                let r = polar_rotation(&f);
                let u = stretch_diagonal(&f);
                let (c, s) = polar_angle(&f);
                let one = each!(a in 3, b in 3 => V::splat(if a == b { 1.0 } else { 0.0 }));
                let stress = [3.0, -1.0, 0.5, 2.0, -0.7, 1.1];
                let space = turned_between::<V, 3>(&one, &f, stress.map(V::splat));
                let in_plane = turned_between::<V, 2>(&one, &f, stress.map(V::splat));
                for l in 0..LANES {
                    let (known, f) = samples[l];
                    let r = Matrix3::from_fn(|a, b| r[a][b].to_array()[l]);
                    let svd = f.svd(true, true);
                    let independent = svd.u.unwrap() * svd.v_t.unwrap();
                    assert!((independent - known).abs().max() < 5e-14, "the test itself");
                    worst = worst.max((r - known).abs().max());
                    worst = worst.max((r.transpose() * r - Matrix3::identity()).abs().max());
                    for a in 0..3 {
                        let expected = (known.transpose() * f)[(a, a)];
                        worst = worst.max((u[a].to_array()[l] - expected).abs() / 5.0);
                    }
                    let turned = known * crate::tensor::symmetric(stress) * known.transpose();
                    let turned = crate::tensor::symmetric_part(&turned);
                    for i in 0..6 {
                        worst = worst.max((space[i].to_array()[l] - turned[i]).abs() / 5.0);
                        if plane {
                            worst = worst.max((in_plane[i].to_array()[l] - turned[i]).abs() / 5.0);
                        }
                    }
                    if plane {
                        let zeros = [r[(0, 2)], r[(1, 2)], r[(2, 0)], r[(2, 1)]];
                        assert_eq!(zeros, [0.0; 4], "out of the plane nothing turns");
                        worst = worst.max((c.to_array()[l] - known[(0, 0)]).abs());
                        worst = worst.max((s.to_array()[l] - known[(1, 0)]).abs());
                    }
                }
            }
            worst
        }
    }

    #[test]
    fn rotations_and_stretches_are_those_that_the_gradients_were_made_of() {
        for isa in Isa::all() {
            let worst = isa.dispatch(AgainstNalgebra);
            assert!(worst <= 1e-14, "{}: {worst:e}", isa.name());
        }
    }

    #[test]
    fn one_gradient_has_the_rotation_of_eight() {
        for (_, f) in samples(3, false) {
            let f: Rows<f64> = each!(a in 3, b in 3 => f[(a, b)]);
            let r = polar_rotation(&f);
            assert!((determinant(&r) - 1.0).abs() < 1e-14);
            let u = stretch_diagonal(&f);
            assert!(u.iter().all(|u| (0.2 - 1e-14..=5.0 + 1e-14).contains(u)), "{u:?}");
        }
    }
}
