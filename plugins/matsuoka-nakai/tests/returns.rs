//! Random steps against the conditions of yield and flow in the invariants I1, I2, I3, and tangents against differences.
#![forbid(unsafe_code)]

mod support;

use lahar_plugin::Driver;
use lahar_plugin::abi::LAHAR_POINT_OK;
use lahar_plugin::nalgebra::Vector3;
use lahar_plugin::tensor::to_matrix;
use lahar_plugin::testing::{Random, principal_axes};
use std::collections::BTreeMap;
use support::{BULK, E, SHEAR, driver, trial};

/// Parameters of a test.
#[derive(Clone, Copy, Debug)]
struct Soil {
    phi: f64,
    psi: f64,
    cohesion: f64,
    cutoff: f64,
}

impl Soil {
    fn driver(&self, n: usize) -> Driver {
        let named = [
            ("friction_angle", self.phi),
            ("dilation_angle", self.psi),
            ("cohesion", self.cohesion),
            ("tension_cutoff", self.cutoff),
        ];
        driver(&named, n)
    }

    fn random(random: &mut Random) -> Self {
        let phi = random.between(2.0, 50.0);
        let cohesion = random.between(-5e3, 20e3).max(0.0);
        let kind = random.between(0.0, 1.0);
        let part = if kind < 0.25 { 0.0 } else { (1.5 * kind).min(1.0) };
        let cutoff = part * cohesion / phi.to_radians().tan();
        Self { phi, psi: random.between(0.0, 1.0) * phi, cohesion, cutoff }
    }

    /// Pressures measured from the apex.
    fn shifted(&self, s: Vector3<f64>) -> Vector3<f64> {
        Vector3::repeat(self.cohesion / self.phi.to_radians().tan()) - s
    }

    /// The least multiplier whose flow at the apex contains a deviatoric strain: max e : t / Γ over directions t of the
    /// deviator, where Γ = M p / q on the surface.
    fn least_flow(&self, e: Vector3<f64>) -> f64 {
        let sin = self.phi.to_radians().sin();
        let (slope, limit) =
            (6.0 * sin / (3.0 - sin), 9.0 + 8.0 * self.phi.to_radians().tan().powi(2));
        let along = (0..360).map(|n| {
            let turn = 2.0 * std::f64::consts::PI / 3.0;
            let angle = std::f64::consts::PI / 180.0 * f64::from(n);
            let t = Vector3::new(angle, angle - turn, angle + turn).map(|a| 2.0 / 3.0 * a.cos());
            // The deviator over the pressure at which the surface is reached, by halving.
            let [mut low, mut high] = [0.0, -1.0 / t.min()];
            for _ in 0..60 {
                let q = 0.5 * (low + high);
                let c = t.map(|t| 1.0 + q * t);
                if c.sum() * c.map(|c| 1.0 / c).sum() < limit { low = q } else { high = q }
            }
            e.dot(&t) * low / slope
        });
        along.fold(0.0, f64::max)
    }

    /// I1 I2 / I3 - 9 - 8 tan² φ over its size [-], and the gradient by the pressures scaled so that its trace is -M; the
    /// surface q Γ = M p + k has the same normal there.
    fn yield_function(&self, s: Vector3<f64>) -> (f64, Vector3<f64>) {
        let (c, limit) = (self.shifted(s), 9.0 + 8.0 * self.phi.to_radians().tan().powi(2));
        let (sum, inverse) = (c.sum(), c.map(|x| 1.0 / x).sum());
        let gradient = c.map(|x| inverse - sum / (x * x));
        let sin = self.phi.to_radians().sin();
        let scale = -6.0 * sin / (3.0 - sin) / gradient.sum();
        (sum * inverse / limit - 1.0, gradient * scale)
    }
}

