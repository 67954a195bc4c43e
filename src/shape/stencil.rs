//! The stencil of particles: nodes, weights and gradients as a tensor product of one-dimensional
//! functions.

use crate::background::{Space, space::Fit};
use crate::simd::{Real, each};

/// Where a particle, or eight, stands along one axis, in units of the spacing.
#[derive(Clone, Copy, Debug)]
pub struct At<R> {
    /// Position ξ = x / h.
    pub xi: R,
    /// Half the edge of the particle's domain; only sized shape functions look at it.
    pub half: R,
    /// The walls below and above; only modified shape functions look at them.
    pub fit: Fit,
}

impl At<f64> {
    /// A point without extent, far from walls.
    pub const fn point(xi: f64) -> Self {
        Self { xi, half: 0.0, fit: Fit::FREE }
    }
}

impl<R: Real> At<R> {
    /// Along axis d, at ξ [h], with edges `size` [m].
    #[inline(always)]
    pub fn along<const D: usize>(space: &Space<D>, d: usize, xi: R, size: R) -> Self {
        let half = size * R::splat(0.5 * space.inverse);
        Self { xi, half, fit: space.fits[d] }
    }
}

/// Where any shape function is wanted for a point; `size` are the edges of its domain [m].
pub fn at_point<const D: usize>(space: &Space<D>, x: [f64; D], size: [f64; D]) -> [At<f64>; D] {
    let xi = space.to_units(x);
    std::array::from_fn(|d| At::along(space, d, xi[d], size[d]))
}

/// Weights along one axis, of one particle or of eight. Node `first + n` has weight `w[n]` and
/// slope `dw[n]` [1/h].
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
    /// Distances of the nodes from the position, in units of the spacing.
    pub r: [R; N],
}

impl<R: Real, const N: usize> Axis<R, N> {
    /// Weights and slopes of nodes at equal distances.
    #[inline(always)]
    pub fn new(first: R, fraction: R, w: [R; N], dw: [R; N]) -> Self {
        Self { first, fraction, w, dw, r: each!(n in N => R::splat(n as f64) - fraction) }
    }
}

/// A shape function of one axis with `N` nodes.
pub trait ShapeFunction<const N: usize> {
    /// The lowest node at ξ is floor(ξ − FIRST_OFFSET).
    const FIRST_OFFSET: f64;
    /// ∫ w (x_i − x_p)² over the nodes, in units of h², if it is the same everywhere (the matrix D
    /// of APIC).
    const MOMENT: Option<f64>;
    /// Whether the weights depend on the size of the particle.
    const SIZED: bool = false;
    /// Whether the weights are modified next to walls.
    const MODIFIED: bool = false;
    /// The smooth ramp R(t) that a field has instead of a kink at a node, and its slope; `half` as
    /// in [`At`]. See [`modified`](super::modified).
    fn ramp<R: Real>(t: R, half: R) -> (R, R);
    /// Weights and slopes.
    fn axis<R: Real>(at: At<R>) -> Axis<R, N>;
}

/// Weights over the N^D nodes of a stencil.
#[derive(Clone, Copy, Debug)]
pub struct Stencil<R, const N: usize, const D: usize> {
    /// The axes, x first.
    pub axes: [Axis<R, N>; D],
}

impl<R: Real, const N: usize, const D: usize> Stencil<R, N, D> {
    /// The stencil of a point.
    #[inline(always)]
    pub fn new<S: ShapeFunction<N>>(at: [At<R>; D]) -> Self {
        let mut axes = [S::axis(at[0]); D];
        for d in 1..D {
            axes[d] = S::axis(at[d]);
        }
        Self { axes }
    }

    /// The stencil of particles with edges `size` [m].
    #[inline(always)]
    pub fn of_particles<S: ShapeFunction<N>>(space: &Space<D>, x: [R; D], size: [R; D]) -> Self {
        let xi = space.to_units(x);
        let mut axes = [S::axis(At::along(space, 0, xi[0], size[0])); D];
        for d in 1..D {
            axes[d] = S::axis(At::along(space, d, xi[d], size[d]));
        }
        Self { axes }
    }
}

impl<const N: usize, const D: usize> Stencil<f64, N, D> {
    /// Visits the nodes in storage order: index, weight, gradient of the weight [1/h].
    pub fn nodes(&self, mut visit: impl FnMut([i64; D], f64, [f64; D])) {
        for flat in 0..N.pow(D as u32) {
            let along = |d: usize| flat / N.pow((D - 1 - d) as u32) % N;
            let index = std::array::from_fn(|d| self.axes[d].first as i64 + along(d) as i64);
            let w = |d: usize| self.axes[d].w[along(d)];
            let slope = |d: usize, e: usize| if d == e { self.axes[e].dw[along(e)] } else { w(e) };
            let dw = std::array::from_fn(|d| (0..D).map(|e| slope(d, e)).product());
            visit(index, (0..D).map(w).product(), dw); // [SHP-7]
        }
    }
}
