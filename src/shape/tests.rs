//! Facts that every shape function must obey.

use super::cubic_bspline::CubicBspline;
use super::gimp::Gimp;
use super::linear::Linear;
use super::modified::Modified;
use super::quadratic_bspline::QuadraticBspline;
use super::stencil::{At, ShapeFunction, Stencil};
use super::{ShapeKind, textbook};

/// Positions around which a wall may stand: the walls of a modified function are nodes 0 and 9.
fn at<const N: usize, S: ShapeFunction<N>>(xi: f64, half: f64) -> At<f64> {
    let walls = if S::MODIFIED { [0.0, 9.0] } else { [f64::NEG_INFINITY, f64::INFINITY] };
    At { xi, half, walls }
}

/// Sums over the nodes of a 3D stencil: Σ w, Σ w (x_i − x_p), Σ ∇w, Σ x_i ⊗ ∇w − I, all of which
/// have known values.
fn defects<const N: usize, S: ShapeFunction<N>>(xi: [f64; 3], half: f64) -> f64 {
    let stencil = Stencil::<f64, N, 3>::new::<S>(xi.map(|xi| at::<N, S>(xi, half)));
    let mut worst = [0.0; 16];
    worst[0] = -1.0;
    for a in 0..3 {
        worst[4 + 4 * a + a] = -1.0;
    }
    stencil.nodes(|index, w, dw| {
        worst[0] += w;
        for a in 0..3 {
            let r = index[a] as f64 - stencil.axes[a].first - stencil.axes[a].fraction;
            worst[1 + a] += w * r;
            for b in 0..3 {
                worst[4 + 4 * a + b] += r * dw[b];
            }
            worst[7 + 4 * a] += dw[a];
        }
    });
    worst.into_iter().fold(0.0, |m, d| f64::max(m, f64::abs(d)))
}

#[test]
fn weights_sum_to_one_and_reproduce_linear_fields() {
    for n in 0..1000 {
        let t = f64::from(n) * 0.618_033_988_749_895;
        let xi = [t - 300.0, 7.0 - 3.0 * t, 0.1 * t];
        assert!(defects::<2, Linear>(xi, 0.0) <= 1e-13);
        assert!(defects::<3, QuadraticBspline>(xi, 0.0) <= 1e-13);
        assert!(defects::<4, CubicBspline>(xi, 0.0) <= 1e-13);
        for half in [1e-9, 0.1, 0.25, 0.5] {
            // the round-off of a domain without extent grows as its inverse
            assert!(defects::<3, Gimp>(xi, half) <= if half < 0.1 { 1e-6 } else { 1e-13 });
        }
    }
}

#[test]
fn next_to_walls_modified_weights_reproduce_linear_fields_and_are_not_negative() {
    for n in 0..=900 {
        let xi = (0.01 * f64::from(n)).min(9.0 - 1e-9);
        for axis in [0, 1, 2] {
            let mut point = [4.3; 3];
            point[axis] = xi;
            assert!(defects::<3, Modified<QuadraticBspline>>(point, 0.0) <= 1e-13);
            assert!(defects::<4, Modified<CubicBspline>>(point, 0.0) <= 1e-13);
            assert!(defects::<3, Modified<Gimp>>(point, 0.3) <= 1e-13);
        }
        let weights = Modified::<CubicBspline>::axis(at::<4, Modified<CubicBspline>>(xi, 0.0));
        for (k, w) in weights.w.into_iter().enumerate() {
            let node = weights.first + k as f64;
            assert!(w >= -1e-16, "node {node} has the weight {w} at {xi}");
            assert!((0.0..=9.0).contains(&node) || w == 0.0, "node {node} is behind a wall");
        }
    }
    let on_the_wall =
        Modified::<QuadraticBspline>::axis(at::<3, Modified<QuadraticBspline>>(0.0, 0.0));
    assert_eq!((on_the_wall.first, on_the_wall.w), (-1.0, [0.0, 1.0, 0.0]));
}

#[test]
fn weights_and_slopes_are_those_of_the_textbook() {
    fn check<const N: usize, S: ShapeFunction<N>>(shape: ShapeKind, half: f64) {
        let walls = if S::MODIFIED { [0, 9] } else { [i64::MIN, i64::MAX] };
        for n in 1..900 {
            let xi = 0.01 * f64::from(n) + 1e-7;
            let axis = S::axis(at::<N, S>(xi, half));
            for k in 0..N {
                let i = axis.first as i64 + k as i64;
                let r = |i: i64| xi - i as f64;
                let (w, slope) = textbook::weight_between(shape, i, r, half, walls);
                assert!((w - axis.w[k]).abs() < 1e-14, "{shape:?} at {xi}: w {w} {:?}", axis.w);
                assert!((slope - axis.dw[k]).abs() < 1e-13, "{shape:?} at {xi}");
            }
        }
    }
    check::<2, Linear>(ShapeKind::Linear, 0.0);
    check::<3, QuadraticBspline>(ShapeKind::QuadraticBspline, 0.0);
    check::<4, CubicBspline>(ShapeKind::CubicBspline, 0.0);
    check::<3, Modified<QuadraticBspline>>(ShapeKind::QuadraticBspline, 0.0);
    check::<4, Modified<CubicBspline>>(ShapeKind::CubicBspline, 0.0);
    for half in [0.1, 0.25, 0.4] {
        check::<3, Gimp>(ShapeKind::UniformGimp, half);
        check::<3, Modified<Gimp>>(ShapeKind::ContiguousGimp, half);
    }
}

#[test]
fn slopes_are_the_derivatives_of_the_weights() {
    for shape in ShapeKind::ALL {
        for n in 0..400 {
            let r = 0.01 * f64::from(n) - 2.0 + 3e-4;
            let w = |r: f64| textbook::weight(shape, r, 0.3).0;
            let difference = (w(r + 1e-6) - w(r - 1e-6)) / 2e-6;
            let slope = textbook::weight(shape, r, 0.3).1;
            assert!((difference - slope).abs() < 1e-8, "{shape:?} at {r}: {difference} {slope}");
        }
    }
}

#[test]
fn second_moments_of_splines_are_constant_and_of_others_not_claimed() {
    fn check<const N: usize, S: ShapeFunction<N>>() {
        let moment = S::MOMENT.expect("splines have one");
        for n in 0..100 {
            let a = S::axis(At::point(0.077 * f64::from(n)));
            let m: f64 = (0..N).map(|k| a.w[k] * (k as f64 - a.fraction).powi(2)).sum();
            assert!((m - moment).abs() < 1e-14);
        }
    }
    check::<3, QuadraticBspline>();
    check::<4, CubicBspline>();
    assert!(Linear::MOMENT.is_none() && Gimp::MOMENT.is_none());
}
