//! A model under test: calls that are reported to the parent before they are made, starts, and
//! paths through strain space.

use super::report::{Event, Report, Verdict};
use crate::info::number;
use crate::plugin::{Library, Values};
use crate::point::{Given, Got, Point, Points};
use lahar::error::{Error, Status};
use lahar::material::{Input, Kinematics, Material, Model};
use lahar::tensor::Mat3;
use std::cell::OnceCell;
use std::sync::Arc;

/// What ends a rule early: it is broken, or it cannot be run.
pub type Outcome<T = Verdict> = Result<T, Verdict>;

/// Length of a step unless a rule needs another [s].
pub const DT: f64 = 1e-3;
/// Mass density of the points [kg/m^3].
pub const DENSITY: f64 = 1000.0;
/// Isotropic pressures of the starts that are tried [Pa].
const PRESSURES: [f64; 4] = [0.0, 1e3, 1e5, 1e6];
/// Specific internal energy of a start, that of air [J/kg].
const ENERGY: f64 = 2e5;

/// A model under test.
pub struct Probe<'a> {
    pub library: &'a Library,
    pub report: &'a Report,
    pub model: &'static Model,
    pub values: Values,
    pub material: Arc<Material>,
    starts: OnceCell<Starts>,
    plane: OnceCell<bool>,
}

/// What came of the starts that were tried.
#[derive(Default)]
pub struct Starts {
    /// Those from which the model goes on.
    pub good: Vec<Start>,
    /// Others, and why they are none.
    pub reasons: Vec<(String, String)>,
    /// A breach of the contract that the engine found in these calls.
    pub breach: Option<Verdict>,
}

/// A point from which a model can go on.
#[derive(Clone)]
pub struct Start {
    pub name: String,
    pub point: Point,
}

impl<'a> Probe<'a> {
    pub fn new(
        library: &'a Library,
        report: &'a Report,
        model: &'static Model,
        values: Values,
    ) -> Outcome<Self> {
        report.send(&Event::At { call: format!("create with {}", show(&values)) });
        let material = library.material(model, &values).map_err(|e| Verdict::Failed {
            sentence: format!("the model refuses its own default and typical values: {e}"),
            input: Some(show(&values)),
        })?;
        let (starts, plane) = Default::default();
        Ok(Self { library, report, model, values, material, starts, plane })
    }

    /// Reports the next call to the parent, in case that it does not return.
    pub fn at(&self, call: impl FnOnce() -> String) {
        self.report.send(&Event::At { call: call() });
    }

    fn announce(&self, call: &str, given: &[Given]) {
        let first = given.first().map(|g| g.describe(self.model)).unwrap_or_default();
        let more = match given.len() {
            1 => String::new(),
            n => format!(" (the first of {n} points)"),
        };
        self.at(|| format!("{call}: {first}{more}"));
    }

    /// An update that may be refused.
    pub fn try_update(&self, material: &Arc<Material>, given: &[Given]) -> Result<Vec<Got>, Error> {
        self.announce("update", given);
        let mut points = Points::new(self.model, given);
        points.update(material)?;
        Ok((0..given.len()).map(|k| points.got(k)).collect())
    }

    /// An update of sane points.
    pub fn update(&self, given: &[Given]) -> Outcome<Vec<Got>> {
        self.try_update(&self.material, given).map_err(|e| self.broken(&e, &given[0]))
    }

    /// An update of one sane point.
    pub fn one(&self, given: &Given) -> Outcome<Got> {
        Ok(self.update(std::slice::from_ref(given))?.remove(0))
    }

    pub fn try_wave_speed(&self, given: &Given) -> Result<Got, Error> {
        self.announce("wave_speed", std::slice::from_ref(given));
        let mut points = Points::new(self.model, std::slice::from_ref(given));
        points.wave_speed(&self.material)?;
        Ok(points.got(0))
    }

    pub fn try_init_state(&self, given: &Given) -> Result<Got, Error> {
        self.announce("init_state", std::slice::from_ref(given));
        let mut points = Points::new(self.model, std::slice::from_ref(given));
        points.init_state(&self.material)?;
        Ok(points.got(0))
    }

