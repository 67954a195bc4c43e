//! Element tests through the plugin table: adiabats, shocks, friction, the balance of energy.
#![forbid(unsafe_code)]

use lahar_model_ideal_gas::IdealGas;
use lahar_plugin::abi::{LAHAR_POINT_FAILED, LAHAR_POINT_OK, LAHAR_POINT_UNRELIABLE};
use lahar_plugin::tensor::{contract, deviator, trace};
use lahar_plugin::{Driver, ModelTable};

const GAMMA: f64 = 1.4;
const RHO: f64 = 1.2;
const P: f64 = 1.0e5;
const INVISCID: [(&str, f64); 2] =
    [("linear_artificial_viscosity", 0.0), ("quadratic_artificial_viscosity", 0.0)];

/// A driver with one particle of gas, which does what the engine does with density and energy.
struct Gas {
    driver: Driver,
    density: f64,
    energy: f64,
}

impl Gas {
    fn new(named: &[(&str, f64)]) -> Self {
        let driver = Driver::new(ModelTable::of::<IdealGas>().desc(), named, 1).unwrap();
        let mut gas = Self { driver, density: RHO, energy: P / ((GAMMA - 1.0) * RHO) };
        gas.driver.set_stress(0, [-P, -P, -P, 0.0, 0.0, 0.0]);
        gas.set_inputs();
        gas.driver.init_state().unwrap();
        gas
    }

    fn set_inputs(&mut self) {
        for (i, value) in [self.density, self.energy, 0.01].into_iter().enumerate() {
            self.driver.set_input(i, 0, value);
        }
    }

    fn pressure(&self) -> f64 {
        (GAMMA - 1.0) * self.density * self.energy
    }

    /// p / ρ^γ, which grows with the entropy alone.
    fn entropic(&self) -> f64 {
        self.pressure() / self.density.powf(GAMMA)
    }

    /// A step that is not kept.
    fn tried(&mut self, strain: [f64; 6], dt: f64) -> [f64; 6] {
        let density = self.density;
        self.density *= (-trace(strain)).exp();
        self.set_inputs();
        self.density = density;
        self.driver.set_strain_increment(0, strain);
        self.driver.update(dt).unwrap();
        self.driver.stress1(0)
    }

    /// A step; returns the work of the mean stress per mass, over the volume half-way, as the engine counts it.
    fn step(&mut self, strain: [f64; 6], dt: f64) -> f64 {
        let old = self.driver.stress0(0);
        let new = self.tried(strain, dt);
        assert_eq!(self.driver.status_of(0), LAHAR_POINT_OK);
        self.density *= (-trace(strain)).exp();
        self.energy = self.driver.energy_of(0) / self.density;
        self.driver.commit();
        let mean: [f64; 6] = std::array::from_fn(|c| 0.5 * (old[c] + new[c]));
        contract(mean, strain) * (1.0 - 0.5 * trace(strain)) / self.density
    }
}

fn axial(e: f64) -> [f64; 6] {
    [e, 0.0, 0.0, 0.0, 0.0, 0.0]
}

#[test]
fn slow_compression_is_adiabatic_with_an_error_of_second_order() {
    for ratio in [0.5, 2.0_f64] {
        let error = |steps: usize| {
            let mut gas = Gas::new(&INVISCID);
            for _ in 0..steps {
                gas.step(axial(ratio.ln() / steps as f64), 1e-3);
            }
            let stress = gas.driver.stress0(0);
            assert!((stress[0] / -gas.pressure() - 1.0).abs() < 1e-14 && stress[0] == stress[2]);
            gas.pressure() / (P * ratio.powf(-GAMMA)) - 1.0
        };
        let errors = [error(50), error(100), error(200)];
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((order - 2.0).abs() < 0.02, "{errors:?}");
        }
        assert!(error(5000).abs() < 1e-8, "{}", error(5000));
    }
    // Half of the volume: 2^1.4 times the pressure, 2^0.4 times the temperature; an isothermal gas would have twice the pressure.
    let mut gas = Gas::new(&INVISCID);
    let energy = gas.energy;
    for _ in 0..5000 {
        gas.step(axial(-(2.0_f64.ln()) / 5000.0), 1e-3);
    }
    assert!((gas.pressure() / P - 2.639_016).abs() < 1e-6);
    assert!((gas.energy / energy - 1.319_508).abs() < 1e-6);
}

