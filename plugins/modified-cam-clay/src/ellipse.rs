//! The return to the yield ellipse: one unknown, the angle on the ellipse, between bounds that hold the solution.

use crate::swelling::{Compression, Swelling};
use lahar_plugin::tensor::{contract, deviator, trace};
use std::f64::consts::PI;

/// Constants of the ellipse.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ellipse {
    /// M [-]
    pub(crate) slope: f64,
    /// λ - κ [-]
    pub(crate) hardening: f64,
    pub(crate) elastic: Swelling,
}

/// One step of one point; strains and pressures of the volume are those of compression.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    /// p [Pa] and its measure g [-] at the start.
    p0: f64,
    g0: f64,
    /// Preconsolidation pressure at the start, not below the minimum [Pa].
    preconsolidation0: f64,
    /// Deviator at the start [Pa].
    deviator0: [f64; 6],
    strain: f64,
    strain_deviator: [f64; 6],
    volume: Compression,
    /// (λ - κ) ln(p_c / p_min) + κ g, which the total volume fixes at the end of the step [-].
    line: f64,
    /// The pressure at which the end would be isotropic: p = p_c [Pa], and its measure [-].
    isotropic: f64,
    g_isotropic: f64,
}

impl Step {
    /// Void ratio at the end [-].
    pub(crate) fn void_ratio(&self) -> f64 {
        self.volume.void_ratio
    }
}

/// The end of a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct End {
    pub(crate) p: f64,
    pub(crate) preconsolidation: f64,
    /// The deviator at the end over that of the elastic trial [-].
    pub(crate) ratio: f64,
    /// Secant shear modulus [Pa].
    shear: f64,
    pub(crate) plastic: bool,
}

/// What stands at one angle of the ellipse, with derivatives by the angle.
struct Place {
    p: f64,
    preconsolidation: f64,
    q: f64,
    trial_q: f64,
    shear: f64,
    residual: f64,
    slope: f64,
    /// 2 p - p_c [Pa], whose sign is that of the plastic volume change.
    side: f64,
}

const TOLERANCE: f64 = 1e-12;

impl Ellipse {
    /// `memory`: ln(p_c / p_min) at the start, below 0 in a point that is looser than any that carries load.
    pub(crate) fn step(
        &self,
        stress0: [f64; 6],
        strain_increment: [f64; 6],
        (preconsolidation0, memory): (f64, f64),
        volume: Compression,
    ) -> Step {
        let p0 = -trace(stress0) / 3.0;
        let g0 = self.elastic.measure(p0);
        let line = self.hardening * memory + volume.fall + self.elastic.slope * g0; // [MCC-3]
        let g_isotropic = (line / (self.hardening + self.elastic.slope)).max(0.0);
        Step {
            p0,
            g0,
            preconsolidation0,
            deviator0: deviator(stress0),
            strain: -trace(strain_increment),
            strain_deviator: deviator(strain_increment),
            volume,
            line,
            isotropic: self.elastic.pressure(g_isotropic),
            g_isotropic,
        }
    }

    /// Secant shear modulus between the start and `p` [Pa], and its derivative by `p`.
    fn shear(&self, step: &Step, p: f64) -> (f64, f64) {
        let factor = self.elastic.shear_ratio * step.volume.mean / self.elastic.slope;
        let (secant, derivative) = self.elastic.secant(step.p0, p);
        (factor * secant, factor * derivative) // [MCC-4]
    }

    fn trial(&self, step: &Step, shear: f64) -> ([f64; 6], f64) {
        let t: [f64; 6] =
            std::array::from_fn(|c| step.deviator0[c] + 2.0 * shear * step.strain_deviator[c]);
        (t, (1.5 * contract(t, t)).sqrt())
    }

    /// The end of the step. `watch` sees the angle and the residual of every iteration.
    pub(crate) fn advance(&self, step: &Step, watch: impl FnMut(f64, f64)) -> End {
        let g = step.g0 + step.volume.fall / self.elastic.slope;
        let p = self.elastic.pressure(g);
        let end = step.isotropic;
        let within = p >= -TOLERANCE * end && p <= (1.0 + TOLERANCE) * end;
        let (shear, _) = self.shear(step, p.clamp(0.0, end));
        let q = self.trial(step, shear).1;
        if within {
            let excess = (q / self.slope).powi(2) + p * (p - step.preconsolidation0); // [MCC-5]
            if excess <= TOLERANCE * end * end {
                let (shear, _) = self.shear(step, p);
                let preconsolidation = step.preconsolidation0;
                return End { p, preconsolidation, ratio: 1.0, shear, plastic: false };
            }
        }
        let wet = p > end || 2.0 * p > step.preconsolidation0;
        let place = self.return_to_ellipse(step, p, q, wet, watch);
        let ratio = if place.trial_q > 0.0 { place.q / place.trial_q } else { 0.0 };
        let Place { p, preconsolidation, shear, .. } = place;
        End { p, preconsolidation, ratio: ratio.min(1.0), shear, plastic: true }
    }

