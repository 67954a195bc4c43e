//! The memory of a point that has opened: compression must first undo the volumetric strain of opening.

use crate::table::State;

/// The volumetric strain [-] by which a point is open as a state variable.
pub const OPENED_STRAIN: State = State::scalar(
    c"opened_volumetric_strain",
    c"-",
    c"Volumetric strain that compression must undo before the point carries stress again",
);

/// The part of a strain increment that loads a point: all of it, unless the point was open by the volumetric strain `opened`.
/// Then it is what remains when the gap has closed, or nothing while the gap stays. Written without branches.
#[inline(always)]
pub fn loading_part(opened: f64, volumetric: f64) -> f64 {
    let gap = opened + volumetric;
    let after_closing = gap / volumetric;
    let part = if opened != 0.0 { after_closing } else { 1.0 };
    if (opened != 0.0) & (gap >= 0.0) { 0.0 } else { part }
}

/// The derivative of the end stress by the whole strain increment, from that by the part that loads the point (rows: stress,
/// columns: strain, a shear strain for both of its places).
pub fn tangent(opened: f64, strain: [f64; 6], loading: [[f64; 6]; 6]) -> [[f64; 6]; 6] {
    let volumetric = strain[0] + strain[1] + strain[2];
    let part = loading_part(opened, volumetric);
    let turns = opened != 0.0 && part != 0.0;
    let change = if turns { -opened / (volumetric * volumetric) } else { 0.0 };
    loading.map(|row| {
        let along: f64 = (0..6).map(|j| row[j] * strain[j]).sum();
        std::array::from_fn(|j| part * row[j] + if j < 3 { along * change } else { 0.0 })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_remains_after_closing_loads_a_point() {
        assert_eq!(loading_part(0.0, -0.1), 1.0);
        assert_eq!(loading_part(0.0, 0.0), 1.0);
        assert_eq!(loading_part(0.2, -0.1), 0.0);
        assert_eq!(loading_part(0.2, 0.1), 0.0);
        assert_eq!(loading_part(0.25, -1.0), 0.75);
        assert!(loading_part(f64::NAN, -0.1).is_nan());
    }

    #[test]
    fn the_tangent_of_a_closing_point_is_the_derivative() {
        let c = crate::elastic::stiffness([3.0, 2.0]);
        let stress = |e: [f64; 6]| {
            let part = loading_part(0.25, e[0] + e[1] + e[2]);
            c.map(|row| part * (0..6).map(|j| row[j] * e[j]).sum::<f64>())
        };
        let strain = [-0.5, -0.3, 0.1, 0.2, -0.1, 0.05];
        let found = tangent(0.25, strain, c);
        for j in 0..6 {
            let at = |h: f64| {
                let mut changed = strain;
                changed[j] += h;
                stress(changed)
            };
            let (above, below) = (at(1e-5), at(-1e-5));
            for i in 0..6 {
                assert!((found[i][j] - (above[i] - below[i]) / 2e-5).abs() < 1e-8);
            }
        }
    }
}
