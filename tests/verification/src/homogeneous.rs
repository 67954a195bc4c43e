//! Homogeneous motions: a block whose nodes are given the velocities L x, and closed forms of its stress.

use lahar::context::Context;
use lahar::error::Result;
use lahar::material::Material;
use lahar::particles::seeding::Region;
use lahar::step::StepOrder;
use lahar::transfer::TransferKind;
use lahar::world::World;
use lahar::world::hooks::{HookArguments, HookPoint};
use lahar::world::options::Options;
use lahar_plugin::nalgebra::{Matrix3, Rotation3, Vector3};
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use crate::world::{fill, read, write};

/// A tensor.
pub type Mat3 = Matrix3<f64>;

/// Length of a step [s].
pub const DT: f64 = 1e-3;

/// A stress to start with, xx, yy, zz, xy, yz, zx [Pa]; yz and zx in three dimensions only.
const START_STRESS: [f64; 6] = [1e4, -5e3, 3e3, 4e3, 2e3, 1e3];

/// A block, and the field of velocities that its nodes are given.
pub struct Block {
    /// Its world.
    pub world: World,
    /// Its id.
    pub body: i64,
}

impl Block {
    /// A block at rest.
    pub fn new(context: &Arc<Context>, material: &Arc<Material>, dimension: usize) -> Result<Self> {
        let options = Options {
            dimension,
            spacing: 0.1,
            transfer: TransferKind::PicFlip,
            order: StepOrder::Usl,
            cfl: 1.0,
            ..Options::default()
        };
        let mut world = World::new(context, &options)?;
        let region = Region::Box { min: [-0.2, -0.2, -0.1], max: [0.3, 0.2, 0.1] };
        let body = fill(&mut world, material, &region, 1000.0, 2)?;
        Ok(Self { world, body })
    }

    /// Gives the nodes the velocities L x in every step.
    pub fn set_field(&mut self, l: Mat3) {
        let field = move |hook: HookArguments<'_>| {
            for node in 0..hook.nodes.count() {
                let v = l * Vector3::from(hook.nodes.position(node));
                hook.nodes.set_velocity(node, v.into());
            }
        };
        self.world.set_hook(HookPoint::AfterBoundaries, Some(Box::new(field)));
    }

    /// Steps with the velocities L x.
    pub fn drive(&mut self, l: Mat3, steps: usize) -> Result<()> {
        self.set_field(l);
        (0..steps).try_for_each(|_| self.world.step(Some(DT)).map(drop))
    }

    /// A symmetric field of the first particle, and the most that it differs by in another.
    pub fn tensor(&self, field: &str) -> Result<(Mat3, f64)> {
        let all = read(&self.world, self.body, field)?;
        let away = all.iter().enumerate().map(|(n, s)| (s - all[n % 6]).abs());
        let symmetric = [0, 3, 5, 3, 1, 4, 5, 4, 2].map(|c| all[c]);
        Ok((Mat3::from_row_slice(&symmetric), away.fold(0.0, f64::max)))
    }

    /// Gives all particles the same symmetric tensor, and returns it.
    pub fn set_start(&mut self, field: &str) -> Result<()> {
        let flat = self.world.options().dimension == 2;
        let mut s = START_STRESS;
        s[4..].iter_mut().for_each(|s| *s *= if flat { 0.0 } else { 1.0 });
        let n = self.world.particle_count(self.body)?;
        write(&mut self.world, self.body, field, &s.repeat(n))
    }

    /// Stresses the block: by a deformation gradient if the stress of the model follows from that.
    pub fn stress(&mut self, model: &str) -> Result<()> {
        if !is_hyperelastic(model) {
            return self.set_start("stress");
        }
        let out = if self.world.options().dimension == 3 { 1.0 } else { 0.0 };
        let f = [1.1, 0.2, 0.1 * out, -0.1, 0.9, 0.0, 0.05 * out, 0.1 * out, 1.05];
        let n = self.world.particle_count(self.body)?;
        write(&mut self.world, self.body, "deformation_gradient", &f.repeat(n))?;
        let j = Mat3::from_row_slice(&f).determinant();
        let volumes = read(&self.world, self.body, "volume")?;
        let volumes: Vec<f64> = volumes.iter().map(|v| v * j).collect();
        write(&mut self.world, self.body, "volume", &volumes)?;
        self.drive(Mat3::zeros(), 1) // the model fills in the stress
    }

    /// Stresses the block and turns it by a right angle. Gives the stress before, and R σ Rᵀ, which it should be then.
    pub fn turn(&mut self, model: &str, axis: Vector3<f64>, steps: usize) -> Result<[Mat3; 2]> {
        self.stress(model)?;
        let (before, _) = self.tensor("stress")?;
        self.drive(spin(model, axis, FRAC_PI_2 / steps as f64), steps)?;
        let r = Rotation3::new(FRAC_PI_2 * axis.normalize()).into_inner();
        Ok([before, r * before * r.transpose()])
    }
}

/// Whether the stress of a model follows from the deformation gradient.
fn is_hyperelastic(model: &str) -> bool {
    ["neo_hookean", "hencky"].contains(&model)
}

/// The velocity gradient that turns by the angle in one step, as the kinematics of the model see it.
fn spin(model: &str, axis: Vector3<f64>, angle: f64) -> Mat3 {
    let unit = axis.normalize();
    let spin = unit.cross_matrix();
    let l = match model {
        "linear_elastic" => angle * spin, // exp(W dt)
        _ if is_hyperelastic(model) => {
            Rotation3::new(angle * unit).into_inner() - Mat3::identity() // I + dt L
        }
        _ => angle.tan() * spin, // the rotation in I + dt L, without strain
    };
    l / DT
}

/// The velocity gradient of a simple shear γ in so many steps.
pub fn shear(gamma: f64, steps: usize) -> Mat3 {
    let rate = gamma / (steps as f64 * DT);
    Mat3::new(0.0, rate, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
}

/// The velocity gradient of a stretch λ along x in so many steps.
pub fn stretch(lambda: f64, steps: usize) -> Mat3 {
    let growth = lambda.powf(1.0 / steps as f64) - 1.0;
    Mat3::from_diagonal(&Vector3::new(growth / DT, 0.0, 0.0))
}

/// xy and xx of the Green–Naghdi hypoelastic stress over μ after a simple shear: J. K. Dienes, Acta Mech. 32 (1979) 217–232,
/// doi:10.1007/BF01379008.
pub fn dienes(gamma: f64) -> (f64, f64) {
    let b = f64::atan(0.5 * gamma);
    let (s, c) = f64::sin_cos(2.0 * b);
    let ln = b.cos().ln();
    let xy = 2.0 * c * (2.0 * b - 2.0 * f64::tan(2.0 * b) * ln - b.tan());
    (xy, 4.0 * (c * ln + b * s - b.sin().powi(2)))
}
