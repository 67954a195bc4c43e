//! The contract between lahar and a constitutive model: types and constants only.
//!
//! `include/lahar/lahar_plugin.h` is generated from this file. A plugin is a shared library that
//! exports one function, `lahar_plugin_entry_v1`, and links nothing of lahar. The number in the
//! name is the major version of the ABI; within a major version tables only grow at their end and
//! every table begins with its size.
//!
//! Conventions: the units are the host's, SI or any other consistent ones, so that a model has no
//! constant, no default and no advised bound with a dimension but 0; what it does not require
//! follows from other parameters. Tension positive; symmetric tensors are stored as the tensor
//! components xx, yy, zz, xy, yz, zx; general 3x3 tensors are row-major xx, xy, xz, yx, ...;
//! stresses have 6 and gradients 9 components in plane strain too. Component `c` of point `k` of
//! an array stands at `base[c * stride + k]`.
//!
//! Life of a plugin: `lahar_plugin_entry_v1` once; then `create`, per instance any number of
//! `init_state`, `update`, `wave_speed` and extension calls, then `destroy`. Libraries are never
//! unloaded. Each function has a tag:
//!
//! * `[exclusive]`: one such call at a time in the whole process, on any thread;
//! * `[concurrent]`: on any thread, at the same time as other calls on the same instance and as
//!   exclusive ones. If the model does not declare `LAHAR_CAPABILITY_THREAD_SAFE`, calls of either
//!   kind come one at a time over all such models of the library.
//!
//! No function may unwind, `longjmp`, exit or print, or change the floating-point environment; it
//! is called with traps off. The engine may call `update` with the same start any number of times:
//! the end must depend only on the start, the step and the instance.
//!
//! Versions: tables grow only at their ends, and both sides give their minor version. A plugin that
//! needs a newer engine sets `required_minor` of the model, or refuses in its entry if `abi_minor`
//! of the host table is too low. An engine accepts tables that are longer than those that it knows,
//! and fills a batch up to its own `struct_size`.
#![no_std]
#![allow(non_camel_case_types)]

mod linked;

pub use linked::LinkedPlugin;

use core::ffi::{c_char, c_void};

/// Major version of the plugin ABI; it is part of the entry's name.
pub const LAHAR_PLUGIN_ABI_MAJOR: u32 = 1;
/// Minor version: tables may have grown at their ends since lower minors.
pub const LAHAR_PLUGIN_ABI_MINOR: u32 = 0;

/// The model takes the strain increment; the engine has turned the start stress (and objective
/// state) by exp(W dt), W = skw L: the Jaumann rate.
pub const LAHAR_KINEMATICS_STRAIN_INCREMENT: i32 = 0;
/// The model takes the velocity gradient and does its own rotation: `stress0` arrives unrotated.
pub const LAHAR_KINEMATICS_VELOCITY_GRADIENT: i32 = 1;
/// The model takes the deformation gradient at the end of the step: `stress0` arrives unrotated.
pub const LAHAR_KINEMATICS_DEFORMATION_GRADIENT: i32 = 2;
/// The model takes the strain increment; the engine has turned the start stress (and objective
/// state) by the increment of the rotation R of F = R U instead of by exp(W dt): the Green-Naghdi
/// rate.
pub const LAHAR_KINEMATICS_GREEN_NAGHDI: i32 = 3;

/// A real number.
pub const LAHAR_PARAMETER_REAL: i32 = 0;
/// A whole number, given as a double.
pub const LAHAR_PARAMETER_INTEGER: i32 = 1;
/// One of the labels in `choices`, given by its position 0, 1, ...
pub const LAHAR_PARAMETER_CHOICE: i32 = 2;

/// One component.
pub const LAHAR_STATE_SCALAR: i32 = 0;
/// Three components.
pub const LAHAR_STATE_VECTOR: i32 = 1;
/// Six components: xx, yy, zz, xy, yz, zx.
pub const LAHAR_STATE_SYMMETRIC: i32 = 2;
/// Nine components, row-major.
pub const LAHAR_STATE_TENSOR: i32 = 3;

/// The state variable does not change under a rigid rotation.
pub const LAHAR_ROTATION_NONE: i32 = 0;
/// The engine rotates the state variable with the material before `update`, as it does the stress.
pub const LAHAR_ROTATION_OBJECTIVE: i32 = 1;

