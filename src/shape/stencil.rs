//! The stencil of a particle: nodes, weights and gradients as a tensor product of one-dimensional functions.

/// Weights of a particle along one axis. Node `first + n` has weight `w[n]` and slope `dw[n]` [1/h].
#[derive(Clone, Copy, Debug)]
pub struct Axis<const N: usize> {
    /// Lowest node of the stencil.
    pub first: f64,
    /// Position above the lowest node, in units of the spacing.
    pub fraction: f64,
    /// Weights.
    pub w: [f64; N],
    /// Derivatives of the weights with respect to ξ = x / h.
    pub dw: [f64; N],
}

/// The largest whole number not above x, for |x| < 2^51; not finite if x is not.
///
/// Adding and subtracting 1.5 · 2^52 rounds to the nearest whole number. The baseline instruction set has no rounding
/// instruction, and the library call costs more than the rest of a weight.
#[inline(always)]
pub fn floor(x: f64) -> f64 {
    const WHOLE: f64 = 6_755_399_441_055_744.0;
    let nearest = (x + WHOLE) - WHOLE;
    if nearest > x { nearest - 1.0 } else { nearest }
}

/// A shape function of one axis with `N` nodes.
pub trait ShapeFunction<const N: usize> {
    /// The lowest node at ξ is floor(ξ − FIRST_OFFSET).
    const FIRST_OFFSET: f64;
    /// ∫ w (x_i − x_p)² over the nodes, in units of h², if it is the same everywhere (the matrix D of APIC).
    const MOMENT: Option<f64>;
    /// Weights and slopes at the position ξ (in units of the spacing).
    fn axis(xi: f64) -> Axis<N>;
}

/// Weights of a particle over the N^D nodes of its stencil.
#[derive(Clone, Copy, Debug)]
pub struct Stencil<const N: usize, const D: usize> {
    /// The axes, x first.
    pub axes: [Axis<N>; D],
}

/// A run of `N` nodes along the last axis: what the outer axes contribute.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Nodes from the lowest node of the stencil to the first node of the row, in a tile of the given edge.
    pub offset: usize,
    /// Product of the outer weights.
    pub w: f64,
    /// Derivatives of that product along the outer axes [1/h].
    pub dw: [f64; 2],
    /// Position of the row in the stencil along the outer axes.
    pub node: [usize; 2],
}

impl<const N: usize, const D: usize> Stencil<N, D> {
    /// The stencil at ξ (in units of the spacing).
    pub fn new<S: ShapeFunction<N>>(xi: [f64; D]) -> Self {
        Self { axes: xi.map(S::axis) }
    }

    /// The last axis, along which rows run.
    pub fn last(&self) -> &Axis<N> {
        &self.axes[D - 1]
    }

    /// Visits the rows of the stencil in a tile with `edge` nodes an axis, in storage order.
    #[inline(always)]
    pub fn rows(&self, edge: usize, mut visit: impl FnMut(Row)) {
        let x = &self.axes[0];
        for i in 0..N {
            if D == 2 {
                visit(Row { offset: i * edge, w: x.w[i], dw: [x.dw[i], 0.0], node: [i, 0] });
            } else {
                let y = &self.axes[1];
                for j in 0..N {
                    visit(Row {
                        offset: (i * edge + j) * edge,
                        w: x.w[i] * y.w[j],
                        dw: [x.dw[i] * y.w[j], x.w[i] * y.dw[j]],
                        node: [i, j],
                    });
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{linear::Linear, quadratic_bspline::QuadraticBspline};
    use super::*;

    /// Sums over the nodes of a 3D stencil: Σ w, Σ w (x_i − x_p), Σ ∇w, Σ x_i ⊗ ∇w − I, all of which have known values.
    fn defects<const N: usize, S: ShapeFunction<N>>(xi: [f64; 3]) -> f64 {
        let stencil = Stencil::<N, 3>::new::<S>(xi);
        let mut worst = [0.0; 16];
        worst[0] = -1.0;
        for a in 0..3 {
            worst[4 + 4 * a + a] = -1.0;
        }
        stencil.rows(8, |row| {
            for k in 0..N {
                let z = stencil.last();
                let w = row.w * z.w[k];
                let dw = [row.dw[0] * z.w[k], row.dw[1] * z.w[k], row.w * z.dw[k]];
                let node = [row.node[0], row.node[1], k];
                worst[0] += w;
                for a in 0..3 {
                    let r = node[a] as f64 - stencil.axes[a].fraction;
                    worst[1 + a] += w * r;
                    for b in 0..3 {
                        worst[4 + 4 * a + b] += r * dw[b];
                    }
                    worst[7 + 4 * a] += dw[a];
                }
            }
        });
        worst.into_iter().fold(0.0, |m, d| f64::max(m, f64::abs(d)))
    }

    #[test]
    fn the_floor_of_a_position_is_that_of_the_library() {
        for x in [0.0, -0.0, 0.5, -0.5, 1.0, -1.0, 2.5, -2.5, 1e9 + 0.75, -1e9 - 0.25, -1e-300] {
            assert_eq!(floor(x), x.floor(), "{x}");
            assert_eq!(floor(f64::next_down(x)), f64::next_down(x).floor(), "below {x}");
        }
        assert!(!floor(f64::NAN).is_finite() && !floor(f64::INFINITY).is_finite());
    }

    #[test]
    fn weights_sum_to_one_and_reproduce_linear_fields() {
        for n in 0..1000 {
            let t = f64::from(n) * 0.618_033_988_749_895;
            let xi = [t - 300.0, 7.0 - 3.0 * t, 0.1 * t];
            assert!(defects::<2, Linear>(xi) <= 1e-13);
            assert!(defects::<3, QuadraticBspline>(xi) <= 1e-13);
        }
    }

    #[test]
    fn slopes_are_the_derivatives_of_the_weights() {
        fn check<const N: usize, S: ShapeFunction<N>>() {
            for n in 1..50 {
                let xi = 3.0 + 0.01 * f64::from(n) - S::FIRST_OFFSET;
                let (below, at, above) = (S::axis(xi - 1e-6), S::axis(xi), S::axis(xi + 1e-6));
                for k in 0..N {
                    let difference = (above.w[k] - below.w[k]) / 2e-6;
                    assert!((difference - at.dw[k]).abs() < 1e-9);
                }
            }
        }
        check::<2, Linear>();
        check::<3, QuadraticBspline>();
    }

    #[test]
    fn the_second_moment_of_the_quadratic_spline_is_a_quarter() {
        let moment = QuadraticBspline::MOMENT.expect("the quadratic spline has one");
        for n in 0..100 {
            let a = QuadraticBspline::axis(0.077 * f64::from(n));
            let m: f64 = (0..3).map(|k| a.w[k] * (k as f64 - a.fraction).powi(2)).sum();
            assert!((m - moment).abs() < 1e-14);
        }
        assert!(Linear::MOMENT.is_none());
    }
}
