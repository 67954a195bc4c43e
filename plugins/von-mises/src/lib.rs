//! Plasticity of von Mises with isotropic hardening: q = sqrt(3 J2) is at most
//! σ_y(κ) = σ_0 + H κ + Q (1 - exp(-b κ)), linear and Voce hardening of the equivalent plastic strain κ.
//!
//! The return goes along the deviator of the trial stress: one equation for Δκ, closed without the Voce part, by six
//! steps of Newton's method with it. Either way the law is straight-line code.
#![forbid(unsafe_code)]

mod hardening;

use hardening::{Hardening, Return};
use lahar_plugin::elastic::{self, Elastic, lame};
use lahar_plugin::radial::Trial;
use lahar_plugin::tensor::is_finite;
use lahar_plugin::{
    Batch, Driver, Input, Model, ModelTable, Parameter, Point, PointLaw, State, Transfer, Updated,
    elastic_model, plastic,
};
use std::ffi::CStr;

lahar_plugin::plugin!(c"org.lahar.von_mises", [VonMises]);

/// `n` points for a bench, all of them in plastic flow, different in each point; with Voce hardening of `voce_stress` [Pa].
pub fn sample(voce_stress: f64, n: usize) -> Result<Driver, String> {
    let named = [
        ("youngs_modulus", 2.0e11),
        ("poissons_ratio", 0.3),
        ("yield_stress", 2.5e8),
        ("hardening_modulus", 1.0e9),
        ("voce_stress", voce_stress),
        ("voce_rate", 20.0),
    ];
    let mut driver = Driver::new(ModelTable::of::<VonMises>().desc(), &named, n)?;
    driver.set_samples(1e-3, [1.0, -2.0, 0.5, 3.0, -1.0, 0.0], [-1e7, -2e7, -1e7, 1e8, 0.0, 0.0]);
    Ok(driver)
}

/// Constants of an instance.
pub struct VonMises {
    /// Lamé's constants [Pa].
    lame: [f64; 2],
    hardening: Hardening,
}

impl Model for VonMises {
    const NAME: &'static CStr = c"von_mises";
    const SUMMARY: &'static CStr =
        c"Von Mises plasticity with linear and Voce isotropic hardening or softening";
    const REFERENCE: &'static CStr =
        c"Simo, Hughes: Computational Inelasticity (1998), section 3.3, doi:10.1007/b98904";
    const PARAMETERS: &'static [Parameter] = &[
        elastic::YOUNGS_MODULUS.typical(2.0e11),
        elastic::POISSONS_RATIO,
        Parameter::real(c"yield_stress", c"sigma_0", c"Pa", c"First yield stress in uniaxial tension")
            .typical(2.5e8)
            .hard(f64::MIN_POSITIVE, f64::INFINITY),
        Parameter::real(
            c"hardening_modulus",
            c"H",
            c"Pa",
            c"Slope of the yield stress over the plastic strain; negative: softening, whose results depend on the grid",
        )
        .default(0.0)
        .advised(0.0, f64::INFINITY),
        Parameter::real(
            c"voce_stress",
            c"Q",
            c"Pa",
            c"What Voce hardening adds to the yield stress at saturation; 0: none; negative: softening",
        )
        .default(0.0)
        .advised(0.0, f64::INFINITY),
        Parameter::real(c"voce_rate", c"b", c"-", c"Rate of Voce hardening over the plastic strain")
            .default(10.0)
            .hard(0.0, f64::INFINITY)
            .advised(0.0, 1.0e4),
        Parameter::real(
            c"residual_ratio",
            c"r",
            c"-",
            c"Softening ends at this part of the first yield stress",
        )
        .default(0.0)
        .hard(0.0, 1.0)
        .advised(0.0, 1.0),
    ];
    const STATES: &'static [State] = &[plastic::EQUIVALENT_STRAIN];
    const INPUTS: &'static [Input] = &[Input::Density];
    const HAS_TANGENT: bool = true;
    const TRANSFER: &'static [Transfer] = &[Transfer::Mean];
    elastic_model!();

    fn check(values: &[f64]) -> Result<(), String> {
        Self::new(values).map(drop)
    }

    fn new(values: &[f64]) -> Result<Self, String> {
        let [e, nu, initial, modulus, voce_stress, voce_rate, residual] = values[..] else {
            return Err("expected 7 values".into());
        };
        let lame = lame(e, nu)?;
        let three_g = 3.0 * lame[1];
        let floor = residual * initial;
        let hardening = Hardening { initial, modulus, voce_stress, voce_rate, floor, three_g };
        let least = hardening.least_stiffness();
        if !(least >= 0.1) {
            return Err(format!(
                "hardening_modulus {modulus} Pa and Voce softening of {voce_stress} Pa at a rate of {voce_rate} fall by \
                 more than 3 G = {three_g} Pa can follow: 3 G + H + Q b is {least} of the stiffness, expected at least \
                 0.1; give a slower softening"
            ));
        }
        Ok(Self { lame, hardening })
    }

    #[inline(always)]
    fn update(&self, batch: &mut Batch<'_>) {
        if self.hardening.is_voce() {
            batch.for_each_point(&Law::<true>(self));
        } else {
            batch.for_each_point(&Law::<false>(self));
        }
    }

    fn tangent(&self, batch: &Batch<'_>, k: usize) -> [[f64; 6]; 6] {
        let trial = Trial::new(self.lame, batch.stress0(k), batch.strain_increment(k));
        let [kappa0] = batch.state0(k);
        let Return { increment, q1, slope, .. } = match self.hardening.is_voce() {
            true => self.hardening.return_from::<true>(trial.q, kappa0),
            false => self.hardening.return_from::<false>(trial.q, kappa0),
        };
        if increment > 0.0 {
            trial.tangent(self.lame, q1, slope)
        } else {
            elastic::stiffness(self.lame)
        }
    }
}

impl Elastic for VonMises {
    #[inline(always)]
    fn lame(&self) -> [f64; 2] {
        self.lame
    }
}

/// The law of a point, with or without the Voce part.
struct Law<'a, const VOCE: bool>(&'a VonMises);

impl<const VOCE: bool> PointLaw<1> for Law<'_, VOCE> {
    type Model = VonMises;

    #[inline(always)]
    fn update(&self, point: &Point<1>) -> Updated<1> {
        let VonMises { lame, hardening } = self.0;
        let trial = Trial::new(*lame, point.stress0, point.strain_increment);
        let [kappa0] = point.state0;
        let Return { increment, q1, converged, .. } =
            hardening.return_from::<VOCE>(trial.q, kappa0);
        let returned = trial.returned(q1);
        let plastic = increment > 0.0;
        let mut stress1 = trial.stress;
        for c in 0..6 {
            stress1[c] = if plastic { returned[c] } else { trial.stress[c] };
        }
        let state1 = [kappa0 + increment];
        let wave_speed = self.0.wave_speed_of(point.inputs[0]);
        Updated::checked(stress1, state1, wave_speed, is_finite([trial.q]) & converged)
    }
}
