//! Any consistent units do: every model gives the same dimensionless results in all of them, with
//! every value left out that has a default.

use std::sync::Arc;

use lahar::boundary::{BoxRegion, PrescribedVelocity, Table};
use lahar::context::Context;
use lahar::error::Result;
use lahar::material::{Input, Kinematics, Material, Model, Parameter, ParameterKind};
use lahar::shape::ShapeKind;
use lahar::transfer::TransferKind;
use lahar::world::World;
use lahar::world::host_arrays::{ParticleArrays, Strided};
use lahar::world::options::Options;

use crate::setup::{context_of, read, world, write};
use crate::support::shipped;

/// A consistent system of units: how many of its units 1 kg, 1 m and 1 s are.
struct System {
    name: &'static str,
    kg: f64,
    m: f64,
    s: f64,
}

const SI: System = System { name: "Pa, kg, m, s", kg: 1.0, m: 1.0, s: 1.0 };
const OTHERS: [System; 3] = [
    System { name: "kPa, Mg, m, s", kg: 1e-3, m: 1.0, s: 1.0 },
    System { name: "MPa, Mg, mm, s", kg: 1e-3, m: 1e3, s: 1.0 },
    System { name: "MPa, g, mm, ms", kg: 1e3, m: 1e3, s: 1e3 },
];

impl System {
    /// How many of its units an SI unit is; an exponent that is a letter is a parameter with that
    /// symbol.
    fn scale(&self, unit: &str, symbol: &dyn Fn(&str) -> f64) -> f64 {
        let newton = self.kg * self.m / (self.s * self.s);
        let factor = |text: &str| {
            let end = text.find(['^', '2', '3']).unwrap_or(text.len());
            let (base, power) = (&text[..end], text[end..].trim_start_matches('^'));
            let value = match base {
                "-" | "1" | "deg" | "K" => 1.0,
                "kg" => self.kg,
                "m" => self.m,
                "s" => self.s,
                "N" => newton,
                "Pa" => newton / (self.m * self.m),
                "J" => newton * self.m,
                _ => panic!("the unit `{unit}` is not known to this test: teach it"),
            };
            let power = match power {
                "" => 1.0,
                power => power.parse().unwrap_or_else(|_| symbol(power)),
            };
            f64::powf(value, power)
        };
        let product =
            |text: &str| -> f64 { text.trim_matches(['(', ')']).split(' ').map(factor).product() };
        match unit.split_once('/') {
            Some((above, below)) => product(above) / product(below),
            None => product(unit),
        }
    }

    /// The same for units without letters in exponents.
    fn of(&self, unit: &str) -> f64 {
        self.scale(unit, &|power| panic!("the unit `{unit}` has the exponent {power}"))
    }
}

fn has_dimension(p: &Parameter) -> bool {
    p.kind == ParameterKind::Real && !["-", "deg"].contains(&p.unit)
}

