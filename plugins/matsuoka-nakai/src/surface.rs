//! The surface of Matsuoka and Nakai as a cone q Γ(θ) = M p + k, which has a value everywhere.

/// Yield q Γ(θ) - M p - k, flow potential q Γ(θ) - M_ψ p; θ is 0 in triaxial compression and π/3 in extension.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface {
    /// M [-]
    pub(crate) slope: f64,
    /// k [Pa]
    pub(crate) strength: f64,
    /// M_ψ [-]
    pub(crate) dilation: f64,
    /// β [-]
    beta: f64,
    /// 1 / cos(arccos(-β) / 3) [-]
    norm: f64,
}

/// Γ and its derivatives by θ.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape {
    pub(crate) value: f64,
    pub(crate) first: f64,
    pub(crate) second: f64,
}

impl Surface {
    /// Angles in degrees, cohesion in Pa.
    pub(crate) fn new(friction: f64, cohesion: f64, dilation: f64) -> Self {
        let (sin, cos) = friction.to_radians().sin_cos();
        let sin_psi = dilation.to_radians().sin();
        // I1 I2 / I3 = 9 + 8 tan² φ; in p, q and θ a cubic equation for p / q, whose largest root is a cosine.
        let eight_tan2 = 8.0 * (sin / cos).powi(2);
        let beta = (9.0 + eight_tan2) * eight_tan2.sqrt() / (6.0 + eight_tan2).powf(1.5);
        let beta = beta.min(1.0); // [MTN-1]
        Self {
            slope: 6.0 * sin / (3.0 - sin),
            strength: 6.0 * cohesion * cos / (3.0 - sin),
            dilation: 6.0 * sin_psi / (3.0 - sin_psi),
            beta,
            norm: 1.0 / ((-beta).acos() / 3.0).cos(),
        }
    }

    /// Γ at a Lode angle between 0 and π/3.
    pub(crate) fn shape(&self, theta: f64) -> Shape {
        let beta = self.beta;
        let (sin3, cos3) = (3.0 * theta).sin_cos();
        let angle = (-beta * cos3).acos() / 3.0;
        // 1 - β² cos² 3θ without cancellation.
        let root = (1.0 - beta * beta + (beta * sin3).powi(2)).max(f64::MIN_POSITIVE).sqrt();
        let first = -beta * sin3 / root;
        let second = -3.0 * beta * cos3 * (1.0 - beta * beta) / (root * root * root);
        let (sin, cos) = angle.sin_cos();
        Shape {
            value: self.norm * cos, // [MTN-2]
            first: -self.norm * sin * first,
            second: -self.norm * (cos * first * first + sin * second),
        }
    }

    /// M p + k [Pa].
    pub(crate) fn capacity(&self, p: f64) -> f64 {
        self.slope * p + self.strength
    }
}

/// Mean tension at the apex, c cot φ; infinite without friction [Pa].
pub(crate) fn apex(friction: f64, cohesion: f64) -> f64 {
    if friction > 0.0 { cohesion / friction.to_radians().tan() } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn the_shape_is_the_strength_of_mohr_coulomb_on_both_meridians() {
        for phi in [0.0, 5.0, 30.0, 60.0, 85.0_f64] {
            let (surface, sin) = (Surface::new(phi, 1.0, 0.0), phi.to_radians().sin());
            assert!((surface.shape(0.0).value - 1.0).abs() < 1e-14);
            let extension = surface.shape(PI / 3.0);
            let expected = (3.0 + sin) / (3.0 - sin);
            assert!((extension.value - expected).abs() < 1e-13, "{phi} {}", extension.value);
            assert!(surface.shape(0.0).first == 0.0 && extension.first.abs() < 1e-10);
        }
    }

    #[test]
    fn the_surface_has_the_invariants_of_matsuoka_and_nakai() {
        for phi in [5.0, 30.0, 60.0_f64] {
            let surface = Surface::new(phi, 0.0, 0.0);
            let expected = 9.0 + 8.0 * phi.to_radians().tan().powi(2);
            for n in 0..=20 {
                let theta = PI / 3.0 * f64::from(n) / 20.0;
                let q = surface.slope / surface.shape(theta).value;
                let turn = 2.0 * PI / 3.0;
                let c = [theta, theta - turn, theta + turn].map(|a| 1.0 + 2.0 / 3.0 * q * a.cos());
                let invariant = c.iter().sum::<f64>() * c.iter().map(|x| 1.0 / x).sum::<f64>();
                assert!((invariant / expected - 1.0).abs() < 1e-12, "{phi} {theta}: {invariant}");
                // Negative control: the round cone is another surface, except in compression.
                let round = [theta, theta - turn, theta + turn]
                    .map(|a| 1.0 + 2.0 / 3.0 * surface.slope * a.cos());
                let invariant =
                    round.iter().sum::<f64>() * round.iter().map(|x| 1.0 / x).sum::<f64>();
                assert!(n == 0 || (invariant / expected - 1.0).abs() > 1e-6);
            }
        }
    }

    #[test]
    fn derivatives_are_those_of_differences_and_the_surface_is_convex() {
        for phi in [0.0, 10.0, 30.0, 60.0] {
            let surface = Surface::new(phi, 0.0, 0.0);
            for n in 0..=50 {
                let (theta, h) = (PI / 3.0 * f64::from(n) / 50.0, 1e-5);
                let [below, at, above] = [theta - h, theta, theta + h].map(|t| surface.shape(t));
                assert!(((above.value - below.value) / (2.0 * h) - at.first).abs() < 1e-7);
                assert!(((above.first - below.first) / (2.0 * h) - at.second).abs() < 1e-6);
                assert!(at.value + at.second > 0.0, "{phi} {theta}");
            }
        }
    }
}
