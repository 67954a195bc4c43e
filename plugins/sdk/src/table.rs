//! The static tables of the plugin ABI, built from constants.

use crate::batch::MAX_INPUTS;
use crate::model::Model;
use crate::wall;
use lahar_plugin_abi::*;
use std::ffi::{CStr, c_char, c_void};
use std::marker::PhantomData;
use std::ops::BitOr;
use std::ptr;

/// Which measure of deformation a model takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Kinematics {
    /// dt sym L [-]; the engine has turned the start stress by exp(W dt), W = skw L (Jaumann).
    StrainIncrement = LAHAR_KINEMATICS_STRAIN_INCREMENT,
    /// L [1/s]; the model rotates the stress itself.
    VelocityGradient = LAHAR_KINEMATICS_VELOCITY_GRADIENT,
    /// F at the end of the step [-].
    DeformationGradient = LAHAR_KINEMATICS_DEFORMATION_GRADIENT,
    /// dt sym L [-]; the engine has turned the start stress by the increment of the rotation R of F = R U.
    GreenNaghdi = LAHAR_KINEMATICS_GREEN_NAGHDI,
}

/// A value that the engine gives beside the deformation, one per point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Input {
    /// Mass density at the end of the step [kg/m^3].
    Density = LAHAR_INPUT_DENSITY,
    /// Grid spacing [m].
    ElementLength = LAHAR_INPUT_ELEMENT_LENGTH,
    /// Temperature [K].
    Temperature = LAHAR_INPUT_TEMPERATURE,
    /// Specific internal energy at the start of the step [J/kg].
    InternalEnergy = LAHAR_INPUT_INTERNAL_ENERGY,
    /// Pore pressure, compression positive [Pa].
    PorePressure = LAHAR_INPUT_PORE_PRESSURE,
    /// x of the position [m].
    PositionX = LAHAR_INPUT_POSITION_X,
    /// y of the position [m].
    PositionY = LAHAR_INPUT_POSITION_Y,
    /// z of the position [m].
    PositionZ = LAHAR_INPUT_POSITION_Z,
    /// Id of the particle inside its body [-].
    ParticleId = LAHAR_INPUT_PARTICLE_ID,
}

/// What becomes of a state variable when points are merged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Transfer {
    /// The mean, weighted by mass.
    Mean = LAHAR_TRANSFER_MEAN,
    /// The largest, component by component.
    Max = LAHAR_TRANSFER_MAX,
    /// Points that differ in it are not merged.
    Never = LAHAR_TRANSFER_NEVER,
}

/// A set of outputs; join them with `|` in run-time code and with [`Output::and`] in constants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Output(u64);

impl Output {
    /// Speed of the fastest wave [m/s].
    pub const WAVE_SPEED: Self = Self(LAHAR_OUTPUT_WAVE_SPEED);
    /// Kinematic diffusivity [m^2/s].
    pub const DIFFUSIVITY: Self = Self(LAHAR_OUTPUT_DIFFUSIVITY);
    /// Energy per current volume, stored or internal [J/m^3].
    pub const ENERGY: Self = Self(LAHAR_OUTPUT_ENERGY);
    /// Wanted factor on the next time step [-].
    pub const DT_FACTOR: Self = Self(LAHAR_OUTPUT_DT_FACTOR);
    /// Status per point.
    pub const STATUS: Self = Self(LAHAR_OUTPUT_STATUS);

    /// Both sets.
    pub const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether all of `other` is in this set.
    pub const fn has(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }
}

impl BitOr for Output {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        self.and(other)
    }
}

/// One material parameter.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct Parameter(lahar_parameter_desc);

impl Parameter {
    const fn new(
        kind: i32,
        key: &'static CStr,
        symbol: &'static CStr,
        unit: &'static CStr,
        description: &'static CStr,
    ) -> Self {
        Self(lahar_parameter_desc {
            key: key.as_ptr(),
            symbol: symbol.as_ptr(),
            unit: unit.as_ptr(),
            description: description.as_ptr(),
            kind,
            required: 1,
            default_value: 0.0,
            hard_min: f64::NEG_INFINITY,
            hard_max: f64::INFINITY,
            advised_min: f64::NEG_INFINITY,
            advised_max: f64::INFINITY,
            choices: ptr::null(),
        })
    }

    /// A required real number without bounds.
    pub const fn real(
        key: &'static CStr,
        symbol: &'static CStr,
        unit: &'static CStr,
        description: &'static CStr,
    ) -> Self {
        Self::new(LAHAR_PARAMETER_REAL, key, symbol, unit, description)
    }

    /// A required whole number without bounds.
    pub const fn integer(
        key: &'static CStr,
        symbol: &'static CStr,
        unit: &'static CStr,
        description: &'static CStr,
    ) -> Self {
        Self::new(LAHAR_PARAMETER_INTEGER, key, symbol, unit, description)
    }

    /// The same parameter without a default, which becomes its typical value.
    pub const fn required(mut self) -> Self {
        self.0.required = 1;
        self
    }

