//! The guests of `tests/fortran` through the tables that the adapter makes of them.

mod support;

use lahar_plugin_abi::*;
use std::fs;
use support::{Material, Numbers, adapt, close, folder, library, library_of, logged, states, text};

const PROBE: &str = r#"{
    "model": "probe", "cmname": "Probe one",
    "parameters": [{"key": "a", "default": 11}, {"key": "b", "default": 12}],
    "states": 140, "energy": true, "predef": ["pore_pressure", "density"]
}"#;

/// The model of a guest.
fn model(name: &str, sidecar: &str) -> &'static lahar_model_desc {
    adapt(&library(name, Some(sidecar))).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Point 2 of three, given something different everywhere.
fn probed(sidecar: &str, l: [f64; 9], stress: [f64; 6], strain: [f64; 6]) -> Material {
    let mut m = Material::new(model("probe.f90", sidecar), &[], 3).expect("an instance");
    (m.dt, m.time, m.step) = (0.5, 8.0, 41);
    m.set_gradient(2, l);
    m.set_stress(2, stress);
    m.set_state(2, m.at("statev_1"), &[0.25]);
    m.set_state(2, m.at("total_strain"), &strain);
    m.set_state(2, m.at("displacement_gradient"), &[0.1, 0.2, 0.0, 0.4, 0.5, 0.0, 0.0, 0.0, 0.3]);
    m.set_state(2, m.at("elastic_energy"), &[1.0, 2.0, 3.0]);
    for (input, value) in [
        (LAHAR_INPUT_ELEMENT_LENGTH, 0.125),
        (LAHAR_INPUT_TEMPERATURE, 300.0),
        (LAHAR_INPUT_POSITION_X, 1.5),
        (LAHAR_INPUT_POSITION_Y, 2.5),
        (LAHAR_INPUT_POSITION_Z, 3.5),
        (LAHAR_INPUT_PARTICLE_ID, 6.0),
        (LAHAR_INPUT_PORE_PRESSURE, 77.0),
    ] {
        m.set_input(input, 2, value);
    }
    m.update().expect("an update");
    m
}

/// Takes what the probe saw from the front.
struct Seen(Vec<f64>);

impl Seen {
    fn assert(&mut self, what: &str, expected: &[f64]) {
        let rest = self.0.split_off(expected.len());
        let seen = std::mem::replace(&mut self.0, rest);
        assert!(close(&seen, expected, 1e-14), "{what}: saw {seen:?}, expected {expected:?}");
    }
}

fn turned_by(angle: f64, [xx, yy, zz, xy, yz, zx]: [f64; 6]) -> [f64; 6] {
    let (s, c) = angle.sin_cos();
    [
        c * c * xx - 2.0 * s * c * xy + s * s * yy,
        s * s * xx + 2.0 * s * c * xy + c * c * yy,
        zz,
        s * c * (xx - yy) + (c * c - s * s) * xy,
        c * yz + s * zx,
        c * zx - s * yz,
    ]
}

