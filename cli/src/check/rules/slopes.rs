//! Derivatives: tangent, wave speed, stored energy.

use crate::check::probe::{DT, Lcg, Outcome, Probe, distance, size};
use crate::check::report::Verdict;
use crate::point::{Given, Point, growth, work};
use lahar::tensor::{Mat3, symmetric};
use lahar_plugin_abi::LAHAR_OUTPUT_DIFFUSIVITY;
use nalgebra::{SymmetricEigen, Vector3};

/// Strain of a difference [-]: its square is small beside any yield strain, and round-off of the
/// stress beside its product with a stiffness.
const H: f64 = 1e-7;

fn unit(j: usize, h: f64) -> [f64; 6] {
    std::array::from_fn(|c| if c == j { h } else { 0.0 })
}

/// Column `j` of the derivative from both sides; None if a step fails.
fn sides(probe: &Probe<'_>, given: &Given, j: usize) -> Outcome<Option<[[f64; 6]; 2]>> {
    let at = |h: f64| -> Outcome<Option<[f64; 6]>> {
        let got = probe.one(&given.strained(probe.model, &unit(j, h)))?;
        Ok(got.is_done().then_some(got.stress))
    };
    let (Some(minus), Some(middle), Some(plus)) = (at(-H)?, at(0.0)?, at(H)?) else {
        return Ok(None);
    };
    let slope = |a: &[f64; 6], b: &[f64; 6]| std::array::from_fn(|i| (b[i] - a[i]) / H);
    Ok(Some([slope(&minus, &middle), slope(&middle, &plus)]))
}

/// Compares the tangent with central differences, and skips points where the stress has a kink.
pub fn tangent(probe: &Probe<'_>) -> Outcome {
    if !probe.model.offers_tangent() {
        return Ok(Verdict::Skipped("not offered".into()));
    }
    let (mut compared, mut kinks) = (0, 0);
    let mut lcg = Lcg::new(8);
    for steps in [0, 4, 20] {
        for point in probe.loaded(9, 3e-4, steps)? {
            for scale in [1e-6, 1e-4, 1e-3] {
                let given = point.given(probe.model, &probe.gradient(&mut lcg, scale / DT), DT);
                let Some(tangent) = probe.tangent(&given)? else { continue };
                let largest = size(tangent.as_flattened());
                for j in (0..6).filter(|j| !probe.plane() || PLANE.contains(j)) {
                    let Some([left, right]) = sides(probe, &given, j)? else { continue };
                    let noise = 1e-13 * size(&point.stress) / H;
                    let scale = largest.max(size(&left)).max(size(&right)) + noise;
                    if distance(&left, &right) > 1e-3 * scale {
                        kinks += 1;
                        continue;
                    }
                    compared += 1;
                    for i in 0..6 {
                        let expected = 0.5 * (left[i] + right[i]);
                        if !((tangent[i][j] - expected).abs() <= 1e-3 * scale) {
                            let text = format!(
                                "the tangent says d stress {} / d strain {} = {:e} Pa, differences of `update` say {expected:e} Pa \
                                 (a shear strain stands for both of its places)",
                                NAMES[i], NAMES[j], tangent[i][j]
                            );
                            return Err(probe.failed(text, &given));
                        }
                    }
                }
            }
        }
    }
    match compared {
        0 => Ok(Verdict::Skipped(format!("no point without a kink among {kinks}"))),
        _ => Ok(Verdict::Ok(format!("{compared} columns compared, {kinks} at kinks left out"))),
    }
}

const NAMES: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "zx"];
/// Strains of plane motions.
const PLANE: [usize; 3] = [0, 1, 3];

