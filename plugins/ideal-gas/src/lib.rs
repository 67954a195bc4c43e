//! Ideal gas of constant heat capacities: p = (γ - 1) ρ e, with the internal energy that the particle carries, artificial viscosity for shocks and,
//! if wanted, a physical one.
//!
//! The energy grows by the work of the mean of both stresses over the step, as the engine counts work elsewhere; that is linear in the energy
//! at the end and solved for it.
#![forbid(unsafe_code)]

use lahar_plugin::tensor::{contract, deviator, is_finite, trace};
use lahar_plugin::{
    Batch, Driver, Input, Model, ModelTable, Output, Parameter, Point, PointLaw, PointStatus,
    Updated, elastic,
};
use std::ffi::CStr;

lahar_plugin::plugin!(c"org.lahar.ideal_gas", [IdealGas]);

/// `n` points for a bench: air under compression and shear, different in each point. Made for steps of 1e-4 s.
pub fn sample(n: usize) -> Result<Driver, String> {
    let mut driver = Driver::typical(ModelTable::of::<IdealGas>().desc(), &[], n)?;
    driver.set_samples(1e-4, [-3.0, 1.0, -2.0, 1.0, -1.0, 0.0], [-1e5, -1e5, -1e5, 0.0, 0.0, 0.0]);
    for k in 0..n {
        driver.set_input(0, k, 1.2);
        driver.set_input(1, k, 2.1e5);
        driver.set_input(2, k, 0.01);
    }
    Ok(driver)
}

/// Constants of an instance.
pub struct IdealGas {
    /// γ [-]
    heat_capacity_ratio: f64,
    /// C1, C2 [-]
    artificial_viscosity: [f64; 2],
    /// μ [Pa s]
    viscosity: f64,
}

/// One step: the gas and its dt [s].
struct Step<'m> {
    gas: &'m IdealGas,
    dt: f64,
}

/// A point at the start of a step, and its strain increment.
#[derive(Clone, Copy)]
struct Before {
    strain: [f64; 6],
    stress0: [f64; 6],
    density: f64,
    energy: f64,
    length: f64,
}

/// The point at the end of the step.
struct After {
    /// e, less than 0 if the gas would do more work than it has energy [J/kg]
    energy: f64,
    /// By what the energy is divided, 1 + (γ - 1)/2 tr Δε (1 - tr Δε / 2) [-]
    divisor: f64,
    /// p and q [Pa]
    pressures: [f64; 2],
    /// Deviator of the viscous stress [Pa]
    viscous: [f64; 6],
    /// -div v in compression, else 0 [1/s]
    closing: f64,
}

impl Step<'_> {
    /// 1/Δt [1/s]; without a step there are no rates.
    #[inline(always)]
    fn per_dt(&self) -> f64 {
        if self.dt > 0.0 { 1.0 / self.dt } else { 0.0 }
    }

    #[inline(always)]
    fn advanced(&self, before: &Before) -> After {
        let Before { strain, stress0, density, energy, length } = *before;
        let gas = self.gas;
        let [linear, quadratic] = gas.artificial_viscosity;
        let volumetric = trace(strain);
        let rate = volumetric * self.per_dt();
        let closing = if rate < 0.0 { -rate } else { 0.0 };
        let speed = gas.wave_speed_of(energy);
        let q = density * length * closing * (linear * speed + quadratic * length * closing); // [GAS-2]
        let viscous = deviator(strain).map(|e| 2.0 * gas.viscosity * self.per_dt() * e);

        // The volume half-way, per mass, times half of the work of the stresses without p at the end.
        let middle = (1.0 - 0.5 * volumetric) / density;
        let work = contract(stress0, strain) + contract(viscous, strain) - q * volumetric;
        let divisor =
            1.0 + 0.5 * (gas.heat_capacity_ratio - 1.0) * (1.0 - 0.5 * volumetric) * volumetric;
        let energy = (energy + 0.5 * middle * work) / divisor; // [GAS-3]
        let kept = if energy < 0.0 { 0.0 } else { energy };
        let p = (gas.heat_capacity_ratio - 1.0) * density * kept; // [GAS-1]
        After { energy, divisor, pressures: [p, q], viscous, closing }
    }
}

