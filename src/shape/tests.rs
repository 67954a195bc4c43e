//! Facts that every shape function must obey.

use super::ShapeKind;
use super::cubic_bspline::CubicBspline;
use super::gimp::Gimp;
use super::linear::Linear;
use super::modified::Modified;
use super::quadratic_bspline::QuadraticBspline;
use super::stencil::{At, ShapeFunction, Stencil};
use super::textbook::{self, Between};
use crate::background::space::Fit;

/// A position, between these walls if the function knows walls.
fn at<const N: usize, S: ShapeFunction<N>>(xi: f64, half: f64, walls: [f64; 2]) -> At<f64> {
    At { xi, half, fit: if S::MODIFIED { Fit::between(walls) } else { Fit::FREE } }
}

/// No walls.
const FREE: [f64; 2] = Fit::FREE.walls;

/// Walls on node planes and off them, far apart and near each other, one alone.
const WALLS: [[f64; 2]; 12] = [
    [0.0, 9.0],
    [-0.3, 9.4],
    [0.999, 7.001],
    [-0.5, 8.5],
    [0.7, f64::INFINITY],
    [f64::NEG_INFINITY, 8.2],
    [0.0, 1.0],
    [0.3, 1.3],
    [0.9, 1.4],
    [0.0, 2.0],
    [0.2, 2.1],
    [-0.6, 2.4],
];

/// Positions between walls, the walls themselves among them.
fn positions(walls: [f64; 2]) -> impl Iterator<Item = f64> {
    let (low, high) = (walls[0].max(-4.0), walls[1].min(12.0));
    (0..=400).map(move |n| low + (high - low) * f64::from(n) / 400.0)
}

/// Sums over the nodes of a 3D stencil: Σ w, Σ w (x_i − x_p), Σ ∇w, Σ x_i ⊗ ∇w − I, all of which
/// have known values.
fn defects<const N: usize, S: ShapeFunction<N>>(xi: [f64; 3], half: f64, walls: [f64; 2]) -> f64 {
    let stencil = Stencil::<f64, N, 3>::new::<S>(xi.map(|xi| at::<N, S>(xi, half, walls)));
    let mut worst = [0.0; 16];
    worst[0] = -1.0;
    for a in 0..3 {
        worst[4 + 4 * a + a] = -1.0;
    }
    stencil.nodes(|index, w, dw| {
        worst[0] += w;
        for a in 0..3 {
            let axis = &stencil.axes[a];
            let r = axis.r[(index[a] - axis.first as i64) as usize];
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
        assert!(defects::<2, Linear>(xi, 0.0, FREE) <= 1e-13);
        assert!(defects::<3, QuadraticBspline>(xi, 0.0, FREE) <= 1e-13);
        assert!(defects::<4, CubicBspline>(xi, 0.0, FREE) <= 1e-13);
        for half in [1e-9, 0.1, 0.25, 0.5] {
            // the round-off of a domain without extent grows as its inverse
            assert!(defects::<3, Gimp>(xi, half, FREE) <= if half < 0.1 { 1e-6 } else { 1e-13 });
        }
    }
}

#[test]
fn next_to_walls_modified_weights_reproduce_linear_fields_and_are_not_negative() {
    fn check<const N: usize, S: ShapeFunction<N>>(half: f64, walls: [f64; 2], xi: f64) {
        for axis in [0, 1, 2] {
            let mut point = [0.5 * (walls[0].max(0.0) + walls[1].min(9.0)); 3];
            point[axis] = xi;
            let defect = defects::<N, S>(point, half, walls);
            assert!(defect <= 1e-13, "{defect:e} at {xi} between {walls:?} for {N} nodes");
        }
        let at = at::<N, S>(xi, half, walls);
        let weights = S::axis(at);
        for (k, w) in weights.w.into_iter().enumerate() {
            let node = weights.first + k as f64;
            let inside = (at.fit.nodes[0]..=at.fit.nodes[1]).contains(&node);
            assert!(w >= -1e-15, "node {node} has the weight {w} at {xi} between {walls:?}");
            assert!(inside || w.abs() <= 1e-15, "node {node} is behind a wall, with {w}");
        }
    }
    for walls in WALLS {
        for xi in positions(walls) {
            check::<2, Modified<Linear>>(0.0, walls, xi);
            check::<3, Modified<QuadraticBspline>>(0.0, walls, xi);
            check::<4, Modified<CubicBspline>>(0.0, walls, xi);
            check::<3, Modified<Gimp>>(0.3, walls, xi);
        }
    }
}

#[test]
fn on_a_wall_its_node_alone_counts() {
    fn check<const N: usize, S: ShapeFunction<N>>(walls: [f64; 2]) {
        for wall in walls.into_iter().filter(|wall| wall.is_finite()) {
            let at = at::<N, S>(wall, 0.25, walls);
            let axis = S::axis(at);
            for (w, r) in axis.w.into_iter().zip(axis.r) {
                let expected = f64::from(r.abs() < 2e-7);
                assert!(
                    (w - expected).abs() < if N == 4 { 1e-6 } else { 1e-14 },
                    "{w} at the distance {r} of wall {wall}"
                );
            }
        }
    }
    for walls in WALLS {
        check::<2, Modified<Linear>>(walls);
        check::<3, Modified<QuadraticBspline>>(walls);
        check::<4, Modified<CubicBspline>>(walls);
        check::<3, Modified<Gimp>>(walls);
    }
}

#[test]
fn the_second_node_of_three_or_four_is_never_so_light_that_round_off_counts() {
    fn check<const N: usize, S: ShapeFunction<N>>(walls: [f64; 2]) {
        for xi in positions(walls) {
            let w = S::axis(at::<N, S>(xi, 0.5, walls)).w[1];
            assert!(
                w >= if N == 3 { 1.0 / 12.0 - 1e-12 } else { 1e-8 },
                "{w} at {xi} between {walls:?}"
            );
        }
    }
    for walls in WALLS.into_iter().filter(|[low, high]| high - low >= 2.0) {
        check::<3, Modified<QuadraticBspline>>(walls);
        check::<4, Modified<CubicBspline>>(walls);
        check::<3, Modified<Gimp>>(walls);
    }
}

#[test]
fn weights_and_slopes_are_those_of_the_textbook() {
    fn check<const N: usize, S: ShapeFunction<N>>(shape: ShapeKind, half: f64) {
        for walls in if S::MODIFIED { &WALLS[..] } else { &[FREE] } {
            let between = Between::new(*walls);
            for xi in positions(*walls).skip(1) {
                let xi = xi - 1e-7;
                let axis = S::axis(at::<N, S>(xi, half, *walls));
                for k in 0..N {
                    let i = axis.first as i64 + k as i64;
                    if S::MODIFIED && !(between.nodes[0]..=between.nodes[1]).contains(&i) {
                        continue;
                    }
                    let (w, slope) = between.weight(shape, i, xi, half);
                    let found = (axis.w[k], axis.dw[k]);
                    assert!((w - found.0).abs() < 1e-13, "{shape:?} at {xi}: w {w} {found:?}");
                    assert!(
                        (slope - found.1).abs() < 1e-12,
                        "{shape:?} at {xi}: {slope} {found:?}"
                    );
                }
            }
        }
    }
    check::<2, Linear>(ShapeKind::Linear, 0.0);
    check::<3, QuadraticBspline>(ShapeKind::QuadraticBspline, 0.0);
    check::<4, CubicBspline>(ShapeKind::CubicBspline, 0.0);
    check::<2, Modified<Linear>>(ShapeKind::Linear, 0.0);
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