/// Input: mass density at the end of the step [kg/m^3].
pub const LAHAR_INPUT_DENSITY: i32 = 1;
/// Input: a length of the discretisation, the grid spacing [m].
pub const LAHAR_INPUT_ELEMENT_LENGTH: i32 = 2;
/// Input: temperature [K], the particle field `temperature` of the host.
pub const LAHAR_INPUT_TEMPERATURE: i32 = 3;
/// Input: specific internal energy at the start of the step [J/kg]: the particle field
/// `strain_energy` over the mass. The field follows the work of the stress, or the output `energy`
/// of a model that gives it.
pub const LAHAR_INPUT_INTERNAL_ENERGY: i32 = 4;
/// Input: pore pressure, compression positive [Pa], the particle field `pore_pressure` of the host.
pub const LAHAR_INPUT_PORE_PRESSURE: i32 = 5;
/// Input: x of the position [m].
pub const LAHAR_INPUT_POSITION_X: i32 = 6;
/// Input: y of the position [m].
pub const LAHAR_INPUT_POSITION_Y: i32 = 7;
/// Input: z of the position [m]; 0 in plane strain.
pub const LAHAR_INPUT_POSITION_Z: i32 = 8;
/// Input: id of the particle inside its body, counted from 0 [-].
pub const LAHAR_INPUT_PARTICLE_ID: i32 = 9;

/// Output: speed of the fastest wave [m/s]; every model must give it.
pub const LAHAR_OUTPUT_WAVE_SPEED: u64 = 1;
/// Output: kinematic diffusivity [m^2/s], for the viscous limit of the time step.
pub const LAHAR_OUTPUT_DIFFUSIVITY: u64 = 2;
/// Output: energy per current volume at the end of the step [J/m^3], stored or internal; replaces
/// the engine's work integral.
pub const LAHAR_OUTPUT_ENERGY: u64 = 4;
/// Output: factor on the time step that the model asks for, in (0, 1] [-]. Below 1 the engine
/// repeats the step with a smaller length if the host allows that, else it shortens the next step.
pub const LAHAR_OUTPUT_DT_FACTOR: u64 = 8;
/// Output: one of the `LAHAR_POINT_*` per point.
pub const LAHAR_OUTPUT_STATUS: u64 = 16;

/// `update`, `init_state` and `wave_speed` may run on one instance from several threads at once.
pub const LAHAR_CAPABILITY_THREAD_SAFE: u64 = 1;
/// A point's result depends on that point alone.
pub const LAHAR_CAPABILITY_POINTWISE: u64 = 2;
/// Equal input gives equal output, bit for bit.
pub const LAHAR_CAPABILITY_DETERMINISTIC: u64 = 4;
/// The extension `lahar.tangent` is offered.
pub const LAHAR_CAPABILITY_TANGENT: u64 = 8;
/// The model may end the process (`STOP` of legacy code); the engine warns when it loads the
/// plugin.
pub const LAHAR_CAPABILITY_MAY_STOP: u64 = 16;
/// The model may print (legacy code); the engine warns when it loads the plugin.
pub const LAHAR_CAPABILITY_MAY_PRINT: u64 = 32;

/// Transfer rule of a state variable when points are merged: the mean, weighted by mass. A split
/// copies.
pub const LAHAR_TRANSFER_MEAN: i32 = 0;
/// Transfer rule: the largest, component by component.
pub const LAHAR_TRANSFER_MAX: i32 = 1;
/// Transfer rule: points that differ in it are not merged.
pub const LAHAR_TRANSFER_NEVER: i32 = 2;

/// The point is updated.
pub const LAHAR_POINT_OK: i32 = 0;
/// The point is updated, but the result is less accurate than promised; the engine logs the first
/// of them.
pub const LAHAR_POINT_UNRELIABLE: i32 = 1;
/// The point is updated, but the model asks for a smaller step: by the factor `dt_factor`, or by
/// one half without that output.
pub const LAHAR_POINT_SMALLER_STEP: i32 = 2;
/// The point could not be updated; its end is not used.
pub const LAHAR_POINT_FAILED: i32 = 3;

/// Return value of a plugin function: done.
pub const LAHAR_PLUGIN_OK: i32 = 0;
/// Return value of a plugin function: not done; `set_error` of the host table may say why.
pub const LAHAR_PLUGIN_ERROR: i32 = 1;

/// Level of `lahar_host_api.log`: something failed.
pub const LAHAR_PLUGIN_LOG_ERROR: i32 = 0;
/// Level: something is unusual.
pub const LAHAR_PLUGIN_LOG_WARNING: i32 = 1;
/// Level: milestones.
pub const LAHAR_PLUGIN_LOG_INFORMATION: i32 = 2;
/// Level: details for finding a fault.
pub const LAHAR_PLUGIN_LOG_DETAIL: i32 = 3;

