//! Roots of one unknown inside a bracket.

/// What a search found.
#[derive(Clone, Copy, Debug)]
pub struct Root {
    /// Where.
    pub at: f64,
    /// The function there.
    pub residual: f64,
    /// Its slope there.
    pub slope: f64,
    /// How often the function was evaluated.
    pub evaluations: usize,
    /// Whether the residual is as small as wanted, or the bracket as narrow as doubles allow.
    pub converged: bool,
}

/// Newton's method for the root of `f`, which gives value and slope, between `low` and `high`, where f(low) <= 0 <= f(high);
/// ends when |f| <= `tolerance`.
///
/// The bracket is halved when a step leaves it or the residual has not at least halved, so that a continuous function always has
/// its root found, at most after 200 evaluations; close to a simple root the convergence is quadratic. W. H. Press et al.,
/// Numerical Recipes, 3rd ed., Cambridge University Press (2007), section 9.4.
pub fn bracketed(
    [mut low, mut high]: [f64; 2],
    start: f64,
    tolerance: f64,
    mut f: impl FnMut(f64) -> [f64; 2],
) -> Root {
    let (mut at, mut last) = (start, f64::INFINITY);
    let mut evaluations = 0;
    loop {
        let [residual, slope] = f(at);
        evaluations += 1;
        let root = |converged| Root { at, residual, slope, evaluations, converged };
        if residual.abs() <= tolerance {
            return root(true);
        }
        if residual.is_nan() || evaluations >= 200 {
            return root(false);
        }
        if residual < 0.0 {
            low = at
        } else {
            high = at
        }
        let newton = at - residual / slope;
        let good = newton > low && newton < high && residual.abs() <= 0.5 * last;
        last = residual.abs();
        let next = if good { newton } else { low + 0.5 * (high - low) };
        if next == at || !(low < high) || next == low || next == high {
            return root(true);
        }
        at = next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smooth_root_is_found_quadratically() {
        let mut residuals = Vec::new();
        let root = bracketed([0.0, 2.0], 1.0, 1e-15, |x| {
            residuals.push((x * x - 2.0).abs());
            [x * x - 2.0, 2.0 * x]
        });
        assert!(root.converged && (root.at - 2.0_f64.sqrt()).abs() < 1e-15, "{root:?}");
        assert!(root.evaluations <= 7, "{residuals:?}");
        assert!(residuals.windows(2).all(|r| r[1] <= r[0] * r[0] + 1e-15), "{residuals:?}");
    }

    #[test]
    fn a_root_where_newton_fails_is_found_by_halving() {
        // Newton's steps for the cubic root and for a jump lead away; with a wrong slope they lead anywhere.
        for slope in [1.0, -1.0, 0.0, f64::NAN] {
            let root = bracketed([-1.0, 3.0], 2.9, 1e-12, |x| [x.cbrt(), slope]);
            assert!(root.converged && root.at.abs() < 1e-12, "{root:?}");
            let jump = |x: f64| [if x < 0.7 { -1.0 } else { 2.0 }, slope];
            let root = bracketed([-1.0, 3.0], -1.0, 1e-12, jump);
            assert!((root.at - 0.7).abs() < 1e-15, "{root:?}");
        }
    }

    #[test]
    fn what_is_not_a_number_ends_the_search() {
        assert!(!bracketed([0.0, 1.0], 0.5, 1e-9, |_| [f64::NAN, 1.0]).converged);
    }
}