    /// The tangent of a step, if the model offers it.
    pub fn tangent(&self, given: &Given) -> Outcome<Option<[[f64; 6]; 6]>> {
        self.announce("tangent", std::slice::from_ref(given));
        let mut points = Points::new(self.model, std::slice::from_ref(given));
        match points.tangent(&self.material) {
            None => Ok(None),
            Some(Err(e)) => Err(self.broken(&e, given)),
            Some(Ok(())) => {
                Ok(Some(std::array::from_fn(|i| std::array::from_fn(|j| points.own(6 * i + j, 0)))))
            }
        }
    }

    /// Stored energy per volume at the start of the step, if the model offers it.
    pub fn stored_energy(&self, given: &Given) -> Outcome<Option<f64>> {
        self.announce("stored_energy", std::slice::from_ref(given));
        let mut points = Points::new(self.model, std::slice::from_ref(given));
        match points.stored_energy(&self.material) {
            None => Ok(None),
            Some(Err(e)) => Err(self.broken(&e, given)),
            Some(Ok(())) => Ok(Some(points.own(0, 0))),
        }
    }

    fn broken(&self, error: &Error, given: &Given) -> Verdict {
        self.failed(error.to_string(), given)
    }

    /// A broken rule with the input that shows it.
    pub fn failed(&self, sentence: impl Into<String>, given: &Given) -> Verdict {
        Verdict::Failed {
            sentence: sentence.into(),
            input: Some(format!("{}; {}", given.describe(self.model), show(&self.values))),
        }
    }

    /// The points at rest from which the model goes on, at least one. A model need not bear every
    /// start: a gas has no pressure without energy, a clay no stiffness without pressure.
    pub fn starts(&self) -> Outcome<Vec<Start>> {
        let starts = self.tried_starts();
        match (&starts.breach, starts.good.is_empty()) {
            (Some(breach), _) => Err(breach.clone()),
            (None, true) => {
                Err(Verdict::Skipped("there is no start, see the rule `starts`".into()))
            }
            (None, false) => Ok(starts.good.clone()),
        }
    }

    /// All that were tried.
    pub fn tried_starts(&self) -> &Starts {
        self.starts.get_or_init(|| self.find_starts())
    }

    fn find_starts(&self) -> Starts {
        let energy = if self.model.input(Input::InternalEnergy).is_some() { ENERGY } else { 0.0 };
        let mut starts = Starts::default();
        for pressure in PRESSURES {
            let name = format!("at the pressure {} Pa", number(pressure));
            let mut point = Point::new(self.model, pressure, DENSITY, energy);
            if self.model.kinematics == Kinematics::DeformationGradient && pressure > 0.0 {
                // The stress follows from F: a small compression instead.
                point = Point::new(self.model, 0.0, DENSITY, energy);
                point.deformation *= 1.0 - 1e-9 * pressure;
            }
            match self.settled(point) {
                Ok(point) => starts.good.push(Start { name, point }),
                Err(NoStart::Because(why)) => starts.reasons.push((name, why)),
                Err(NoStart::Breach(verdict)) => starts.breach = starts.breach.or(Some(verdict)),
            }
        }
        starts
    }

    /// The point with the first state that the model derives, after a step at rest.
    fn settled(&self, mut point: Point) -> Result<Point, NoStart> {
        let given = point.at_rest(self.model);
        let why = |e: Error| match e.status {
            Status::PluginBroken => NoStart::Breach(self.broken(&e, &given)),
            _ => NoStart::Because(e.to_string()),
        };
        point.state = self.try_init_state(&given).map_err(why)?.state;
        let given = point.at_rest(self.model);
        let got = self.try_update(&self.material, std::slice::from_ref(&given)).map_err(why)?;
        let got = &got[0];
        if !got.is_done() || !got.is_finite() {
            let text = format!("a step at rest gives status {} and {:?}", got.status, got.stress);
            return Err(NoStart::Because(text));
        }
        let speed = self.try_wave_speed(&given).map_err(why)?.wave_speed;
        for (name, speed) in [("wave_speed", speed), ("update", got.wave_speed)] {
            if !(speed > 0.0 && speed.is_finite()) {
                let text = format!("`{name}` gives the wave speed {speed:?} m/s");
                return Err(NoStart::Because(text));
            }
        }
        Ok(point.moved(self.model, &Mat3::zeros(), &given, got))
    }

