//! Strength as a function of the equivalent plastic strain.

/// How the strength falls from its peak to its residual value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Softening {
    /// It stays at the peak.
    None,
    /// By the factor e in every softening strain.
    Exponential,
    /// In a straight line until the softening strain.
    Linear,
}

impl Softening {
    /// In the order of the parameter's choices.
    pub(crate) const ALL: [Softening; 3] =
        [Softening::None, Softening::Exponential, Softening::Linear];
}

/// Angles of friction and dilation [rad] and cohesion [Pa].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Angles {
    pub(crate) friction: f64,
    pub(crate) cohesion: f64,
    pub(crate) dilation: f64,
}

/// Peak, residual and what is between.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Law {
    pub(crate) softening: Softening,
    pub(crate) peak: Angles,
    pub(crate) residual: Angles,
    /// Largest principal tension at the peak [Pa].
    pub(crate) tension_cutoff: f64,
    /// Equivalent plastic strain of softening [-].
    pub(crate) softening_strain: f64,
}

/// The constants of the planes at one plastic strain; also their derivative by it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Strength {
    /// sin φ [-]
    pub(crate) sin_friction: f64,
    /// sin ψ [-]
    pub(crate) sin_dilation: f64,
    /// 2 c cos φ [Pa]
    pub(crate) cohesion: f64,
    /// Largest principal tension [Pa].
    pub(crate) tension: f64,
}

impl Law {
    /// The strength at the equivalent plastic strain `kappa` and its derivative.
    pub(crate) fn at(&self, kappa: f64) -> [Strength; 2] {
        let x = kappa / self.softening_strain;
        let [weight, slope] = match self.softening {
            Softening::None => [1.0, 0.0],
            Softening::Exponential => [(-x).exp(), -(-x).exp() / self.softening_strain], // [MHC-4]
            Softening::Linear if x < 1.0 => [1.0 - x, -1.0 / self.softening_strain],
            Softening::Linear => [0.0, 0.0],
        };
        let (peak, residual) = (self.peak, self.residual);
        let between = |peak: f64, residual: f64| {
            [residual + weight * (peak - residual), slope * (peak - residual)]
        };
        let friction = between(peak.friction, residual.friction);
        let cohesion = between(peak.cohesion, residual.cohesion);
        let dilation = between(peak.dilation, residual.dilation);
        let (sin, cos) = friction[0].sin_cos();
        // The cut-off falls like the cohesion, hence stays below the apex.
        let tension = match peak.cohesion > 0.0 {
            true => cohesion.map(|c| self.tension_cutoff * c / peak.cohesion),
            false => [self.tension_cutoff, 0.0],
        };
        let strength = Strength {
            sin_friction: sin,
            sin_dilation: dilation[0].sin(),
            cohesion: 2.0 * cohesion[0] * cos,
            tension: tension[0],
        };
        let derivative = Strength {
            sin_friction: cos * friction[1],
            sin_dilation: dilation[0].cos() * dilation[1],
            cohesion: 2.0 * (cohesion[1] * cos - cohesion[0] * sin * friction[1]),
            tension: tension[1],
        };
        [strength, derivative]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(softening: Softening) -> Law {
        Law {
            softening,
            peak: Angles { friction: 0.6, cohesion: 10e3, dilation: 0.3 },
            residual: Angles { friction: 0.4, cohesion: 2e3, dilation: 0.0 },
            tension_cutoff: 5e3,
            softening_strain: 0.05,
        }
    }

    #[test]
    fn derivatives_of_the_strength_are_those_of_differences() {
        for softening in Softening::ALL {
            for kappa in [0.0, 0.01, 0.03, 0.08] {
                let (law, h) = (law(softening), 1e-6);
                let derivative = law.at(kappa)[1];
                let (above, below) = (law.at(kappa + h)[0], law.at(kappa - h)[0]);
                let close = |d: f64, above: f64, below: f64, scale: f64| {
                    assert!(((above - below) / (2.0 * h) - d).abs() < 1e-6 * scale / h, "{d}");
                };
                close(derivative.sin_friction, above.sin_friction, below.sin_friction, 1.0);
                close(derivative.sin_dilation, above.sin_dilation, below.sin_dilation, 1.0);
                close(derivative.cohesion, above.cohesion, below.cohesion, 10e3);
                close(derivative.tension, above.tension, below.tension, 5e3);
            }
        }
    }

    #[test]
    fn strength_goes_from_the_peak_to_the_residual_one() {
        for softening in Softening::ALL {
            let [start, _] = law(softening).at(0.0);
            assert!((start.sin_friction - 0.6_f64.sin()).abs() < 1e-15);
            assert_eq!((start.tension, start.cohesion), (5e3, 20e3 * 0.6_f64.cos()));
            let [end, _] = law(softening).at(5.0);
            let friction: f64 = if softening == Softening::None { 0.6 } else { 0.4 };
            assert!((end.sin_friction - friction.sin()).abs() < 1e-15);
        }
        let [half, _] = law(Softening::Linear).at(0.025);
        assert!((half.sin_friction - 0.5_f64.sin()).abs() < 1e-15);
        assert!((half.tension - 3e3).abs() < 1e-9);
        let [once, _] = law(Softening::Exponential).at(0.05);
        assert!((once.sin_dilation - (0.3 / 1.0_f64.exp()).sin()).abs() < 1e-15);
    }
}