/// What the engine offers to a plugin. Valid for the life of the process. A plugin uses only
/// members inside `struct_size`.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_host_api {
    /// Size of this table in bytes, as the engine knows it.
    pub struct_size: u32,
    /// Minor version of the ABI that the engine has.
    pub abi_minor: u32,
    /// Passes a line to the host's log. `level` is one of `LAHAR_PLUGIN_LOG_*`; `message` is
    /// copied. It has an effect only while a function of the plugin runs. [concurrent]
    pub log: Option<unsafe extern "C" fn(level: i32, message: *const c_char)>,
    /// Sets the text that explains why the function that is running returns an error; `message` is
    /// copied. [concurrent]
    pub set_error: Option<unsafe extern "C" fn(message: *const c_char)>,
    /// 1 if the host asks long work to end, else 0. [concurrent]
    pub should_stop: Option<unsafe extern "C" fn() -> i32>,
}

/// One material parameter. Strings are UTF-8, keys ASCII.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_parameter_desc {
    /// Name by which hosts give the value: `youngs_modulus`.
    pub key: *const c_char,
    /// Symbol used in the literature: `E`.
    pub symbol: *const c_char,
    /// SI unit: `Pa`, `-`.
    pub unit: *const c_char,
    /// One sentence.
    pub description: *const c_char,
    /// `LAHAR_PARAMETER_REAL`, `_INTEGER` or `_CHOICE`.
    pub kind: i32,
    /// 1: the host must give it; 0: `default_value` is used.
    pub required: i32,
    /// Value if the host gives none, inside the hard bounds. Of a required parameter a typical
    /// value in SI units, with which tools try the model.
    pub default_value: f64,
    /// Smallest value that is accepted; -infinity for none.
    pub hard_min: f64,
    /// Largest value that is accepted; infinity for none.
    pub hard_max: f64,
    /// Below this a warning is logged; -infinity for none.
    pub advised_min: f64,
    /// Above this a warning is logged; infinity for none.
    pub advised_max: f64,
    /// Labels of a choice, separated by `|`; NULL for other kinds.
    pub choices: *const c_char,
}

/// One state variable: a value that a point carries from step to step.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_state_desc {
    /// Name of the particle field: `equivalent_plastic_strain`.
    pub key: *const c_char,
    /// SI unit.
    pub unit: *const c_char,
    /// One sentence.
    pub description: *const c_char,
    /// `LAHAR_STATE_SCALAR`, `_VECTOR`, `_SYMMETRIC` or `_TENSOR`.
    pub kind: i32,
    /// `LAHAR_ROTATION_NONE` or `_OBJECTIVE`.
    pub rotation: i32,
    /// Initial value of every component, before `init_state`.
    pub initial: f64,
}

/// A batch of points. All arrays are 64-byte aligned, share `stride` (a multiple of 8, at least
/// `n`) and do not alias each other.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_stress_batch {
    /// Size of this struct in bytes, as the engine knows it.
    pub struct_size: u32,
    /// 0; bits may get a meaning later.
    pub flags: u32,
    /// Number of points.
    pub n: i64,
    /// Component `c` of point `k` stands at `base[c * stride + k]`.
    pub stride: i64,
    /// Length of the step [s].
    pub dt: f64,
    /// Time at the start of the step [s].
    pub time: f64,
    /// Number of steps before this one; -1 if there is no such count.
    pub step: i64,
    /// Strain increment dt sym L, 6 components [-]; NULL unless the kinematics ask for it.
    pub strain_increment: *const f64,
    /// Velocity gradient L, 9 components [1/s]; NULL unless the kinematics ask for it.
    pub velocity_gradient: *const f64,
    /// Deformation gradient F at the end of the step, 9 components [-]; NULL unless the kinematics
    /// ask for it.
    pub deformation_gradient: *const f64,
    /// Cauchy stress at the start, 6 components [Pa]; never written.
    pub stress0: *const f64,
    /// State at the start, the components of all state variables in the descriptor's order; never
    /// written.
    pub state0: *const f64,
    /// Cauchy stress at the end, 6 components [Pa]; written by `update`.
    pub stress1: *mut f64,
    /// State at the end; written whole by `update` and, over the initial values, by `init_state`.
    pub state1: *mut f64,
    /// The wanted inputs in the descriptor's order, each a scalar array.
    pub inputs: *const *const f64,
    /// Speed of the fastest wave [m/s].
    pub wave_speed: *mut f64,
    /// Kinematic diffusivity [m^2/s]; NULL unless declared.
    pub diffusivity: *mut f64,
    /// Energy per current volume [J/m^3]; NULL unless declared.
    pub energy: *mut f64,
    /// Factor on the time step that the model asks for [-]; NULL unless declared.
    pub dt_factor: *mut f64,
    /// `LAHAR_POINT_*` per point, zero on entry; NULL unless declared.
    pub status: *mut i32,
}

