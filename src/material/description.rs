//! What plugins and models say about themselves, checked and copied out of their tables.
//!
//! Texts come as `&str` for Rust and, with the suffix `_c`, as the C string that the C interface
//! hands out. Both live as long as the process, as the plugins do.

use crate::plugin::Functions;
use lahar_plugin_abi as abi;
use std::ffi::CStr;
use std::path::PathBuf;

/// A loaded plugin.
pub struct Plugin {
    /// Reverse domain name or the like.
    pub id: &'static str,
    /// The same.
    pub id_c: &'static CStr,
    /// Version of the plugin.
    pub version: &'static str,
    /// The same.
    pub version_c: &'static CStr,
    /// Who wrote it.
    pub author: &'static str,
    /// The same.
    pub author_c: &'static CStr,
    /// SPDX licence expression.
    pub licence: &'static str,
    /// The same.
    pub licence_c: &'static CStr,
    /// Its address in the web; may be empty.
    pub url: &'static str,
    /// The same.
    pub url_c: &'static CStr,
    /// Canonical path of the file.
    pub path: PathBuf,
    /// The same.
    pub path_c: &'static CStr,
    /// Minor version of the plugin ABI that the plugin was built with.
    pub abi_minor: u32,
    /// The models, at least one.
    pub models: Vec<Model>,
}

/// One constitutive model of a plugin.
pub struct Model {
    /// Name by which hosts ask for the model.
    pub name: &'static str,
    /// The same.
    pub name_c: &'static CStr,
    /// One sentence.
    pub summary: &'static str,
    /// The same.
    pub summary_c: &'static CStr,
    /// Where the model is published.
    pub reference: &'static str,
    /// The same.
    pub reference_c: &'static CStr,
    /// Id of the plugin.
    pub plugin_id: &'static str,
    /// Which measure of deformation the model takes.
    pub kinematics: Kinematics,
    /// The parameters.
    pub parameters: Vec<Parameter>,
    /// The state variables, in the order of their components in a batch.
    pub states: Vec<StateVariable>,
    /// The wanted inputs.
    pub inputs: Vec<Input>,
    /// Sum of `LAHAR_OUTPUT_*`.
    pub outputs: u64,
    /// Sum of `LAHAR_CAPABILITY_*`.
    pub capabilities: u64,
    pub(crate) functions: Functions,
}

impl Model {
    /// Number of components of all state variables of a point.
    pub fn state_components(&self) -> usize {
        self.states.iter().map(|s| s.kind.components()).sum()
    }

    /// Whether the model gives all outputs of `mask`, a sum of `LAHAR_OUTPUT_*`.
    pub fn gives(&self, mask: u64) -> bool {
        self.outputs & mask == mask
    }

    /// Whether [`Material::tangent`](super::Material::tangent) gives something.
    pub fn offers_tangent(&self) -> bool {
        self.functions.offers_tangent()
    }

    /// Whether [`Material::stored_energy`](super::Material::stored_energy) gives something.
    pub fn offers_stored_energy(&self) -> bool {
        self.functions.offers_stored_energy()
    }

    /// Index of an input among those that the model wants.
    pub fn input(&self, input: Input) -> Option<usize> {
        self.inputs.iter().position(|i| *i == input)
    }
}

/// Which measure of deformation a model takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Kinematics {
    /// The strain increment dt sym L; the engine turns the start stress by exp(W dt), W = skw L
    /// (Jaumann).
    StrainIncrement = abi::LAHAR_KINEMATICS_STRAIN_INCREMENT,
    /// The velocity gradient; the start stress arrives unrotated.
    VelocityGradient = abi::LAHAR_KINEMATICS_VELOCITY_GRADIENT,
    /// The deformation gradient at the end of the step; the start stress arrives unrotated.
    DeformationGradient = abi::LAHAR_KINEMATICS_DEFORMATION_GRADIENT,
    /// The strain increment dt sym L; the engine turns the start stress by the increment of the
    /// rotation R of F = R U.
    GreenNaghdi = abi::LAHAR_KINEMATICS_GREEN_NAGHDI,
}

impl Kinematics {
    /// Whether the model is given the strain increment.
    pub fn takes_strain_increment(self) -> bool {
        matches!(self, Self::StrainIncrement | Self::GreenNaghdi)
    }

    /// Whether the particles of such a model carry the deformation gradient.
    pub fn carries_deformation_gradient(self) -> bool {
        matches!(self, Self::DeformationGradient | Self::GreenNaghdi)
    }
}

