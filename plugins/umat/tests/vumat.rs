//! VUMATs through the tables that the adapter makes of them.

mod support;

use lahar_plugin_abi::*;
use support::{Material, Numbers, adapt, close, library, states, text};

const PROBE: &str = r#"{"states": 150, "energy": true, "predef": ["pore_pressure"], "cmname": "VPROBE",
    "parameters": [{"key": "a", "default": 11}, {"key": "b", "default": 12}]}"#;

fn model(name: &str, sidecar: &str) -> &'static lahar_model_desc {
    adapt(&library(name, Some(sidecar))).unwrap_or_else(|e| panic!("{name}: {e}"))
}

type Matrix = [[f64; 3]; 3];

fn about_z(angle: f64) -> Matrix {
    let (s, c) = angle.sin_cos();
    [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]
}

fn times(a: Matrix, b: Matrix) -> Matrix {
    let entry = |i: usize, j: usize| (0..3).map(|k| a[i][k] * b[k][j]).sum();
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

fn transposed(a: Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

fn full([xx, yy, zz, xy, yz, zx]: [f64; 6]) -> Matrix {
    [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]]
}

fn six(a: Matrix) -> [f64; 6] {
    [a[0][0], a[1][1], a[2][2], a[0][1], a[1][2], a[2][0]]
}

/// Symmetric components of aᵀ s a.
fn seen_from(a: Matrix, s: Matrix) -> [f64; 6] {
    six(times(transposed(a), times(s, a)))
}

fn general(f: Matrix) -> [f64; 9] {
    [f[0][0], f[1][1], f[2][2], f[0][1], f[1][2], f[2][0], f[1][0], f[2][1], f[0][2]]
}

const STRETCH: Matrix = [[1.2, 0.1, 0.0], [0.1, 0.9, 0.0], [0.0, 0.0, 1.1]];

/// Point 129 of 130, turned by 0.5 before, stretched, and spun at 0.4 per second for half a second.
fn probed(sidecar: &str) -> (Material, [Matrix; 4]) {
    let mut m = Material::new(model("vumat_probe.f90", sidecar), &[], 130).expect("an instance");
    (m.dt, m.time, m.step) = (0.5, 8.0, 41);
    let l = [[0.02, -0.41, 0.0], [0.39, 0.06, 0.0], [0.0, 0.0, 0.08]];
    let f0 = times(about_z(0.5), STRETCH);
    let mut step = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            step[i][j] = 0.5 * l[i][j] + f64::from(u8::from(i == j));
        }
    }
    let f1 = times(step, f0);
    // In the plane R turns by atan((F21 - F12) / (F11 + F22)).
    let r1 = about_z((f1[1][0] - f1[0][1]).atan2(f1[0][0] + f1[1][1]));
    let k = 129;
    m.set_gradient(k, l.as_flattened().try_into().expect("nine"));
    m.set_stress(k, [1.0, 2.0, 3.0, 4.0, 0.0, 0.0]);
    let mut h = f0;
    for i in 0..3 {
        h[i][i] -= 1.0;
    }
    m.set_state(k, m.at("displacement_gradient"), h.as_flattened());
    m.set_state(k, m.at("statev_1"), &[0.25]);
    m.set_state(k, m.at("plastic_dissipation"), &[2.0]);
    for (input, value) in [
        (LAHAR_INPUT_ELEMENT_LENGTH, 0.125),
        (LAHAR_INPUT_TEMPERATURE, 300.0),
        (LAHAR_INPUT_POSITION_X, 1.5),
        (LAHAR_INPUT_POSITION_Y, 2.5),
        (LAHAR_INPUT_POSITION_Z, 3.5),
        (LAHAR_INPUT_PARTICLE_ID, 6.0),
        (LAHAR_INPUT_PORE_PRESSURE, 77.0),
        (LAHAR_INPUT_INTERNAL_ENERGY, 33.0),
    ] {
        m.set_input(input, k, value);
    }
    m.update().expect("an update");
    (m, [l, f0, f1, r1])
}

