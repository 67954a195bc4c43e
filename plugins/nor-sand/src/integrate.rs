//! The update of one point: implicit steps in pressure, image pressure and multiplier, as many as it takes.

use crate::dual::{Dual, Real};
use crate::law::Law;
use lahar_plugin::PointStatus;

/// A point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sand<T> {
    /// Cauchy stress [Pa]
    pub(crate) stress: [T; 6],
    /// e [-]
    pub(crate) void_ratio: T,
    /// ln(p_i / p_min) [-]
    pub(crate) image: T,
    /// Equivalent plastic strain [-]
    pub(crate) plastic: T,
    /// Volumetric strain since the point opened; 0: closed [-]
    pub(crate) opened: T,
}

/// ln(p_i / p_min) is not below this: isotropic compression is elastic up to the minimum pressure.
pub(crate) const LEAST_IMAGE: f64 = -1.0;

/// A step is cut so that an elastic change of stress is at most this part of the pressure, and so on for the image pressure.
const LARGEST_CHANGE: f64 = 0.5;
/// No more equal parts of the increment than this, before Newton's method asks for smaller ones.
const PARTS: f64 = 128.0;
/// How often a part is halved before the point is put on the yield surface at constant pressure instead.
const HALVINGS: i32 = 8;
/// After as many parts the rest of the increment goes the same way.
const MOST_PARTS: usize = 500;
const ITERATIONS: usize = 25;
const TOLERANCE: f64 = 1e-10;

/// One part of an increment, from the start of which everything is seen.
#[derive(Clone, Copy, Debug)]
struct Part<T> {
    /// p [Pa] at the start and its elastic strain [-].
    start: [T; 2],
    deviator: [T; 6],
    /// Compression [-] and deviator of the strain.
    strain: T,
    strain_deviator: [T; 6],
    image: T,
    /// At the end of the part [-].
    void_ratio: T,
}

/// Which equations hold at the end.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Mode {
    /// q = 0: the tip of the yield surface on the axis of pressure.
    tip: bool,
    /// The image pressure stays at its least value.
    least: bool,
}

fn trace<T: Real>(a: [T; 6]) -> T {
    a[0] + a[1] + a[2]
}

fn deviator<T: Real>(a: [T; 6]) -> [T; 6] {
    let m = trace(a) / 3.0;
    [a[0] - m, a[1] - m, a[2] - m, a[3], a[4], a[5]]
}

/// sqrt(factor a : a).
fn norm<T: Real>(a: [T; 6], factor: f64) -> T {
    let [xx, yy, zz, xy, yz, zx] = a;
    let sum = xx * xx + yy * yy + zz * zz + (xy * xy + yz * yz + zx * zx) * 2.0;
    (sum * factor).sqrt()
}

impl<T: Real> Part<T> {
    /// The same part with other numbers.
    fn map<U: Real>(&self, f: impl Fn(T) -> U) -> Part<U> {
        Part {
            start: self.start.map(&f),
            deviator: self.deviator.map(&f),
            strain: f(self.strain),
            strain_deviator: self.strain_deviator.map(&f),
            image: f(self.image),
            void_ratio: f(self.void_ratio),
        }
    }

    /// Secant shear modulus [Pa], deviator of the trial [Pa] and its q [Pa], if the part ends at `p`.
    fn trial(&self, law: &Law, p: T, u: T) -> (T, [T; 6], T) {
        let shear = law.elastic.secant_shear(self.start, [p, u]);
        let e = self.strain_deviator;
        let t: [T; 6] = std::array::from_fn(|c| self.deviator[c] + shear * e[c] * 2.0);
        (shear, t, norm(t, 1.5))
    }
}

impl Law {
    /// Flow rule, yield and hardening at the end of a part; unknown are ln(p / p_min), ln(p_i / p_min) and the multiplier.
    fn residual<T: Real>(
        &self,
        part: &Part<T>,
        [lnp, image, multiplier]: [T; 3],
        mode: Mode,
    ) -> [T; 3] {
        let p = lnp.exp() * self.elastic.minimum;
        let u = self.elastic.strain(p);
        let (shear, t, q) = part.trial(self, p, u);
        let ratio = self.critical_ratio_of(t, q);
        let at = self.image(part.void_ratio, image);
        let (x, mi) = (lnp - image, ratio * at.softened);
        let flow = part.strain - (u - part.start[1]) - multiplier * mi * x; // [NRS-8]
        let strength =
            if mode.tip { x - 1.0 } else { (q - mi * p * (-x + 1.0)) / (shear * 3.0) - multiplier };
        let rate = ratio * (self.hardening / self.critical_ratio);
        let growth = multiplier * rate * ((x - at.limit).exp() - 1.0); // [NRS-9]
        let hardening = if mode.least { image - LEAST_IMAGE } else { image - part.image - growth };
        [flow, strength, hardening]
    }

