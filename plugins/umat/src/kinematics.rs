//! Rotations and deformations of eight points at once: [`lanes`] runs the formula of one point over them.

/// Points that go together.
pub const LANES: usize = 8;

/// One component of eight points.
pub type Lane = [f64; LANES];

/// Identity, row by row.
pub const IDENTITY: [f64; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

/// Row and column of the components xx, yy, zz, xy, yz, zx.
pub const SYMMETRIC: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)];

const INDEX: [[usize; 3]; 3] = [[0, 3, 5], [3, 1, 4], [5, 4, 2]];

/// `formula(k)` of every lane k, component by component.
#[inline(always)]
pub fn lanes<const N: usize>(out: &mut [Lane; N], formula: impl Fn(usize) -> [f64; N]) {
    for k in 0..LANES {
        let value = formula(k);
        for c in 0..N {
            out[c][k] = value[c];
        }
    }
}

/// No lanes yet.
pub const fn zero<const N: usize>() -> [Lane; N] {
    [[0.0; LANES]; N]
}

/// The components of lane k.
#[inline(always)]
pub fn lane<const N: usize>(lanes: &[Lane; N], k: usize) -> [f64; N] {
    components(|c| lanes[c][k])
}

/// `component(c)` of every c. What `std::array::from_fn` does, but always inlined.
#[inline(always)]
pub fn components<const N: usize>(component: impl Fn(usize) -> f64) -> [f64; N] {
    let mut out = [0.0; N];
    for (c, value) in out.iter_mut().enumerate() {
        *value = component(c);
    }
    out
}

/// a b.
#[inline(always)]
pub fn product(a: [f64; 9], b: [f64; 9]) -> [f64; 9] {
    components(|c| {
        let (i, j) = (c / 3, c % 3);
        a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j]
    })
}

/// aᵀ.
#[inline(always)]
pub fn transposed(a: [f64; 9]) -> [f64; 9] {
    components(|c| a[3 * (c % 3) + c / 3])
}

/// r s rᵀ of a symmetric tensor.
#[inline(always)]
pub fn rotated(r: [f64; 9], s: [f64; 6]) -> [f64; 6] {
    let full: [f64; 9] = components(|c| s[INDEX[c / 3][c % 3]]);
    let half = product(r, full);
    components(|c| {
        let (i, j) = SYMMETRIC[c];
        half[3 * i] * r[3 * j] + half[3 * i + 1] * r[3 * j + 1] + half[3 * i + 2] * r[3 * j + 2]
    })
}

/// dt sym L.
#[inline(always)]
pub fn strain_increment(l: [f64; 9], dt: f64) -> [f64; 6] {
    components(|c| {
        let (i, j) = SYMMETRIC[c];
        0.5 * dt * (l[3 * i + j] + l[3 * j + i])
    })
}

/// (I + dt L) F.
#[inline(always)]
pub fn deformed(f: [f64; 9], l: [f64; 9], dt: f64) -> [f64; 9] {
    let lf = product(l, f);
    components(|c| f[c] + dt * lf[c])
}

/// Components (0, 1), (1, 2) and (0, 2) of W dt, W = skw L.
#[inline(always)]
pub fn spin(l: [f64; 9], dt: f64) -> [f64; 3] {
    [0.5 * dt * (l[1] - l[3]), 0.5 * dt * (l[5] - l[7]), 0.5 * dt * (l[2] - l[6])]
}

/// exp(W dt) of eight velocity gradients, by Rodrigues' formula: the rotation with which the engine turns the stress of other models.
/// Small angles take the series, whose next term is below the round-off.
#[inline(always)]
pub fn step_rotations(l: &[Lane; 9], dt: f64, out: &mut [Lane; 9]) {
    const SMALL: f64 = 1e-3;
    let (mut w, mut factors) = (zero(), zero());
    lanes(&mut w, |k| spin(lane(l, k), dt));
    lanes(&mut factors, |k| {
        let [x, y, z] = lane(&w, k);
        series(x * x + y * y + z * z)
    });
    for k in 0..LANES {
        let [x, y, z] = lane(&w, k);
        let t = x * x + y * y + z * z;
        if !(t < SMALL) {
            let (theta, half) = (t.sqrt(), 0.5 * t.sqrt());
            factors[0][k] = theta.sin() / theta;
            factors[1][k] = 0.5 * (half.sin() / half).powi(2);
        }
    }
    lanes(out, |k| {
        let ([x, y, z], [a, b]) = (lane(&w, k), lane(&factors, k));
        let (xx, yy, zz) = (b * x * x, b * y * y, b * z * z);
        let (xy, yz, xz) = (b * x * y, b * y * z, b * x * z);
        [
            1.0 - xx - zz,
            a * x - yz,
            a * z + xy,
            -a * x - yz,
            1.0 - xx - yy,
            a * y - xz,
            xy - a * z,
            -a * y - xz,
            1.0 - yy - zz,
        ]
    });
}

