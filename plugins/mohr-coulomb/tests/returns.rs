//! Random steps against the conditions of Kuhn and Tucker in brute force, and tangents against differences.
#![forbid(unsafe_code)]

mod support;

use lahar_plugin::Driver;
use lahar_plugin::abi::LAHAR_POINT_OK;
use lahar_plugin::nalgebra::{DMatrix, DVector, Vector3};
use lahar_plugin::tensor::to_matrix;
use lahar_plugin::testing::{Random, principal_axes};
use std::collections::BTreeMap;
use support::{E, NU, SHEAR, driver, trial};

/// Parameters of a test and what they mean, written down apart from the model.
#[derive(Clone, Copy)]
struct Soil {
    /// Angles of friction and dilation [deg], cohesion [Pa]: peak and residual.
    peak: [f64; 3],
    residual: [f64; 3],
    cutoff: f64,
    /// 0 none, 1 exponential, 2 linear.
    softening: f64,
    softening_strain: f64,
}

impl Soil {
    fn driver(&self, n: usize) -> Driver {
        let named = [
            ("friction_angle", self.peak[0]),
            ("dilation_angle", self.peak[1]),
            ("cohesion", self.peak[2]),
            ("tension_cutoff", self.cutoff),
            ("softening", self.softening),
            ("softening_strain", self.softening_strain),
            ("residual_friction_angle", self.residual[0]),
            ("residual_dilation_angle", self.residual[1]),
            ("residual_cohesion", self.residual[2]),
        ];
        driver(&named, n)
    }

    /// sin φ, sin ψ, 2 c cos φ, largest tension.
    fn strength(&self, kappa: f64) -> [f64; 4] {
        let x = kappa / self.softening_strain;
        let left = [1.0, (-x).exp(), (1.0 - x).max(0.0)][self.softening as usize];
        let value: [f64; 3] =
            std::array::from_fn(|i| left * self.peak[i] + (1.0 - left) * self.residual[i]);
        let (sin, cos) = value[0].to_radians().sin_cos();
        let tension = if self.cutoff > 0.0 { self.cutoff * value[2] / self.peak[2] } else { 0.0 };
        [sin, value[1].to_radians().sin(), 2.0 * value[2] * cos, tension]
    }

    fn random(random: &mut Random) -> Self {
        let phi = random.between(0.0, 50.0);
        let cohesion = random.between(-4e3, 20e3).max(0.0);
        let apex = cohesion / phi.to_radians().tan();
        let kind = random.between(0.0, 1.0);
        // No tension, the whole cone, and between.
        let cutoff = if kind < 0.25 { 0.0 } else { apex.min(50e3) * (1.5 * kind).min(1.0) };
        let residual = random.between(0.3, 1.0) * phi;
        let psi = random.between(0.0, 1.0) * residual;
        Self {
            peak: [phi, psi, cohesion],
            residual: [residual, 0.5 * psi, random.between(0.0, 1.0) * cohesion],
            cutoff,
            softening: random.between(0.0, 2.999).floor(),
            softening_strain: random.between(0.05, 0.5),
        }
    }
}

/// All planes in all orders of the principal stresses: normal or flow for a sine, and the bound.
fn planes() -> Vec<(usize, Option<usize>)> {
    let mut all: Vec<_> = (0..3).map(|i| (i, None)).collect();
    for i in 0..3 {
        all.extend((0..3).filter(|j| *j != i).map(|j| (i, Some(j))));
    }
    all
}

fn direction((i, j): (usize, Option<usize>), sine: f64) -> Vector3<f64> {
    let mut n = Vector3::zeros();
    match j {
        Some(j) => (n[i], n[j]) = (1.0 + sine, sine - 1.0),
        None => n[i] = 1.0,
    }
    n
}

fn excess(plane: (usize, Option<usize>), strength: [f64; 4], s: Vector3<f64>) -> f64 {
    let [sin, _, cohesion, tension] = strength;
    direction(plane, sin).dot(&s) - if plane.1.is_some() { cohesion } else { tension }
}

/// Whether a strain is a combination of some of the directions with factors that are not negative.
fn in_cone(strain: Vector3<f64>, directions: &[Vector3<f64>], round_off: f64) -> bool {
    let n = directions.len();
    let tolerance = 1e-8 * strain.norm() + round_off;
    (1..1_usize << n).filter(|set| set.count_ones() <= 3).any(|set| {
        let chosen: Vec<_> =
            (0..n).filter(|i| set & (1 << i) != 0).map(|i| directions[i]).collect();
        let matrix = DMatrix::from_fn(3, chosen.len(), |i, j| chosen[j][i]);
        let right = DVector::from_column_slice(strain.as_slice());
        let Ok(factors) = matrix.clone().svd(true, true).solve(&right, 1e-12) else { return false };
        (matrix * &factors - right).norm() <= tolerance && factors.iter().all(|f| *f >= -tolerance)
    })
}

