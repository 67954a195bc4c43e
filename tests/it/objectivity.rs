//! Homogeneous motions, prescribed at the nodes: every measure of strain against its closed form,
//! in 2D and 3D.

use std::ffi::CStr;

use lahar::error::Status;
use lahar::material::Material;
use lahar::simd::Isa;
use lahar_plugin::nalgebra::Vector3;
use lahar_plugin::{Batch, Input, Kinematics, Model, ModelTable, Output, Parameter, Plugin, State};
use lahar_verification::homogeneous::{Block, DT, Mat3, dienes, shear, stretch};

use crate::setup::{context_with, read};

const E: f64 = 1e6;
const NU: f64 = 0.3;
const MU: f64 = E / (2.0 * (1.0 + NU));
const LAMBDA: f64 = E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU));

/// A block of a model.
fn block(dimension: usize, model: &str, isa: Isa) -> Block {
    let context = context_with(1, isa);
    if model == Follower::NAME.to_str().unwrap() {
        context.register_plugin(|host| FOLLOWER.entered(host)).expect("a good table");
    }
    let values: &[(&str, f64)] = match model {
        "follower" => &[],
        _ => &[("youngs_modulus", E), ("poissons_ratio", NU)],
    };
    let material = Material::new(&context, model, values).expect("a material");
    Block::new(&context, &material, dimension).expect("a block")
}

/// A field of six components, which must be the same in all particles up to `spread`.
fn tensor(block: &Block, field: &str, spread: f64) -> Mat3 {
    let (mean, away) = block.tensor(field).expect("a field");
    assert!(away <= spread, "{field} differs by {away:e} between particles");
    mean
}

fn stress(block: &Block) -> Mat3 {
    tensor(block, "stress", 1e-9 * E)
}

/// Leaves stress and a tensor of its own as the engine turned them.
struct Follower;

static FOLLOWER: Plugin =
    Plugin::new(c"org.lahar.tests.follower", c"0", &[ModelTable::of::<Follower>()]);

impl Model for Follower {
    const NAME: &'static CStr = c"follower";
    const SUMMARY: &'static CStr = c"A model for tests";
    const REFERENCE: &'static CStr = c"";
    const KINEMATICS: Kinematics = Kinematics::GreenNaghdi;
    const PARAMETERS: &'static [Parameter] = &[];
    const STATES: &'static [State] = &[State::symmetric(c"back_stress", c"Pa", c"")];
    const INPUTS: &'static [Input] = &[];
    const OUTPUTS: Output = Output::WAVE_SPEED;

    fn new(_values: &[f64]) -> Result<Self, String> {
        Ok(Self)
    }

    fn update(&self, batch: &mut Batch<'_>) {
        for k in 0..batch.n() {
            batch.set_stress1(k, batch.stress0(k));
            batch.set_state1(k, batch.state0::<6>(k));
            batch.set_wave_speed(k, 1.0);
        }
    }

    fn wave_speed(&self, batch: &mut Batch<'_>) {
        (0..batch.n()).for_each(|k| batch.set_wave_speed(k, 1.0));
    }
}

/// Stress after a simple shear γ in so many steps.
fn sheared(dimension: usize, model: &str, gamma: f64, steps: usize) -> Mat3 {
    let mut block = block(dimension, model, Isa::best());
    let volumes = read(&block.world, block.body, "volume");
    block.drive(shear(gamma, steps), steps).expect("steps");
    for (new, old) in read(&block.world, block.body, "volume").iter().zip(volumes) {
        assert!((new / old - 1.0).abs() < 1e-12, "shear keeps the volume");
    }
    stress(&block)
}

/// The closed form of Dienes, xy and xx, by integrating dσ/dγ = Ω σ − σ Ω + 2 D, Ω = dR/dγ Rᵀ
/// (Runge and Kutta's fourth order): R turns by −atan(γ/2).
fn dienes_integrated(gamma: f64) -> (f64, f64) {
    let rate = |g: f64, [xx, xy]: [f64; 2]| {
        let w = 0.5 / (1.0 + 0.25 * g * g); // yy = −xx
        [2.0 * w * xy, 1.0 - 2.0 * w * xx]
    };
    let (n, mut s) = (2000, [0.0, 0.0]);
    let h = gamma / f64::from(n);
    for i in 0..n {
        let g = f64::from(i) * h;
        let along = |k: [f64; 2], h: f64| [s[0] + h * k[0], s[1] + h * k[1]];
        let k1 = rate(g, s);
        let k2 = rate(g + 0.5 * h, along(k1, 0.5 * h));
        let k3 = rate(g + 0.5 * h, along(k2, 0.5 * h));
        let k4 = rate(g + h, along(k3, h));
        s = std::array::from_fn(|c| s[c] + h / 6.0 * (k1[c] + 2.0 * (k2[c] + k3[c]) + k4[c]));
    }
    (s[1], s[0])
}