/// sin(θ)/θ and (1 − cos θ)/θ² for t = θ² below 1e-3.
#[inline(always)]
fn series(t: f64) -> [f64; 2] {
    [
        1.0 - t / 6.0 * (1.0 - t / 20.0 * (1.0 - t / 42.0)),
        0.5 - t / 24.0 * (1.0 - t / 30.0 * (1.0 - t / 56.0)),
    ]
}

/// R of F = R U of eight deformation gradients, det F > 0: Newton's iteration with scaling (N. J. Higham, SIAM J. Sci. Stat. Comput. 7 (1986)
/// 1160–1174, doi:10.1137/0907079). Stretches up to 25 reach round-off in seven steps.
#[inline(always)]
pub fn polar_rotations(f: &[Lane; 9], x: &mut [Lane; 9]) {
    *x = *f;
    for step in 0..8 {
        let before = *x;
        for k in 0..LANES {
            let next = towards_rotation(lane(&before, k), step < 5);
            for c in 0..9 {
                x[c][k] = next[c];
            }
        }
    }
}

/// (g X + X⁻ᵀ / g) / 2, with g = √(|X⁻¹| / |X|) or 1.
#[inline(always)]
fn towards_rotation(x: [f64; 9], scaled: bool) -> [f64; 9] {
    let cofactor = cofactors(x);
    let inverse = 1.0 / (x[0] * cofactor[0] + x[1] * cofactor[1] + x[2] * cofactor[2]);
    let y: [f64; 9] = components(|c| cofactor[c] * inverse); // X⁻ᵀ
    let g = if scaled { (squares(y) / squares(x)).sqrt().sqrt() } else { 1.0 };
    let (g, h) = (0.5 * g, 0.5 / g);
    components(|c| g * x[c] + h * y[c])
}

/// The rotation vector of a rotation by less than a right angle: components 32, 13, 21 of its logarithm.
#[inline(always)]
pub fn rotation_vector(r: [f64; 9]) -> [f64; 3] {
    let v = [0.5 * (r[7] - r[5]), 0.5 * (r[2] - r[6]), 0.5 * (r[3] - r[1])];
    let sine = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    let factor = if sine > 1e-8 { sine.min(1.0).asin() / sine } else { 1.0 };
    v.map(|x| x * factor)
}

/// det(A) A⁻ᵀ.
#[inline(always)]
fn cofactors(a: [f64; 9]) -> [f64; 9] {
    components(|c| {
        let (i, j) = (c / 3, c % 3);
        let (k, l, m, n) = (3 * ((i + 1) % 3), 3 * ((i + 2) % 3), (j + 1) % 3, (j + 2) % 3);
        a[k + m] * a[l + n] - a[k + n] * a[l + m]
    })
}

#[inline(always)]
fn squares(a: [f64; 9]) -> f64 {
    a.iter().map(|x| x * x).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rotation(l: [f64; 9]) -> [f64; 9] {
        let mut r = zero();
        step_rotations(&l.map(|x| [x; LANES]), 1.0, &mut r);
        lane(&r, 3)
    }

    fn close(a: &[f64], b: &[f64], tolerance: f64) -> bool {
        a.iter().zip(b).all(|(x, y)| (x - y).abs() <= tolerance)
    }

    #[test]
    fn the_rotation_of_a_step_is_the_rotation_by_its_angle() {
        for angle in [0.0, 1e-6, 0.03, 0.0317, 0.7, -2.0] {
            let l = [0.0, -angle, 0.0, angle, 0.0, 0.0, 0.0, 0.0, 0.0];
            let r = rotation(l);
            let (s, c) = f64::sin_cos(angle);
            assert!(close(&r, &[c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0], 1e-15), "{angle}: {r:?}");
        }
    }

    #[test]
    fn the_polar_rotation_and_the_rotation_vector_give_back_a_rotation() {
        let l = [0.0, -0.5, 0.3, 0.5, 0.0, -0.2, -0.3, 0.2, 0.0];
        let r = rotation(l);
        assert!(close(&product(r, transposed(r)), &IDENTITY, 1e-15));
        assert!(close(&rotation_vector(r), &[0.2, 0.3, 0.5], 1e-14));
        let stretch = [1.5, 0.2, 0.0, 0.2, 0.8, -0.1, 0.0, -0.1, 1.1];
        let f = product(r, stretch).map(|x| [x; LANES]);
        let mut found = zero();
        polar_rotations(&f, &mut found);
        assert!(close(&lane(&found, 5), &r, 1e-14));
    }

    #[test]
    fn a_tensor_turns_as_its_matrix_does() {
        let r = [0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]; // x to y
        assert_eq!(rotated(r, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]), [2.0, 1.0, 3.0, -4.0, 6.0, -5.0]);
        assert_eq!(
            rotated(transposed(r), [2.0, 1.0, 3.0, -4.0, 6.0, -5.0]),
            [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
        );
    }
}