fn for_each_model(work: impl Fn(&Arc<Context>, &'static Model)) {
    for name in shipped() {
        let context = context_of(&name);
        context.models().into_iter().for_each(|model| work(&context, model));
    }
}

/// How many units of a system the unit of a parameter is.
fn scale(model: &Model, parameter: &Parameter, system: &System) -> f64 {
    system.scale(parameter.unit, &|symbol| {
        model.parameters.iter().find(|p| p.symbol == symbol).expect("a parameter").default
    })
}

/// Every required parameter at its typical value, in the units of a system; `kept` keeps its SI
/// number.
fn values(model: &Model, system: &System, kept: Option<&str>) -> Vec<(&'static str, f64)> {
    let required = model.parameters.iter().filter(|p| p.required);
    let scale = |p: &Parameter| if kept == Some(p.key) { 1.0 } else { scale(model, p, system) };
    required.map(|p| (p.key, p.default * scale(p))).collect()
}

/// Length of a step [s].
const DT: f64 = 1e-5;
/// Stress at the start of models that keep one, and of the gas [Pa].
const PRESSURE: f64 = 2.1e4;

/// The strain increments of the path, displacement gradients as rows: compression, shear,
/// unloading, tension, compression with shear the other way round, shear at another rate.
fn path() -> Vec<[[f64; 3]; 3]> {
    let diagonal = |x: f64, y: f64, z: f64| [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]];
    let shear = |g: f64, z: f64| [[0.0, g, 0.0], [0.3 * g, 0.0, 0.0], [0.0, 0.0, z]];
    [
        (20, diagonal(-1e-4, -1e-4, -1e-4)),
        (40, diagonal(1e-4, 5e-5, -4e-4)),
        (40, shear(1e-3, 0.0)),
        (20, shear(-5e-5, 1e-5)),
        (40, diagonal(4e-4, 2e-4, 1e-4)),
        (60, shear(-8e-4, -4e-4)),
        (20, shear(2e-3, 1e-5)),
    ]
    .into_iter()
    .flat_map(|(n, step)| std::iter::repeat_n(step, n))
    .collect()
}

/// A particle in the middle of a cell whose nodes are moved.
fn point(
    context: &Arc<Context>,
    model: &Model,
    u: &System,
    values: &[(&str, f64)],
) -> Result<World> {
    let gas = model.input(Input::InternalEnergy).is_some();
    let stressed = model.kinematics != Kinematics::DeformationGradient && !gas;
    let options = Options {
        dimension: 3,
        spacing: u.m,
        shape: ShapeKind::Linear,
        transfer: TransferKind::PicFlip,
        gravity: [0.0; 3],
        cfl: 1.0,
        ..Options::default()
    };
    let material = Material::new(context, model.name, values)?;
    let p = if stressed { -PRESSURE * u.of("Pa") } else { 0.0 };
    let mut world = world(context, &options);
    let (position, volume, stress) = ([0.5 * u.m; 3], [u.of("m3")], [p, p, p, 0.0, 0.0, 0.0]);
    let particle = ParticleArrays {
        position: Strided::interleaved(&position, 3).expect("a point"),
        volume: Strided::interleaved(&volume, 1).expect("a volume"),
        mass: None,
        density: (if gas { 1.2 } else { 1800.0 }) * u.of("kg/m3"),
        velocity: None,
        stress: Some(Strided::interleaved(&stress, 6).expect("a stress")),
        size: None,
    };
    world.add_particles(&material, &particle)?;
    if gas {
        write(&mut world, 0, "strain_energy", &[PRESSURE / 0.4 * u.of("J")]);
    }
    Ok(world)
}

/// One step in which the cell is deformed by a displacement gradient.
fn deform(world: &mut World, u: &System, gradient: &[[f64; 3]; 3]) -> Result<()> {
    let mut held = Vec::new();
    for corner in 0..8 {
        let place: [f64; 3] = std::array::from_fn(|a| f64::from(corner >> a & 1));
        let speed = |row: &[f64; 3]| -> f64 {
            (0..3).map(|b| row[b] * (place[b] - 0.5)).sum::<f64>() / DT * u.of("m/s")
        };
        let at = place.map(|x| x * u.m);
        let velocity = Table::constant([0, 1, 2].map(|a| speed(&gradient[a])));
        let region = BoxRegion { min: at, max: at };
        let condition = PrescribedVelocity { region, components: 7, velocity };
        held.push(world.add_prescribed_velocity(condition).expect("a good condition"));
    }
    world.step(Some(DT * u.s))?;
    held.into_iter().try_for_each(|id| world.remove_prescribed_velocity(id))
}

/// What a point goes through: for each quantity its name and its values along the path, in SI
/// units.
type Course = Vec<Quantity>;
type Quantity = (String, Vec<f64>);