#[test]
fn hyperelastic_models_in_simple_shear_have_the_stress_of_the_closed_form() {
    for (dimension, gamma) in [(2, 0.2), (2, 1.0), (3, 0.5)] {
        let neo = sheared(dimension, "neo_hookean", gamma, 100) / MU;
        assert!((neo[(0, 1)] - gamma).abs() < 1e-12, "{neo}");
        assert!((neo[(0, 0)] - gamma * gamma).abs() < 1e-12, "{neo}");
        assert!(neo[(1, 1)].abs().max(neo[(2, 2)].abs()) < 1e-12, "{neo}");
        let hencky = sheared(dimension, "hencky", gamma, 100) / MU;
        let k = f64::asinh(0.5 * gamma);
        let (xy, xx) = (2.0 * k / k.cosh(), gamma * k / k.cosh());
        assert!((hencky[(0, 1)] - xy).abs() < 1e-12, "{hencky}");
        assert!((hencky[(0, 0)] - xx).abs() < 1e-12, "{hencky}");
        assert!((hencky[(1, 1)] + xx).abs() < 1e-12, "{hencky}");
    }
}

#[test]
fn the_stored_energy_in_simple_shear_is_that_of_the_closed_form() {
    let (gamma, steps) = (1.5, 100);
    let k = f64::asinh(0.5 * gamma);
    for (model, w) in [("neo_hookean", 0.5 * MU * gamma * gamma), ("hencky", 2.0 * MU * k * k)] {
        for dimension in [2, 3] {
            let mut block = block(dimension, model, Isa::best());
            block.drive(shear(gamma, steps), steps).expect("good steps");
            let energies = read(&block.world, block.body, "strain_energy");
            let volumes = read(&block.world, block.body, "volume");
            for (u, v) in energies.iter().zip(volumes) {
                assert!((u / (v * w) - 1.0).abs() < 1e-11, "{model}: {u} J, closed form {}", v * w);
            }
        }
    }
}

#[test]
fn the_closed_form_of_dienes_is_the_integral_of_the_green_naghdi_rate() {
    for gamma in [0.1, 1.0, 3.0, 6.0] {
        let ((xy, xx), (xy1, xx1)) = (dienes(gamma), dienes_integrated(gamma));
        assert!((xy - xy1).abs() < 1e-10 && (xx - xx1).abs() < 1e-10, "{gamma}");
    }
}

/// Runs a shear with two numbers of steps: the error is of first order, and what is left when it is
/// taken out is of second order.
fn converges(dimension: usize, model: &str, gamma: f64, (xy, xx): (f64, f64)) {
    let error = |s: Mat3| {
        let [a, b, c] = [s[(0, 1)] - xy, s[(0, 0)] - xx, s[(1, 1)] + xx];
        Vector3::new(a, b, c).amax()
    };
    let [coarse, fine] = [500, 1000].map(|steps| sheared(dimension, model, gamma, steps) / MU);
    let (first, second, rest) = (error(coarse), error(fine), error(2.0 * fine - coarse));
    println!("{model}, {dimension}D, γ = {gamma}: {first:e}, {second:e}, extrapolated {rest:e}");
    assert!(second < gamma * gamma / 1000.0, "{second:e}");
    assert!((second / first - 0.5).abs() < 0.01, "{first:e} and {second:e}: not of first order");
    assert!(rest < 1e-2 * second, "{rest:e} is left of {second:e}");
}

#[test]
fn jaumann_stress_in_simple_shear_oscillates_and_green_naghdi_stress_follows_dienes() {
    for (dimension, gamma) in [(2, 1.0), (2, 3.0), (3, 1.0)] {
        let jaumann = (f64::sin(gamma), 1.0 - f64::cos(gamma));
        converges(dimension, "linear_elastic", gamma, jaumann);
        converges(dimension, "linear_elastic_green_naghdi", gamma, dienes(gamma));
    }
    // the two rates are as different as the literature says, so the test distinguishes them
    assert!((f64::sin(3.0) - 0.1411).abs() < 1e-4 && dienes(3.0).0 > 1.5);
}