    /// Whether the model refuses what shears out of the plane of x and y and takes what does not:
    /// it is then tried with plane motions.
    pub fn plane(&self) -> bool {
        *self.plane.get_or_init(|| {
            let Some(start) = self.tried_starts().good.first() else { return false };
            let l = Mat3::new(0.5, 0.2, 0.1, 0.1, -0.4, -0.2, 0.2, 0.3, -0.2) * (1e-6 / DT);
            let takes = |l: &Mat3| {
                let given = start.point.given(self.model, l, DT);
                let got = self.try_update(&self.material, std::slice::from_ref(&given));
                got.is_ok_and(|got| got[0].is_done())
            };
            !takes(&l) && takes(&planar(l))
        })
    }

    /// The part of a velocity gradient, strain or change of stress that the model can be tried
    /// with.
    pub fn in_plane(&self, l: Mat3) -> Mat3 {
        if self.plane() { planar(l) } else { l }
    }

    /// A random velocity gradient [1/s] that the model can be tried with.
    pub fn gradient(&self, lcg: &mut Lcg, rate: f64) -> Mat3 {
        self.in_plane(lcg.gradient(rate))
    }

    /// Points of every start after some random steps of that size [-]; where a step fails, the path
    /// ends before it.
    pub fn loaded(&self, seed: u64, scale: f64, steps: usize) -> Outcome<Vec<Point>> {
        let mut lcg = Lcg::new(seed);
        let mut points = Vec::new();
        for Start { mut point, .. } in self.starts()? {
            let mut l = self.gradient(&mut lcg, scale / DT);
            for step in 0..steps {
                if step % 6 == 5 {
                    l = self.gradient(&mut lcg, scale / DT);
                }
                let given = point.given(self.model, &l, DT);
                let got = self.one(&given)?;
                if !got.is_done() || !got.is_finite() {
                    break;
                }
                point = point.moved(self.model, &l, &given, &got);
            }
            points.push(point);
        }
        Ok(points)
    }

    /// ρ c² of a point [Pa]: the scale of stress changes.
    pub fn modulus(&self, point: &Point) -> Outcome<f64> {
        let given = point.at_rest(self.model);
        let got = self.try_wave_speed(&given).map_err(|e| self.broken(&e, &given))?;
        Ok(point.density * got.wave_speed.powi(2))
    }
}

/// Without what leads out of the plane of x and y.
fn planar(l: Mat3) -> Mat3 {
    Mat3::from_fn(|a, b| if a == 2 || b == 2 { 0.0 } else { l[(a, b)] })
}

/// Why a model does not go on from a point.
enum NoStart {
    Because(String),
    Breach(Verdict),
}

/// `youngs_modulus = 1e7, ...`
pub fn show(values: &Values) -> String {
    let each: Vec<String> =
        values.iter().map(|(key, value)| format!("{key} = {}", number(*value))).collect();
    match each.is_empty() {
        true => "no parameters".into(),
        false => each.join(", "),
    }
}

/// Largest component by magnitude.
pub fn size(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m, v| m.max(v.abs()))
}

/// Largest difference; infinity if one is not a number.
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    let largest = |m: f64, (a, b): (&f64, &f64)| match (a - b).abs() {
        d if d.is_nan() => f64::INFINITY,
        d => m.max(d),
    };
    a.iter().zip(b).fold(0.0, largest)
}

/// The same pseudo-random numbers on every machine: D. E. Knuth's linear congruence (MMIX).
pub struct Lcg(u64);

impl Lcg {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// From -1 to 1.
    pub fn number(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// A velocity gradient [1/s] with components up to `rate`, little of it volumetric.
    pub fn gradient(&mut self, rate: f64) -> Mat3 {
        let l = Mat3::from_fn(|_, _| rate * self.number());
        l - Mat3::identity() * (0.3 * l.trace())
    }
}