#[test]
fn all_arguments_of_a_vumat_arrive_along_axes_that_turn_with_the_material() {
    for ntens in [6, 4] {
        let sidecar = PROBE.replacen('{', &format!("{{\"ntens\": {ntens}, "), 1);
        let (m, [l, f0, f1, r1]) = probed(&sidecar);
        let r0 = about_z(0.5);
        let mut seen = m.state1::<150>(129, m.at("statev_1")).to_vec();
        let mut assert = |what: &str, expected: &[f64]| {
            let rest = seen.split_off(expected.len());
            let front = std::mem::replace(&mut seen, rest);
            assert!(close(&front, expected, 1e-13), "{what}: saw {front:?}, expected {expected:?}");
        };
        let nshr = (ntens - 3) as f64;
        assert("jblock", &[2.0, 1.0, 1.0, 1.0, 7.0]); // the second block
        assert("ndir, nshr, nstatev, nfieldv, nprops, lanneal", &[3.0, nshr, 150.0, 1.0, 2.0, 0.0]);
        assert("stepTime, totalTime, dt, length of cmname", &[8.5, 8.5, 0.5, 80.0, 6.0]);
        assert("coordMp, charLength", &[1.5, 2.5, 3.5, 0.125]);
        assert("props, density", &[11.0, 12.0, 1000.0]);
        let mut strain = [[0.0; 3]; 3];
        for i in 0..3 {
            for j in 0..3 {
                strain[i][j] = 0.25 * (l[i][j] + l[j][i]);
            }
        }
        assert("strainInc", &seen_from(r1, strain)[..ntens]);
        // Spin less turn of R, about z; in space components 32, 13, 21.
        let turn = r1[1][0].atan2(r1[0][0]) - 0.5;
        let spin = [0.0, 0.0, 0.25 * (l[1][0] - l[0][1]) - turn];
        assert("relSpinInc", if ntens == 6 { &spin } else { &spin[2..] });
        assert("tempOld, tempNew", &[300.0, 300.0]);
        assert("stretchOld", &six(STRETCH)[..ntens]);
        assert("stretchNew", &six(times(transposed(r1), f1))[..ntens]);
        let components = |f: Matrix| {
            let nine = general(f);
            if ntens == 6 {
                nine.to_vec()
            } else {
                vec![nine[0], nine[1], nine[2], nine[3], nine[6]]
            }
        };
        assert("defgradOld", &components(f0));
        assert("defgradNew", &components(f1));
        assert("fieldOld, fieldNew", &[77.0, 77.0]);
        let stress = full([1.0, 2.0, 3.0, 4.0, 0.0, 0.0]);
        assert("stressOld", &seen_from(r0, stress)[..ntens]);
        assert("stateOld, enerInternOld, enerInelasOld", &[0.25, 33.0, 2.0]);
        assert!(seen.iter().all(|x| *x == -77.0), "{seen:?}");

        let mut given = [10.0, 20.0, 30.0, 40.0, 50.0, 60.0];
        given[ntens..].fill(0.0);
        let back = six(times(r1, times(full(given), transposed(r1))));
        assert!(close(&m.stress1(129), &back, 1e-13), "{:?}", m.stress1(129));
        assert_eq!((m.energy[129], m.status[129]), (38.0 * 1000.0, LAHAR_POINT_OK));
        assert_eq!(m.state1::<2>(129, m.at("elastic_energy")), [38.0, 8.0]);
    }
}

const MISES: &str =
    r#"{"states": [{"key": "equivalent_plastic_strain"}], "parameters": 4, "energy": true}"#;

/// What the VUMAT answers along its own axes, in closed form.
fn radial_return(p: [f64; 4], stress: [f64; 6], plastic: f64, strain: [f64; 6]) -> ([f64; 6], f64) {
    let g = p[0] / (2.0 * (1.0 + p[1]));
    let lambda = 2.0 * g * p[1] / (1.0 - 2.0 * p[1]);
    let volume = lambda * (strain[0] + strain[1] + strain[2]);
    let trial: [f64; 6] =
        std::array::from_fn(|c| stress[c] + 2.0 * g * strain[c] + if c < 3 { volume } else { 0.0 });
    let mean = (trial[0] + trial[1] + trial[2]) / 3.0;
    let s: [f64; 6] = std::array::from_fn(|c| trial[c] - if c < 3 { mean } else { 0.0 });
    let norm: f64 = (0..6).map(|c| s[c] * s[c] * if c < 3 { 1.0 } else { 2.0 }).sum();
    let q = (1.5 * norm).sqrt();
    let gamma = ((q - p[2] - p[3] * plastic) / (3.0 * g + p[3])).max(0.0);
    let factor = 1.0 - 3.0 * g * gamma / q;
    (std::array::from_fn(|c| factor * s[c] + if c < 3 { mean } else { 0.0 }), plastic + gamma)
}