    /// The root of the residual between the trial and the critical state. On the wet side the residual is negative at the
    /// trial (or, beyond the ellipse, at its end) and positive at the critical state, on the dry side the reverse.
    fn return_to_ellipse(
        &self,
        step: &Step,
        p: f64,
        q: f64,
        wet: bool,
        mut watch: impl FnMut(f64, f64),
    ) -> Place {
        let end = step.isotropic;
        let trial = 2.0 * (end - p).max(0.0).sqrt().atan2(p.clamp(0.0, end).sqrt());
        let (mut low, mut high) = if wet { (trial, PI) } else { (0.0, trial) };
        if contract(step.deviator0, step.deviator0) == 0.0
            && contract(step.strain_deviator, step.strain_deviator) == 0.0
        {
            return self.at(step, if wet { 0.0 } else { PI });
        }
        let towards = (q / self.slope).atan2(p - 0.5 * end);
        let inside = |angle: f64| angle > low && angle < high;
        let mut angle = if inside(towards) { towards } else { 0.5 * (low + high) };
        for _ in 0..100 {
            let place = self.at(step, angle);
            watch(angle, place.residual);
            let beyond = if wet { place.side < 0.0 } else { place.side > 0.0 };
            let newton = angle - place.residual / place.slope;
            let settled = !beyond && (newton - angle).abs() <= 1e-14 * angle;
            if settled || high - low <= 1e-15 * angle {
                return place;
            }
            if if beyond { wet } else { place.residual > 0.0 } {
                high = angle;
            } else {
                low = angle;
            }
            let good = !beyond && newton > low && newton < high;
            angle = if good { newton } else { 0.5 * (low + high) };
        }
        self.at(step, angle)
    }

    /// The ellipse p = p_e cos²(α/2), q² = M² p (p_c - p), in which p_c follows p since the total volume is known, and the
    /// flow rule as residual. α is 0 at the isotropic end and π where the ellipse meets zero pressure.
    fn at(&self, step: &Step, angle: f64) -> Place {
        let (sin, cos) = (0.5 * angle).sin_cos();
        let (end, kappa, m) = (step.isotropic, self.elastic.slope, self.slope);
        let (p, dp) = (end * cos * cos, -end * cos * sin);
        let dg = dp / self.elastic.slope_at(p);
        let fall = if p >= self.elastic.minimum {
            -(-sin * sin).ln_1p()
        } else {
            step.g_isotropic - self.elastic.measure(p)
        };
        // ln(p_c / p_e), 0 as long as p_c stays at the minimum pressure.
        let growth = (step.line.min(0.0) + kappa * fall) / self.hardening;
        let (growth, dgrowth) =
            if growth > 0.0 { (growth, -kappa * dg / self.hardening) } else { (0.0, 0.0) };
        let (excess, dexcess) = (growth.exp_m1(), growth.exp() * dgrowth);
        let root = (excess + sin * sin).sqrt();
        let q = m * end * cos * root;
        let droot = if root > 0.0 { 0.5 * (dexcess + cos * sin) / root } else { 0.0 };
        let dq = m * end * (cos * droot - 0.5 * sin * root);

        let strain = step.strain - kappa * (step.g_isotropic - fall - step.g0) / step.volume.mean;
        let dstrain = -kappa * dg / step.volume.mean;
        let (shear, dshear) = self.shear(step, p);
        let dshear = dshear * dp;
        let (t, trial_q) = self.trial(step, shear);
        let along = contract(t, step.strain_deviator);
        let dtrial = if trial_q > 0.0 { 3.0 * along * dshear / trial_q } else { 0.0 };
        let side = end * (2.0 * cos * cos - 1.0 - excess);
        let factor = m * m / (6.0 * shear);
        let a = factor * side;
        let da = -a * dshear / shear + factor * (2.0 * dp - end * dexcess);
        Place {
            p,
            preconsolidation: end * (1.0 + excess),
            q,
            trial_q,
            shear,
            residual: strain * q - a * (trial_q - q), // [MCC-6]
            slope: dstrain * q + strain * dq - da * (trial_q - q) - a * (dtrial - dq),
            side,
        }
    }

    /// Stress at the end [Pa] and the plastic part of the equivalent deviatoric strain [-].
    pub(crate) fn stress(&self, step: &Step, stress0: [f64; 6], end: &End) -> ([f64; 6], f64) {
        let (t, q) = self.trial(step, end.shear);
        if end.plastic {
            let [xx, yy, zz, xy, yz, zx] = t.map(|x| end.ratio * x);
            let stress = [xx - end.p, yy - end.p, zz - end.p, xy, yz, zx];
            return (stress, (1.0 - end.ratio) * q / (3.0 * end.shear));
        }
        let rise = end.p - step.p0;
        let e = step.strain_deviator;
        let grown = |c: usize| stress0[c] + 2.0 * end.shear * e[c] - if c < 3 { rise } else { 0.0 };
        (std::array::from_fn(grown), 0.0)
    }