/// A value per point that the engine gives beside the deformation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Input {
    /// Mass density at the end of the step [kg/m^3].
    Density = abi::LAHAR_INPUT_DENSITY,
    /// Grid spacing [m].
    ElementLength = abi::LAHAR_INPUT_ELEMENT_LENGTH,
    /// Temperature [K].
    Temperature = abi::LAHAR_INPUT_TEMPERATURE,
    /// Specific internal energy at the start of the step [J/kg].
    InternalEnergy = abi::LAHAR_INPUT_INTERNAL_ENERGY,
    /// Pore pressure, compression positive [Pa].
    PorePressure = abi::LAHAR_INPUT_PORE_PRESSURE,
    /// x of the position [m].
    PositionX = abi::LAHAR_INPUT_POSITION_X,
    /// y of the position [m].
    PositionY = abi::LAHAR_INPUT_POSITION_Y,
    /// z of the position [m].
    PositionZ = abi::LAHAR_INPUT_POSITION_Z,
    /// Id of the particle inside its body [-].
    ParticleId = abi::LAHAR_INPUT_PARTICLE_ID,
}

impl Input {
    /// Its name: that of the constant of the plugin ABI in small letters.
    pub fn key(self) -> &'static str {
        match self {
            Input::Density => "density",
            Input::ElementLength => "element_length",
            Input::Temperature => "temperature",
            Input::InternalEnergy => "internal_energy",
            Input::PorePressure => "pore_pressure",
            Input::PositionX => "position_x",
            Input::PositionY => "position_y",
            Input::PositionZ => "position_z",
            Input::ParticleId => "particle_id",
        }
    }
}

/// What becomes of a state variable when points are merged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Transfer {
    /// The mean, weighted by mass.
    Mean = abi::LAHAR_TRANSFER_MEAN,
    /// The largest, component by component.
    Max = abi::LAHAR_TRANSFER_MAX,
    /// Points that differ in it are not merged.
    Never = abi::LAHAR_TRANSFER_NEVER,
}

/// What values a parameter takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum ParameterKind {
    /// A real number.
    Real = abi::LAHAR_PARAMETER_REAL,
    /// A whole number.
    Integer = abi::LAHAR_PARAMETER_INTEGER,
    /// The position of one of the labels.
    Choice = abi::LAHAR_PARAMETER_CHOICE,
}

/// One material parameter.
pub struct Parameter {
    /// Name by which hosts give the value.
    pub key: &'static str,
    /// The same.
    pub key_c: &'static CStr,
    /// Symbol of the literature.
    pub symbol: &'static str,
    /// The same.
    pub symbol_c: &'static CStr,
    /// SI unit.
    pub unit: &'static str,
    /// The same.
    pub unit_c: &'static CStr,
    /// One sentence.
    pub description: &'static str,
    /// The same.
    pub description_c: &'static CStr,
    /// What values it takes.
    pub kind: ParameterKind,
    /// Whether the host must give it.
    pub required: bool,
    /// Value if the host gives none; of a required parameter a typical value, or 0.
    pub default: f64,
    /// Smallest value that is accepted.
    pub hard_min: f64,
    /// Largest value that is accepted.
    pub hard_max: f64,
    /// Below this a warning is logged.
    pub advised_min: f64,
    /// Above this a warning is logged.
    pub advised_max: f64,
    /// Labels of a choice; empty for other kinds.
    pub choices: Vec<&'static str>,
    /// The labels separated by `|`.
    pub choices_c: Option<&'static CStr>,
}

/// How many components a state variable has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum StateKind {
    /// 1 component.
    Scalar = abi::LAHAR_STATE_SCALAR,
    /// 3 components.
    Vector = abi::LAHAR_STATE_VECTOR,
    /// 6 components: xx, yy, zz, xy, yz, zx.
    Symmetric = abi::LAHAR_STATE_SYMMETRIC,
    /// 9 components, row-major.
    Tensor = abi::LAHAR_STATE_TENSOR,
}

impl StateKind {
    /// Number of components.
    pub fn components(self) -> usize {
        match self {
            StateKind::Scalar => 1,
            StateKind::Vector => 3,
            StateKind::Symmetric => 6,
            StateKind::Tensor => 9,
        }
    }
}

/// What a rigid rotation does to a state variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Rotation {
    /// Nothing.
    None = abi::LAHAR_ROTATION_NONE,
    /// The engine rotates it as it does the stress.
    Objective = abi::LAHAR_ROTATION_OBJECTIVE,
}

/// One state variable: a value that a point carries from step to step.
pub struct StateVariable {
    /// Name of the particle field.
    pub key: &'static str,
    /// The same.
    pub key_c: &'static CStr,
    /// SI unit.
    pub unit: &'static str,
    /// The same.
    pub unit_c: &'static CStr,
    /// One sentence.
    pub description: &'static str,
    /// The same.
    pub description_c: &'static CStr,
    /// How many components.
    pub kind: StateKind,
    /// What a rigid rotation does to it.
    pub rotation: Rotation,
    /// What becomes of it when points are merged.
    pub transfer: Transfer,
    /// Initial value of every component.
    pub initial: f64,
}

impl StateVariable {
    /// Number of components.
    pub fn components(&self) -> usize {
        self.kind.components()
    }
}
