//! The yield stress as a function of the equivalent plastic strain, and the return to it.

use lahar_plugin::math::{exp, exp_m1, ln};

/// Largest residual of a solution over the trial q; round-off is 1e-15.
const TOLERANCE: f64 = 1e-11;

/// The curve σ_y(κ) = max(σ_0 + H κ + Q (1 - exp(-b κ)), floor) and the elastic stiffness against which it is reached.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hardening {
    /// σ_0 [Pa]
    pub(crate) initial: f64,
    /// H [Pa]
    pub(crate) modulus: f64,
    /// Q [Pa]
    pub(crate) voce_stress: f64,
    /// b [-]
    pub(crate) voce_rate: f64,
    /// Least yield stress [Pa].
    pub(crate) floor: f64,
    /// 3 G [Pa]
    pub(crate) three_g: f64,
}

/// What a return gives.
pub(crate) struct Return {
    /// Δκ [-]; 0 in an elastic step.
    pub(crate) increment: f64,
    /// q at the end [Pa].
    pub(crate) q1: f64,
    /// dq1/dq [-].
    pub(crate) slope: f64,
    pub(crate) converged: bool,
}

impl Hardening {
    /// Whether the curve has the exponential part.
    pub(crate) fn is_voce(&self) -> bool {
        self.voce_stress * self.voce_rate != 0.0
    }

    /// Least 3 G + dσ_y/dκ without the floor over 3 G + max(H, 0): the return has one solution if it is positive.
    pub(crate) fn least_stiffness(&self) -> f64 {
        let steepest = (self.voce_stress * self.voce_rate).min(0.0);
        (self.three_g + self.modulus + steepest) / (self.three_g + self.modulus.max(0.0))
    }

    #[inline(always)]
    fn curve<const VOCE: bool>(&self, kappa: f64) -> f64 {
        let linear = self.initial + self.modulus * kappa;
        let voce = if VOCE { -self.voce_stress * exp_m1(-self.voce_rate * kappa) } else { 0.0 };
        linear + voce
    }

    #[inline(always)]
    fn yield_stress<const VOCE: bool>(&self, kappa: f64) -> f64 {
        larger(self.curve::<VOCE>(kappa), self.floor) // [VMS-1]
    }

    /// From the trial q [Pa] to the yield stress. The residual along the maximum of curve and floor is the smaller of two
    /// falling functions, so its root is the smaller root.
    #[inline(always)]
    pub(crate) fn return_from<const VOCE: bool>(&self, q: f64, kappa0: f64) -> Return {
        let excess = q - self.curve::<VOCE>(kappa0);
        let stiffness = self.three_g + self.modulus;
        let (along_curve, converged) = if VOCE {
            Voce::new(self, excess, kappa0).solve(q)
        } else {
            (excess / stiffness, true)
        };
        let to_floor = (q - self.floor) / self.three_g;
        let at_floor = to_floor <= along_curve;
        let root = if at_floor { to_floor } else { along_curve };
        let plastic = q > self.yield_stress::<VOCE>(kappa0);
        let increment = if plastic { root } else { 0.0 }; // [VMS-2]

        let kappa = kappa0 + increment;
        let voce = if VOCE { exp(-self.voce_rate * kappa) } else { 0.0 };
        let hardening = self.modulus + self.voce_stress * self.voce_rate * voce;
        let slope = if at_floor { 0.0 } else { hardening / (self.three_g + hardening) };
        Return {
            increment,
            q1: if plastic { self.yield_stress::<VOCE>(kappa) } else { q },
            slope: if plastic { slope } else { 1.0 },
            converged: converged | at_floor | !plastic,
        }
    }
}

/// The equation r(x) = f - c x + a (exp(-b x) - 1) = 0 of the plastic increment x, with the excess f > 0 of the trial.
struct Voce {
    excess: f64,
    stiffness: f64,
    amplitude: f64,
    rate: f64,
}

impl Voce {
    #[inline(always)]
    fn new(hardening: &Hardening, excess: f64, kappa0: f64) -> Self {
        Self {
            excess,
            stiffness: hardening.three_g + hardening.modulus,
            amplitude: hardening.voce_stress * exp(-hardening.voce_rate * kappa0),
            rate: hardening.voce_rate,
        }
    }

    #[inline(always)]
    fn residual(&self, x: f64) -> f64 {
        self.excess - self.stiffness * x + self.amplitude * exp_m1(-self.rate * x)
    }

    /// -dr/dx.
    #[inline(always)]
    fn slope(&self, x: f64) -> f64 {
        self.stiffness + self.rate * self.amplitude * exp(-self.rate * x)
    }

