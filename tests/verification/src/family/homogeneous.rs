//! Homogeneous motions: stretch, simple shear and rotation of a block of one material.

use lahar::error::Result;
use lahar_plugin::nalgebra::Vector3;
use serde::Deserialize;

use crate::homogeneous::{Block, shear, stretch};
use crate::run::Outcome;
use crate::world::{context, read};

/// E = 1 MPa, ν = 0.3. The nodes of a block are given the velocities of a homogeneous motion in every step.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setup {
    /// The model, `neo_hookean` for example.
    model: String,
    motion: Motion,
    /// Axes of the world.
    dimension: usize,
    /// Steps.
    steps: usize,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum Motion {
    /// Simple shear γ.
    Shear(f64),
    /// Stretch λ along x.
    Stretch(f64),
    /// A right angle about an axis, of a block under stress.
    Turn([f64; 3]),
}

const YOUNG: f64 = 1e6;
const POISSON: f64 = 0.3;

/// Gives `stress_xx` and `stress_xy` [Pa], `volume` (over that at the start), `spread` (largest difference of the stress between
/// particles over E), with a turn `defect` (of σ = R σ0 Rᵀ over the largest stress) and `change` (of the stress by the turn, over the same),
/// with a shear `defect_xy` (|σ_xy / μ − sin γ|, what is wrong with a Jaumann rate), and the curve `stress_xy` over γ.
pub fn run(setup: &Setup) -> Result<Outcome> {
    let plugin = setup.model.trim_end_matches("_green_naghdi");
    let context = context(plugin)?;
    let values = [("youngs_modulus", YOUNG), ("poissons_ratio", POISSON)];
    let material = lahar::material::Material::new(&context, &setup.model, &values)?;
    let mut block = Block::new(&context, &material, setup.dimension)?;
    let volume = read(&block.world, block.body, "volume")?[0];
    let mu = YOUNG / (2.0 * (1.0 + POISSON));
    let mut out = Outcome::new();
    match setup.motion {
        Motion::Shear(gamma) => {
            let (l, parts, mut curve) = (shear(gamma, setup.steps), 100, vec![[0.0, 0.0]]);
            for part in 1..=parts {
                block.drive(l, setup.steps / parts)?;
                let xy = block.tensor("stress")?.0[(0, 1)];
                curve.push([gamma * part as f64 / parts as f64, xy / mu]);
            }
            out.set("defect_xy", (curve[parts][1] - gamma.sin()).abs());
            out.curve("stress_xy", curve);
        }
        Motion::Stretch(lambda) => block.drive(stretch(lambda, setup.steps), setup.steps)?,
        Motion::Turn(axis) => {
            let [before, expected] = block.turn(&setup.model, Vector3::from(axis), setup.steps)?;
            let (after, _) = block.tensor("stress")?;
            out.set("defect", (after - expected).amax() / before.amax());
            out.set("change", (after - before).amax() / before.amax());
        }
    }
    let (stress, spread) = block.tensor("stress")?;
    out.set("stress_xx", stress[(0, 0)]);
    out.set("stress_xy", stress[(0, 1)]);
    out.set("volume", read(&block.world, block.body, "volume")?[0] / volume);
    out.set("spread", spread / YOUNG);
    Ok(out)
}