struct Checked {
    /// Which planes are active, in words.
    active: String,
    /// Largest yield function over the stresses.
    residual: f64,
}

/// Checks a step from a closed state; `flow_error` [-] is added to sin ψ for negative controls.
fn check(
    soil: &Soil,
    d: &Driver,
    k: usize,
    strain: [f64; 6],
    flow_error: f64,
) -> Result<Checked, String> {
    let (start, end) = (trial(d.stress0(k), strain), d.stress1(k));
    let (values, axes) = principal_axes(start);
    let turned = axes.transpose() * to_matrix(end) * axes;
    let scale = values.iter().fold(1.0_f64, |scale, v| scale.max(v.abs()));
    let largest = (0..6).fold(1.0_f64, |scale, c| scale.max(end[c].abs()));
    for (i, j) in [(0, 1), (1, 2), (0, 2)] {
        if turned[(i, j)].abs() > 1e-9 * scale {
            return Err(format!("the axes have turned: {turned}"));
        }
    }
    let (v, s) = (Vector3::from(values), turned.diagonal());
    let [kappa0, kappa1] = [d.state0(k, 0), d.state1(k, 0)];
    let mut strength = soil.strength(kappa1);
    let residual = planes().into_iter().map(|p| excess(p, strength, s)).fold(f64::MIN, f64::max);
    strength[1] += flow_error;
    // Round-off of the trial stress is all that the yield function may have.
    if residual > 1e-9 * largest.max(strength[2]) + 1e-14 * scale {
        return Err(format!("outside by {residual}"));
    }
    let change = v - s;
    let plastic = (change - Vector3::repeat(change.sum() * NU / (1.0 + NU))) / (2.0 * SHEAR);
    let deviator = plastic - Vector3::repeat(plastic.sum() / 3.0);
    let growth = (2.0_f64 / 3.0).sqrt() * deviator.norm();
    if (kappa1 - kappa0 - growth).abs() > 1e-11 * scale / SHEAR + 1e-9 * growth {
        return Err(format!("kappa grows by {} instead of {growth}", kappa1 - kappa0));
    }
    let active: Vec<_> = planes()
        .into_iter()
        .filter(|p| excess(*p, strength, s).abs() <= 1e-9 * scale.max(strength[2]))
        .collect();
    if plastic.norm() > 1e-9 * scale / E {
        let flows: Vec<_> = active.iter().map(|p| direction(*p, strength[1])).collect();
        if flows.is_empty() || !in_cone(plastic, &flows, 1e-14 * scale / E) {
            return Err(format!("{plastic} is no flow of {active:?} at {s}"));
        }
        let name = |p: &(usize, Option<usize>)| match p.1 {
            Some(j) => format!("{}{j} ", p.0),
            None => format!("t{} ", p.0),
        };
        let active = active.iter().map(name).collect();
        return Ok(Checked { active, residual: residual / largest.max(strength[2]) });
    }
    Ok(Checked { active: "elastic".into(), residual: residual / largest.max(strength[2]) })
}

