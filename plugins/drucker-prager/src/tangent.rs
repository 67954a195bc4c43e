//! The derivative of the step.

use crate::DruckerPrager;
use crate::cone::Cone;
use lahar_plugin::elastic::{Elastic, stiffness};
use lahar_plugin::gap;
use lahar_plugin::tensor::{contract, deviator, trace};

impl DruckerPrager {
    /// Derivative [Pa] of the end stress (rows) by the strain increment (columns); zero for what ends open.
    pub(crate) fn tangent_of(
        &self,
        stress0: [f64; 6],
        opened: f64,
        strain: [f64; 6],
    ) -> [[f64; 6]; 6] {
        let part = gap::loading_part(opened, trace(strain));
        let start = if opened != 0.0 { [0.0; 6] } else { stress0 };
        gap::tangent(opened, strain, self.loading_tangent(start, strain.map(|e| part * e)))
    }

    /// The same for an increment that loads a closed point.
    fn loading_tangent(&self, stress0: [f64; 6], strain: [f64; 6]) -> [[f64; 6]; 6] {
        let (bulk, shear) = (self.bulk_modulus, self.shear_modulus);
        let loaded = self.load(stress0, deviator(strain), trace(strain));
        if loaded.opened != 0.0 {
            return [[0.0; 6]; 6];
        }
        if loaded.plastic_strain == 0.0 {
            return stiffness(self.lame());
        }
        let (s0, e) = (deviator(stress0), deviator(strain));
        let s: [f64; 6] = std::array::from_fn(|c| s0[c] + 2.0 * shear * e[c]);
        let q = (1.5 * contract(s, s)).sqrt();
        let scale = (1.0 - 3.0 * shear * loaded.plastic_strain / q).max(0.0);
        let Cone { slope, dilation, .. } = self.cone;
        let mut tangent = [[0.0; 6]; 6];
        for j in 0..6 {
            // A shear component of the strain stands for both of its places.
            let mut unit = [0.0; 6];
            unit[j] = 1.0;
            let change = deviator(unit);
            let d_q = 3.0 * shear * contract(s, change) / q;
            let d_p = -bulk * trace(unit);
            let d_multiplier = (d_q - slope * d_p) / (3.0 * shear + bulk * slope * dilation);
            let d_p_end = d_p + bulk * dilation * d_multiplier; // [DRP-4]
            let d_scale = ((1.0 - scale) * d_q - 3.0 * shear * d_multiplier) / q;
            for i in 0..6 {
                tangent[i][j] = 2.0 * shear * scale * change[i] + d_scale * s[i];
                tangent[i][j] -= if i < 3 { d_p_end } else { 0.0 };
            }
        }
        tangent
    }
}
