//! A dam breaks: the front and the height of the water against an experiment.

use lahar::boundary::WallKind;
use lahar::error::Result;
use lahar::world::World;
use serde::Deserialize;

use crate::judge::slope;
use crate::run::Outcome;
use crate::world::{Cloud, Method, material, read, wall};

/// Water of width a = 0.05715 m and height H = 2 a, computed with its mirror image; sound at ten times √(2 g H).
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setup {
    method: Method,
    /// Cells along the height, a multiple of 2.
    cells: usize,
    /// Viscosity [Pa s].
    viscosity: f64,
}

/// Lines `front,T,Z` and `height,τ,y/H` with T = t √(2 g / a), Z = x / a and τ = t √(g / a).
const EXPERIMENT: &str = include_str!("../../../data/martin_moyce_1952.csv");
const GRAVITY: f64 = 9.81;
const DENSITY: f64 = 1000.0;
const WIDTH: f64 = 0.05715;
/// The front is compared in this range of T, its slope from the third number on; the run ends at the last.
const TIMES: [f64; 4] = [0.84, 3.33, 1.83, 3.83];

/// Gives `front_relative_rms`, `front_shift` (of T, that suits the front best), `front_rms_after_shift` (of Z), `front_slope`
/// (dZ/dT), `height_worst_error` (of y / H), `volume_worst_drift`, and the curves `front`, `front_measured`, `height`,
/// `height_measured`.
pub fn run(setup: &Setup) -> Result<Outcome> {
    let (mut world, body) = dam(setup)?;
    let start: f64 = read(&world, body, "volume")?.iter().sum();
    let clock = (2.0 * GRAVITY / WIDTH).sqrt();
    let end = TIMES[3] / clock;
    let (mut front, mut height, mut drift) = (Vec::new(), Vec::new(), 0.0_f64);
    loop {
        let now = look(&world, body)?;
        let t = world.time() * clock;
        front.push([t, now.front / WIDTH]);
        height.push([t / 2.0_f64.sqrt(), now.height / (2.0 * WIDTH)]);
        if t <= TIMES[1] {
            drift = drift.max((now.volume / start - 1.0).abs());
        }
        if world.time() >= end {
            break;
        }
        world.advance(end, 1).1?;
    }
    let mut out = Outcome::new();
    let height_marks = marks("height");
    judge_front(&mut out, &front);
    let late = |mark: &&[f64; 2]| mark[0] <= TIMES[3] / 2.0_f64.sqrt();
    let error = |mark: &[f64; 2]| (at(&height, mark[0]) - mark[1]).abs();
    out.set("height_worst_error", height_marks.iter().filter(late).map(error).fold(0.0, f64::max));
    out.set("volume_worst_drift", drift);
    out.curve("front", front);
    out.curve("front_measured", marks("front"));
    out.curve("height", height);
    out.curve("height_measured", height_marks);
    Ok(out)
}

/// What was measured of the front or the height: times and values.
fn marks(kind: &str) -> Vec<[f64; 2]> {
    let numbers = |line: &str| {
        let (time, value) = line.strip_prefix(kind)?.strip_prefix(',')?.split_once(',')?;
        Some([time.trim().parse().ok()?, value.trim().parse().ok()?])
    };
    EXPERIMENT.lines().filter_map(numbers).collect()
}

fn judge_front(out: &mut Outcome, front: &[[f64; 2]]) {
    let marks = marks("front");
    let within =
        |first: f64| marks.iter().filter(move |mark| (first..=TIMES[1]).contains(&mark[0]));
    let rms = |shift: f64, relative: bool| {
        let square = |mark: &[f64; 2]| {
            let error = at(front, mark[0] - shift) - mark[1];
            (error / if relative { mark[1] } else { 1.0 }).powi(2)
        };
        let count = within(TIMES[0]).count() as f64;
        (within(TIMES[0]).map(square).sum::<f64>() / count).sqrt()
    };
    let shifts = (-500..=500).map(|k| 0.001 * f64::from(k));
    let best = shifts.map(|shift| (rms(shift, false), shift)).min_by(|a, b| a.0.total_cmp(&b.0));
    let (error, shift) = best.unwrap_or((f64::NAN, f64::NAN));
    let steady: Vec<[f64; 2]> =
        within(TIMES[2]).map(|mark| [mark[0], at(front, mark[0])]).collect();
    out.set("front_relative_rms", rms(0.0, true));
    out.set("front_shift", shift);
    out.set("front_rms_after_shift", error);
    out.set("front_slope", slope(&steady));
}

/// Water and its mirror image at rest on a floor that lets it slide. A wall in the middle would hold a strip of half a cell back.
fn dam(setup: &Setup) -> Result<(World, i64)> {
    let bulk = DENSITY * 100.0 * 2.0 * GRAVITY * 2.0 * WIDTH;
    let values = [
        ("bulk_modulus", bulk),
        ("viscosity", setup.viscosity),
        ("equation_of_state", 1.0),
        ("zero_tension", 1.0),
    ];
    let (context, water) = material("newtonian", &values)?;
    let h = 2.0 * WIDTH / setup.cells as f64;
    let mut options = setup.method.options(h);
    options.gravity = [0.0, -GRAVITY, 0.0];
    let mut world = World::new(&context, &options)?;
    wall(&mut world, WallKind::Slip, 1, 1, 0.0)?;
    let pressure = |y: f64| DENSITY * GRAVITY * (2.0 * WIDTH - y);
    let count = [2 * setup.cells; 2];
    let cloud = Cloud::fluid_at_rest([-WIDTH, 0.0], count, 0.5 * h, (DENSITY, bulk), pressure);
    let body = cloud.add(&mut world, &water)?;
    Ok((world, body))
}

struct Look {
    front: f64,
    height: f64,
    volume: f64,
}

/// The height at the wall is the volume of water nearer to it than a / 5, over this width. Where the water was pulled apart its
/// volume ratio exceeds 1; the rest of its volume is a void.
fn look(world: &World, body: i64) -> Result<Look> {
    let x = world.field_data(body, "position")?;
    let (volume, ratio) =
        (world.field_data(body, "volume")?, world.field_data(body, "volume_ratio")?);
    let mut look = Look { front: 0.0, height: 0.0, volume: 0.0 };
    for k in 0..volume.count {
        let (x, volume, ratio) = (x.data[k], volume.data[k], ratio.data[k]);
        look.front = look.front.max(x);
        look.volume += volume;
        if x.abs() < 0.2 * WIDTH {
            look.height += 0.5 * volume / ratio.max(1.0) / (0.2 * WIDTH);
        }
    }
    Ok(look)
}

/// Value of a curve at an abscissa; its ends reach on.
fn at(curve: &[[f64; 2]], x: f64) -> f64 {
    let after = curve.partition_point(|point| point[0] <= x);
    match (after.checked_sub(1).map(|k| curve[k]), curve.get(after)) {
        (None, Some(first)) => first[1],
        (Some(last), None) => last[1],
        (Some(a), Some(b)) => a[1] + (b[1] - a[1]) * (x - a[0]) / (b[0] - a[0]),
        (None, None) => f64::NAN,
    }
}