/// One constitutive model: static tables and functions. All pointers must stay valid for the life
/// of the process. Functions that have no instance yet are given the table, so that models may
/// share them.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_model_desc {
    /// Size of this table in bytes, as the plugin knows it.
    pub struct_size: u32,
    /// One of `LAHAR_KINEMATICS_*`.
    pub kinematics: i32,
    /// Name by which hosts select the model: ASCII, unique.
    pub name: *const c_char,
    /// One sentence.
    pub summary: *const c_char,
    /// Publication of the model, with a DOI if there is one.
    pub reference: *const c_char,
    /// Number of parameters.
    pub parameter_count: u32,
    /// `sizeof(lahar_parameter_desc)` as the plugin knows it.
    pub parameter_size: u32,
    /// The parameters; NULL if there are none.
    pub parameters: *const lahar_parameter_desc,
    /// Number of state variables.
    pub state_count: u32,
    /// `sizeof(lahar_state_desc)` as the plugin knows it.
    pub state_size: u32,
    /// The state variables; NULL if there are none.
    pub states: *const lahar_state_desc,
    /// Number of wanted inputs.
    pub input_count: u32,
    /// Smallest minor version of the engine with which the model works; 0 for any.
    pub required_minor: u32,
    /// The wanted inputs, `LAHAR_INPUT_*`; NULL if there are none.
    pub inputs: *const i32,
    /// Sum of `LAHAR_OUTPUT_*`; `LAHAR_OUTPUT_WAVE_SPEED` is mandatory.
    pub outputs: u64,
    /// Sum of `LAHAR_CAPABILITY_*`.
    pub capabilities: u64,
    /// Makes an instance of `model`, this table, from one value per parameter, inside the hard
    /// bounds; the model must copy what it needs of `values`. Mandatory. Returns `LAHAR_PLUGIN_OK`,
    /// or `LAHAR_PLUGIN_ERROR` and no instance. [exclusive; after the entry]
    pub create: Option<
        unsafe extern "C" fn(
            model: *const lahar_model_desc,
            values: *const f64,
            count: i64,
            instance: *mut *mut c_void,
        ) -> i32,
    >,
    /// Frees an instance. Mandatory. [exclusive; once per instance, after all its other calls]
    pub destroy: Option<unsafe extern "C" fn(instance: *mut c_void)>,
    /// Says whether the values can be combined; if not, writes a NUL-terminated sentence of at most
    /// `capacity` bytes to `message`. May be NULL. [exclusive; before create]
    pub check: Option<
        unsafe extern "C" fn(
            model: *const lahar_model_desc,
            values: *const f64,
            count: i64,
            message: *mut c_char,
            capacity: i64,
        ) -> i32,
    >,
    /// Derives the first state from `stress0` and `inputs` into `state1`, which holds the initial
    /// values. May be NULL. [concurrent; between create and destroy]
    pub init_state: Option<
        unsafe extern "C" fn(instance: *const c_void, batch: *const lahar_stress_batch) -> i32,
    >,
    /// One step of all points of the batch: writes `stress1`, `state1` and the declared outputs of
    /// every point. Mandatory. A point that fails says so in `status`; `LAHAR_PLUGIN_ERROR` is for
    /// a batch that cannot be processed at all. [concurrent; between create and destroy]
    pub update: Option<
        unsafe extern "C" fn(instance: *const c_void, batch: *const lahar_stress_batch) -> i32,
    >,
    /// Wave speed (and diffusivity, if declared) from `stress0`, `state0`, `inputs` and, if the
    /// kinematics ask for it, the deformation gradient. Mandatory. [concurrent; between create and
    /// destroy]
    pub wave_speed: Option<
        unsafe extern "C" fn(instance: *const c_void, batch: *const lahar_stress_batch) -> i32,
    >,
    /// A static table for the extension `id`, or NULL. May be NULL. The ids: `lahar.tangent`
    /// (lahar_tangent_extension), `lahar.energy` (lahar_energy_extension), `lahar.transfer`
    /// (lahar_transfer_extension); others belong to whoever owns the domain name that they begin
    /// with. [exclusive; after the entry]
    pub get_extension: Option<
        unsafe extern "C" fn(model: *const lahar_model_desc, id: *const c_char) -> *const c_void,
    >,
}