    /// Newton's method; the unknowns and the inverse of the matrix where it ends. `watch` sees the residuals.
    fn solve(
        &self,
        part: &Part<f64>,
        first: [f64; 3],
        mode: Mode,
        watch: &mut impl FnMut([f64; 3]),
    ) -> Option<([f64; 3], [[f64; 3]; 3])> {
        let constant = part.map(Dual::<3>::of);
        let mut unknowns = first;
        for _ in 0..ITERATIONS {
            let variables = std::array::from_fn(|i| Dual::variable(unknowns[i], i));
            let residual = self.residual(&constant, variables, mode);
            watch(residual.map(Real::value));
            let inverse = inverse(residual.map(|r| r.derivatives))?;
            let step = times(inverse, residual.map(Real::value));
            if !step.iter().all(|s| s.is_finite()) {
                return None;
            }
            let small = step[0].abs() < 1e-9
                && step[1].abs() < 1e-9
                && step[2].abs() < 1e-9 * unknowns[2].abs() + 1e-16;
            if small {
                return Some((unknowns, inverse));
            }
            let longest = step[0].abs().max(step[1].abs());
            let scale = if longest > 1.0 { 1.0 / longest } else { 1.0 };
            unknowns = std::array::from_fn(|i| unknowns[i] - scale * step[i]);
        }
        None
    }

    /// The end of a plastic part, or nothing if Newton's method finds none.
    fn plastic_end<T: Real>(
        &self,
        part: &Part<T>,
        p: T,
        watch: &mut impl FnMut([f64; 3]),
    ) -> Option<[T; 3]> {
        let values = part.map(Real::value);
        for (tip, start) in self.guesses(&values, p.value()) {
            for least in [false, true] {
                let mode = Mode { tip, least };
                let Some((unknowns, inverse)) = self.solve(&values, start, mode, watch) else {
                    continue;
                };
                // One more step, which also carries the derivatives.
                let residual = self.residual(part, unknowns.map(T::of), mode);
                let step = times(inverse, residual);
                let end: [T; 3] = std::array::from_fn(|i| -step[i] + unknowns[i]);
                let [lnp, image, multiplier] = end.map(Real::value);
                if image < LEAST_IMAGE - 1e-12 {
                    continue; // again with the image pressure at its least
                }
                if self.is_sound(&values, [lnp, image, multiplier], tip) {
                    return Some(end);
                }
                break;
            }
        }
        None
    }

    /// Where Newton's method may start, and whether at the tip.
    fn guesses(&self, part: &Part<f64>, p: f64) -> [(bool, [f64; 3]); 5] {
        let (lnp, image) = ((p / self.elastic.minimum).ln(), part.image);
        let isotropic = lnp - image > 1.0;
        // Sand that softens faster than it unloads elastically has no end nearby, but one at the limit.
        let (shear, t, q) = part.trial(self, p, self.elastic.strain(p));
        let at = self.image(part.void_ratio, image);
        let strength = self.critical_ratio_of(t, q) * at.softened * p * (1.0 - at.limit);
        let multiplier = ((q - strength) / (3.0 * shear)).max(0.0);
        [
            (isotropic, [lnp, image, 0.0]),
            (!isotropic, [lnp.min(image + 1.0), image, 0.0]),
            (false, [lnp, lnp - at.limit, multiplier]),
            (false, [image, image, 0.0]),
            (false, [image - 1.5, image, 0.0]),
        ]
    }

    /// Whether a solution of the equations is one of the model: plastic flow forwards, and q not below 0.
    fn is_sound(&self, part: &Part<f64>, [lnp, image, multiplier]: [f64; 3], tip: bool) -> bool {
        let p = lnp.exp() * self.elastic.minimum;
        let (shear, _, q) = part.trial(self, p, self.elastic.strain(p));
        let rest = q - 3.0 * shear * multiplier;
        let forwards = multiplier >= -1e-12;
        let place = if tip { rest <= 1e-9 * p } else { rest >= -1e-9 * p };
        forwards && place && lnp - image <= 1.0 + 1e-9
    }

