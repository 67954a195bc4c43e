//! Triaxial tests of Drucker–Prager soil: the model alone, and a cell of particles in the engine.

use lahar::error::{Error, Result, Status};
use lahar::particles::seeding::{Fill, Region};
use lahar::transfer::TransferKind;
use lahar::world::World;
use lahar_model_drucker_prager::DruckerPrager;
use lahar_plugin::{Driver, ModelTable};
use serde::Deserialize;

use crate::run::Outcome;
use crate::world::{Method, Transfer, material, read, write};

/// φ = 30°, c = 10 kPa, E = 20 MPa, ν = 0.3, confined by 100 kPa along x and y, strained along z.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setup {
    /// What is strained.
    sample: Sample,
    /// Strain along z of a step; negative is compression.
    strain: f64,
    /// Steps.
    steps: usize,
    /// Which Mohr-Coulomb strength the cone has: 0 triaxial compression, 1 extension, 2 plane strain.
    cone: f64,
    /// Dilation angle [deg].
    #[serde(default)]
    dilation_angle: f64,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Sample {
    /// The model, driven without an engine.
    Model,
    /// Eight particles in the engine, moved as a host likes.
    Cell,
}

const YOUNG: f64 = 20e6;
const POISSON: f64 = 0.3;
const CONFINEMENT: f64 = 100e3;
const ISOTROPIC: [f64; 6] = [-CONFINEMENT, -CONFINEMENT, -CONFINEMENT, 0.0, 0.0, 0.0];

/// Gives `strength` (|σ_zz − σ_xx| at the end [kPa]), `dilation` (volume strain over axial strain in the last step), `slope` (of the
/// stress difference over axial strain below half the strength [MPa]), `lateral` (σ_xx over the confinement at the end), and the
/// curve `deviator` [kPa] over axial strain [%].
pub fn run(setup: &Setup) -> Result<Outcome> {
    let values = [
        ("youngs_modulus", YOUNG),
        ("poissons_ratio", POISSON),
        ("friction_angle", 30.0),
        ("cohesion", 10e3),
        ("dilation_angle", setup.dilation_angle),
        ("cone", setup.cone),
    ];
    let points = match setup.sample {
        Sample::Model => model(setup, &values)?,
        Sample::Cell => cell(setup, &values)?,
    };
    let last = points[points.len() - 1];
    let deviator = |point: &Point| point.stress[2] - point.stress[0];
    let end = deviator(&last);
    let early = points.iter().rfind(|point| deviator(point).abs() < 0.5 * end.abs());
    let mut out = Outcome::new();
    out.set("strength", end.abs() / 1e3);
    out.set("dilation", (2.0 * last.lateral + setup.strain) / setup.strain);
    out.set("slope", early.map_or(f64::NAN, |point| deviator(point) / point.axial / 1e6));
    out.set("lateral", -last.stress[0] / CONFINEMENT);
    let curve = points.iter().map(|point| [-100.0 * point.axial, -deviator(point) / 1e3]);
    out.curve("deviator", curve.collect());
    Ok(out)
}

/// The end of a step.
#[derive(Clone, Copy)]
struct Point {
    /// Strain along z since the start.
    axial: f64,
    /// Strain along x, and along y, in the step.
    lateral: f64,
    stress: [f64; 6],
}

/// In each step the lateral strain is found by the secant method so that the lateral stress stays.
fn model(setup: &Setup, values: &[(&str, f64)]) -> Result<Vec<Point>> {
    let failed = |text: String| Error::new(Status::MaterialFailed, text);
    let mut driver =
        Driver::new(ModelTable::of::<DruckerPrager>().desc(), values, 1).map_err(failed)?;
    driver.set_stress(0, ISOTROPIC);
    let mut points = Vec::new();
    for step in 1..=setup.steps {
        let mut residual = |lateral: f64| {
            driver.set_strain_increment(0, [lateral, lateral, setup.strain, 0.0, 0.0, 0.0]);
            driver.update(1.0).map_err(failed)?;
            Ok::<f64, Error>(driver.stress1(0)[0] + CONFINEMENT)
        };
        let (mut a, mut b) = (0.0, -0.5 * setup.strain);
        let mut at_a = residual(a)?;
        for _ in 0..50 {
            let at_b = residual(b)?;
            if at_b.abs() < 1e-10 * CONFINEMENT || at_b == at_a {
                break;
            }
            (a, b, at_a) = (b, b - at_b * (b - a) / (at_b - at_a), at_b);
        }
        residual(b)?;
        driver.commit();
        let axial = step as f64 * setup.strain;
        points.push(Point { axial, lateral: b, stress: driver.stress0(0) });
    }
    Ok(points)
}

/// The particles are so heavy that their stresses do not move them: they follow the velocity that they are given before each step, a
/// linear field, which the affine transfer reproduces. A controller holds the lateral stress.
fn cell(setup: &Setup, values: &[(&str, f64)]) -> Result<Vec<Point>> {
    let (context, soil) = material("drucker_prager", values)?;
    let method = Method { transfer: Transfer::Of(TransferKind::Apic), ..Method::default() };
    let mut options = method.options(1.0);
    options.dimension = 3;
    let mut world = World::new(&context, &options)?;
    let region = Region::Box { min: [0.0; 3], max: [1.0; 3] };
    let fill = Fill { density: 1e15, stress: ISOTROPIC, ..Fill::default() };
    let body = world.add_shape(&soil, &region, &fill)?;
    let dt = 1e-3;
    // the lateral stiffness of an elastic sample and what the axial strain adds
    let lambda = YOUNG * POISSON / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON));
    let stiffness = 2.0 * lambda + YOUNG / (1.0 + POISSON);
    let mut integral = -setup.strain * lambda / stiffness;
    let (mut stress, mut points) = (ISOTROPIC, Vec::new());
    for step in 1..=setup.steps {
        let error = (-CONFINEMENT - stress[0]) / stiffness;
        integral += 0.1 * error;
        let lateral = integral + 0.5 * error;
        let rate = [lateral / dt, lateral / dt, setup.strain / dt];
        let x = read(&world, body, "position")?;
        let v: Vec<f64> = x.iter().enumerate().map(|(k, x)| rate[k % 3] * x).collect();
        let gradient = [rate[0], 0.0, 0.0, 0.0, rate[1], 0.0, 0.0, 0.0, rate[2]];
        write(&mut world, body, "velocity", &v)?;
        write(&mut world, body, "affine", &gradient.repeat(x.len() / 3))?;
        world.step(Some(dt))?;
        stress.copy_from_slice(&read(&world, body, "stress")?[..6]);
        points.push(Point { axial: step as f64 * setup.strain, lateral, stress });
    }
    Ok(points)
}