/// Extension `lahar.tangent`, offered together with `LAHAR_CAPABILITY_TANGENT`.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_tangent_extension {
    /// Size of this table in bytes, as the plugin knows it.
    pub struct_size: u32,
    /// 0.
    pub reserved: u32,
    /// The tangent of the step that `update` makes of the same batch [Pa]: component `6 i + j` of
    /// point `k`, at `tangent[(6 * i + j) * stride + k]`, is the derivative of `stress1` component
    /// i by strain increment component j. A shear component of the increment stands for two
    /// components of the tensor, such as xy and yx, so that elasticity has 2 G there. Outputs of
    /// the batch may be NULL. [concurrent; between create and destroy]
    pub tangent: Option<
        unsafe extern "C" fn(
            instance: *const c_void,
            batch: *const lahar_stress_batch,
            tangent: *mut f64,
        ) -> i32,
    >,
}

/// Extension `lahar.energy`.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_energy_extension {
    /// Size of this table in bytes, as the plugin knows it.
    pub struct_size: u32,
    /// 0.
    pub reserved: u32,
    /// Energy per current volume [J/m^3], one value per point, that can be recovered, from
    /// `stress0`, `state0` and, if the kinematics ask for it, the deformation gradient. Outputs of
    /// the batch may be NULL. [concurrent; between create and destroy]
    pub stored: Option<
        unsafe extern "C" fn(
            instance: *const c_void,
            batch: *const lahar_stress_batch,
            energy: *mut f64,
        ) -> i32,
    >,
}

/// Extension `lahar.transfer`: how state variables are combined when points are merged. Without it
/// every rule is the mean.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_transfer_extension {
    /// Size of this table in bytes, as the plugin knows it.
    pub struct_size: u32,
    /// Number of rules, which is the number of state variables.
    pub count: u32,
    /// One `LAHAR_TRANSFER_*` per state variable.
    pub rules: *const i32,
}

/// Description of a plugin. All pointers must stay valid for the life of the process.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_plugin_desc {
    /// Size of this table in bytes, as the plugin knows it.
    pub struct_size: u32,
    /// `LAHAR_PLUGIN_ABI_MAJOR` of the header that the plugin was built with.
    pub abi_major: u32,
    /// `LAHAR_PLUGIN_ABI_MINOR` of the header that the plugin was built with.
    pub abi_minor: u32,
    /// Number of models, at least 1.
    pub model_count: u32,
    /// Reverse domain name or the like: `org.lahar.linear_elastic`.
    pub id: *const c_char,
    /// Version of the plugin.
    pub version: *const c_char,
    /// Who wrote it.
    pub author: *const c_char,
    /// SPDX licence expression.
    pub licence: *const c_char,
    /// Its address in the web; may be empty.
    pub url: *const c_char,
    /// The models, one pointer each.
    pub models: *const *const lahar_model_desc,
}

/// Type of the function `lahar_plugin_entry_v1`, which every plugin exports. NULL refuses, after
/// `set_error`. [exclusive; once in a process, again only after it has refused]
pub type lahar_plugin_entry =
    Option<unsafe extern "C" fn(host: *const lahar_host_api) -> *const lahar_plugin_desc>;

/// Type of the function `lahar_plugin_adapt_v1`, which an adapter exports instead of an entry: it
/// makes a plugin of the foreign library at `path` (a canonical path), for example of one with a
/// UMAT. NULL refuses, after `set_error`. [exclusive; once for each library, again only after it
/// has refused]
pub type lahar_plugin_adapt = Option<
    unsafe extern "C" fn(
        host: *const lahar_host_api,
        path: *const c_char,
    ) -> *const lahar_plugin_desc,
>;

// SAFETY: the tables hold pointers to immutable data of static lifetime and function pointers; the
// contract above says from which threads the functions are called.
unsafe impl Sync for lahar_plugin_desc {}
// SAFETY: as above.
unsafe impl Sync for lahar_model_desc {}
// SAFETY: as above.
unsafe impl Sync for lahar_parameter_desc {}
// SAFETY: as above.
unsafe impl Sync for lahar_state_desc {}
// SAFETY: as above.
unsafe impl Sync for lahar_transfer_extension {}
