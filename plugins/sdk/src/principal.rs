//! Principal values and axes of a symmetric tensor, without branches: the loop over points vectorises.

/// Principal values and, in the columns of a rotation, their axes; in no order. `a` is xx, yy, zz, xy, yz, zx.
///
/// Cyclic Jacobi rotations, each of which makes one component zero: C. G. J. Jacobi, J. reine angew. Math. 30 (1846) 51–94,
/// doi:10.1515/crll.1846.30.51. They converge quadratically, equal principal values are no special case, and the error of a
/// value is a few units in the last place of the largest. Four sweeps do for 3x3 tensors.
#[inline(always)]
pub fn principal(a: [f64; 6]) -> ([f64; 3], [[f64; 3]; 3]) {
    let mut t = [[a[0], a[3], a[5]], [a[3], a[1], a[4]], [a[5], a[4], a[2]]];
    let mut v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    sweep(&mut t, &mut v);
    sweep(&mut t, &mut v);
    sweep(&mut t, &mut v);
    sweep(&mut t, &mut v);
    ([t[0][0], t[1][1], t[2][2]], v)
}

/// The same for one point: ends as soon as the other components are negligible, which is after one rotation in plane strain.
pub(crate) fn principal_of_one(a: [f64; 6]) -> ([f64; 3], [[f64; 3]; 3]) {
    let mut t = [[a[0], a[3], a[5]], [a[3], a[1], a[4]], [a[5], a[4], a[2]]];
    let mut v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _ in 0..4 {
        let size = t[0][0].abs().max(t[1][1].abs()).max(t[2][2].abs());
        let negligible = |x: f64| x.abs() <= 1e-18 * size;
        if negligible(t[0][1]) && negligible(t[1][2]) && negligible(t[0][2]) {
            break;
        }
        if !negligible(t[0][1]) {
            rotate::<0, 1, 2>(&mut t, &mut v);
        }
        if !negligible(t[1][2]) {
            rotate::<1, 2, 0>(&mut t, &mut v);
        }
        if !negligible(t[0][2]) {
            rotate::<0, 2, 1>(&mut t, &mut v);
        }
    }
    ([t[0][0], t[1][1], t[2][2]], v)
}

#[inline(always)]
fn sweep(t: &mut [[f64; 3]; 3], v: &mut [[f64; 3]; 3]) {
    rotate::<0, 1, 2>(t, v);
    rotate::<1, 2, 0>(t, v);
    rotate::<0, 2, 1>(t, v);
}

/// Turns in the plane of the axes P and Q so that component (P, Q) becomes zero; R is the third axis.
#[inline(always)]
fn rotate<const P: usize, const Q: usize, const R: usize>(
    t: &mut [[f64; 3]; 3],
    v: &mut [[f64; 3]; 3],
) {
    let (pq, gap) = (t[P][Q], t[Q][Q] - t[P][P]);
    let below = gap.abs() + (gap * gap + 4.0 * pq * pq).sqrt();
    let above = if gap < 0.0 { -2.0 * pq } else { 2.0 * pq };
    let tan = above / if below > 0.0 { below } else { 1.0 };
    let cos = 1.0 / (1.0 + tan * tan).sqrt();
    let sin = tan * cos;
    t[P][P] -= tan * pq;
    t[Q][Q] += tan * pq;
    t[P][Q] = 0.0;
    t[Q][P] = 0.0;
    let (rp, rq) = (t[R][P], t[R][Q]);
    t[R][P] = cos * rp - sin * rq;
    t[P][R] = t[R][P];
    t[R][Q] = sin * rp + cos * rq;
    t[Q][R] = t[R][Q];
    for row in v {
        (row[P], row[Q]) = (cos * row[P] - sin * row[Q], sin * row[P] + cos * row[Q]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix3, Rotation3, Vector3};

    #[test]
    fn axes_turn_the_tensor_into_its_principal_values() {
        for n in 0..20_000 {
            let x = |c: usize| ((n * 13 + c * 7 + 1) as f64).sin();
            let base = if n % 2 == 0 { 9f64 } else { 1e4 };
            let mut values = Vector3::new(x(0), x(1), x(2)).map(|x| base.powf(x));
            match n % 7 {
                0 => values[1] = values[0],
                1 => values = Vector3::repeat(values[0]),
                2 => values[1] = values[0] * (1.0 + 1e-9 * x(3)),
                3 => values = Vector3::new(0.09, 9.0, 0.09),
                _ => {}
            }
            let axis = 3.0 * Vector3::new(x(4), x(5), if n % 3 == 0 { 0.0 } else { x(6) });
            let q = Rotation3::new(axis).into_inner();
            let a = q * Matrix3::from_diagonal(&values) * q.transpose();
            let six = [a[(0, 0)], a[(1, 1)], a[(2, 2)], a[(0, 1)], a[(1, 2)], a[(0, 2)]];
            for (w, v) in [principal(six), principal_of_one(six)] {
                let v = Matrix3::from_fn(|i, j| v[i][j]);
                let again = v * Matrix3::from_diagonal(&Vector3::from(w)) * v.transpose();
                assert!((v * v.transpose() - Matrix3::identity()).abs().max() < 1e-14);
                assert!((again - a).abs().max() < 1e-14 * values.max(), "{n}: {values}");
                let (mut w, mut expected) = (w, [values[0], values[1], values[2]]);
                w.sort_by(f64::total_cmp);
                expected.sort_by(f64::total_cmp);
                for i in 0..3 {
                    assert!((w[i] - expected[i]).abs() < 1e-14 * expected[2], "{n}: {w:?}");
                }
            }
        }
    }
}