    /// One of the labels in `choices`, which are separated by `|` and counted from 0; the default is `default`.
    pub const fn choice(
        key: &'static CStr,
        choices: &'static CStr,
        default: usize,
        description: &'static CStr,
    ) -> Self {
        let mut parameter = Self::new(LAHAR_PARAMETER_CHOICE, key, c"", c"-", description);
        let mut last = 0.0;
        let bytes = choices.to_bytes();
        let mut i = 0;
        while i < bytes.len() {
            if bytes[i] == b'|' {
                last += 1.0;
            }
            i += 1;
        }
        parameter.0.choices = choices.as_ptr();
        parameter.default(default as f64).hard(0.0, last)
    }

    /// The same parameter with another description.
    pub const fn described(mut self, text: &'static CStr) -> Self {
        self.0.description = text.as_ptr();
        self
    }

    /// The same parameter with a default value, hence not required.
    pub const fn default(mut self, value: f64) -> Self {
        self.0.required = 0;
        self.0.default_value = value;
        self
    }

    /// The same parameter, still required, with a typical value: tools try the model with it.
    pub const fn typical(mut self, value: f64) -> Self {
        self.0.default_value = value;
        self
    }

    /// The same parameter with bounds outside which a value is refused.
    pub const fn hard(mut self, min: f64, max: f64) -> Self {
        self.0.hard_min = min;
        self.0.hard_max = max;
        self
    }

    /// The same parameter with bounds outside which a warning is logged.
    pub const fn advised(mut self, min: f64, max: f64) -> Self {
        self.0.advised_min = min;
        self.0.advised_max = max;
        self
    }
}

/// One state variable.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct State(lahar_state_desc);

impl State {
    const fn new(
        kind: i32,
        rotation: i32,
        key: &'static CStr,
        unit: &'static CStr,
        description: &'static CStr,
    ) -> Self {
        Self(lahar_state_desc {
            key: key.as_ptr(),
            unit: unit.as_ptr(),
            description: description.as_ptr(),
            kind,
            rotation,
            initial: 0.0,
        })
    }

    /// One component, 0 at the start.
    pub const fn scalar(key: &'static CStr, unit: &'static CStr, text: &'static CStr) -> Self {
        Self::new(LAHAR_STATE_SCALAR, LAHAR_ROTATION_NONE, key, unit, text)
    }

    /// Six components, 0 at the start, rotated with the material by the engine.
    pub const fn symmetric(key: &'static CStr, unit: &'static CStr, text: &'static CStr) -> Self {
        Self::new(LAHAR_STATE_SYMMETRIC, LAHAR_ROTATION_OBJECTIVE, key, unit, text)
    }

    /// Nine components, row-major, 0 at the start, left alone by the engine.
    pub const fn tensor(key: &'static CStr, unit: &'static CStr, text: &'static CStr) -> Self {
        Self::new(LAHAR_STATE_TENSOR, LAHAR_ROTATION_NONE, key, unit, text)
    }

    /// The same variable with another initial value of every component.
    pub const fn initial(mut self, value: f64) -> Self {
        self.0.initial = value;
        self
    }

    /// Number of components.
    pub const fn components(&self) -> usize {
        match self.0.kind {
            LAHAR_STATE_SCALAR => 1,
            LAHAR_STATE_VECTOR => 3,
            LAHAR_STATE_SYMMETRIC => 6,
            _ => 9,
        }
    }
}

/// Number of components of all state variables.
pub(crate) const fn state_components(states: &[State]) -> usize {
    let mut sum = 0;
    let mut i = 0;
    while i < states.len() {
        sum += states[i].components();
        i += 1;
    }
    sum
}

/// The table of one model.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct ModelTable(&'static lahar_model_desc);

impl ModelTable {
    /// The table of `M`. Mistakes in its constants that would make no sense to any engine stop the compilation.
    pub const fn of<M: Model>() -> Self {
        Self(Table::<M>::DESC)
    }

    /// The C table.
    pub const fn desc(&self) -> &'static lahar_model_desc {
        self.0
    }
}

struct Table<M>(PhantomData<M>);

impl<M: Model> Table<M> {
    const DESC: &'static lahar_model_desc = &Self::desc();

    const fn desc() -> lahar_model_desc {
        assert!(M::INPUTS.len() <= MAX_INPUTS, "more inputs than MAX_INPUTS");
        assert!(M::OUTPUTS.has(Output::WAVE_SPEED), "every model must give the wave speed");
        lahar_model_desc {
            struct_size: size_of::<lahar_model_desc>() as u32,
            kinematics: M::KINEMATICS as i32,
            name: M::NAME.as_ptr(),
            summary: M::SUMMARY.as_ptr(),
            reference: M::REFERENCE.as_ptr(),
            parameter_count: M::PARAMETERS.len() as u32,
            parameter_size: size_of::<lahar_parameter_desc>() as u32,
            parameters: table_of(M::PARAMETERS),
            state_count: M::STATES.len() as u32,
            state_size: size_of::<lahar_state_desc>() as u32,
            states: table_of(M::STATES),
            input_count: M::INPUTS.len() as u32,
            required_minor: 0,
            inputs: table_of(M::INPUTS),
            outputs: M::OUTPUTS.0,
            capabilities: LAHAR_CAPABILITY_THREAD_SAFE
                | LAHAR_CAPABILITY_POINTWISE
                | LAHAR_CAPABILITY_DETERMINISTIC
                | if M::HAS_TANGENT { LAHAR_CAPABILITY_TANGENT } else { 0 },
            create: Some(wall::create::<M>),
            destroy: Some(wall::destroy::<M>),
            check: Some(wall::check::<M>),
            init_state: Some(wall::init_state::<M>),
            update: Some(wall::update::<M>),
            wave_speed: Some(wall::wave_speed::<M>),
            get_extension: Some(get_extension::<M>),
        }
    }
}