#[test]
fn confined_compression_and_extension_have_the_stress_and_volume_of_the_closed_form() {
    let known = [(0.5, -1376708.0), (0.8, -333997.8), (1.2, 228680.2), (1.5, 476460.9)];
    for (dimension, (lambda, neo)) in [2, 3, 2, 3].into_iter().zip(known) {
        let steps = 200;
        let l = stretch(lambda, steps);
        let summed = steps as f64 * l[(0, 0)] * DT; // what the increments of strain sum up to
        let m = LAMBDA + 2.0 * MU;
        let expected = [
            ("neo_hookean", (MU * (lambda * lambda - 1.0) + LAMBDA * f64::ln(lambda)) / lambda),
            ("hencky", m * f64::ln(lambda) / lambda),
            ("linear_elastic", m * summed),
            ("linear_elastic_green_naghdi", m * summed),
        ];
        assert!((expected[0].1 / neo - 1.0).abs() < 1e-6, "the formula of the test");
        for (model, axial) in expected {
            let mut block = block(dimension, model, Isa::best());
            let volumes = read(&block.world, block.body, "volume");
            block.drive(l, steps).expect("steps");
            let s = stress(&block);
            assert!((s[(0, 0)] - axial).abs() < 1e-11 * E, "{model} {lambda}: {s}, not {axial}");
            // V = V0 det F where F is carried, else V0 exp(tr Δε) step by step
            let ratio = if model == "linear_elastic" { summed.exp() } else { lambda };
            for (new, old) in read(&block.world, block.body, "volume").iter().zip(volumes) {
                assert!((new / old / ratio - 1.0).abs() < 1e-12, "{model}: {}", new / old);
            }
        }
        // what the two volumes differ by is what the test would miss otherwise
        assert!((summed.exp() / lambda - 1.0).abs() > 1e-5);
    }
}

#[test]
fn the_volume_of_what_carries_f_is_that_of_f_in_any_motion() {
    for dimension in [2, 3] {
        let mut block = block(dimension, "hencky", Isa::best());
        let volume = read(&block.world, block.body, "volume")[0];
        for n in 0..3 {
            let x = |c: usize| ((7 * n + 5 * c + 1) as f64).sin();
            let mut l = Mat3::from_fn(|a, b| x(3 * a + b));
            if dimension == 2 {
                l = l.component_mul(&Mat3::new(1.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0));
            }
            block.drive(l, 200).expect("steps");
        }
        let volumes = read(&block.world, block.body, "volume");
        let f = read(&block.world, block.body, "deformation_gradient");
        for (v, f) in volumes.iter().zip(f.chunks(9)) {
            let j = Mat3::from_row_slice(f).determinant();
            assert!((v / volume / j - 1.0).abs() < 1e-12, "{} and {j}", v / volume);
            assert!((j - 1.0).abs() > 0.01, "a motion that changes the volume");
        }
    }
}

/// Stresses a block, turns it by a right angle in 1000 steps, and gives the largest defect of R σ
/// Rᵀ over the largest stress.
fn turn_defect(dimension: usize, model: &str, isa: Isa, axis: Vector3<f64>) -> f64 {
    let mut block = block(dimension, model, isa);
    if model == "follower" {
        block.set_start("back_stress").expect("a field");
    }
    let [before, expected] = block.turn(model, axis, 1000).expect("steps");
    let mut defect = (stress(&block) - expected).amax();
    if model == "follower" {
        defect = defect.max((tensor(&block, "back_stress", 1e-3) - expected).amax());
    }
    assert!((before - expected).amax() > 0.5 * before.amax(), "the turn changes the stress");
    defect / before.amax()
}

#[test]
fn a_right_angle_turns_the_stress_of_every_kind_of_model_with_the_body() {
    let models =
        ["linear_elastic", "linear_elastic_green_naghdi", "neo_hookean", "hencky", "follower"];
    for model in models {
        for isa in Isa::all() {
            let plane = turn_defect(2, model, isa, Vector3::z());
            let space = turn_defect(3, model, isa, Vector3::new(1.0, 2.0, 3.0));
            println!("{model}, {}: R σ Rᵀ to {plane:e} in 2D, {space:e} in 3D", isa.name());
            assert!(plane <= 1e-10 && space <= 1e-10, "{model}: {plane:e}, {space:e}");
        }
    }
}

#[test]
fn a_step_that_turns_particles_inside_out_is_an_error() {
    for (growth, good) in [(-0.9, true), (-1.1, false)] {
        let mut block = block(2, "follower", Isa::best());
        let l = Mat3::from_diagonal(&Vector3::new(growth / DT, 0.0, 0.0));
        block.set_field(l);
        let result = block.world.step(Some(DT));
        assert_eq!(result.is_ok(), good, "{result:?}");
        if let Err(error) = result {
            assert_eq!(error.status, Status::NonFinite, "{error}");
        }
    }
}