#[test]
fn random_steps_satisfy_the_conditions_of_kuhn_and_tucker() {
    let mut random = Random::new(11);
    let (mut seen, mut worst, mut refuted) = (BTreeMap::<String, usize>::new(), f64::MIN, 0);
    for n in 0..300 {
        let soil = Soil::random(&mut random);
        let mut d = soil.driver(16);
        for k in 0..16 {
            let p = random.between(0.0, 100e3);
            d.set_stress(k, [-p, -p, -p, 0.0, 0.0, 0.0]);
        }
        for _ in 0..20 {
            let size = 10f64.powf(random.between(-5.0, -1.5));
            // A mean compression, for the points would all open otherwise; every fourth step has equal principal strains.
            let strains: Vec<[f64; 6]> = (0..16)
                .map(|k| {
                    let mut strain = random.symmetric(size);
                    let mean = random.between(-1.0, 0.7) * size;
                    (0..3).for_each(|c| strain[c] += mean);
                    match k % 4 {
                        0 => [strain[0], strain[0], strain[2], 0.0, 0.0, 0.0],
                        _ => strain,
                    }
                })
                .collect();
            for k in 0..16 {
                d.set_strain_increment(k, strains[k]);
            }
            d.update(1.0).unwrap();
            for k in 0..16 {
                assert_eq!(d.status_of(k), LAHAR_POINT_OK);
                if d.state0(k, 1) != 0.0 {
                    continue;
                }
                let checked = check(&soil, &d, k, strains[k], 0.0)
                    .unwrap_or_else(|text| panic!("soil {n}, point {k}: {text}"));
                worst = worst.max(checked.residual);
                *seen.entry(checked.active).or_default() += 1;
                refuted += usize::from(check(&soil, &d, k, strains[k], 0.05).is_err());
            }
            d.commit();
        }
    }
    // Planes, edges and vertices of shear, of tension and of both, with names such as `02 12 ` for an edge.
    for active in [
        "elastic",
        "02 ",
        "02 12 ",
        "01 02 ",
        "t0 ",
        "t0 t1 ",
        "t0 02 ",
        "t0 01 02 ",
        "t0 t1 02 12 ",
        "t0 t1 t2 ",
    ] {
        assert!(seen.get(active).is_some_and(|n| *n >= 10), "{active}: {seen:?}");
    }
    assert!(worst <= 1e-9, "{worst}");
    // Negative control: flow with another dilation angle is refused wherever the shear planes are active alone.
    let alone: usize = ["02 ", "02 12 ", "01 02 "].iter().map(|active| seen[*active]).sum();
    assert!(refuted >= alone, "{refuted} of {alone}");
}

/// Largest difference between the tangent and central differences over E, and whether there is a kink.
fn tangent_error(d: &mut Driver, k: usize, strain: [f64; 6]) -> (f64, bool) {
    let size = strain.iter().fold(1e-5_f64, |size, e| size.max(e.abs()));
    let found = d.compare_tangent(k, strain, 1e-5 * size, 1.0).unwrap();
    (found.error() / E, found.bend() > 1e-3 * E)
}

#[test]
fn tangents_are_those_of_differences_on_planes_edges_and_vertices() {
    let mut random = Random::new(5);
    let mut seen = BTreeMap::<String, usize>::new();
    let (mut smooth, mut kinks, mut opened) = (0, 0, 0);
    for _ in 0..200 {
        let soil = Soil::random(&mut random);
        let mut d = soil.driver(1);
        let p = random.between(0.0, 100e3);
        d.set_stress(0, [-p, -p, -p, 0.0, 0.0, 0.0]);
        for _ in 0..12 {
            let size = 10f64.powf(random.between(-4.0, -2.0));
            let mut strain = random.symmetric(size);
            let mean = random.between(-1.0, 0.8) * size;
            (0..3).for_each(|c| strain[c] += mean);
            // Every fourth point starts open: the tangent is that of what remains after closing, or zero.
            if random.between(0.0, 1.0) < 0.25 {
                d.set_state(0, 1, random.between(0.0, 2.0) * size);
            }
            let (error, kink) = tangent_error(&mut d, 0, strain);
            if kink {
                kinks += 1;
            } else {
                smooth += 1;
                assert!(error < 1e-5, "{error} {strain:?} from {:?}", d.stress0(0));
            }
            if d.state0(0, 1) == 0.0 {
                *seen.entry(check(&soil, &d, 0, strain, 0.0).unwrap().active).or_default() += 1;
            } else {
                opened += 1;
            }
            d.commit();
        }
    }
    assert!(seen.len() >= 9 && seen.contains_key("t0 t1 t2 ") && opened > 300, "{seen:?} {opened}");
    assert!(kinks * 20 < smooth, "{kinks} kinks, {smooth} smooth");
}

#[test]
fn the_tangent_of_a_shear_plane_is_not_the_elastic_one() {
    // Negative control of the test above: an elastic tangent and one without the turning of axes
    // are found to be wrong.
    let mut d = driver(&[("dilation_angle", 10.0)], 1);
    d.set_stress(0, [-1e5, -1e5, -1e5, 0.0, 0.0, 0.0]);
    let strain = [2e-2, -1e-2, 0.0, 1e-2, 5e-3, 0.0];
    let (error, kink) = tangent_error(&mut d, 0, strain);
    assert!(error < 1e-5 && !kink, "{error}");
    d.set_strain_increment(0, strain);
    let tangent = d.tangent(0, 1.0).unwrap();
    let elastic = lahar_plugin::elastic::stiffness(lahar_plugin::elastic::lame(E, NU).unwrap());
    let gap = (0..36).map(|n| (tangent[n / 6][n % 6] - elastic[n / 6][n % 6]).abs());
    assert!(gap.fold(0.0, f64::max) > 0.1 * E);
}