impl PointLaw<0> for Step<'_> {
    type Model = IdealGas;

    #[inline(always)]
    fn update(&self, point: &Point<0>) -> Updated<0> {
        let (gas, strain) = (self.gas, point.strain_increment);
        let [density, energy0, length, ..] = point.inputs;
        let before = Before { strain, stress0: point.stress0, density, energy: energy0, length };
        let After { energy, divisor, pressures: [p, q], viscous, closing } = self.advanced(&before);
        let overdrawn = energy < 0.0;
        let kept = if overdrawn { 0.0 } else { energy };
        let [xx, yy, zz, xy, yz, zx] = viscous;
        let total = p + q;
        let stress1 = [xx - total, yy - total, zz - total, xy, yz, zx];
        let wave_speed = gas.wave_speed_of(kept);
        let diffusivity = gas.diffusivity_of(wave_speed, length, closing, density);
        let sane = is_finite(stress1)
            & is_finite(strain)
            & is_finite([energy, wave_speed, diffusivity])
            & (density > 0.0)
            & (energy0 >= 0.0)
            & (divisor > 0.0);
        let status = if overdrawn { PointStatus::Unreliable } else { PointStatus::Ok };
        Updated {
            stress1,
            state1: [],
            wave_speed,
            diffusivity,
            energy: density * kept,
            status: if sane { status } else { PointStatus::Failed },
        }
    }
}

impl IdealGas {
    /// Speed of sound at an energy [J/kg].
    #[inline(always)]
    fn wave_speed_of(&self, energy: f64) -> f64 {
        (self.heat_capacity_ratio * (self.heat_capacity_ratio - 1.0) * energy).sqrt() // [GAS-4]
    }

    /// Kinematic diffusivity of longitudinal motion while the gas closes at a rate [1/s].
    #[inline(always)]
    fn diffusivity_of(&self, speed: f64, length: f64, closing: f64, density: f64) -> f64 {
        let [linear, quadratic] = self.artificial_viscosity;
        let artificial = length * (linear * speed + quadratic * length * closing);
        let artificial = if closing > 0.0 { artificial } else { 0.0 };
        artificial + 4.0 / 3.0 * self.viscosity / density
    }
}

