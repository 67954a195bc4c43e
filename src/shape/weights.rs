//! Weights on their way to the kernels: those of eight stencils, then of one particle in the lanes
//! of a node, and the tensor product of its axes, which scatter and gather share.

use super::stencil::Stencil;
use crate::background::{EDGE, Key};
use crate::simd::{LANES, Vector};

/// Particles of a batch, which go through each phase of a kernel together: phases have long chains
/// of operations, which overlap within a phase only.
pub const BATCH: usize = 4 * LANES;
/// Groups of eight in a batch.
pub const GROUPS: usize = BATCH / LANES;

/// The node of an axis that gets what the others leave, and from which the others are counted,
/// since Σ w = 1 and Σ c = 0: that saves a third of the products. Its weight must never be small,
/// or mass and momentum of a light node would lose their common factor; that excludes linear shape
/// functions, which have none.
const fn rest(nodes: usize) -> Option<usize> {
    if nodes > 2 { Some(1) } else { None }
}

/// Weights of eight stencils: w_n, and the two halves of c_n.
pub struct Weights<const N: usize, const D: usize> {
    w: [[[f64; LANES]; N]; D],
    low: [[[f64; LANES]; N]; D],
    high: [[[f64; LANES]; N]; D],
}

impl<const N: usize, const D: usize> Weights<N, D> {
    /// Room.
    pub const ZERO: Self = Self {
        w: [[[0.0; LANES]; N]; D],
        low: [[[0.0; LANES]; N]; D],
        high: [[[0.0; LANES]; N]; D],
    };

    /// c_n = [r_n w_n; w'_n] with the distance r_n = x_n − x_p in units of the spacing, or [w'_n;
    /// w'_n] if not `moments`.
    #[inline(always)]
    pub fn set<V: Vector>(&mut self, stencil: &Stencil<V, N, D>, moments: bool) {
        for d in 0..D {
            let axis = &stencil.axes[d];
            for n in 0..N {
                if rest(N) == Some(n) {
                    continue;
                }
                axis.w[n].store(&mut self.w[d][n]);
                axis.dw[n].store(&mut self.high[d][n]);
                let low = if moments { axis.r[n] * axis.w[n] } else { axis.dw[n] };
                low.store(&mut self.low[d][n]);
            }
        }
    }

    /// The axes of particle l.
    #[inline(always)]
    pub fn axes<V: Vector>(&self, l: usize) -> Axes<V, N, D> {
        let zero = V::splat(0.0);
        let mut axes = Axes { w: [[zero; N]; D], c: [[zero; N]; D] };
        for d in 0..D {
            for n in 0..N {
                if rest(N) != Some(n) {
                    axes.w[d][n] = V::splat(self.w[d][n][l]);
                    axes.c[d][n] = V::halves(self.low[d][n][l], self.high[d][n][l]);
                }
            }
        }
        axes
    }
}

/// w_n in all lanes, and c_n, of the axes of a stencil.
pub struct Axes<V, const N: usize, const D: usize> {
    w: [[V; N]; D],
    c: [[V; N]; D],
}

impl<V: Vector, const N: usize, const D: usize> Axes<V, N, D> {
    /// w_n B + c_n G for the nodes n of axis d.
    #[inline(always)]
    pub fn spread(&self, d: usize, value: V, column: V) -> [V; N] {
        let mut nodes = [value; N];
        for n in 0..N {
            if rest(N) != Some(n) {
                nodes[n] = self.w[d][n].mul_add(value, self.c[d][n] * column); // [SHP-7]
            }
        }
        Self::with_rest(nodes)
    }

    /// w_n B for the nodes n of axis d.
    #[inline(always)]
    pub fn share(&self, d: usize, value: V) -> [V; N] {
        let mut nodes = [value; N];
        for n in 0..N {
            if rest(N) != Some(n) {
                nodes[n] = self.w[d][n] * value;
            }
        }
        Self::with_rest(nodes)
    }

    /// Takes from the rest, which holds everything, what the other nodes got.
    #[inline(always)]
    fn with_rest(mut nodes: [V; N]) -> [V; N] {
        if let Some(rest) = rest(N) {
            for n in 0..N {
                if n != rest {
                    nodes[rest] = nodes[rest] - nodes[n];
                }
            }
        }
        nodes
    }

    /// Σ w_n R_n over the nodes n of axis d.
    #[inline(always)]
    pub fn sum(&self, d: usize, nodes: [V; N]) -> V {
        self.collect(d, nodes).0
    }

    /// Σ w_n R_n and Σ c_n R_n over the nodes n of axis d.
    #[inline(always)]
    pub fn collect(&self, d: usize, nodes: [V; N]) -> (V, V) {
        let (mut sum, mut slope) = (V::splat(0.0), V::splat(0.0));
        if let Some(rest) = rest(N) {
            sum = nodes[rest];
        }
        for n in 0..N {
            if rest(N) == Some(n) {
                continue;
            }
            let node = match rest(N) {
                Some(rest) => nodes[n] - nodes[rest],
                None => nodes[n],
            };
            sum = self.w[d][n].mul_add(node, sum);
            slope = self.c[d][n].mul_add(node, slope); // [SHP-7]
        }
        (sum, slope)
    }
}

/// Indices of the lowest nodes of eight stencils in the tile of block `key`, whose edge is
/// 4 + N − 1 nodes.
#[inline(always)]
pub fn corners<V: Vector, const N: usize, const D: usize>(
    stencil: &Stencil<V, N, D>,
    key: Key<D>,
) -> [u32; LANES] {
    let edge = V::splat((EDGE + N - 1) as f64);
    let mut at = V::splat(0.0);
    for d in 0..D {
        let lowest = V::splat(f64::from(key.at[d]) * EDGE as f64);
        at = at.mul_add(edge, stencil.axes[d].first - lowest);
    }
    at.to_indices()
}

/// Nodes from the first to the last of a stencil in a tile, inclusive.
pub const fn span(nodes: usize, dimension: usize) -> usize {
    let edge = EDGE + nodes - 1;
    let rows = if dimension == 3 { edge + 1 } else { 1 };
    (nodes - 1) * (rows * edge + 1) + 1
}