#[test]
fn all_37_arguments_of_a_umat_arrive_in_three_dimensions() {
    // Spin about z by 0.3 in the step, and a stretch.
    let l = [0.02, -0.6, 0.04, 0.6, 0.06, 0.1, 0.04, 0.1, 0.08];
    let (stress, strain) = ([1.0, 2.0, 3.0, 4.0, 5.0, 6.0], [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]);
    let m = probed(PROBE, l, stress, strain);
    let mut seen = Seen(m.state1::<140>(2, m.at("statev_1")).to_vec());
    let [xx, yy, zz, xy, yz, zx] = turned_by(0.3, stress);
    seen.assert("STRESS turned by DROT, in the order of Abaqus", &[xx, yy, zz, xy, zx, yz]);
    seen.assert("STATEV", &[0.25]);
    seen.assert(
        "DDSDDE, SSE, SPD, SCD, RPL, DDSDDT, DRPLDE, DRPLDT",
        &[0.0, 1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 0.0],
    );
    seen.assert("STRAN with engineering shears", &[0.1, 0.2, 0.3, 0.8, 1.2, 1.0]);
    seen.assert("DSTRAN", &[0.01, 0.03, 0.04, 0.0, 0.04, 0.1]);
    seen.assert("TIME", &[8.0, 8.0]);
    seen.assert("DTIME, TEMP, DTEMP", &[0.5, 300.0, 0.0]);
    seen.assert("PREDEF", &[77.0, 1000.0]);
    seen.assert("DPRED", &[0.0, 0.0]);
    seen.assert(
        "CMNAME: length, length without blanks, first and last letter",
        &[80.0, 9.0, 80.0, 32.0],
    );
    seen.assert("NDI, NSHR, NTENS, NSTATV", &[3.0, 3.0, 6.0, 140.0]);
    seen.assert("PROPS and NPROPS", &[11.0, 12.0, 2.0]);
    seen.assert("COORDS", &[1.5, 2.5, 3.5]);
    let (s, c) = f64::sin_cos(0.3);
    seen.assert("DROT by columns", &[c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0]);
    seen.assert("PNEWDT, CELENT", &[1e36, 0.125]);
    seen.assert("the scale of the last", &[]);
    let f0 = [[1.1, 0.2, 0.0], [0.4, 1.5, 0.0], [0.0, 0.0, 1.3]];
    let f1 =
        |i: usize, j: usize| f0[i][j] + 0.5 * (0..3).map(|k| l[3 * i + k] * f0[k][j]).sum::<f64>();
    let columns =
        |f: &dyn Fn(usize, usize) -> f64| -> Vec<f64> { (0..9).map(|c| f(c % 3, c / 3)).collect() };
    seen.assert("DFGRD0 by columns", &columns(&|i, j| f0[i][j]));
    seen.assert("DFGRD1 by columns", &columns(&f1));
    seen.assert("NOEL, NPT, LAYER, KSPT", &[7.0, 1.0, 1.0, 1.0]);
    seen.assert("KSTEP(4), KINC", &[1.0, 0.0, 1.0, 0.0, 42.0]);
    assert!(seen.0.iter().all(|x| *x == -77.0), "{:?}", seen.0);

    assert_eq!(m.stress1(2), [10.0, 20.0, 30.0, 40.0, 60.0, 50.0]);
    let strain: [f64; 6] = m.state1(2, m.at("total_strain"));
    assert!(close(&strain, &[0.11, 0.23, 0.34, 0.4, 0.55, 0.62], 1e-14), "{strain:?}");
    let h: [f64; 9] = m.state1(2, m.at("displacement_gradient"));
    for c in 0..9 {
        let identity = f64::from(u8::from(c % 4 == 0));
        assert!((h[c] + identity - f1(c / 3, c % 3)).abs() < 1e-15);
    }
    assert_eq!(m.state1::<3>(2, m.at("elastic_energy")), [101.0, 202.0, 303.0]);
    assert_eq!((m.energy[2], m.status[2], m.dt_factor[2]), (101.0, LAHAR_POINT_OK, 1.0));
    assert!((m.wave_speed[2] - (7.0f64 / 1000.0).sqrt()).abs() < 1e-15, "{}", m.wave_speed[2]);
}

#[test]
fn the_arguments_of_plane_strain_have_four_components() {
    let sidecar = PROBE.replace("\"states\"", "\"ntens\": 4, \"states\"");
    let l = [0.02, -0.6, 0.0, 0.6, 0.06, 0.0, 0.0, 0.0, 0.08];
    let (stress, strain) = ([1.0, 2.0, 3.0, 4.0, 0.0, 0.0], [0.1, 0.2, 0.3, 0.4, 0.0, 0.0]);
    let m = probed(&sidecar, l, stress, strain);
    let mut seen = Seen(m.state1::<140>(2, m.at("statev_1")).to_vec());
    seen.assert("STRESS", &turned_by(0.3, stress)[..4]);
    seen.assert("STATEV", &[0.25]);
    seen.assert("others", &[0.0, 1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 0.0]);
    seen.assert("STRAN", &[0.1, 0.2, 0.3, 0.8]);
    seen.assert("DSTRAN", &[0.01, 0.03, 0.04, 0.0]);
    seen.0.drain(..2 + 3 + 2 + 2 + 4);
    seen.assert("NDI, NSHR, NTENS, NSTATV", &[3.0, 1.0, 4.0, 140.0]);
    assert_eq!(m.stress1(2), [10.0, 20.0, 30.0, 40.0, 0.0, 0.0]);
    assert!((m.wave_speed[2] - (7.0f64 / 1000.0).sqrt()).abs() < 1e-15, "{}", m.wave_speed[2]);

    let mut m = Material::new(m.model, &[], 1).expect("an instance");
    m.set_gradient(0, [0.0, 0.0, 0.0, 0.0, 0.0, 1e-9, 0.0, 0.0, 0.0]);
    let error = m.update().expect_err("a shear out of the plane");
    assert!(error.contains("`ntens` 4") && error.contains("set `ntens` to 6"), "{error}");
}

