//! What an author implements.

use crate::batch::Batch;
use crate::table::{Input, Kinematics, Output, Parameter, State, Transfer};
use std::ffi::CStr;

/// A constitutive model with one set of parameter values. Instances are shared by threads.
pub trait Model: Sized + Send + Sync + 'static {
    /// Name by which hosts ask for the model: ASCII letters, digits and underscores.
    const NAME: &'static CStr;
    /// One sentence.
    const SUMMARY: &'static CStr;
    /// Where the model is published.
    const REFERENCE: &'static CStr;
    /// Which measure of deformation the model takes; by default the strain increment.
    const KINEMATICS: Kinematics = Kinematics::StrainIncrement;
    /// The parameters, in the order in which `new` gets their values.
    const PARAMETERS: &'static [Parameter];
    /// The state variables, in the order of their components in a batch.
    const STATES: &'static [State] = &[];
    /// The wanted inputs, at most [`MAX_INPUTS`](crate::MAX_INPUTS); their order is that of [`Batch::input`].
    const INPUTS: &'static [Input] = &[];
    /// The outputs beside the stress, by default wave speed and status.
    /// [`Output::WAVE_SPEED`] is mandatory.
    const OUTPUTS: Output = Output::WAVE_SPEED.and(Output::STATUS);
    /// Whether [`Model::tangent`] is written.
    const HAS_TANGENT: bool = false;
    /// Whether [`Model::stored_energy`] is written.
    const HAS_STORED_ENERGY: bool = false;
    /// What becomes of each state variable when points are merged; empty: the mean of all.
    const TRANSFER: &'static [Transfer] = &[];

    /// Makes an instance from one value per parameter; the engine has checked kinds and hard bounds.
    fn new(values: &[f64]) -> Result<Self, String>;

    /// Says whether the values go together; the text of the error is shown to the user.
    fn check(_values: &[f64]) -> Result<(), String> {
        Ok(())
    }

    /// Derives the first state from the start stress and the inputs. The end state holds the initial values on entry.
    fn init_state(&self, _batch: &mut Batch<'_>) -> Result<(), String> {
        Ok(())
    }

    /// Advances all points of the batch by one step: writes the whole end stress and end state, and the outputs.
    /// A point that cannot be updated gets [`PointStatus::Failed`](crate::PointStatus::Failed).
    ///
    /// The function is compiled once per [level of vector instructions](crate::simd); mark it `#[inline(always)]`, or
    /// its loops get those that every processor has. [`Batch::for_each_point`] is the short way.
    fn update(&self, batch: &mut Batch<'_>);

    /// Writes the wave speed (and the diffusivity, if declared) of the points from start stress, start state, inputs and,
    /// if the model takes it, the deformation gradient.
    /// Compiled like `update`.
    fn wave_speed(&self, batch: &mut Batch<'_>);

    /// Derivative [Pa] of the end stress (rows) of point `k` by its strain increment (columns), of the step that `update` makes. A shear
    /// component of the increment stands for both of its places: elasticity has 2 G there.
    fn tangent(&self, _batch: &Batch<'_>, _k: usize) -> [[f64; 6]; 6] {
        [[f64::NAN; 6]; 6]
    }

    /// Energy per current volume [J/m^3] of point `k` at the start that can be had back.
    fn stored_energy(&self, _batch: &Batch<'_>, _k: usize) -> f64 {
        f64::NAN
    }
}