    /// One part of an increment; nothing if it should be smaller. The flag is set where the flow rule was given up.
    fn advance_part<T: Real>(
        &self,
        mut sand: Sand<T>,
        mut strain: [T; 6],
        last: bool,
        watch: &mut impl FnMut([f64; 3]),
    ) -> Option<(Sand<T>, bool)> {
        let zero = T::of(0.0);
        let compression = -trace(strain);
        sand.void_ratio = (sand.void_ratio + 1.0) * (-compression).exp() - 1.0; // [NRS-10]
        if sand.opened.value() > 0.0 {
            let gap = sand.opened - compression;
            if gap.value() >= 0.0 {
                sand.plastic = sand.plastic + norm(deviator(strain), 2.0 / 3.0);
                (sand.opened, sand.stress) = (gap, [zero; 6]);
                return Some((sand, false));
            }
            // What is left of the increment when the gap has closed.
            let rest = -gap / compression;
            sand.plastic = sand.plastic + norm(deviator(strain), 2.0 / 3.0) * (-rest + 1.0);
            strain = strain.map(|e| e * rest);
            (sand.opened, sand.stress) = (zero, [zero; 6]);
        }
        let p0 = -trace(sand.stress) / 3.0;
        let part = Part {
            start: [p0, self.elastic.strain(p0)],
            deviator: deviator(sand.stress),
            strain: -trace(strain),
            strain_deviator: deviator(strain),
            image: sand.image,
            void_ratio: sand.void_ratio,
        };
        let u = part.start[1] + part.strain;
        let p = self.elastic.pressure(u);
        if p.value() <= 0.0 {
            sand.plastic = sand.plastic + norm(part.strain_deviator, 2.0 / 3.0);
            sand.opened = -p / self.elastic.bulk; // [NRS-11]
            (sand.stress, sand.image) = ([zero; 6], T::of(LEAST_IMAGE));
            return Some((sand, false));
        }
        let (shear, t, q) = part.trial(self, p, u);
        let ratio = self.critical_ratio_of(t, q);
        let excess = self.excess(q, p, ratio, sand.image, sand.void_ratio);
        let scale = p.value().max(sand.image.value().exp() * self.elastic.minimum);
        if excess.value() <= TOLERANCE * scale {
            let rise = p - p0;
            for c in 0..6 {
                let grown = sand.stress[c] + shear * part.strain_deviator[c] * 2.0;
                sand.stress[c] = if c < 3 { grown - rise } else { grown };
            }
            return Some((sand, false));
        }
        if let Some([lnp, image, multiplier]) = self.plastic_end(&part, p, watch) {
            let p = lnp.exp() * self.elastic.minimum;
            let (shear, t, q) = part.trial(self, p, self.elastic.strain(p));
            let fall = (shear * multiplier * 3.0 / q.max(f64::MIN_POSITIVE)).min(1.0);
            sand.stress = with_pressure(t.map(|x| x * (-fall + 1.0)), p);
            sand.image = image;
            sand.plastic = sand.plastic + q * fall / (shear * 3.0);
            return Some((sand, false));
        }
        if !last {
            return None;
        }
        // The yield surface at constant pressure.
        let lnp = (p / self.elastic.minimum).ln();
        sand.image = if (lnp - sand.image).value() > 1.0 { lnp - 1.0 } else { sand.image };
        let at = self.image(sand.void_ratio, sand.image);
        let strength = ratio * at.softened * p * (-(lnp - sand.image) + 1.0);
        let kept = (strength / q.max(f64::MIN_POSITIVE)).min(1.0);
        sand.stress = with_pressure(t.map(|x| x * kept), p);
        sand.plastic = sand.plastic + q * (-kept + 1.0) / (shear * 3.0);
        Some((sand, true))
    }