#[test]
fn the_hidden_length_of_the_material_name_may_be_an_int() {
    let sidecar = PROBE.replacen('{', "{\"hidden_length\": \"int\", ", 1);
    let m = probed(&sidecar, [0.0; 9], [0.0; 6], [0.0; 6]);
    let cmname = 6 + 1 + 8 + 6 + 6 + 2 + 3 + 2 + 2;
    assert_eq!(m.state1::<4>(2, cmname), [80.0, 9.0, 80.0, 32.0]);
}

#[test]
fn the_first_increment_has_number_one_and_states_begin_by_sdvini() {
    let mut m = Material::new(model("probe.f90", PROBE), &[], 2).expect("an instance");
    m.set_input(LAHAR_INPUT_PARTICLE_ID, 1, 4.0);
    m.set_input(LAHAR_INPUT_POSITION_X, 1, 1.0);
    m.set_input(LAHAR_INPUT_POSITION_Y, 1, 2.0);
    m.set_input(LAHAR_INPUT_POSITION_Z, 1, 3.0);
    m.init_state().expect("first states");
    assert_eq!(m.state1::<3>(0, 0), [1111.0, 0.0, 0.0]);
    assert_eq!(m.state1::<3>(1, 0), [5111.0, 321.0, 0.0]);
    for step in [-1, 0] {
        m.step = step;
        m.update().expect("an update");
        let seen = m.state1::<140>(1, 0);
        let last = seen.iter().rposition(|x| *x != -77.0).expect("a value");
        assert_eq!(seen[last], 1.0, "KINC at step {step}");
        assert_eq!(seen[6], 5111.0, "STATEV(1)");
    }
    m.wave_speed().expect("wave speeds");
    assert!((m.wave_speed[1] - (7.0f64 / 1000.0).sqrt()).abs() < 1e-15);
}

/// Hooke's law on a stress that has been turned.
fn hooke([e, nu]: [f64; 2], stress: [f64; 6], strain: [f64; 6]) -> [f64; 6] {
    let mu = e / (2.0 * (1.0 + nu));
    let lambda = 2.0 * mu * nu / (1.0 - 2.0 * nu);
    let volume = strain[0] + strain[1] + strain[2];
    std::array::from_fn(|c| {
        stress[c] + 2.0 * mu * strain[c] + if c < 3 { lambda * volume } else { 0.0 }
    })
}

const ELASTIC: &str = r#"{"states": 0, "parameters": [
    {"key": "youngs_modulus", "unit": "Pa", "typical": 1e7, "hard": [0, null]},
    {"key": "poissons_ratio", "typical": 0.3, "hard": [-1, 0.5], "advised": [0, 0.49]}]}"#;

#[test]
fn an_elastic_umat_gives_hookes_law_component_by_component() {
    let model = model("elastic.f", ELASTIC);
    let constants = [2e7, 0.2];
    for n in [1, 8, 13] {
        let mut m = Material::new(model, &constants, n).expect("an instance");
        let mut numbers = Numbers(n as u64);
        let mut expected = Vec::new();
        for k in 0..n {
            let (stress, [xx, yy, zz, xy, yz, zx]) = (numbers.array(1e4), numbers.array::<6>(1e-3));
            m.set_stress(k, stress);
            m.set_gradient(k, [xx, xy, zx, xy, yy, yz, zx, yz, zz]);
            expected.push(hooke(constants, stress, [xx, yy, zz, xy, yz, zx]));
        }
        m.update().expect("an update");
        for k in 0..n {
            assert!(close(&m.stress1(k), &expected[k], 1e-14), "{:?}", m.stress1(k));
            let exact = (2e7 * 0.8 / (1.2 * 0.6) / 1000.0f64).sqrt();
            assert!((m.wave_speed[k] / exact - 1.0).abs() < 1e-12, "{}", m.wave_speed[k]);
        }
    }
}