/// Compares what `wave_speed` and `update` say with each other and with the response to small
/// strains: ρ c² is the largest eigenvalue of the acoustic tensor n.C.n. Of a fluid, whose shear
/// stress is no stiffness, with the bulk modulus.
pub fn wave_speed(probe: &Probe<'_>) -> Outcome {
    let mut slowest = f64::INFINITY;
    for steps in [0, 12] {
        for point in probe.loaded(13, 1e-5, steps)? {
            let given = point.at_rest(probe.model);
            let queried = probe
                .try_wave_speed(&given)
                .map_err(|e| probe.failed(e.to_string(), &given))?
                .wave_speed;
            let got = probe.one(&given)?;
            if !got.is_done() {
                continue;
            }
            for (name, speed) in [("wave_speed", queried), ("update", got.wave_speed)] {
                if !(speed > 0.0 && speed.is_finite()) {
                    let text = format!("`{name}` gives the wave speed {speed:?} m/s");
                    return Err(probe.failed(text, &given));
                }
            }
            if !(0.5..=2.0).contains(&(queried / got.wave_speed)) {
                let text = format!(
                    "`wave_speed` gives {queried:?} m/s and `update` {:?} m/s at the same point",
                    got.wave_speed
                );
                return Err(probe.failed(text, &given));
            }
            let Some((stiffness, how)) = largest_stiffness(probe, &point)? else { continue };
            let speed = (stiffness / point.density).sqrt();
            let declared = queried.min(got.wave_speed);
            if declared < 0.99 * speed {
                let text = format!(
                    "the wave speed is {declared:.6e} m/s, but {how} carries waves of {speed:.6e} m/s; time steps would be too \
                     large by {:.0} %",
                    100.0 * (speed / declared - 1.0)
                );
                return Err(probe.failed(text, &given));
            }
            slowest = slowest.min(declared / speed);
        }
    }
    match slowest.is_finite() {
        true => Ok(Verdict::Ok(format!("at least {slowest:.4} of what small strains carry"))),
        false => Ok(Verdict::Skipped("no small strain has a linear response".into())),
    }
}

/// The largest stiffness that waves of any direction meet [Pa], and the strain that shows it.
fn largest_stiffness(probe: &Probe<'_>, point: &Point) -> Outcome<Option<(f64, String)>> {
    let fluid = probe.model.gives(LAHAR_OUTPUT_DIFFUSIVITY);
    // A fluid has a long step, in which what is viscous dies out.
    let given = point.given(probe.model, &Mat3::zeros(), if fluid { 1e3 } else { DT });
    let mut best: Option<(f64, String)> = None;
    let mut consider = |stiffness: f64, how: String| {
        if stiffness > best.as_ref().map_or(0.0, |b| b.0) {
            best = Some((stiffness, how));
        }
    };
    for h in [H, -H] {
        let sign = if h > 0.0 { "extension" } else { "compression" };
        let axes = if probe.plane() { 2 } else { 3 };
        let even = probe.in_plane(Mat3::identity()) / f64::from(axes);
        if let Some(change) = response(probe, &given, &even, h)? {
            let mean = probe.in_plane(change).trace() / f64::from(axes);
            consider(mean, format!("a small isotropic {sign}"));
        }
        if fluid {
            continue;
        }
        for n in directions().into_iter().filter(|n| !probe.plane() || n.z == 0.0) {
            let shape = |m: &Vector3<f64>| 0.5 * (m * n.transpose() + n * m.transpose());
            let mut acoustic = Mat3::zeros();
            let mut linear = true;
            for m in 0..axes as usize {
                match response(probe, &given, &shape(&Vector3::ith(m, 1.0)), h)? {
                    Some(change) => acoustic.set_column(m, &(probe.in_plane(change) * n)),
                    None => linear = false,
                }
            }
            if !linear {
                continue;
            }
            // At a corner of a yield surface the response to a sum is not the sum of responses: ask
            // for that of the fastest wave itself.
            let waves = SymmetricEigen::new(0.5 * (acoustic + acoustic.transpose()));
            let m = waves.eigenvectors.column(waves.eigenvalues.imax()).into_owned();
            for m in [m, -m] {
                if let Some(change) = response(probe, &given, &shape(&m), h)? {
                    let along = [n, m].map(|v| [v.x, v.y, v.z].map(|x| (1e3 * x).round() / 1e3));
                    let how =
                        format!("a small strain along {:?} that moves {:?}", along[0], along[1]);
                    consider(m.dot(&(change * n)), how);
                }
            }
        }
    }
    Ok(best)
}

