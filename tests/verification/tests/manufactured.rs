//! The body forces of manufactured solutions, taken automatically, are those of the literature and of differences.

use lahar_plugin::nalgebra::{Matrix3, Vector3};
use lahar_verification::motion::Motion;
use std::f64::consts::PI;

/// Points of a ring, times and the amplitude of a motion.
fn samples(inner: f64, outer: f64) -> impl Iterator<Item = ([f64; 3], f64)> {
    (0..40).map(move |n| {
        let part = |k: usize| (0.37 * (n * k) as f64).fract();
        let (r, angle) = (inner + (outer - inner) * part(1), 2.0 * PI * part(2));
        ([r * angle.cos(), r * angle.sin(), part(3)], part(5))
    })
}

#[test]
fn the_force_along_the_axes_is_that_of_wallstedt_and_guilkey() {
    let material = Motion::AxisAligned.material();
    let ((lambda, mu), c) = (material.lame(), material.bar_speed());
    let amplitude = 0.1;
    for (at, t) in samples(0.0, 1.0) {
        let exact = Motion::AxisAligned.exact(3, amplitude, at, t / c);
        let swing = |axis: usize| amplitude * (PI * t + 2.0 * PI / 3.0 * axis as f64).sin();
        let f: Vec<f64> =
            (0..3).map(|axis| 1.0 + PI * swing(axis) * (PI * at[axis]).cos()).collect();
        let log = f.iter().product::<f64>().ln();
        for axis in 0..3 {
            let u = swing(axis) * (PI * at[axis]).sin();
            let square = f[axis] * f[axis];
            let elastic = lambda * (1.0 - log) / square + mu * (1.0 + 1.0 / square);
            let force = PI * PI * u / material.density * (elastic - material.youngs_modulus);
            assert!((exact.body_force[axis] - force).abs() < 1e-9 * material.youngs_modulus);
            assert!((exact.position[axis] - at[axis] - u).abs() < 1e-14);
            assert!((exact.gradient[(axis, axis)] - f[axis]).abs() < 1e-14);
        }
    }
}

#[test]
fn the_force_of_the_vortex_is_that_of_kamojjala_and_others() {
    let (motion, a) = (Motion::Vortex, 1.0);
    let material = motion.material();
    let (mu, rho) = (material.lame().1, material.density);
    for (at, t) in samples(0.75, 1.25) {
        let exact = motion.exact(2, a, at, t);
        let (r, (s, c)) = (at[0].hypot(at[1]), (PI * t).sin_cos());
        let (p, q) = (4.0 * r - 3.0, 4.0 * r - 5.0);
        let radial = -r * (a * c * PI).powi(2) * (p * q).powi(4)
            + 2.0 / rho * 2048.0 * (q * (r - 1.0) * p * a * s).powi(2) * r * mu;
        let cubic = 96.0 * r.powi(3) - 240.0 * r.powi(2) + 188.0 * r - 45.0;
        let around = -a * s * (r * (PI * p * q).powi(2) + 64.0 * mu / rho * cubic);
        let turn = a * s * (1.0 - 32.0 * (r - 1.0).powi(2) + 256.0 * (r - 1.0).powi(4));
        let (sb, cb) = (at[1].atan2(at[0]) + turn).sin_cos();
        let force = Vector3::new(cb * radial - sb * around, sb * radial + cb * around, 0.0);
        let away = (exact.body_force - force).amax();
        assert!(away < 1e-9 * force.amax().max(1.0), "{away:e}");
        assert!((exact.gradient.determinant() - 1.0).abs() < 1e-12, "no change of volume");
    }
}

/// ρ0 (ẍ − b) = Div P with central differences of P = J σ F⁻ᵀ and of the velocity.
#[test]
fn the_force_of_the_expanding_ring_balances_differences_of_its_stress() {
    let motion = Motion::ExpandingRing;
    let material = motion.material();
    let (c, step) = (material.bar_speed(), 1e-5);
    let stress = |at: [f64; 3], t: f64| -> Matrix3<f64> {
        let exact = motion.exact(2, 0.1, at, t);
        let inverse = exact.gradient.try_inverse().expect("a deformation");
        exact.gradient.determinant() * exact.stress * inverse.transpose()
    };
    for (at, t) in samples(0.4, 0.6).map(|(at, t)| (at, t / c)) {
        let exact = motion.exact(2, 0.1, at, t);
        let velocity = |t: f64| motion.exact(2, 0.1, at, t).velocity;
        let dt = step / c;
        let acceleration = (velocity(t + dt) - velocity(t - dt)) / (2.0 * dt);
        let mut divergence = Vector3::zeros();
        for axis in 0..3 {
            let shifted = |by: f64| {
                let mut at = at;
                at[axis] += by;
                stress(at, t)
            };
            divergence += (shifted(step) - shifted(-step)).column(axis) / (2.0 * step);
        }
        let force = acceleration - divergence / material.density;
        let scale = divergence.amax() / material.density + acceleration.amax();
        assert!((exact.body_force - force).amax() < 1e-6 * scale.max(1.0));
    }
}

#[test]
fn the_edges_of_the_rings_are_free_of_stress() {
    for (motion, amplitude) in [(Motion::Vortex, 1.0), (Motion::ExpandingRing, 0.1)] {
        let material = motion.material();
        for r in motion.radii().expect("a ring") {
            let at = [0.6 * r, 0.8 * r, 0.0];
            let exact = motion.exact(2, amplitude, at, 0.3 / material.bar_speed());
            let normal = exact.gradient.try_inverse().expect("a deformation").transpose()
                * Vector3::new(0.6, 0.8, 0.0);
            let traction = (exact.stress * normal).amax();
            assert!(traction < 1e-12 * material.youngs_modulus, "{traction:e}");
        }
        let [inner, outer] = motion.radii().expect("a ring");
        let within = [0.75 * inner + 0.25 * outer, 0.0, 0.0];
        let inside = motion.exact(2, amplitude, within, 0.3 / material.bar_speed());
        assert!(inside.stress.amax() > 1e-2 * material.youngs_modulus, "but not what is between");
    }
}