#[test]
fn a_rigid_rotation_leaves_the_invariants_of_the_stress() {
    let mut m = Material::new(model("elastic.f", ELASTIC), &[1e7, 0.3], 1).expect("an instance");
    let stress = [3e4, -1e4, 2e4, 5e3, -7e3, 1e3];
    m.set_stress(0, stress);
    let invariants = |s: [f64; 6]| {
        let square = s[0] * s[0] + s[1] * s[1] + s[2] * s[2];
        let shear = s[3] * s[3] + s[4] * s[4] + s[5] * s[5];
        let det = s[0] * (s[1] * s[2] - s[4] * s[4]) - s[3] * (s[3] * s[2] - s[4] * s[5])
            + s[5] * (s[3] * s[4] - s[1] * s[5]);
        [s[0] + s[1] + s[2], (square + 2.0 * shear).sqrt(), det.cbrt()]
    };
    for step in 0..200 {
        let (a, b, c) = (0.01, if step % 2 == 0 { 0.8 } else { -0.02 }, 0.03); // by small and by large angles
        m.set_gradient(0, [0.0, -a, b, a, 0.0, -c, -b, c, 0.0]);
        m.update().expect("an update");
        assert!(close(&invariants(m.stress1(0)), &invariants(stress), 1e-12));
        m.commit();
    }
    // The control: the stress itself has turned.
    assert!(!close(&m.stress1(0), &stress, 0.1));
}

/// Radial return in closed form; the twin of `von_mises.f90`. Stress after the step, and plastic strain.
fn radial_return(p: [f64; 4], stress: [f64; 6], plastic: f64, strain: [f64; 6]) -> ([f64; 6], f64) {
    let trial = hooke([p[0], p[1]], stress, strain);
    let mean = (trial[0] + trial[1] + trial[2]) / 3.0;
    let s: [f64; 6] = std::array::from_fn(|c| trial[c] - if c < 3 { mean } else { 0.0 });
    let norm = (0..6).map(|c| s[c] * s[c] * if c < 3 { 1.0 } else { 2.0 }).sum::<f64>();
    let (q, g) = ((1.5 * norm).sqrt(), p[0] / (2.0 * (1.0 + p[1])));
    let gamma = ((q - p[2] - p[3] * plastic) / (3.0 * g + p[3])).max(0.0);
    let factor = 1.0 - 3.0 * g * gamma / q;
    let end = std::array::from_fn(|c| factor * s[c] + if c < 3 { mean } else { 0.0 });
    (if q > 0.0 { end } else { trial }, plastic + gamma)
}

#[test]
fn a_von_mises_umat_agrees_with_its_twin_over_a_path_in_space_and_plane() {
    let sidecar = r#"{"states": [{"key": "equivalent_plastic_strain"}], "parameters": 4}"#;
    let p = [2e11, 0.3, 2.5e8, 1e9];
    for ntens in [6, 4] {
        let sidecar = sidecar.replacen('{', &format!("{{\"ntens\": {ntens}, "), 1);
        let model = model("von_mises.f90", &sidecar);
        let mut m = Material::new(model, &p, 11).expect("an instance");
        let mut numbers = Numbers(7);
        let mut twins = [([0.0; 6], 0.0); 11];
        let mut yielded = 0;
        for _ in 0..60 {
            for (k, twin) in twins.iter_mut().enumerate() {
                let [xx, yy, zz, xy, mut yz, mut zx] = numbers.array(8e-4);
                if ntens == 4 {
                    (yz, zx) = (0.0, 0.0);
                }
                m.set_gradient(k, [xx, xy, zx, xy, yy, yz, zx, yz, zz]);
                let before = twin.1;
                *twin = radial_return(p, twin.0, twin.1, [xx, yy, zz, xy, yz, zx]);
                yielded += u32::from(twin.1 > before);
            }
            m.update().expect("an update");
            m.commit();
            for (k, (stress, plastic)) in twins.iter().enumerate() {
                assert!(close(&m.stress1(k), stress, 1e-12), "{:?} {stress:?}", m.stress1(k));
                assert!((m.state1::<1>(k, 0)[0] - plastic).abs() <= 1e-12 * plastic);
                // Steps as large as the yield strain make the consistent tangent soft as a whole, of which the speed knows nothing.
                let ratio = m.wave_speed[k] / elastic_speed(p);
                assert!((0.9..1.3).contains(&ratio), "{ratio}");
            }
        }
        assert!((100..600).contains(&yielded), "{yielded} of 660 steps yield");
    }
}