#[test]
fn a_von_mises_vumat_agrees_with_its_twin_over_a_path() {
    let p = [2e11, 0.3, 2.5e8, 1e9];
    let mut m = Material::new(model("vumat_von_mises.f", MISES), &p, 300).expect("an instance");
    let mut numbers = Numbers(5);
    let mut twins = vec![([0.0; 6], 0.0); m.n];
    let exact = (2e11 * 0.7 / (1.3 * 0.4) / 1000.0f64).sqrt();
    m.wave_speed().expect("wave speeds");
    assert!((m.wave_speed[299] / exact - 1.0).abs() < 1e-9, "{} {exact}", m.wave_speed[299]);
    let mut yielded = 0;
    for _ in 0..30 {
        for (k, twin) in twins.iter_mut().enumerate() {
            let [xx, yy, zz, xy, yz, zx] = numbers.array(8e-4);
            m.set_gradient(k, [xx, xy, zx, xy, yy, yz, zx, yz, zz]);
            // The axes stand still but for what two stretches that do not commute turn them.
            m.set_state(k, m.at("displacement_gradient"), &[0.0; 9]);
            let before = twin.1;
            *twin = radial_return(p, twin.0, twin.1, [xx, yy, zz, xy, yz, zx]);
            yielded += u32::from(twin.1 > before);
        }
        m.update().expect("an update");
        m.commit();
        for (k, (stress, plastic)) in twins.iter().enumerate() {
            assert!(close(&m.stress1(k), stress, 1e-12), "{:?} {stress:?}", m.stress1(k));
            assert!((m.state1::<1>(k, 0)[0] - plastic).abs() <= 1e-12 * plastic);
            assert!((1.0 - 1e-9..1.0 + 1e-6).contains(&(m.wave_speed[k] / exact)));
        }
    }
    assert!((1000..8000).contains(&yielded), "{yielded} of 9000 steps yield");
}

#[test]
fn the_stress_of_a_vumat_turns_rigidly_with_the_material() {
    let p = [2e11, 0.3, 2.5e8, 1e9];
    let mut m = Material::new(model("vumat_von_mises.f", MISES), &p, 1).expect("an instance");
    let stress = [3e7, -1e7, 2e7, 5e6, -7e6, 1e6];
    m.set_stress(0, stress);
    // F is integrated exactly only up to the step: a spin by (I + dt W) also stretches by half its square.
    let (steps, angle) = (1000, 1.0);
    let w = angle / f64::from(steps);
    m.set_gradient(0, [0.0, -w, 0.0, w, 0.0, 0.0, 0.0, 0.0, 0.0]);
    for _ in 0..steps {
        m.update().expect("an update");
        m.commit();
    }
    // R of (I + w W) turns by atan(w) each step.
    let r = about_z(f64::from(steps) * w.atan());
    let expected = six(times(r, times(full(stress), transposed(r))));
    assert!(close(&m.stress1(0), &expected, 1e-11), "{:?} {expected:?}", m.stress1(0));
}

#[test]
fn a_vumat_that_answers_nothing_at_time_zero_needs_a_modulus() {
    let yields_at_once = [0.0, 0.3, 1.0, 0.0]; // no stiffness
    let error = Material::new(model("vumat_von_mises.f", MISES), &yields_at_once, 1).err();
    let error = error.expect("no wave speed");
    assert!(error.contains("at time zero") && error.contains("`modulus`"), "{error}");
    let with = MISES.replacen('{', "{\"modulus\": 4e6, ", 1);
    let mut m = Material::new(model("vumat_von_mises.f", &with), &yields_at_once, 1);
    let m = m.as_mut().expect("an instance");
    m.wave_speed().expect("wave speeds");
    assert!((m.wave_speed[0] - 4e3f64.sqrt()).abs() < 1e-9);
}

#[test]
fn states_of_a_vumat_do_not_turn() {
    let sidecar = r#"{"states": [{"key": "b", "kind": "symmetric", "rotation": "objective"}]}"#;
    let error = adapt(&library("vumat_von_mises.f", Some(sidecar))).err().expect("refused");
    assert!(
        error.contains("axes that turn with the material") && error.contains("`rotation`"),
        "{error}"
    );
    let described = states(model("vumat_von_mises.f", MISES)).iter().map(|s| text(s.key));
    assert_eq!(
        described.collect::<Vec<_>>(),
        [
            "equivalent_plastic_strain",
            "displacement_gradient",
            "elastic_energy",
            "plastic_dissipation",
            "creep_dissipation"
        ]
    );
}
