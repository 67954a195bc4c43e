//! From a tangent stiffness to a bound of the speed of waves in it.

/// A bound on the largest eigenvalue of the acoustic tensor of a stiffness [Pa], exact for isotropic elasticity.
///
/// `c` is the `ntens` times `ntens` stiffness with engineering shears, stored by columns (`DDSDDE`). It is split into its isotropic
/// part (λ, μ), projected orthogonally, and the rest D. For unit vectors m, n the tensor sym(m ⊗ n) is no longer than 1, so that
/// m·A(n)·m is at most max(λ + 2 μ, μ) and the largest eigenvalue of D, which is at most √((n − 1)/n) |D| for the n = `ntens` of a tensor without
/// trace, with the Frobenius norm.
#[inline(always)]
pub fn wave_modulus(ntens: usize, c: &[f64; 36]) -> f64 {
    if ntens == 4 { of::<4>(c) } else { of::<6>(c) }
}

/// The same for a stiffness stored by columns; sums go row by row, so that rows are added side by side.
#[inline(always)]
fn of<const N: usize>(c: &[f64; 36]) -> f64 {
    let at = |i: usize, j: usize| c[i + N * j];
    let (mut normal, mut diagonal) = ([0.0; 3], [0.0; N]);
    for j in 0..3 {
        for i in 0..3 {
            normal[i] += at(i, j);
        }
    }
    for i in 0..N {
        diagonal[i] = if i < 3 { at(i, i) } else { 2.0 * at(i, i) };
    }
    let bulk = (normal[0] + normal[1] + normal[2]) * (1.0 / 9.0);
    let trace: f64 = diagonal.iter().sum();
    let mu = (trace - 3.0 * bulk) * (0.5 / (N - 1) as f64);
    let lambda = bulk - 2.0 / 3.0 * mu;
    let mut rest = [0.0; N];
    for j in 0..N {
        for i in 0..N {
            let isotropic = match (i < 3 && j < 3, i == j) {
                (true, true) => lambda + 2.0 * mu,
                (true, false) => lambda,
                (false, true) => mu,
                (false, false) => 0.0,
            };
            let weight = [1.0, 2.0, 4.0][usize::from(i >= 3) + usize::from(j >= 3)];
            let d = at(i, j) - isotropic;
            rest[i] += weight * d * d;
        }
    }
    let (rest, n) = (rest.iter().sum::<f64>(), N as f64);
    mu.max(lambda + 2.0 * mu) + (rest * ((n - 1.0) / n)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn modulus(ntens: usize, c: &Stiffness) -> f64 {
        let mut columns = [0.0; 36];
        for i in 0..ntens {
            for j in 0..ntens {
                columns[i + ntens * j] = c[i][j];
            }
        }
        wave_modulus(ntens, &columns)
    }

    /// Stiffness with engineering shears in the order 11, 22, 33, 12, 13, 23.
    type Stiffness = [[f64; 6]; 6];

    fn isotropic(lambda: f64, mu: f64) -> Stiffness {
        std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let normal = if i < 3 && j < 3 { lambda } else { 0.0 };
                let diagonal = if i < 3 { 2.0 * mu } else { mu };
                normal + if i == j { diagonal } else { 0.0 }
            })
        })
    }

    /// Largest m·A(n)·m over many pairs of directions.
    fn sampled(c: &Stiffness) -> f64 {
        let direction = |a: usize, b: usize| {
            let (t, p) = (a as f64 * 0.13, b as f64 * 0.26);
            [t.sin() * p.cos(), t.sin() * p.sin(), t.cos()]
        };
        let all: Vec<_> = (0..25).flat_map(|a| (0..25).map(move |b| direction(a, b))).collect();
        let mut largest = f64::MIN;
        for m in &all {
            for n in &all {
                let strain = [
                    m[0] * n[0],
                    m[1] * n[1],
                    m[2] * n[2],
                    m[0] * n[1] + m[1] * n[0],
                    m[0] * n[2] + m[2] * n[0],
                    m[1] * n[2] + m[2] * n[1],
                ];
                let mut sum = 0.0;
                for i in 0..6 {
                    for j in 0..6 {
                        sum += strain[i] * c[i][j] * strain[j];
                    }
                }
                largest = largest.max(sum);
            }
        }
        largest
    }

    #[test]
    fn the_modulus_of_isotropic_elasticity_is_exact_in_space_and_plane() {
        let c = isotropic(3.0, 2.0);
        for ntens in [4, 6] {
            let modulus = modulus(ntens, &c);
            assert!((modulus - 7.0).abs() < 1e-14, "{ntens}: {modulus}");
        }
        let auxetic = isotropic(-1.9, 1.0); // shear waves are the faster ones
        assert!((modulus(6, &auxetic) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn the_modulus_bounds_that_of_anisotropic_and_plastic_tangents_closely() {
        let mut fibre = isotropic(3.0, 2.0);
        fibre[0][0] += 20.0;
        let mut plastic = isotropic(3.0, 2.0); // perfectly plastic in uniaxial flow: less 2 mu n n
        let n = [2.0, -1.0, -1.0].map(|x: f64| x / 6f64.sqrt());
        for i in 0..3 {
            for j in 0..3 {
                plastic[i][j] -= 4.0 * n[i] * n[j];
            }
        }
        let mut skew = plastic; // not associated
        skew[0][3] += 1.5;
        for (c, most) in [(fibre, 1.6), (plastic, 1.6), (skew, 1.7)] {
            let (modulus, exact) = (modulus(6, &c), sampled(&c));
            assert!(modulus >= exact && modulus < most * exact, "{modulus} for {exact}");
        }
        // Unloading is elastic: the bound from the plastic tangent is not below the speed of elastic waves.
        assert!(modulus(6, &plastic) >= 7.0);
    }
}