/// The tables of the extensions that a model offers.
struct Extensions<M>(PhantomData<M>);

impl<M: Model> Extensions<M> {
    const TANGENT: &'static lahar_tangent_extension = &lahar_tangent_extension {
        struct_size: size_of::<lahar_tangent_extension>() as u32,
        reserved: 0,
        tangent: Some(wall::tangent::<M>),
    };
    const ENERGY: &'static lahar_energy_extension = &lahar_energy_extension {
        struct_size: size_of::<lahar_energy_extension>() as u32,
        reserved: 0,
        stored: Some(wall::stored_energy::<M>),
    };
    const TRANSFER: &'static lahar_transfer_extension = &{
        assert!(
            M::TRANSFER.is_empty() || M::TRANSFER.len() == M::STATES.len(),
            "TRANSFER has one rule per state variable, or none"
        );
        lahar_transfer_extension {
            struct_size: size_of::<lahar_transfer_extension>() as u32,
            count: M::TRANSFER.len() as u32,
            rules: table_of(M::TRANSFER),
        }
    };
}

unsafe extern "C" fn get_extension<M: Model>(
    _model: *const lahar_model_desc,
    id: *const c_char,
) -> *const c_void {
    if id.is_null() {
        return ptr::null();
    }
    // SAFETY: the ABI gives a text that ends with a NUL.
    match unsafe { CStr::from_ptr(id) }.to_bytes() {
        b"lahar.tangent" if M::HAS_TANGENT => ptr::from_ref(Extensions::<M>::TANGENT).cast(),
        b"lahar.energy" if M::HAS_STORED_ENERGY => ptr::from_ref(Extensions::<M>::ENERGY).cast(),
        b"lahar.transfer" if !M::TRANSFER.is_empty() => {
            ptr::from_ref(Extensions::<M>::TRANSFER).cast()
        }
        _ => ptr::null(),
    }
}

/// Pointer to the first element as the C type that `T` transparently wraps; NULL for an empty table.
const fn table_of<T, C>(items: &'static [T]) -> *const C {
    assert!(size_of::<T>() == size_of::<C>() && align_of::<T>() == align_of::<C>());
    if items.is_empty() { ptr::null() } else { items.as_ptr().cast() }
}

/// What a plugin is: its identity and its models.
#[repr(transparent)]
pub struct Plugin(lahar_plugin_desc);

impl Plugin {
    /// A plugin without author, licence and address.
    pub const fn new(
        id: &'static CStr,
        version: &'static CStr,
        models: &'static [ModelTable],
    ) -> Self {
        assert!(!models.is_empty(), "a plugin has at least one model");
        Self(lahar_plugin_desc {
            struct_size: size_of::<lahar_plugin_desc>() as u32,
            abi_major: LAHAR_PLUGIN_ABI_MAJOR,
            abi_minor: LAHAR_PLUGIN_ABI_MINOR,
            model_count: models.len() as u32,
            id: id.as_ptr(),
            version: version.as_ptr(),
            author: EMPTY,
            licence: EMPTY,
            url: EMPTY,
            models: models.as_ptr().cast(),
        })
    }

    /// The same plugin with its author.
    pub const fn author(mut self, text: &'static CStr) -> Self {
        self.0.author = text.as_ptr();
        self
    }

    /// The same plugin with its SPDX licence expression.
    pub const fn licence(mut self, text: &'static CStr) -> Self {
        self.0.licence = text.as_ptr();
        self
    }

    /// The same plugin with the address where it is found.
    pub const fn url(mut self, text: &'static CStr) -> Self {
        self.0.url = text.as_ptr();
        self
    }

    /// The C table.
    pub const fn desc(&'static self) -> &'static lahar_plugin_desc {
        &self.0
    }

    /// The C table for a host that links the plugin statically, after its own table has been kept.
    pub fn entered(&'static self, host: &'static lahar_host_api) -> LinkedPlugin {
        wall::set_host(host);
        // SAFETY: the table is made of constants by this crate, and its functions are those of `wall`.
        unsafe { LinkedPlugin::new(self.desc()) }
    }
}

const EMPTY: *const c_char = c"".as_ptr();

/// Turns a text that ends with a NUL into a C string, in constants: `c_text(concat!(env!("CARGO_PKG_VERSION"), "\0"))`.
pub const fn c_text(text: &'static str) -> &'static CStr {
    match CStr::from_bytes_with_nul(text.as_bytes()) {
        Ok(text) => text,
        Err(_) => panic!("the text must hold one NUL, at its end"),
    }
}