/// Change of stress per strain of this shape [Pa]; None if it fails or depends on the size of the
/// strain.
fn response(probe: &Probe<'_>, given: &Given, shape: &Mat3, h: f64) -> Outcome<Option<Mat3>> {
    let at = |h: f64| -> Outcome<Option<Mat3>> {
        let strain = lahar::tensor::symmetric_part(&(shape * h));
        let got = probe.one(&given.strained(probe.model, &strain))?;
        Ok((got.is_done() && got.is_finite()).then(|| symmetric(got.stress)))
    };
    let (Some(zero), Some(half), Some(whole)) = (at(0.0)?, at(0.5 * h)?, at(h)?) else {
        return Ok(None);
    };
    let (half, whole) = ((half - zero) / (0.5 * h), (whole - zero) / h);
    Ok(((half - whole).amax() <= 0.02 * whole.amax()).then_some(whole))
}

fn directions() -> Vec<Vector3<f64>> {
    let mut all = vec![Vector3::x(), Vector3::y(), Vector3::z()];
    for (x, y, z) in
        [(1.0, 1.0, 0.0), (1.0, 0.0, -1.0), (0.0, 1.0, 1.0), (1.0, 1.0, 1.0), (1.0, -2.0, 0.5)]
    {
        all.push(Vector3::new(x, y, z).normalize());
    }
    all
}

/// Small cycles of strain: if the stress returns to its start, the work of the loading half must be
/// in the stored energy.
pub fn stored_energy(probe: &Probe<'_>) -> Outcome {
    if !probe.model.offers_stored_energy() {
        return Ok(Verdict::Skipped("not offered".into()));
    }
    let mut lcg = Lcg::new(17);
    let (mut closed, mut open) = (0, 0);
    for start in probe.starts()? {
        let modulus = probe.modulus(&start.point)?;
        if size(&start.point.stress) > 1e-3 * modulus {
            continue; // a law in rates stores per current volume only up to the strain that is there already
        }
        for _ in 0..6 {
            let l = probe.gradient(&mut lcg, 1e-5 / DT);
            let Some((out, turn)) = path(probe, &start.point, &l, 10)? else { continue };
            let Some((_, back)) = path(probe, &turn, &-l, 10)? else { continue };
            let elastic = distance(&back.stress, &start.point.stress) <= 1e-3 * modulus * 1e-4
                && distance(&back.state, &start.point.state)
                    <= 1e-3 * 1e-4 * (1.0 + size(&back.state));
            if !elastic {
                open += 1;
                continue;
            }
            closed += 1;
            let given = turn.at_rest(probe.model);
            let energy = |point: &Point| -> Outcome<f64> {
                let stored = probe.stored_energy(&point.at_rest(probe.model))?.unwrap_or(f64::NAN);
                Ok(stored * start.point.density / point.density)
            };
            let stored = energy(&turn)? - energy(&start.point)?;
            // The strain is 1e-4: the energy of a stiffness, and what a stress at the start adds to
            // it.
            let scale = out.abs() + modulus * 1e-8;
            if !((stored - out).abs() <= 0.01 * scale) {
                let text = format!(
                    "on an elastic path the stress does the work {out:e} J/m^3 and the stored energy grows by {stored:e} J/m^3"
                );
                return Err(probe.failed(text, &given));
            }
        }
    }
    match closed {
        0 => Ok(Verdict::Skipped(format!("none of {open} cycles is elastic"))),
        _ => Ok(Verdict::Ok(format!("{closed} elastic cycles"))),
    }
}

/// Steps along `l`: the work per volume at the start [J/m^3] and the point at the end; None if a
/// step fails.
fn path(probe: &Probe<'_>, start: &Point, l: &Mat3, steps: usize) -> Outcome<Option<(f64, Point)>> {
    let (mut point, mut done) = (start.clone(), 0.0);
    for _ in 0..steps {
        let given = point.given(probe.model, l, DT);
        let got = probe.one(&given)?;
        if !got.is_done() || !got.is_finite() {
            return Ok(None);
        }
        let volume = start.density / point.density * (1.0 + growth(probe.model, l, DT)) / 2.0;
        done += volume * work(&point.stress, &got.stress, &given.strain);
        point = point.moved(probe.model, l, &given, &got);
    }
    Ok(Some((done, point)))
}