/// Checks a step from a closed state; `flow_error` [-] is added to M_ψ for negative controls. Returns what is active and
/// how far outside the stress is over the stresses.
fn check(
    soil: &Soil,
    d: &Driver,
    k: usize,
    strain: [f64; 6],
    flow_error: f64,
) -> Result<(&'static str, f64), String> {
    let (values, axes) = principal_axes(trial(d.stress0(k), strain));
    let turned = axes.transpose() * to_matrix(d.stress1(k)) * axes;
    let scale = values.iter().fold(1.0_f64, |scale, v| scale.max(v.abs()));
    for (i, j) in [(0, 1), (1, 2), (0, 2)] {
        if turned[(i, j)].abs() > 1e-9 * scale {
            return Err(format!("the axes have turned: {turned}"));
        }
    }
    let (v, s) = (Vector3::from(values), turned.diagonal());
    let mean = |a: Vector3<f64>| a.sum() / 3.0;
    let deviator = |a: Vector3<f64>| a - Vector3::repeat(mean(a));
    // Plastic strain, compression positive as the pressures.
    let plastic = -deviator(v - s) / (2.0 * SHEAR);
    let volumetric = -mean(v - s) / BULK;
    let growth = (2.0_f64 / 3.0).sqrt() * plastic.norm();
    let kappa = d.state1(k, 0) - d.state0(k, 0);
    if (kappa - growth).abs() > 1e-14 * scale / SHEAR + 1e-9 * growth {
        return Err(format!("kappa grows by {kappa} instead of {growth}"));
    }
    let moved = (v - s).norm() > 1e-9 * scale;
    if mean(s) > soil.cutoff + 1e-14 * scale {
        return Err(format!("tension {}", mean(s)));
    }
    let at_cutoff = moved && (mean(s) - soil.cutoff).abs() <= 1e-13 * scale;
    let smallest = soil.shifted(s).min();
    if smallest <= 1e-9 * scale {
        // The apex: no deviator, and more expansion than the dilation of the flow that needs all of the trial deviator.
        let sin = soil.psi.to_radians().sin();
        let dilation = (6.0 * sin / (3.0 - sin) + flow_error) * soil.least_flow(plastic);
        let is_apex = deviator(s).norm() < 1e-13 * scale && at_cutoff;
        let expands = -volumetric > (1.0 - 1e-4) * dilation && volumetric < 0.0;
        return match is_apex && expands {
            true => Ok(("apex", 0.0)),
            false => Err(format!("beyond the apex: {s} {volumetric} {dilation}")),
        };
    }
    let (excess, gradient) = soil.yield_function(s);
    // In stresses: the slope of the invariant ratio by the stresses is of the order 1 / smallest pressure.
    let outside = excess * smallest / scale;
    if outside > 1e-10 {
        return Err(format!("outside by {outside} of the stresses"));
    }
    if !moved {
        return Ok(("elastic", outside));
    }
    if plastic.norm() < 1e-12 * scale / SHEAR && at_cutoff && volumetric < 0.0 {
        return Ok(("cut-off", outside));
    }
    let direction = deviator(gradient);
    let lambda = plastic.dot(&direction) / direction.norm_squared();
    if lambda < 0.0 || outside.abs() > 1e-9 {
        return Err(format!("flow {lambda} inside by {outside}"));
    }
    if (plastic - direction * lambda).norm() > 1e-7 * plastic.norm() + 1e-14 * scale / SHEAR {
        return Err(format!("{plastic} is not along {direction} at {s}"));
    }
    let sin = soil.psi.to_radians().sin();
    let dilation = -lambda * (6.0 * sin / (3.0 - sin) + flow_error);
    let error = volumetric - dilation;
    let tolerance = 1e-7 * lambda + 1e-13 * scale / BULK;
    match at_cutoff {
        true if error < tolerance => Ok(("both", outside)),
        false if error.abs() < tolerance => Ok(("surface", outside)),
        _ => Err(format!("dilation {volumetric} instead of {dilation}")),
    }
}

