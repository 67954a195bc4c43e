//! The swelling line and its slopes: elasticity whose bulk modulus grows with the pressure.

/// K = v p / κ above the minimum pressure, constant below it. Pressures are those of compression [Pa].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Swelling {
    /// κ [-]
    pub(crate) slope: f64,
    /// G / K [-]
    pub(crate) shear_ratio: f64,
    /// p_min [Pa]
    pub(crate) minimum: f64,
}

impl Swelling {
    /// g: ln(p / p_min), continued by its tangent below p_min. An elastic change of v is -κ times that of g.
    pub(crate) fn measure(&self, p: f64) -> f64 {
        let ratio = p / self.minimum;
        if ratio >= 1.0 { ratio.ln() } else { ratio - 1.0 } // [MCC-1]
    }

    /// The pressure whose measure is g [Pa].
    pub(crate) fn pressure(&self, g: f64) -> f64 {
        self.minimum * if g >= 0.0 { g.exp() } else { 1.0 + g }
    }

    /// dp/dg [Pa].
    pub(crate) fn slope_at(&self, p: f64) -> f64 {
        p.max(self.minimum)
    }

    /// The secant (p1 - p0) / (g1 - g0) [Pa] and its derivative by p1 [-].
    pub(crate) fn secant(&self, p0: f64, p1: f64) -> (f64, f64) {
        let least = self.minimum;
        if p0 <= least && p1 <= least {
            return (least, 0.0);
        }
        if p0 >= least && p1 >= least {
            let x = (p1 / p0).ln();
            if x.abs() < 1e-4 {
                let mean = p0 * (1.0 + x * (0.5 + x * (1.0 / 6.0 + x / 24.0)));
                return (mean, 0.5 - x * (1.0 / 6.0 - x / 24.0));
            }
            let mean = (p1 - p0) / x;
            return (mean, (1.0 - mean / p1) / x);
        }
        let change = self.measure(p1) - self.measure(p0);
        let mean = (p1 - p0) / change;
        let derivative = (1.0 - mean / self.slope_at(p1)) / change;
        (mean, if change.abs() < 1e-7 { 0.0 } else { derivative })
    }
}

/// The specific volume 1 + e with which compression lines are straight: v itself between 1 and the loosest state that
/// carries load, and continued beyond both by its tangents over ln v, so that grains without voids stay compressible no
/// more than the lines say, and a point that has opened does not stiffen as it flies apart.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SpecificVolume {
    /// v without stress after normal compression to the minimum pressure [-]
    pub(crate) loosest: f64,
}

/// What a strain does to the specific volume.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Compression {
    /// By how much v falls [-].
    pub(crate) fall: f64,
    /// Its derivative by the compressive strain [-].
    pub(crate) slope: f64,
    /// fall / strain [-].
    pub(crate) mean: f64,
    /// Derivative of that by the strain [-].
    pub(crate) mean_slope: f64,
    /// The void ratio at the end [-].
    pub(crate) void_ratio: f64,
}

impl SpecificVolume {
    /// The continued specific volume of v.
    pub(crate) fn of(&self, v: f64) -> f64 {
        let within = self.slope(v);
        within * (1.0 + (v / within).ln())
    }

    /// Derivative by -ln v.
    pub(crate) fn slope(&self, v: f64) -> f64 {
        v.clamp(1.0, self.loosest)
    }

    /// Compression of a point of specific volume `v0` by a logarithmic volumetric strain.
    pub(crate) fn compress(&self, v0: f64, strain: f64) -> Compression {
        let change = v0 * (-strain).exp_m1();
        let v1 = v0 + change;
        let (slope0, slope) = (self.slope(v0), self.slope(v1));
        let inside = slope0 == v0 && slope == v1;
        let fall = if inside {
            -change // [MCC-2]
        } else if slope0 == slope {
            slope * strain
        } else {
            self.of(v0) - self.of(v1)
        };
        let mean = if strain == 0.0 { slope0 } else { fall / strain };
        let mean_slope = if strain.abs() > 1e-6 {
            (slope - mean) / strain
        } else if inside {
            -0.5 * slope
        } else {
            0.0
        };
        Compression { fall, slope, mean, mean_slope, void_ratio: v1 - 1.0 }
    }
}
