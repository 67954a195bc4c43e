//! Drucker-Prager elastoplasticity with a tension cut-off that remembers how far a point has opened.
//!
//! In the invariants p = -tr σ / 3 and q = sqrt(3 J2): yield q = M p + k, flow potential q - M_ψ p, perfectly plastic.
//! The cone is linear, hence the return from a trial state is Δλ = (q - M p - k) / (3 G + K M M_ψ), q - 3 G Δλ and
//! p + K M_ψ Δλ: exact, without iteration. All sums are three-dimensional; σ_zz of plane strain is carried along.
#![forbid(unsafe_code)]

mod cone;
mod tangent;

use cone::{Cone, ConeKind};
use lahar_plugin::elastic::{self, Elastic};
use lahar_plugin::tensor::{contract, deviator, is_finite, trace};
use lahar_plugin::{
    Batch, Driver, Input, Model, ModelTable, Parameter, Point, PointLaw, State, Transfer, Updated,
    elastic_model, gap, plastic,
};
use std::ffi::CStr;

lahar_plugin::plugin!(c"org.lahar.drucker_prager", [DruckerPrager]);

/// `n` points for a bench: sheared under pressure, all of them in plastic flow, different in each point.
pub fn sample(n: usize) -> Result<Driver, String> {
    let named = [
        ("youngs_modulus", 1.0e7),
        ("poissons_ratio", 0.3),
        ("friction_angle", 30.0),
        ("cohesion", 0.0),
        ("dilation_angle", 5.0),
        ("cone", 0.0),
    ];
    let mut driver = Driver::new(ModelTable::of::<DruckerPrager>().desc(), &named, n)?;
    driver.set_samples(1e-4, [1.0, -2.0, 0.5, 30.0, -1.0, 0.0], [-1e4, -2e4, -1e4, 1e3, 0.0, 0.0]);
    Ok(driver)
}

/// Constants of an instance: moduli and strengths [Pa], slopes of the cone and of the flow potential [-].
pub struct DruckerPrager {
    bulk_modulus: f64,
    shear_modulus: f64,
    cone: Cone,
    tension_cutoff: f64,
}

impl Model for DruckerPrager {
    const NAME: &'static CStr = c"drucker_prager";
    const SUMMARY: &'static CStr =
        c"Drucker-Prager, perfectly plastic, non-associated, with a tension cut-off";
    const REFERENCE: &'static CStr =
        c"Drucker, Prager: Soil mechanics and plastic analysis or limit design, Q. Appl. Math. 10 (1952), doi:10.1090/qam/48291";
    const PARAMETERS: &'static [Parameter] = &[
        elastic::YOUNGS_MODULUS,
        elastic::POISSONS_RATIO,
        Parameter::real(c"friction_angle", c"phi", c"deg", c"Mohr-Coulomb friction angle")
            .typical(30.0)
            .hard(0.0, 89.0)
            .advised(0.0, 55.0),
        Parameter::real(c"cohesion", c"c", c"Pa", c"Mohr-Coulomb cohesion")
            .typical(1.0e3)
            .hard(0.0, f64::INFINITY),
        Parameter::real(c"dilation_angle", c"psi", c"deg", c"Dilation angle, at most phi")
            .default(0.0)
            .hard(0.0, 89.0)
            .advised(0.0, 30.0),
        Parameter::choice(
            c"cone",
            c"compression|extension|plane_strain",
            0,
            c"Where the cone has the strength of Mohr-Coulomb: in triaxial compression (3D, axial symmetry), in triaxial extension (3D; the weakest) or in plane strain (2D, where 30 deg of the compression cone act as 44)",
        )
        .required(),
        Parameter::real(
            c"tension_cutoff",
            c"p_t",
            c"Pa",
            c"Largest mean tension, at most c cot(phi); 0: no tension",
        )
        .default(0.0)
        .hard(0.0, f64::INFINITY),
    ];
    const STATES: &'static [State] = &[plastic::EQUIVALENT_STRAIN, gap::OPENED_STRAIN];
    const INPUTS: &'static [Input] = &[Input::Density];
    const HAS_TANGENT: bool = true;
    const TRANSFER: &'static [Transfer] = &[Transfer::Max, Transfer::Never];
    elastic_model!();

    fn check(values: &[f64]) -> Result<(), String> {
        let [_, _, friction, cohesion, dilation, _, cutoff] = values[..] else {
            return Err("expected 7 values".into());
        };
        if dilation > friction {
            return Err(format!(
                "dilation_angle is {dilation} deg, but must not exceed friction_angle, which is {friction} deg"
            ));
        }
        let apex = cone::apex(friction, cohesion);
        if cutoff > apex * (1.0 + 1e-12) {
            return Err(format!(
                "tension_cutoff is {cutoff} Pa, but the cone ends at a mean tension of c cot(phi) = {apex} Pa; give \
                 at most that"
            ));
        }
        Ok(())
    }

    fn new(values: &[f64]) -> Result<Self, String> {
        let [e, nu, friction, cohesion, dilation, kind, cutoff] = values[..] else {
            return Err("expected 7 values".into());
        };
        let kind = ConeKind::ALL.get(kind as usize).ok_or("the cone is not one of the choices")?;
        let bulk_modulus = e / (3.0 * (1.0 - 2.0 * nu));
        let shear_modulus = e / (2.0 * (1.0 + nu));
        if !(bulk_modulus.is_finite() && shear_modulus.is_finite()) {
            return Err(format!("Young's modulus {e} gives moduli that are not finite"));
        }
        let cone = Cone::new(*kind, friction, cohesion, dilation);
        Ok(Self { bulk_modulus, shear_modulus, cone, tension_cutoff: cutoff })
    }

    #[inline(always)]
    fn update(&self, batch: &mut Batch<'_>) {
        batch.for_each_point(self);
    }

    fn tangent(&self, batch: &Batch<'_>, k: usize) -> [[f64; 6]; 6] {
        let [_, opened] = batch.state0(k);
        self.tangent_of(batch.stress0(k), opened, batch.strain_increment(k))
    }
}