fn random_strain(random: &mut Random, k: usize) -> [f64; 6] {
    let size = 10f64.powf(random.between(-5.0, -1.5));
    let mut strain = random.symmetric(size);
    let mean = random.between(-1.0, 0.7) * size;
    (0..3).for_each(|c| strain[c] += mean);
    match k % 4 {
        0 => [strain[0], strain[0], strain[2], 0.0, 0.0, 0.0],
        _ => strain,
    }
}

#[test]
fn random_steps_satisfy_yield_and_flow() {
    let mut random = Random::new(11);
    let (mut seen, mut worst, mut refuted) = (BTreeMap::<&str, usize>::new(), f64::MIN, 0);
    for n in 0..400 {
        let soil = Soil::random(&mut random);
        let mut d = soil.driver(16);
        for k in 0..16 {
            let p = random.between(0.0, 100e3);
            d.set_stress(k, [-p, -p, -p, 0.0, 0.0, 0.0]);
        }
        for _ in 0..20 {
            let strains: Vec<_> = (0..16).map(|k| random_strain(&mut random, k)).collect();
            for k in 0..16 {
                d.set_strain_increment(k, strains[k]);
            }
            d.update(1.0).unwrap();
            for k in 0..16 {
                assert_eq!(d.status_of(k), LAHAR_POINT_OK);
                if d.state0(k, 1) != 0.0 {
                    continue;
                }
                let (active, outside) = check(&soil, &d, k, strains[k], 0.0)
                    .unwrap_or_else(|text| panic!("{n} {k} {soil:?}: {text}"));
                worst = worst.max(outside);
                *seen.entry(active).or_default() += 1;
                refuted += usize::from(check(&soil, &d, k, strains[k], 0.05).is_err());
            }
            d.commit();
        }
    }
    for active in ["elastic", "surface", "cut-off", "both", "apex"] {
        assert!(seen.get(active).is_some_and(|n| *n >= 20), "{active}: {seen:?}");
    }
    assert!(worst <= 1e-9, "{worst}");
    // Negative control: another dilation is refused wherever the surface alone is active and flow is more than round-off.
    assert!(refuted * 10 >= seen["surface"] * 9, "{refuted} of {}", seen["surface"]);
}

#[test]
fn tangents_are_those_of_differences() {
    let mut random = Random::new(5);
    let mut seen = BTreeMap::<&str, usize>::new();
    let (mut smooth, mut kinks) = (0, 0);
    for _ in 0..300 {
        let soil = Soil::random(&mut random);
        let mut d = soil.driver(1);
        let p = random.between(0.0, 100e3);
        d.set_stress(0, [-p, -p, -p, 0.0, 0.0, 0.0]);
        for n in 0..12 {
            let strain = random_strain(&mut random, n);
            let size = strain.iter().fold(0.0_f64, |size, e| size.max(e.abs()));
            // Every fourth point starts open.
            if random.between(0.0, 1.0) < 0.25 {
                d.set_state(0, 1, random.between(0.0, 2.0) * size);
            }
            let found = d.compare_tangent(0, strain, 1e-5 * size, 1.0).unwrap();
            let (worst, kink) = (found.error() / E, found.bend() > 1e-3 * E);
            let active = match d.state0(0, 1) != 0.0 {
                true if d.state1(0, 1) != 0.0 => "open",
                true => "closing",
                false => check(&soil, &d, 0, strain, 0.0).unwrap().0,
            };
            if kink {
                kinks += 1;
            } else {
                smooth += 1;
                *seen.entry(active).or_default() += 1;
                assert!(worst < 1e-5, "{worst} {active} {strain:?} from {:?}", d.stress0(0));
            }
            d.commit();
        }
    }
    for active in ["elastic", "surface", "cut-off", "both", "apex", "open", "closing"] {
        assert!(seen.get(active).is_some_and(|n| *n >= 5), "{active}: {seen:?}");
    }
    assert!(kinks * 20 < smooth, "{kinks} kinks, {smooth} smooth");
}
