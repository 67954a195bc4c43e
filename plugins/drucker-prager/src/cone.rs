//! Slope and strength of the cone that meets Mohr-Coulomb in one kind of loading.

/// In which kind of loading the cone has the strength (and the dilation) of Mohr-Coulomb.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ConeKind {
    /// σ1 > σ2 = σ3, compression positive.
    Compression,
    /// σ1 = σ2 > σ3, compression positive.
    Extension,
    /// Flow without strain along z.
    PlaneStrain,
}

impl ConeKind {
    /// In the order of the parameter's choices.
    pub(crate) const ALL: [ConeKind; 3] =
        [ConeKind::Compression, ConeKind::Extension, ConeKind::PlaneStrain];
}

/// Yield q = slope p + strength, flow potential q - dilation p.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cone {
    /// M [-]
    pub(crate) slope: f64,
    /// k [Pa]
    pub(crate) strength: f64,
    /// M_ψ [-]
    pub(crate) dilation: f64,
}

impl Cone {
    /// Angles in degrees, cohesion in Pa.
    ///
    /// Plane strain: flow without strain along z needs s_zz = -2/9 M_ψ q. With the in-plane radius t and mean
    /// compression P this gives t = q sqrt((9 - M_ψ²) / 27) and P = p - M_ψ q / 9; t = P sin φ + c cos φ and
    /// sin ψ = M_ψ q / (3 t) are solved for M, k and M_ψ.
    pub(crate) fn new(kind: ConeKind, friction: f64, cohesion: f64, dilation: f64) -> Self {
        let (sin_phi, cos_phi) = friction.to_radians().sin_cos();
        let sin_psi = dilation.to_radians().sin();
        let root = (3.0 + sin_psi * sin_psi).sqrt();
        let (factor, dilation) = match kind {
            ConeKind::Compression => (6.0 / (3.0 - sin_phi), 6.0 * sin_psi / (3.0 - sin_psi)),
            ConeKind::Extension => (6.0 / (3.0 + sin_phi), 6.0 * sin_psi / (3.0 + sin_psi)),
            ConeKind::PlaneStrain => (3.0 * root / (3.0 + sin_phi * sin_psi), 3.0 * sin_psi / root),
        };
        Self { slope: factor * sin_phi, strength: factor * cohesion * cos_phi, dilation } // [DRP-1]
    }
}

/// Mean tension at the apex, c cot φ, the same for every cone; infinite without friction [Pa].
pub(crate) fn apex(friction: f64, cohesion: f64) -> f64 {
    if friction > 0.0 { cohesion / friction.to_radians().tan() } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plane_strain_match_has_both_known_limits() {
        for phi in [5.0, 20.0, 30.0, 45.0_f64] {
            let (sin, cos) = phi.to_radians().sin_cos();
            let tan = sin / cos;
            let isochoric = Cone::new(ConeKind::PlaneStrain, phi, 10.0, 0.0);
            assert!((isochoric.slope - 3.0_f64.sqrt() * sin).abs() < 1e-14);
            assert!((isochoric.strength - 3.0_f64.sqrt() * 10.0 * cos).abs() < 1e-13);
            assert_eq!(isochoric.dilation, 0.0);
            let associated = Cone::new(ConeKind::PlaneStrain, phi, 10.0, phi);
            let expected = 3.0 * 3.0_f64.sqrt() * tan / (9.0 + 12.0 * tan * tan).sqrt();
            assert!((associated.slope - expected).abs() < 1e-14);
            assert!((associated.dilation - expected).abs() < 1e-14);
        }
    }

    #[test]
    fn constants_are_those_of_the_tables() {
        let values = [
            (ConeKind::Compression, 1.2, 20.784610),
            (ConeKind::Extension, 0.857143, 14.846150),
            (ConeKind::PlaneStrain, 0.832050, 14.411534),
        ];
        for (kind, slope, strength) in values {
            let cone = Cone::new(kind, 30.0, 10.0, 30.0);
            assert!((cone.slope - slope).abs() < 5e-7, "{kind:?}");
            assert!((cone.strength - strength).abs() < 5e-7, "{kind:?}");
            // All cones end at the same point.
            assert!((cone.strength / cone.slope - apex(30.0, 10.0)).abs() < 1e-12);
        }
    }
}
