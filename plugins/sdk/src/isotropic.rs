//! Isotropic laws in principal axes: from a tensor to its sorted principal values and back, and their tangent.

use crate::principal::principal_of_one;

/// Stresses beyond this have no squares [Pa].
pub const LARGEST_STRESS: f64 = 1e150;

/// Principal values, the largest first, and in the columns of an orthogonal matrix their axes. `a` is xx, yy, zz, xy, yz, zx.
pub fn sorted_principal(a: [f64; 6]) -> ([f64; 3], [[f64; 3]; 3]) {
    let (values, axes) = principal_of_one(a);
    let mut order = [0, 1, 2];
    order.sort_by(|i, j| values[*j].total_cmp(&values[*i]));
    (order.map(|i| values[i]), axes.map(|row| order.map(|i| row[i])))
}

/// The tensor with these principal values on these axes, as xx, yy, zz, xy, yz, zx.
pub fn compose(values: [f64; 3], axes: [[f64; 3]; 3]) -> [f64; 6] {
    let at = |i: usize, j: usize| (0..3).map(|a| values[a] * axes[i][a] * axes[j][a]).sum();
    [at(0, 0), at(1, 1), at(2, 2), at(0, 1), at(1, 2), at(2, 0)]
}

/// The tangent of the extension `lahar.tangent` of a law that turns the principal values `trial` [Pa] of an isotropic elastic
/// stress into those `end` [Pa] on the same axes.
///
/// `normal[i][j]` is the derivative [Pa] of principal stress i by principal strain j, `two_g` twice the shear modulus [Pa] of
/// the trial. Beside them stands the turning of the axes, dσ_ij = 2G (σ_i - σ_j) / (σ*_i - σ*_j) dε_ij, and its limit for
/// equal values: E. A. de Souza Neto, D. Peric, D. R. J. Owen, Computational Methods for Plasticity, Wiley (2008), appendix A,
/// doi:10.1002/9780470694626.
pub fn tangent(
    trial: [f64; 3],
    end: [f64; 3],
    axes: [[f64; 3]; 3],
    normal: [[f64; 3]; 3],
    two_g: f64,
) -> [[f64; 6]; 6] {
    const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];
    let scale = trial.iter().fold(0.0_f64, |scale, x| scale.max(x.abs()));
    let mut result = [[0.0; 6]; 6];
    for (column, (r, s)) in PAIRS.into_iter().enumerate() {
        // The unit increment in principal axes, both places of a shear component.
        let strain = |i: usize, j: usize| match r == s {
            true => axes[r][i] * axes[r][j],
            false => axes[r][i] * axes[s][j] + axes[s][i] * axes[r][j],
        };
        let mut stress = [[0.0; 3]; 3];
        for i in 0..3 {
            stress[i][i] = (0..3).map(|j| normal[i][j] * strain(j, j)).sum();
            for j in 0..i {
                let gap = trial[i] - trial[j];
                let shear = match gap.abs() > 1e-9 * scale {
                    true => two_g * (end[i] - end[j]) / gap,
                    false => 0.5 * (normal[i][i] - normal[i][j] - normal[j][i] + normal[j][j]),
                };
                stress[i][j] = shear * strain(i, j);
                stress[j][i] = stress[i][j];
            }
        }
        for (row, (k, l)) in PAIRS.into_iter().enumerate() {
            let mut sum = 0.0;
            for i in 0..3 {
                for j in 0..3 {
                    sum += axes[k][i] * stress[i][j] * axes[l][j];
                }
            }
            result[row][column] = sum;
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elastic::stiffness;

    #[test]
    fn composing_undoes_the_decomposition_and_the_values_are_sorted() {
        for n in 0..1000 {
            let a: [f64; 6] = std::array::from_fn(|c| ((n * 11 + c * 3 + 1) as f64).sin());
            let (values, axes) = sorted_principal(a);
            assert!(values[0] >= values[1] && values[1] >= values[2]);
            let again = compose(values, axes);
            assert!((0..6).all(|c| (again[c] - a[c]).abs() < 1e-14));
        }
    }

    #[test]
    fn the_tangent_of_elasticity_is_its_stiffness_whatever_the_axes_and_equal_values() {
        let lame = [3.0, 2.0];
        let c = stiffness(lame);
        let normal =
            [[c[0][0], c[0][1], c[0][2]], [c[1][0], c[1][1], c[1][2]], [c[2][0], c[2][1], c[2][2]]];
        let all = [[1.0, 0.3, -2.0, 0.4, -0.7, 0.2], [1.0, 2.0, 1.0, 0.0, 0.0, 0.0], [2.0; 6]];
        for trial in all {
            let (values, axes) = sorted_principal(trial);
            let found = tangent(values, values, axes, normal, 2.0 * lame[1]);
            for i in 0..6 {
                assert!((0..6).all(|j| (found[i][j] - c[i][j]).abs() < 1e-13), "{found:?}");
            }
        }
    }

    #[test]
    fn the_tangent_of_a_square_is_its_derivative() {
        // The principal values of the square of a tensor are squares; a trial stress equals the strain (2 G = 1).
        let square = |a: [f64; 6]| {
            let m = crate::tensor::to_matrix(a);
            crate::tensor::from_matrix(&(m * m))
        };
        let a = [1.0, 0.3, -2.0, 0.4, -0.7, 0.2];
        let (values, axes) = sorted_principal(a);
        let mut normal = [[0.0; 3]; 3];
        for i in 0..3 {
            normal[i][i] = 2.0 * values[i];
        }
        let found = tangent(values, values.map(|x| x * x), axes, normal, 1.0);
        for j in 0..6 {
            let at = |h: f64| {
                let mut changed = a;
                changed[j] += h;
                square(changed)
            };
            let (above, below) = (at(0.5), at(-0.5));
            assert!((0..6).all(|i| (found[i][j] - (above[i] - below[i])).abs() < 1e-13));
        }
    }
}
