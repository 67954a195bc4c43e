//! The flow stress and the equation of a plastic step.

use lahar_plugin::math::{exp, ln};

/// Most evaluations of the residual: metals need 4 to 8, odd numbers up to 60 (measured over 1e6 random steps).
const STEPS: usize = 100;
/// Residual of a solution over the flow stress, beside the round-off of the trial q.
const TOLERANCE: f64 = 1e-12;

/// σ_y = (A + B κ^n) (1 + C ln max(1, rate / rate0)) (1 - T*^m).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flow {
    /// A [Pa]
    pub(crate) initial: f64,
    /// B [Pa]
    pub(crate) hardening: f64,
    /// n [-]
    pub(crate) exponent: f64,
    /// C [-]
    pub(crate) rate_factor: f64,
    /// Rate from which on the rate counts [1/s].
    pub(crate) reference_rate: f64,
    /// m [-]
    pub(crate) softening: f64,
    /// Temperature up to which there is no softening [K].
    pub(crate) reference_temperature: f64,
    /// Temperature from which on there is no strength [K].
    pub(crate) melting_temperature: f64,
}

/// A flow stress with its derivatives.
pub(crate) struct FlowStress {
    /// [Pa]
    pub(crate) value: f64,
    /// By the plastic strain [Pa].
    by_strain: f64,
    /// By the plastic rate [Pa s].
    by_rate: f64,
    /// By the temperature [Pa/K].
    by_temperature: f64,
}

impl Flow {
    /// At a plastic strain [-], a plastic rate [1/s] and a temperature above the reference [K]. Derivatives are right for
    /// positive strains.
    pub(crate) fn at(&self, strain: f64, rate: f64, warmth: f64) -> FlowStress {
        let power = self.hardening * exp(self.exponent * ln(strain));
        let hardened = self.initial + power;
        let counts = rate > self.reference_rate;
        let speed = if counts { ln(rate / self.reference_rate) } else { 0.0 };
        let quickened = 1.0 + self.rate_factor * speed;
        let range = self.melting_temperature - self.reference_temperature;
        let homologous = (warmth / range).clamp(0.0, 1.0);
        let lost = exp(self.softening * ln(homologous));
        let left = 1.0 - lost;
        let softens = homologous > 0.0 && homologous < 1.0;
        let loss = if softens { self.softening * lost / (homologous * range) } else { 0.0 };
        FlowStress {
            value: hardened * quickened * left, // [JCK-1]
            by_strain: self.exponent * power / strain * quickened * left,
            by_rate: if counts { hardened * self.rate_factor / rate * left } else { 0.0 },
            by_temperature: -hardened * quickened * loss,
        }
    }
}

/// A step of a point, whose unknown is the plastic increment Δκ.
pub(crate) struct Step<'a> {
    pub(crate) flow: &'a Flow,
    /// 3 G [Pa]
    pub(crate) three_g: f64,
    /// q of the trial [Pa].
    pub(crate) q: f64,
    /// Plastic strain at the start [-].
    pub(crate) strain0: f64,
    /// Temperature above the reference at the start [K]; the difference, since heating may be less than the round-off of a
    /// temperature.
    pub(crate) warmth0: f64,
    /// Temperature per plastic work, χ / (ρ c) [K m^3/J].
    pub(crate) heating: f64,
    /// Length of the step [s].
    pub(crate) dt: f64,
}

/// What a plastic step gives.
pub(crate) struct Solution {
    /// Δκ [-]
    pub(crate) increment: f64,
    /// q at the end [Pa].
    pub(crate) q1: f64,
    /// dq1/dq [-]
    pub(crate) slope: f64,
}

/// The residual at a plastic increment.
struct Residual {
    /// q - 3 G Δκ - σ_y [Pa]
    value: f64,
    /// Its derivative by Δκ, with the other sign [Pa].
    slope: f64,
    stress: FlowStress,
}

