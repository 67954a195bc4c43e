//! Isotropic linear elasticity in rate form: Δσ = λ tr(Δε) I + 2 G Δε on the objectively rotated stress.
#![forbid(unsafe_code)]

use lahar_plugin::{
    Batch, Columns, Input, Kinematics, Model, ModelTable, Output, Parameter, Plugin, PointStatus,
    State, c_text,
};
use std::ffi::CStr;

/// The plugin with this model.
pub static PLUGIN: Plugin = Plugin::new(
    c"org.lahar.linear_elastic",
    c_text(concat!(env!("CARGO_PKG_VERSION"), "\0")),
    &[ModelTable::of::<LinearElastic>()],
)
.author(c"The lahar developers")
.licence(c"MIT OR Apache-2.0");

/// The table of the plugin, for programs that link the model statically.
pub fn plugin() -> &'static lahar_plugin::abi::lahar_plugin_desc {
    PLUGIN.desc()
}

/// Elastic constants of an instance [Pa].
pub struct LinearElastic {
    lambda: f64,
    shear_modulus: f64,
}

impl LinearElastic {
    fn wave_speed_of(&self, density: f64) -> f64 {
        ((self.lambda + 2.0 * self.shear_modulus) / density).sqrt()
    }
}

impl Model for LinearElastic {
    const NAME: &'static CStr = c"linear_elastic";
    const SUMMARY: &'static CStr = c"Isotropic linear elasticity in rate form";
    const REFERENCE: &'static CStr =
        c"Belytschko, Liu, Moran, Elkhodary: Nonlinear Finite Elements, 2nd ed. (2014), section 5.4";
    const KINEMATICS: Kinematics = Kinematics::StrainIncrement;
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::real(c"youngs_modulus", c"E", c"Pa", c"Young's modulus")
            .hard(f64::MIN_POSITIVE, f64::INFINITY),
        Parameter::real(c"poissons_ratio", c"nu", c"-", c"Poisson's ratio")
            .hard(-0.999, 0.4999)
            .advised(0.0, 0.495),
    ];
    const STATES: &'static [State] = &[];
    const INPUTS: &'static [Input] = &[Input::Density];
    const OUTPUTS: Output = Output::WAVE_SPEED.and(Output::STATUS);

    fn new(values: &[f64]) -> Result<Self, String> {
        let [e, nu] = values[..] else { return Err("expected 2 values".into()) };
        let shear_modulus = e / (2.0 * (1.0 + nu));
        let lambda = e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
        if !(lambda.is_finite() && shear_modulus.is_finite()) {
            return Err(format!("Young's modulus {e} gives moduli that are not finite"));
        }
        Ok(Self { lambda, shear_modulus })
    }

    fn update(&self, batch: &mut Batch<'_>) {
        let n = batch.n();
        let (lambda, two_g) = (self.lambda, 2.0 * self.shear_modulus);
        {
            let Columns { strain_increment: [xx, yy, zz, xy, yz, zx], stress0, stress1, .. } =
                batch.columns::<0>();
            let [s_xx, s_yy, s_zz, s_xy, s_yz, s_zx] = stress1;
            for k in 0..n {
                let pressure_part = lambda * (xx[k] + yy[k] + zz[k]);
                s_xx[k] = stress0[0][k] + pressure_part + two_g * xx[k];
                s_yy[k] = stress0[1][k] + pressure_part + two_g * yy[k];
                s_zz[k] = stress0[2][k] + pressure_part + two_g * zz[k];
            }
            for k in 0..n {
                s_xy[k] = stress0[3][k] + two_g * xy[k];
                s_yz[k] = stress0[4][k] + two_g * yz[k];
                s_zx[k] = stress0[5][k] + two_g * zx[k];
            }
        }
        self.finish(batch);
    }

    fn wave_speed(&self, batch: &mut Batch<'_>) {
        let density = batch.input(0);
        for k in 0..batch.n() {
            batch.set_wave_speed(k, self.wave_speed_of(density[k]));
        }
    }
}

impl LinearElastic {
    /// Wave speeds, and the status of points with a stress or density that makes no sense.
    fn finish(&self, batch: &mut Batch<'_>) {
        let columns = batch.columns::<0>();
        let stress = columns.stress1;
        let density = columns.inputs[0];
        for k in 0..density.len() {
            let c = self.wave_speed_of(density[k]);
            columns.wave_speed[k] = c;
            let sum = stress.iter().fold(c, |sum, s| sum + s[k].abs());
            if !sum.is_finite() {
                columns.status[k] = PointStatus::Failed as i32;
            }
        }
    }
}