impl Elastic for DruckerPrager {
    fn lame(&self) -> [f64; 2] {
        [self.bulk_modulus - 2.0 / 3.0 * self.shear_modulus, self.shear_modulus]
    }

    // Also of opened points, which may close at any time.
    #[inline(always)]
    fn wave_modulus(&self) -> f64 {
        self.bulk_modulus + 4.0 / 3.0 * self.shear_modulus
    }
}

impl DruckerPrager {
    /// A closed point: elastic trial from `stress0` with the deviator and the trace of a strain, return to the cone,
    /// tension cut-off.
    #[inline(always)]
    fn load(&self, stress0: [f64; 6], strain_deviator: [f64; 6], volumetric: f64) -> Loaded {
        let (bulk, shear) = (self.bulk_modulus, self.shear_modulus);
        let mean0 = trace(stress0) / 3.0;
        let [xx, yy, zz, xy, yz, zx] = stress0;
        let stress0_deviator = [xx - mean0, yy - mean0, zz - mean0, xy, yz, zx];
        let s: [f64; 6] =
            std::array::from_fn(|c| stress0_deviator[c] + 2.0 * shear * strain_deviator[c]);
        let p = -mean0 - bulk * volumetric;
        let q = (1.5 * contract(s, s)).sqrt();

        let Cone { slope, strength, dilation } = self.cone;
        let excess = q - slope * p - strength;
        let plastic = excess / (3.0 * shear + bulk * slope * dilation); // [DRP-2]
        let multiplier = if excess > 0.0 { plastic } else { 0.0 };
        let p_end = p + bulk * dilation * multiplier;

        // The apex comes before the scaling of the deviator: beyond it q - 3 G Δλ would be negative.
        let opens = -p_end > self.tension_cutoff;
        let q_end = q - 3.0 * shear * multiplier;
        let q_end = if q_end > 0.0 { q_end } else { 0.0 };
        let scaled = q_end / q;
        let scale = if (multiplier > 0.0) & (q > 0.0) { scaled } else { 1.0 };
        let [xx, yy, zz, xy, yz, zx] = s.map(|x| scale * x);
        let stress = [xx - p_end, yy - p_end, zz - p_end, xy, yz, zx];
        Loaded {
            stress: stress.map(|x| if opens { 0.0 } else { x }),
            plastic_strain: if opens { q / (3.0 * shear) } else { multiplier },
            opened: if opens { -p / bulk } else { 0.0 }, // [DRP-3]
        }
    }
}

/// What loading a closed point gives.
struct Loaded {
    stress: [f64; 6],
    plastic_strain: f64,
    opened: f64,
}

impl PointLaw<2> for DruckerPrager {
    type Model = Self;

    #[inline(always)]
    fn update(&self, point: &Point<2>) -> Updated<2> {
        let strain = point.strain_increment;
        let [plastic_strain0, opened0] = point.state0;
        let volumetric = trace(strain);
        let strain_deviator = deviator(strain);

        // An open point starts without stress.
        let was_open = opened0 != 0.0;
        let gap = opened0 + volumetric;
        let stays_open = was_open & (gap >= 0.0);
        let part = gap::loading_part(opened0, volumetric);
        let start = point.stress0.map(|x| if was_open { 0.0 } else { x });
        let free = (1.0 - part) * (2.0 / 3.0 * contract(strain_deviator, strain_deviator)).sqrt();

        let loaded = self.load(start, strain_deviator.map(|e| part * e), part * volumetric);
        let state1 = [
            plastic_strain0 + free + loaded.plastic_strain,
            if stays_open { gap } else { loaded.opened },
        ];
        let wave_speed = self.wave_speed_of(point.inputs[0]);
        let sane = is_finite(point.stress0) & is_finite(strain);
        Updated::checked(loaded.stress, state1, wave_speed, sane)
    }
}
