//! The stencil of particles: nodes, weights and gradients as a tensor product of one-dimensional functions.

use crate::simd::Real;

/// Weights along one axis, of one particle or of eight. Node `first + n` has weight `w[n]` and slope `dw[n]` [1/h].
#[derive(Clone, Copy, Debug)]
pub struct Axis<R, const N: usize> {
    /// Lowest node of the stencil.
    pub first: R,
    /// Position above the lowest node, in units of the spacing.
    pub fraction: R,
    /// Weights.
    pub w: [R; N],
    /// Derivatives of the weights with respect to ξ = x / h.
    pub dw: [R; N],
}

/// A shape function of one axis with `N` nodes.
pub trait ShapeFunction<const N: usize> {
    /// The lowest node at ξ is floor(ξ − FIRST_OFFSET).
    const FIRST_OFFSET: f64;
    /// ∫ w (x_i − x_p)² over the nodes, in units of h², if it is the same everywhere (the matrix D of APIC).
    const MOMENT: Option<f64>;
    /// Weights and slopes at the position ξ (in units of the spacing).
    fn axis<R: Real>(xi: R) -> Axis<R, N>;
}

/// Weights over the N^D nodes of a stencil.
#[derive(Clone, Copy, Debug)]
pub struct Stencil<R, const N: usize, const D: usize> {
    /// The axes, x first.
    pub axes: [Axis<R, N>; D],
}

impl<R: Real, const N: usize, const D: usize> Stencil<R, N, D> {
    /// The stencil at ξ (in units of the spacing).
    #[inline(always)]
    pub fn new<S: ShapeFunction<N>>(xi: [R; D]) -> Self {
        let mut axes = [S::axis(xi[0]); D];
        for d in 1..D {
            axes[d] = S::axis(xi[d]);
        }
        Self { axes }
    }
}

impl<const N: usize, const D: usize> Stencil<f64, N, D> {
    /// Visits the nodes in storage order: index, weight, gradient of the weight [1/h].
    pub fn nodes(&self, mut visit: impl FnMut([i64; D], f64, [f64; D])) {
        for flat in 0..N.pow(D as u32) {
            let place = |d: usize| flat / N.pow((D - 1 - d) as u32) % N;
            let index = std::array::from_fn(|d| self.axes[d].first as i64 + place(d) as i64);
            let w = |d: usize| self.axes[d].w[place(d)];
            let slope = |d: usize, e: usize| if d == e { self.axes[e].dw[place(e)] } else { w(e) };
            let dw = std::array::from_fn(|d| (0..D).map(|e| slope(d, e)).product());
            visit(index, (0..D).map(w).product(), dw);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{linear::Linear, quadratic_bspline::QuadraticBspline};
    use super::*;

    /// Sums over the nodes of a 3D stencil: Σ w, Σ w (x_i − x_p), Σ ∇w, Σ x_i ⊗ ∇w − I, all of which have known values.
    fn defects<const N: usize, S: ShapeFunction<N>>(xi: [f64; 3]) -> f64 {
        let stencil = Stencil::<f64, N, 3>::new::<S>(xi);
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