fn course(context: &Arc<Context>, model: &Model, u: &System, kept: Option<&str>) -> Result<Course> {
    let mut world = point(context, model, u, &values(model, u, kept))?;
    let states = model.states.iter().map(|s| (s.key, s.unit));
    let fields: Vec<_> = [("stress", "Pa"), ("volume", "m3"), ("strain_energy", "J")]
        .into_iter()
        .chain(states)
        .collect();
    let names = fields.iter().map(|f| f.0).chain(["stable_dt"]);
    let mut course: Course = names.map(|name| (name.to_string(), Vec::new())).collect();
    for gradient in path() {
        deform(&mut world, u, &gradient)?;
        for ((_, list), (name, unit)) in course.iter_mut().zip(&fields) {
            list.extend(read(&world, 0, name).iter().map(|v| v / u.of(unit)));
        }
        let dt = world.stable_dt().expect("a wave speed") / u.s;
        course.last_mut().expect("the last").1.push(dt);
    }
    Ok(course)
}

/// The largest difference of two courses over the largest value of the quantity, and its name.
fn difference(a: &Course, b: &Course) -> (f64, String) {
    let of = |(a, b): (&Quantity, &Quantity)| {
        assert!(a.1.iter().all(|v| v.is_finite()), "{}", a.0);
        let largest = a.1.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        let most = a.1.iter().zip(&b.1).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
        (if most == 0.0 { 0.0 } else { most / largest }, a.0.clone())
    };
    a.iter().zip(b).map(of).max_by(|a, b| a.0.total_cmp(&b.0)).expect("quantities")
}

#[test]
fn every_model_gives_the_same_in_all_consistent_units_with_its_defaults_left_out() {
    for_each_model(|context, model| {
        let course = |system| {
            course(context, model, system, None)
                .unwrap_or_else(|e| panic!("{} in {}: {}", model.name, system.name, e.message))
        };
        let si = course(&SI);
        for system in &OTHERS {
            let (error, quantity) = difference(&si, &course(system));
            println!("{} in {}: {error:.1e} ({quantity})", model.name, system.name);
            // Round-off of some hundred steps, which hardening amplifies.
            assert!(error < 1e-11, "{} in {}: {quantity} {error:e}", model.name, system.name);
        }
    });
}

#[test]
fn a_value_that_keeps_its_number_in_other_units_is_seen() {
    // Negative control: each value with a dimension takes part, so that one that is a constant of
    // the model would be seen.
    for_each_model(|context, model| {
        let si = course(context, model, &SI, None).expect("a course");
        let required = model.parameters.iter().filter(|p| p.required);
        let pairs = required.flat_map(|p| OTHERS.iter().map(move |system| (p, system)));
        for (p, system) in pairs.filter(|(p, system)| scale(model, p, system) != 1.0) {
            let difference = match course(context, model, system, Some(p.key)) {
                Ok(kept) => difference(&si, &kept).0,
                Err(_) => f64::INFINITY, // refused: values that do not go together, a step that is too long
            };
            let what = format!("{} in {}, `{}` as in SI", model.name, system.name, p.key);
            println!("{what}: {difference:.1e}");
            assert!(difference > 1e-8, "{what}: no effect");
        }
    });
}

#[test]
fn no_default_and_no_bound_of_a_parameter_has_a_dimension() {
    // 0, none, and the ends of the numbers are the same in all units.
    let none = |v: f64| v == 0.0 || v.abs() >= 1e300 || v.abs() <= 1e-300;
    for_each_model(|_, model| {
        for p in model.parameters.iter().filter(|p| has_dimension(p)) {
            let bounds = [p.hard_min, p.hard_max, p.advised_min, p.advised_max];
            let default = if p.required { 0.0 } else { p.default };
            assert!(
                none(default) && bounds.into_iter().all(none),
                "{}: `{}` [{}] has the default {default} and the bounds {bounds:?}: require it, or let it follow from others",
                model.name,
                p.key,
                p.unit
            );
        }
    });
}