fn elastic_speed([e, nu, ..]: [f64; 4]) -> f64 {
    (e * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu)) / 1000.0).sqrt()
}

#[test]
fn the_wave_speed_of_a_umat_that_yields_is_not_below_the_elastic_one() {
    let sidecar = r#"{"states": 1, "parameters": 4}"#;
    let model = model("von_mises.f90", sidecar);
    for nu in [0.0, 0.2, 0.3, 0.45] {
        let p = [2e11, nu, 2.5e8, 1e8];
        let mut m = Material::new(model, &p, 8).expect("an instance");
        let mut numbers = Numbers(3);
        for k in 0..8 {
            // Each point goes its own straight way, in steps as an explicit method makes them.
            let [xx, yy, zz, xy, yz, zx] = numbers.array(2e-5);
            m.set_gradient(k, [xx, xy, zx, xy, yy, yz, zx, yz, zz]);
        }
        for _ in 0..300 {
            m.update().expect("an update");
            m.commit();
            for k in 0..8 {
                let ratio = m.wave_speed[k] / elastic_speed(p);
                assert!((1.0 - 1e-12..1.31).contains(&ratio), "nu {nu}: {ratio}");
            }
        }
        assert!((0..8).all(|k| m.state1::<1>(k, 0)[0] > 1e-4), "a point does not yield");
    }
}

#[test]
fn objective_states_are_converted_between_both_orders() {
    let sidecar = r#"{"parameters": 2, "states": [{"key": "first"},
        {"key": "back_stress", "kind": "symmetric", "rotation": "objective"},
        {"key": "strain", "kind": "symmetric", "shear": "engineering", "initial": 0.5},
        {"key": "normal", "kind": "vector", "rotation": "objective"},
        {"key": "fabric", "kind": "tensor", "rotation": "objective"}]}"#;
    let all = r#"
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, dtemp, &
    predef, dpred, cmname, ndi, nshr, ntens, nstatv)
  double precision :: stress(6), statev(*), ddsdde(6, 6), fabric(3, 3)
  integer :: nstatv
  if (nstatv /= 25) statev(26) = 1
  fabric = reshape(statev(17:25), [3, 3])
  stress = [statev(2), statev(5), statev(6), statev(7), statev(11), fabric(1, 2)]
  statev(2:13) = [11, 22, 33, 12, 13, 23, 11, 22, 33, 12, 13, 23]
  fabric(1, 2) = 12
  fabric(2, 1) = 21
  statev(17:25) = reshape(fabric, [9])
  ddsdde(1, 1) = 1