#[test]
fn the_energy_grows_by_the_work_of_the_stresses() {
    let mut seed = 1_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let mut gas = Gas::new(&[("viscosity", 20.0)]);
    let started = gas.entropic();
    for _ in 0..2000 {
        let strain: [f64; 6] = std::array::from_fn(|_| 0.02 * random());
        // Back to where it was, on the average.
        let pull = 0.01 * (gas.density / RHO).ln();
        let strain = std::array::from_fn(|c| strain[c] + if c < 3 { pull } else { 0.0 });
        let before = gas.energy;
        let work = gas.step(strain, 1e-4);
        assert!((gas.energy - before - work).abs() < 1e-14 * gas.energy);
    }
    assert!(gas.entropic() > 1.1 * started, "friction heats");
}

#[test]
fn artificial_viscosity_acts_in_compression_alone() {
    let (rate, dt, h) = (200.0, 1e-6, 0.01);
    let speed = (GAMMA * P / RHO).sqrt();
    for sign in [-1.0, 1.0] {
        let with = Gas::new(&[]).tried(axial(sign * rate * dt), dt)[0];
        let without = Gas::new(&INVISCID).tried(axial(sign * rate * dt), dt)[0];
        let expected = match sign < 0.0 {
            true => -RHO * h * rate * (speed + h * rate),
            false => 0.0,
        };
        // The density and the heat change by 2e-4.
        assert!((with - without - expected).abs() <= 1e-3 * expected.abs(), "{sign}");
    }
    // In compression the entropy grows with d ln(p / ρ^γ) = (γ - 1) q / p d ln ρ, back it stays.
    let (mut gas, dt, rate) = (Gas::new(&[]), 1e-7, 1e4);
    let (started, mut growth) = (gas.entropic(), 0.0);
    for _ in 0..1000 {
        gas.step(axial(-1e-3), dt);
        let speed = (GAMMA * (GAMMA - 1.0) * gas.energy).sqrt();
        growth +=
            (GAMMA - 1.0) * gas.density * h * rate * (speed + h * rate) / gas.pressure() * 1e-3;
    }
    let ratio = (gas.entropic() / started).ln() / growth;
    assert!(growth > 0.15 && (ratio - 1.0).abs() < 2e-3, "{growth} {ratio}");
    // The last of the viscous stress is still in the start stress of the first step back.
    gas.step(axial(1e-3), dt);
    let turned = gas.entropic();
    for _ in 0..999 {
        gas.step(axial(1e-3), dt);
    }
    assert!((gas.entropic() / turned - 1.0).abs() < 1e-5);
}

#[test]
fn viscosity_heats_by_its_power() {
    let (viscosity, rate, dt, steps) = (0.3, 100.0, 1e-4, 1000);
    let mut gas = Gas::new(&[("viscosity", viscosity)]);
    let before = gas.energy;
    for _ in 0..steps {
        gas.step([0.0, 0.0, 0.0, 0.5 * rate * dt, 0.0, 0.0], dt);
    }
    assert!((gas.driver.stress0(0)[3] - viscosity * rate).abs() < 1e-10);
    // The first step begins without shear stress: half of its work is missing.
    let expected = viscosity * rate * rate / RHO * dt * (f64::from(steps) - 0.5);
    assert!(((gas.energy - before) / expected - 1.0).abs() < 1e-9);
}

#[test]
fn sound_has_the_speed_of_the_adiabat_and_viscosities_their_diffusivity() {
    let mut gas = Gas::new(&[("viscosity", 0.3)]);
    let speed = (GAMMA * P / RHO).sqrt();
    let physical = 4.0 / 3.0 * 0.3 / RHO;
    gas.driver.wave_speed().unwrap();
    assert!((gas.driver.wave_speed_of(0) / speed - 1.0).abs() < 1e-14);
    assert!((gas.driver.diffusivity_of(0) / (0.01 * speed + physical) - 1.0).abs() < 1e-14);
    gas.tried(axial(-1e-9), 1e-9);
    assert!((gas.driver.wave_speed_of(0) / speed - 1.0).abs() < 1e-8);
    let expected = 0.01 * (speed + 0.01) + physical;
    assert!((gas.driver.diffusivity_of(0) / expected - 1.0).abs() < 1e-8);
    gas.tried(axial(1e-9), 1e-9);
    assert!((gas.driver.diffusivity_of(0) / physical - 1.0).abs() < 1e-8);
}