impl Model for IdealGas {
    const NAME: &'static CStr = c"ideal_gas";
    const SUMMARY: &'static CStr = c"Ideal gas with artificial viscosity for shocks";
    const REFERENCE: &'static CStr = c"von Neumann, Richtmyer: A method for the numerical calculation of hydrodynamic shocks, J. Appl. Phys. 21 (1950), doi:10.1063/1.1699639";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::real(
            c"heat_capacity_ratio",
            c"gamma",
            c"-",
            c"Ratio of the heat capacities; 1.4 for air, 5/3 for gases of single atoms",
        )
        .default(1.4)
        .hard(1.001, 10.0)
        .advised(1.05, 3.0),
        Parameter::real(
            c"linear_artificial_viscosity",
            c"C1",
            c"-",
            c"Factor of rho h c |div v| in compression (Landshoff)",
        )
        .default(1.0)
        .hard(0.0, 100.0)
        .advised(0.0, 2.0),
        Parameter::real(
            c"quadratic_artificial_viscosity",
            c"C2",
            c"-",
            c"Factor of rho (h div v)^2 in compression (von Neumann, Richtmyer)",
        )
        .default(1.0)
        .hard(0.0, 100.0)
        .advised(0.0, 4.0),
        Parameter::real(c"viscosity", c"mu", c"Pa s", c"Dynamic viscosity; 1.8e-5 for air")
            .default(0.0)
            .hard(0.0, f64::INFINITY),
    ];
    const INPUTS: &'static [Input] = &[Input::Density, Input::InternalEnergy, Input::ElementLength];
    const OUTPUTS: Output =
        Output::WAVE_SPEED.and(Output::DIFFUSIVITY).and(Output::ENERGY).and(Output::STATUS);
    const HAS_TANGENT: bool = true;

    fn new(values: &[f64]) -> Result<Self, String> {
        let [heat_capacity_ratio, linear, quadratic, viscosity] = values[..] else {
            return Err("expected 4 values".into());
        };
        Ok(Self { heat_capacity_ratio, artificial_viscosity: [linear, quadratic], viscosity })
    }

    fn init_state(&self, batch: &mut Batch<'_>) -> Result<(), String> {
        let energy = batch.input(1);
        match (0..batch.n()).find(|k| !(energy[*k] >= 0.0 && energy[*k].is_finite())) {
            None => Ok(()),
            Some(k) => Err(format!(
                "the internal energy {} J/kg of point {k} of the batch is not one that a gas can have; set the field \
                 strain_energy to mass p / ((gamma - 1) density)",
                energy[k]
            )),
        }
    }

    #[inline(always)]
    fn update(&self, batch: &mut Batch<'_>) {
        let dt = batch.dt();
        batch.for_each_point(&Step { gas: self, dt });
    }

    #[inline(always)]
    fn wave_speed(&self, batch: &mut Batch<'_>) {
        let (density, energy, length) = (batch.input(0), batch.input(1), batch.input(2));
        for k in 0..batch.n() {
            let speed = self.wave_speed_of(energy[k]);
            batch.set_wave_speed(k, speed);
            // How fast it will close is not known; that it may close is.
            let diffusivity = self.diffusivity_of(speed, length[k], f64::MIN_POSITIVE, density[k]);
            batch.set_diffusivity(k, diffusivity);
        }
    }

    /// The density of the batch, that of the end of the step, follows the strain increment here.
    fn tangent(&self, batch: &Batch<'_>, k: usize) -> [[f64; 6]; 6] {
        let step = Step { gas: self, dt: batch.dt() };
        let (strain, stress0) = (batch.strain_increment(k), batch.stress0(k));
        let [density, energy0, length] = [0, 1, 2].map(|i| batch.input(i)[k]);
        let before = Before { strain, stress0, density, energy: energy0, length };
        let After { energy, divisor, pressures: [p, q], viscous, closing } = step.advanced(&before);
        let (volumetric, ratio) = (trace(strain), self.heat_capacity_ratio - 1.0);
        let [linear, quadratic] = self.artificial_viscosity;

        // By the volumetric strain: q, the volume half-way and the divisor.
        let slope = linear * self.wave_speed_of(energy0) + 2.0 * quadratic * length * closing;
        let steepness = density * length * slope * step.per_dt();
        let dq = if closing > 0.0 { -q - steepness } else { 0.0 };
        let middle = (1.0 - 0.5 * volumetric) / density;
        let dmiddle = middle - 0.5 / density;
        let ddivisor = 0.5 * ratio * (1.0 - volumetric);
        let work = contract(stress0, strain) + contract(viscous, strain) - q * volumetric;
        let by_volume =
            0.5 * dmiddle * work - 0.5 * middle * (dq * volumetric + q) - energy * ddivisor;

        let mu_per_dt = self.viscosity * step.per_dt();
        let mut tangent = elastic::stiffness([-2.0 / 3.0 * mu_per_dt, mu_per_dt]);
        for j in 0..6 {
            let (normal, places) = if j < 3 { (1.0, 1.0) } else { (0.0, 2.0) };
            let dwork = places * (stress0[j] + 2.0 * viscous[j]);
            let denergy = (0.5 * middle * dwork + normal * by_volume) / divisor;
            let dp = if energy < 0.0 { 0.0 } else { ratio * density * denergy - normal * p };
            for row in &mut tangent[..3] {
                row[j] -= dp + normal * dq;
            }
        }
        tangent
    }
}