    /// The whole increment.
    pub(crate) fn advance<T: Real>(
        &self,
        start: Sand<T>,
        strain: [T; 6],
        watch: &mut impl FnMut([f64; 3]),
    ) -> (Sand<T>, PointStatus) {
        let (mut sand, mut left, mut status) = (start, 1.0_f64, PointStatus::Ok);
        let compression = trace(strain).value().abs();
        let shear_strain = norm(deviator(strain.map(Real::value)), 2.0 / 3.0);
        if !(compression.is_finite() && shear_strain.is_finite()) {
            return (sand, PointStatus::Failed);
        }
        for parts in 0.. {
            let p = (-trace(sand.stress) / 3.0).value().max(self.elastic.minimum);
            let bulk = self.elastic.bulk_modulus(p);
            let change = bulk * (compression + 3.0 * self.elastic.shear_ratio * shear_strain) / p;
            let change = change.max(self.hardening * shear_strain).max(50.0 * compression);
            let wanted = (LARGEST_CHANGE / change).clamp(1.0 / PARTS, 1.0);
            // Powers of two: the parts stay the same as the increment varies a little, and the tangent holds.
            let mut fraction = left.min(wanted.log2().floor().exp2());
            let many = parts >= MOST_PARTS;
            if many || sand.opened.value() > compression * left {
                fraction = left;
            }
            for halving in 0..=HALVINGS {
                // The last part takes what is left, so that the parts add up.
                fraction = if left - fraction < 1e-9 { left } else { fraction };
                let part = strain.map(|e| e * fraction);
                let last = many || halving == HALVINGS;
                if let Some((end, given_up)) = self.advance_part(sand, part, last, watch) {
                    sand = end;
                    left -= fraction;
                    status = if given_up { PointStatus::Unreliable } else { status };
                    break;
                }
                fraction *= 0.5;
            }
            if left <= 0.0 {
                break;
            }
        }
        (sand, status)
    }
}

fn with_pressure<T: Real>([xx, yy, zz, xy, yz, zx]: [T; 6], p: T) -> [T; 6] {
    [xx - p, yy - p, zz - p, xy, yz, zx]
}

fn times<T: Real>(a: [[f64; 3]; 3], b: [T; 3]) -> [T; 3] {
    a.map(|row| b[0] * row[0] + b[1] * row[1] + b[2] * row[2])
}

fn inverse(a: [[f64; 3]; 3]) -> Option<[[f64; 3]; 3]> {
    let minor = |i: usize, j: usize| {
        let (r, s, c, d) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
        a[r][c] * a[s][d] - a[r][d] * a[s][c]
    };
    let determinant = (0..3).map(|j| a[0][j] * minor(0, j)).sum::<f64>();
    let inverse = std::array::from_fn(|i| std::array::from_fn(|j| minor(j, i) / determinant));
    (determinant != 0.0 && determinant.is_finite()).then_some(inverse)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Elasticity;

    #[test]
    fn the_return_converges_quadratically() {
        let elastic = Elasticity { minimum: 1e3, bulk: 4e6, shear_ratio: 0.75, exponent: 0.5 };
        let law = Law {
            elastic,
            critical_ratio: 1.25,
            extension: (3.0_f64 / 4.25).powi(4),
            critical_void_ratio: 0.9,
            critical_slope: 0.03,
            coupling: 0.3,
            dilatancy: 3.5,
            hardening: 150.0,
        };
        let (isotropic, sheared) =
            ([-1e5, -1e5, -1e5, 0.0, 0.0, 0.0], [-6e4, -6e4, -18e4, 0.0, 0.0, 0.0]);
        let ln100 = 100f64.ln();
        for (stress, image, strain) in [
            (isotropic, ln100 - 1.0, [-3e-4, -3e-4, -3e-4, 0.0, 1e-6, 0.0]),
            (isotropic, ln100 - 1.0, [3e-4, 2e-4, -4e-4, 0.0, 1e-4, 0.0]),
            (sheared, ln100 + 0.1, [2e-4, 2e-4, -5e-4, 0.0, 0.0, 0.0]),
            (sheared, ln100 + 0.1, [0.0, 1e-4, -2e-4, 3e-4, -1e-4, 0.0]),
            (sheared, ln100 + 0.1, [-3e-4, -3e-4, -3e-4, 0.0, 5e-4, 0.0]),
        ] {
            let start = Sand { stress, void_ratio: 0.7, image, plastic: 0.0, opened: 0.0 };
            let mut table: Vec<f64> = Vec::new();
            let watch = &mut |r: [f64; 3]| table.push(r.iter().fold(0.0, |m, x| x.abs().max(m)));
            let (end, given_up) = law.advance_part(start, strain, false, watch).unwrap();
            assert!(!given_up && end.image != start.image);
            assert!((4..=7).contains(&table.len()), "{table:?}");
            // Each residual is of the order of the square of the one before, until round-off.
            // The first step is far from the end, and mixes residuals of different sizes.
            let falls = table[1..].windows(2).filter(|r| r[0] < 1e-1 && r[1] > 1e-14);
            let ratios: Vec<f64> = falls.map(|r| r[1] / (r[0] * r[0])).collect();
            assert!(!ratios.is_empty() && ratios.iter().all(|r| *r < 100.0), "{table:?}");
            assert!(*table.last().unwrap() < 1e-14, "{table:?}");
        }
    }
}