impl Step<'_> {
    /// Whether the trial is beyond the yield stress without rate.
    pub(crate) fn is_plastic(&self) -> bool {
        self.q > self.flow.at(self.strain0, 0.0, self.warmth0).value
    }

    /// With the end stress in the plastic work q1 Δκ.
    fn residual(&self, x: f64) -> Residual {
        let q1 = self.q - self.three_g * x;
        let warmth = self.warmth0 + self.heating * q1 * x; // [JCK-3]
        let stress = self.flow.at(self.strain0 + x, x / self.dt, warmth);
        let warming = self.heating * (self.q - 2.0 * self.three_g * x);
        Residual {
            value: q1 - stress.value, // [JCK-2]
            slope: self.three_g
                + stress.by_strain
                + stress.by_rate / self.dt
                + stress.by_temperature * warming,
            stress,
        }
    }

    /// The increment to try after `x`: a step of Newton's method, between the bounds. Where it leaves them or the last
    /// one has not halved the residual, as near the power or the logarithm of a small number, the same step of ln x; where
    /// that leaves them too, the middle.
    fn next(&self, x: f64, at: &Residual, [low, high]: [f64; 2], halved: bool) -> f64 {
        let inside = |y: f64| y > low && y < high;
        let step = at.value / at.slope;
        let (newton, logarithmic) = (x + step, x * exp(step / x));
        if halved && inside(newton) {
            newton
        } else if inside(logarithmic) {
            logarithmic
        } else {
            0.5 * (low + high)
        }
    }

    fn is_small(&self, at: &Residual) -> bool {
        let round_off = 4.0 * f64::EPSILON * self.q;
        at.value.abs() <= TOLERANCE * at.stress.value + round_off
    }

    /// The increments that the iteration tries, each with its residual, until the residual or the interval is small.
    fn iterate(&self, mut visit: impl FnMut(f64, &Residual)) -> Option<(f64, Residual)> {
        let (mut low, mut high) = (0.0, self.q / self.three_g);
        let mut x = (self.q - self.flow.at(self.strain0, 0.0, self.warmth0).value) / self.three_g;
        let mut last = f64::INFINITY;
        for _ in 0..STEPS {
            let at = self.residual(x);
            visit(x, &at);
            let size = at.value.abs();
            match at.value > 0.0 {
                true => low = x,
                false => high = x,
            }
            // A steep flow stress can have its root between two numbers, a virgin point's below the smallest.
            let narrow = high - low <= 4.0 * f64::EPSILON * high + f64::MIN_POSITIVE;
            if self.is_small(&at) || narrow {
                return Some((x, at));
            }
            x = self.next(x, &at, [low, high], size < 0.5 * last);
            last = size;
        }
        None
    }

    /// The plastic step, if there is one; the trial must be plastic.
    pub(crate) fn solve(&self) -> Option<Solution> {
        if !(self.dt > 0.0) {
            return None; // there is no rate
        }
        let (increment, at) = self.iterate(|_, _| ())?;
        let q1 =
            if self.is_small(&at) { at.stress.value } else { self.q - self.three_g * increment };
        let heated = self.heating * increment * at.stress.by_temperature;
        let slope = 1.0 - self.three_g * (1.0 - heated) / at.slope; // [JCK-4]
        Some(Solution { increment, q1, slope })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COPPER: Flow = Flow {
        initial: 90.0e6,
        hardening: 292.0e6,
        exponent: 0.31,
        rate_factor: 0.025,
        reference_rate: 1.0,
        softening: 1.09,
        reference_temperature: 293.15,
        melting_temperature: 1356.0,
    };

    /// A step of copper to a trial q [Pa].
    fn step(flow: &Flow, q: f64) -> Step<'_> {
        let three_g = 1.388e11;
        let heating = 0.9 / (8960.0 * 383.0);
        Step { flow, three_g, q, strain0: 0.1, warmth0: 106.85, heating, dt: 1e-7 }
    }

    /// The residuals over q and the increments of an iteration.
    fn table(step: &Step<'_>) -> Vec<(f64, f64)> {
        let mut table = Vec::new();
        step.iterate(|x, at| table.push((x, at.value.abs() / step.q))).unwrap();
        table
    }

    /// The root by halving the interval alone.
    fn bisected(step: &Step<'_>) -> f64 {
        let (mut low, mut high) = (0.0, step.q / step.three_g);
        for _ in 0..400 {
            let x = 0.5 * (low + high);
            if step.residual(x).value > 0.0 {
                low = x;
            } else {
                high = x;
            }
        }
        high
    }

    #[test]
    fn the_slope_of_the_residual_is_its_difference() {
        let step = step(&COPPER, 4.0e8);
        for x in [1e-8, 1e-6, 1e-4, 1e-3, 2.8e-3] {
            let ends = [1.0 + 1e-5, 1.0 - 1e-5].map(|factor| step.residual(factor * x).value);
            let difference = (ends[1] - ends[0]) / (2e-5 * x);
            let slope = step.residual(x).slope;
            assert!((difference / slope - 1.0).abs() < 1e-5, "{x}: {slope:e} {difference:e}");
        }
    }

    #[test]
    fn newtons_method_converges_quadratically() {
        let mut looked_at = 0;
        for q in [2.9e8, 3.1e8, 4.0e8, 1.0e9, 1.0e10] {
            let step = step(&COPPER, q);
            let rows = table(&step);
            // The constant of Newton's method, r'' / 2 r'^2, at the root.
            let root = rows[rows.len() - 1].0;
            let slopes = [0.999, 1.001].map(|factor| step.residual(factor * root).slope);
            let curvature = (slopes[1] - slopes[0]).abs() / (0.002 * root);
            let constant = 0.5 * curvature / step.residual(root).slope.powi(2) * q;
            for pair in rows.windows(2).filter(|pair| pair[0].1 * constant < 0.1) {
                looked_at += 1;
                let bound = 1.5 * constant * pair[0].1.powi(2) + 1e-14;
                assert!(pair[1].1 <= bound, "C = {constant:e}, residuals {rows:?}");
                // Negative control: with a slope that is a twentieth off, a twentieth of the residual remains.
                let at = step.residual(pair[0].0);
                let off = step.residual(pair[0].0 + at.value / (1.05 * at.slope)).value.abs() / q;
                assert!(off > bound || constant * pair[0].1 > 0.02);
            }
        }
        assert!(looked_at >= 6, "{looked_at}");
    }

    #[test]
    fn the_iteration_ends_at_the_root_whatever_the_numbers() {
        let mut seed = 1_u64;
        let mut random = |low: f64, high: f64| {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            low + (high - low) * (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut most = 0;
        for k in 0..20_000 {
            let flow = Flow {
                initial: 10.0_f64.powf(random(7.0, 9.5)),
                hardening: 10.0_f64.powf(random(6.0, 9.5)),
                exponent: random(0.05, 1.5),
                rate_factor: random(0.0, 0.2),
                reference_rate: 10.0_f64.powf(random(-6.0, 3.0)),
                softening: random(0.3, 2.0),
                ..COPPER
            };
            let mut step = step(&flow, 0.0);
            step.strain0 = if k % 3 == 0 { 0.0 } else { 10.0_f64.powf(random(-9.0, 0.5)) };
            step.warmth0 = if k % 4 == 0 { 0.0 } else { random(-100.0, 1100.0) };
            step.dt = 10.0_f64.powf(random(-10.0, 0.0));
            let start = flow.at(step.strain0, 0.0, step.warmth0).value;
            // From a trial that is hardly beyond the yield stress to one at a thousand times it.
            step.q = (start + 1e-9) * (1.0 + 10.0_f64.powf(random(-12.0, 3.0)));
            let (x, _) = step.iterate(|_, _| ()).unwrap();
            most = most.max(table(&step).len());
            let expected = bisected(&step);
            // What counts for nothing in the stress, by a slope of a hundredth of the elastic one.
            let near = 100.0 * TOLERANCE * step.q / step.three_g;
            let same = (x - expected).abs() <= 1e-7 * expected + near;
            // Below m = 1 the loss of strength begins with an infinite slope, and there may be two roots.
            assert!(same || flow.softening < 1.0, "{k}: {x:e} {expected:e} {flow:?}");
        }
        assert!(most <= 60, "{most}");
    }
}
