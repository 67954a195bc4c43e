//! Plasticity: what its models share.

use crate::table::State;

/// Equivalent plastic strain [-] as a state variable.
pub const EQUIVALENT_STRAIN: State = State::scalar(
    c"equivalent_plastic_strain",
    c"-",
    c"Sum of sqrt(2/3 de_p : de_p) of the deviatoric plastic strain",
);