end subroutine
"#;
    let file = folder().join("order.f90");
    fs::write(&file, all).expect("a source");
    let model = adapt(&library_of(&file, Some(sidecar))).expect("a model");
    let described: Vec<_> = states(model)[..5].iter().map(|s| (s.kind, s.rotation)).collect();
    assert_eq!(described, [(0, 0), (2, 1), (2, 0), (1, 1), (3, 1)]);
    let mut m = Material::new(model, &[0.0, 0.0], 1).expect("an instance");
    m.set_state(0, m.at("back_stress"), &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    m.set_state(0, m.at("fabric"), &[0.0, 7.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    m.update().expect("an update");
    // 11, 12, 13, 23 of the back stress, the engineering shear 12 of the strain, 12 of the fabric; the last two in Abaqus' order
    assert_eq!(m.stress1(0), [1.0, 4.0, 6.0, 5.0, 7.0, 1.0]);
    assert_eq!(m.state1(0, m.at("back_stress")), [11.0, 22.0, 33.0, 12.0, 23.0, 13.0]);
    assert_eq!(m.state1(0, m.at("strain")), [11.0, 22.0, 33.0, 6.0, 11.5, 6.5]);
    assert_eq!(m.state1::<4>(0, m.at("fabric")), [0.0, 12.0, 0.0, 21.0]);
}

#[test]
fn the_utility_routines_compute_what_they_say() {
    let sidecar = r#"{"parameters": 0, "states": 31}"#;
    let mut m = Material::new(model("utilities.f90", sidecar), &[], 1).expect("an instance");
    let (a, b, c) = (0.3, 0.2, 0.1);
    m.set_gradient(0, [0.0, -a, b, a, 0.0, -c, -b, c, 0.0]);
    m.set_state(0, m.at("total_strain"), &[0.1, -0.2, 0.3, 0.05, -0.03, 0.02]);
    m.set_stress(0, [3.0, 3.0, 3.0, 0.0, 0.0, 0.0]); // turned, it is the same
    m.update().expect("an update");
    let seen = m.state1::<31>(0, 0);
    assert!(close(&seen[..5], &[3.0, 0.0, 3.0, 3.0, 3.0], 1e-14), "{seen:?}");
    m.set_stress(0, [1.0, 2.0, 4.0, 3.0, 5.0, 6.0]);
    m.update().expect("an update");
    let seen = m.state1::<31>(0, 0);
    let second = (1.5 * (16.0 / 9.0 + 1.0 / 9.0 + 25.0 / 9.0 + 2.0 * 70.0f64)).sqrt();
    assert!(close(&seen[..2], &[7.0 / 3.0, second], 1e-14), "SINV {:?}", &seen[..2]);
    assert!((seen[2] + seen[3] + seen[4] - 7.0).abs() < 1e-13, "SPRINC");
    assert!((seen[5] + seen[6] + seen[7] - 0.2).abs() < 1e-14, "SPRIND");
    for c in (8..20).chain(24..31) {
        assert!(seen[c].abs() < 1e-13, "{c}: {}", seen[c]);
    }
    assert!(seen[20] != 0.0 && (seen[20] - seen[21]).abs() < 1e-15, "ROTSIG of a strain");
    assert_eq!((seen[22], seen[23]), (1.0, 1.0), "GETJOBNAME, GETOUTDIR");
}

#[test]
fn a_library_without_a_sidecar_has_numbered_parameters_and_states() {
    let path = library("elastic.f", None);
    let model = adapt(&path).expect("a model");
    let (level, line) = logged().remove(0);
    assert_eq!(level, LAHAR_PLUGIN_LOG_INFORMATION);
    assert!(
        line.contains("has no sidecar file") && line.contains("`prop_1` to `prop_40`"),
        "{line}"
    );
    assert_eq!(text(model.name), "elastic");
    assert_eq!((model.parameter_count, states(model).len()), (41, 22));
    let legacy = LAHAR_CAPABILITY_MAY_STOP | LAHAR_CAPABILITY_MAY_PRINT;
    assert_eq!(model.capabilities, legacy);
    let mut m = Material::new(model, &[2.0, 1e7, 0.25], 1).expect("an instance");
    m.set_gradient(0, [1e-3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    m.update().expect("an update");
    assert!(close(&m.stress1(0), &[1.2e4, 4e3, 4e3, 0.0, 0.0, 0.0], 1e-14));
}

#[test]
fn a_umat_in_c_without_hidden_length_and_tangent_runs_with_a_modulus() {
    let sidecar = r#"{"hidden_length": "none", "states": 0, "modulus": "m", "parameters": [
        {"key": "lambda", "typical": 1}, {"key": "mu", "typical": 1}, {"key": "m", "default": 9e6}]}"#;
    let mut m = Material::new(model("in_c.c", sidecar), &[3e6, 2e6], 1).expect("an instance");
    m.set_gradient(0, [1e-3, 0.0, 0.0, 0.0, 0.0, 2e-3, 0.0, 2e-3, 0.0]);
    m.update().expect("an update");
    assert!(close(&m.stress1(0), &[7e3, 3e3, 3e3, 0.0, 8e3, 0.0], 1e-14), "{:?}", m.stress1(0));
    assert!((m.wave_speed[0] - 9e3f64.sqrt()).abs() < 1e-10);

    let without = r#"{"hidden_length": "none", "states": 0, "parameters": 2}"#;
    let mut m = Material::new(model("in_c.c", without), &[3e6, 2e6], 1).expect("an instance");
    let error = m.update().expect_err("no wave speed");
    assert!(error.contains("left DDSDDE zero") && error.contains("give `modulus`"), "{error}");
}