    /// Where the iteration starts. For a > 0, r is convex and both values are below the root: a step of Newton from 0,
    /// and from b x + c'/c = W(z) the bound W(z) >= L - ln L, L = ln z >= 1. For a < 0, r is concave and both are above.
    /// From there Newton's method runs to the root without crossing it.
    #[inline(always)]
    fn start(&self) -> f64 {
        let tangent = self.excess / self.slope(0.0);
        let asymptote = (self.excess - self.amplitude) / self.stiffness;
        let log = ln(self.rate * self.amplitude / self.stiffness) - self.rate * asymptote;
        let bound = asymptote + if log > 1.0 { (log - ln(log)) / self.rate } else { 0.0 };
        let convex = larger(tangent, bound);
        let concave = if tangent < asymptote { tangent } else { asymptote };
        if self.amplitude > 0.0 { convex } else { concave }
    }

    #[inline(always)]
    fn step(&self, x: f64) -> f64 {
        x + self.residual(x) / self.slope(x) // [VMS-3]
    }

    /// The root after six steps, and whether it is one (`six_steps_reach_round_off_for_every_curve`).
    #[inline(always)]
    fn solve(&self, q: f64) -> (f64, bool) {
        // Written out: a loop in it would keep the loop over the points from vectorising.
        let x = self.step(self.step(self.start()));
        let x = self.step(self.step(x));
        let x = self.step(self.step(x));
        (x, self.residual(x).abs() <= TOLERANCE * q)
    }
}

#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEPS: usize = 6;

    /// |r| of the start and of each step over the excess.
    fn table(voce: &Voce, step: impl Fn(f64) -> f64) -> Vec<f64> {
        let steps = std::iter::successors(Some(voce.start()), |x| Some(step(*x)));
        steps.take(STEPS + 1).map(|x| (voce.residual(x) / voce.excess).abs()).collect()
    }

    /// The number of pairs r, s of successive entries above round-off that were looked at, if every s <= 2 C r² with the
    /// constant C of Newton's method at the root.
    fn quadratic(voce: &Voce, table: &[f64]) -> Result<usize, String> {
        let root = (0..40).fold(voce.start(), |x, _| voce.step(x));
        let curvature = (voce.rate.powi(2) * voce.amplitude * exp(-voce.rate * root)).abs();
        let constant = 0.5 * curvature / voce.slope(root).powi(2) * voce.excess;
        let mut pairs = 0;
        for pair in table.windows(2).filter(|pair| pair[0] < 0.1 && pair[1] > 1e-13) {
            pairs += 1;
            if pair[1] > 2.0 * constant * pair[0] * pair[0] {
                return Err(format!("C = {constant:e}, residuals {table:?}"));
            }
        }
        Ok(pairs)
    }

    #[test]
    fn newtons_method_converges_quadratically() {
        let mut looked_at = 0;
        for (amplitude, excess) in [(0.3, 0.5), (2.0, 1.0), (40.0, 10.0), (-0.6, 0.4), (-0.9, 1.0)]
        {
            let voce = Voce { excess, stiffness: 1.0, amplitude, rate: 1.0 };
            let residuals = table(&voce, |x| voce.step(x));
            looked_at += quadratic(&voce, &residuals).unwrap();
            assert!(residuals[STEPS] < 1e-15, "{residuals:?}");
            // Negative control: the slope of the start for all steps converges, but linearly.
            let slope = voce.slope(voce.start());
            let chord = table(&voce, |x| x + voce.residual(x) / slope);
            assert!(quadratic(&voce, &chord).is_err(), "{chord:?}");
        }
        assert!(looked_at >= 8, "{looked_at}");
    }

    #[test]
    fn six_steps_reach_round_off_for_every_curve() {
        let mut seed = 1_u64;
        let mut random = |low: f64, high: f64| {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            low + (high - low) * (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        for k in 0..200_000 {
            // Voce hardening of any slope; softening that leaves a tenth of the stiffness.
            let amplitude = if k % 2 == 0 { random(-14.0, 18.0).exp() } else { -random(0.0, 0.9) };
            let excess = random(-20.0, 10.0).exp();
            let voce = Voce { excess, stiffness: 1.0, amplitude, rate: 1.0 };
            let (x, _) = voce.solve(1.0);
            let terms = excess + x + (amplitude * exp_m1(-x)).abs();
            let r = voce.residual(x).abs() / terms;
            assert!(r < 1e-15, "a = {amplitude}, f = {excess}: {r}");
        }
    }
}