    /// Derivative of the end stress by the strain increment [Pa]: implicit differentiation of yield and flow rule.
    pub(crate) fn tangent(&self, step: &Step, end: &End) -> [[f64; 6]; 6] {
        let Step { volume, strain_deviator, .. } = step;
        let (kappa, m2, p) = (self.elastic.slope, self.slope * self.slope, end.p);
        let (shear, shear_p) = self.shear(step, p);
        let shear_e = shear * volume.mean_slope / volume.mean;
        let (t, _) = self.trial(step, shear);
        let along = contract(t, *strain_deviator);
        let dg = 1.0 / self.elastic.slope_at(p);
        let change = self.elastic.measure(p) - step.g0;
        let flow = step.strain - kappa * change / volume.mean;
        let flow_p = -kappa * dg / volume.mean;
        let flow_e = 1.0 + kappa * change * volume.mean_slope / (volume.mean * volume.mean);
        let pc = end.preconsolidation;
        let hardens = if pc > self.elastic.minimum { pc / self.hardening } else { 0.0 };
        let (pc_p, pc_e) = (-hardens * kappa * dg, hardens * volume.slope);
        let factor = m2 / (6.0 * shear);
        let a = factor * (2.0 * p - pc);
        let (a_p, a_e) =
            (-a * shear_p / shear + factor * (2.0 - pc_p), -a * shear_e / shear - factor * pc_e);
        // Yield ρ² q*² + M² p (p - p_c) = 0 and flow ρ (ε_p + a) - a = 0 in the unknowns p and ρ.
        let near_critical = (2.0 * p - pc).abs() < 0.1 * pc;
        let rho = if near_critical { end.ratio } else { a / (flow + a) };
        let square = 6.0 * rho * rho;
        let yield_p = square * along * shear_p + m2 * (2.0 * p - pc - p * pc_p);
        let yield_rho = 3.0 * rho * contract(t, t);
        let yield_e = square * along * shear_e - m2 * p * pc_e;
        let flow_rule_p = rho * (flow_p + a_p) - a_p;
        let flow_rule_rho = flow + a;
        let flow_rule_e = rho * (flow_e + a_e) - a_e;
        let determinant = yield_p * flow_rule_rho - yield_rho * flow_rule_p;

        let mut tangent = [[0.0; 6]; 6];
        for j in 0..6 {
            let mut unit = [0.0; 6];
            unit[j] = 1.0;
            let (de, dev) = (-trace(unit), deviator(unit));
            let (dp, drho) = if end.plastic {
                let y = -yield_e * de - square * shear * contract(t, dev);
                let f = -flow_rule_e * de;
                let dp = (y * flow_rule_rho - yield_rho * f) / determinant;
                (dp, (yield_p * f - flow_rule_p * y) / determinant)
            } else {
                (volume.slope * de / (kappa * dg), 0.0)
            };
            let rho = if end.plastic { rho } else { 1.0 };
            let dshear = shear_p * dp + shear_e * de;
            for i in 0..6 {
                let trial = 2.0 * (shear * dev[i] + dshear * strain_deviator[i]);
                tangent[i][j] = rho * trial + t[i] * drho - if i < 3 { dp } else { 0.0 };
            }
        }
        tangent
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::swelling::SpecificVolume;

    /// Angles and residuals of the iterations of one step from 100 kPa.
    fn iterations(strain: [f64; 6]) -> Vec<(f64, f64)> {
        let elastic = Swelling { slope: 0.04, shear_ratio: 0.46, minimum: 1e3 };
        let ellipse = Ellipse { slope: 1.2, hardening: 0.16, elastic };
        let volume = SpecificVolume { loosest: 3.0 }.compress(2.0, -trace(strain));
        let stress = [-1e5, -1e5, -1e5, 0.0, 0.0, 0.0];
        let step = ellipse.step(stress, strain, (1e5, 100f64.ln()), volume);
        let mut table = Vec::new();
        let end = ellipse.advance(&step, |angle, residual| table.push((angle, residual)));
        assert!(end.plastic);
        table
    }

    #[test]
    fn the_return_converges_quadratically() {
        for strain in [
            [5e-4, 5e-4, -1e-3, 0.0, 0.0, 0.0],
            [0.0, 0.0, -1e-2, 0.0, 0.0, 0.0],
            [1e-3, 0.0, -3e-3, 4e-3, 1e-3, 0.0],
            [1e-2, 2e-2, 0.0, 1e-2, 0.0, 0.0],
        ] {
            let table = iterations(strain);
            let root = table.last().unwrap().0;
            let errors: Vec<f64> = table.iter().map(|(angle, _)| (angle - root).abs()).collect();
            assert!(table.len() <= 9, "{strain:?}: {table:?}");
            let quadratic = errors.windows(2).filter(|e| e[0] < 0.1 && e[1] > 1e-13);
            let ratios: Vec<f64> = quadratic.map(|e| e[1] / (e[0] * e[0])).collect();
            assert!(!ratios.is_empty() && ratios.iter().all(|r| *r < 10.0), "{errors:?}");
            let first = table[0].1.abs();
            assert!(table.last().unwrap().1.abs() <= 1e-13 * first, "{table:?}");
        }
    }
}