#[test]
fn the_tangent_is_the_derivative_of_the_stress_with_the_density_that_follows() {
    for (e, dt) in [(-3e-3, 1e-4), (4e-3, 1e-4), (-1e-4, 1.0)] {
        let mut gas = Gas::new(&[("viscosity", 0.3)]);
        gas.driver.set_stress(0, [-1.1 * P, -P, -0.9 * P, 300.0, -200.0, 100.0]);
        let strain = [e, 2.0 * e, -0.5 * e, 1e-3, -2e-3, 5e-4];
        gas.tried(strain, dt);
        let tangent = gas.driver.tangent(0, dt).unwrap();
        for j in 0..6 {
            let mut end = |h: f64| {
                let mut moved = strain;
                moved[j] += h;
                gas.tried(moved, dt)
            };
            let (h, ahead, behind) = (1e-5, end(1e-5), end(-1e-5));
            for i in 0..6 {
                let difference = (ahead[i] - behind[i]) / (2.0 * h);
                assert!((tangent[i][j] - difference).abs() < 1e-6 * P, "{e} {i} {j}");
            }
        }
    }
    // Without a strain it is that of sound.
    let mut gas = Gas::new(&[]);
    gas.tried([0.0; 6], 1e-4);
    let tangent = gas.driver.tangent(0, 1e-4).unwrap();
    assert!((tangent[0][0] / (GAMMA * P) - 1.0).abs() < 1e-14 && tangent[3] == [0.0; 6]);
}

#[test]
fn a_cold_gas_has_no_pressure_and_is_heated_by_a_shock() {
    let mut gas = Gas::new(&[]);
    gas.energy = 0.0;
    gas.driver.set_stress(0, [0.0; 6]);
    assert_eq!(gas.tried([0.0; 6], 1e-4), [0.0; 6]);
    assert_eq!((gas.driver.status_of(0), gas.driver.wave_speed_of(0)), (LAHAR_POINT_OK, 0.0));
    for _ in 0..100 {
        gas.step(axial(-1e-2), 1e-4);
    }
    assert!(gas.pressure() > 0.1);
}

#[test]
fn a_gas_that_would_do_more_work_than_it_can_ends_cold_and_says_so() {
    let mut gas = Gas::new(&[]);
    gas.energy = 1.0;
    let stress = gas.tried(axial(0.1), 1e-4);
    assert_eq!(gas.driver.status_of(0), LAHAR_POINT_UNRELIABLE);
    assert_eq!((stress, gas.driver.energy_of(0)), ([0.0; 6], 0.0));
}

#[test]
fn a_negative_energy_is_refused() {
    let mut gas = Gas::new(&[]);
    for energy in [-1.0, f64::NAN, f64::INFINITY] {
        gas.driver.set_input(1, 0, energy);
        let error = gas.driver.init_state().unwrap_err();
        assert!(error.contains("internal energy") && error.contains("strain_energy"), "{error}");
        gas.driver.update(1e-4).unwrap();
        assert_eq!(gas.driver.status_of(0), LAHAR_POINT_FAILED);
    }
}

#[test]
fn a_point_that_is_not_a_number_fails_alone() {
    let mut d = Driver::typical(ModelTable::of::<IdealGas>().desc(), &[], 9).unwrap();
    for k in 0..9 {
        d.set_input(1, k, 2e5);
        d.set_strain_increment(k, axial(-1e-3));
    }
    d.set_strain_increment(1, [0.0, 0.0, 0.0, f64::NAN, 0.0, 0.0]);
    // Compressed by more than the midpoint rule can answer for.
    d.set_strain_increment(2, axial(-3.0));
    d.set_strain_increment(3, axial(-1e200));
    d.set_stress(4, [f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0]);
    d.set_input(0, 5, 0.0);
    d.set_input(0, 6, -1.0);
    d.set_input(2, 7, f64::INFINITY);
    d.update(1e-3).unwrap();
    assert_eq!(d.failed_points().unwrap(), (1..8).collect::<Vec<_>>());
    assert!(deviator(d.stress1(0)).iter().all(|s| s.abs() < 1e-6));
}
