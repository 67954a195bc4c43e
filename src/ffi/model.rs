//! Models: the constitutive models of the loaded plugins. Numbers such as `kinematics` are the
//! constants of lahar_plugin.h.

use super::arguments::{Grows, index, out, struct_out, text};
use super::context::lahar_context;
use super::entry::entry;
use super::status::lahar_status;
use crate::context::Context;
use crate::error::Result;
use crate::material::Model;
use std::ffi::c_char;

/// A constitutive model. The texts are static.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_model_info {
    /// sizeof(lahar_model_info); set by the host.
    pub struct_size: u32,
    /// Measure of deformation that the model takes: one of LAHAR_KINEMATICS_* of lahar_plugin.h.
    pub kinematics: i32,
    /// Name, for lahar_material_create.
    pub name: *const c_char,
    /// One sentence.
    pub summary: *const c_char,
    /// Publication of the model.
    pub reference: *const c_char,
    /// Index of the plugin that it comes from.
    pub plugin: i64,
    /// Number of parameters.
    pub parameter_count: i64,
    /// Number of state variables.
    pub state_count: i64,
    /// Sum of LAHAR_OUTPUT_* of lahar_plugin.h.
    pub outputs: u64,
    /// Sum of LAHAR_CAPABILITY_* of lahar_plugin.h.
    pub capabilities: u64,
}

// SAFETY: repr(C), begins with a u32, no padding (layout.rs), numbers and raw pointers only.
unsafe impl Grows for lahar_model_info {
    const NAME: &'static str = "lahar_model_info";
    const FIRST: usize = 72;
}

/// A parameter of a model. The texts are static.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_parameter_info {
    /// sizeof(lahar_parameter_info); set by the host.
    pub struct_size: u32,
    /// One of LAHAR_PARAMETER_* of lahar_plugin.h: a real, a whole number, or a choice given by its
    /// position 0, 1, ...
    pub kind: i32,
    /// 1: must be given; 0: `default_value` is used.
    pub required: i32,
    /// 0.
    pub reserved: i32,
    /// Name, for lahar_material_create.
    pub name: *const c_char,
    /// Symbol used in the literature.
    pub symbol: *const c_char,
    /// SI unit; values are in the units of the host.
    pub unit: *const c_char,
    /// One sentence.
    pub description: *const c_char,
    /// Labels of a choice, separated by '|'; empty for other kinds.
    pub choices: *const c_char,
    /// Value if none is given; of a required parameter a typical value in SI units, or 0.
    pub default_value: f64,
    /// Smallest accepted value; -infinity for none.
    pub hard_min: f64,
    /// Largest accepted value; infinity for none.
    pub hard_max: f64,
    /// Below this a warning is logged; -infinity for none.
    pub advised_min: f64,
    /// Above this a warning is logged; infinity for none.
    pub advised_max: f64,
}

// SAFETY: repr(C), begins with a u32, no padding (layout.rs), numbers and raw pointers only.
unsafe impl Grows for lahar_parameter_info {
    const NAME: &'static str = "lahar_parameter_info";
    const FIRST: usize = 96;
}

/// A state variable of a model. Bodies of such a material have a particle field with this name. The
/// texts are static.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_state_info {
    /// sizeof(lahar_state_info); set by the host.
    pub struct_size: u32,
    /// One of LAHAR_STATE_* of lahar_plugin.h.
    pub kind: i32,
    /// Number of components: 1, 3, 6 or 9.
    pub components: i32,
    /// One of LAHAR_ROTATION_* of lahar_plugin.h.
    pub rotation: i32,
    /// Name of the field.
    pub name: *const c_char,
    /// SI unit.
    pub unit: *const c_char,
    /// One sentence.
    pub description: *const c_char,
    /// Initial value of each component, before the model derives the first state.
    pub initial: f64,
}

// SAFETY: repr(C), begins with a u32, no padding (layout.rs), numbers and raw pointers only.
unsafe impl Grows for lahar_state_info {
    const NAME: &'static str = "lahar_state_info";
    const FIRST: usize = 48;
}

/// Number of models of all loaded plugins.
///
/// `models`: gets the number.
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_context_model_count(
    context: *const lahar_context,
    models: *mut i64,
) -> lahar_status {
    entry("lahar_context_model_count", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a writable integer.
        let (cell, models) = unsafe { (scope.context(context)?, out(models, "models")?) };
        models.set(cell.context.models().len() as i64);
        Ok(())
    })
}

/// Describes a model.
///
/// `model`: 0 to lahar_context_model_count - 1, in the order of loading.
/// `info`: written; the host has set `struct_size`.
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_context_model_info(
    context: *const lahar_context,
    model: i64,
    info: *mut lahar_model_info,
) -> lahar_status {
    entry("lahar_context_model_info", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a writable struct.
        let (cell, info) = unsafe { (scope.context(context)?, struct_out(info, "info")?) };
        info.set(model_info(&cell.context, model)?);
        Ok(())
    })
}

/// Index of the model of this name.
///
/// `name`: NUL-terminated, UTF-8.
/// `model`: gets the index.
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_context_find_model(
    context: *const lahar_context,
    name: *const c_char,
    model: *mut i64,
) -> lahar_status {
    entry("lahar_context_find_model", |scope| {
        // SAFETY: the host passes NULL or a live handle, a text and a writable integer.
        let (cell, name, target) =
            unsafe { (scope.context(context)?, text(name, "name")?, out(model, "model")?) };
        let found = cell.context.model(name)?;
        let position = cell.context.models().iter().position(|m| std::ptr::eq(*m, found));
        target.set(position.map_or(-1, |i| i as i64));
        Ok(())
    })
}

/// Describes a parameter of a model.
///
/// `model`: index of the model. `parameter`: 0 to `parameter_count` - 1 of lahar_model_info.
/// `info`: written; the host has set `struct_size`.
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_context_model_parameter(
    context: *const lahar_context,
    model: i64,
    parameter: i64,
    info: *mut lahar_parameter_info,
) -> lahar_status {
    entry("lahar_context_model_parameter", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a writable struct.
        let (cell, info) = unsafe { (scope.context(context)?, struct_out(info, "info")?) };
        info.set(parameter_info(model_at(&cell.context, model)?, parameter)?);
        Ok(())
    })
}

/// Describes a state variable of a model.
///
/// `model`: index of the model. `state`: 0 to `state_count` - 1 of lahar_model_info.
/// `info`: written; the host has set `struct_size`.
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_context_model_state(
    context: *const lahar_context,
    model: i64,
    state: i64,
    info: *mut lahar_state_info,
) -> lahar_status {
    entry("lahar_context_model_state", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a writable struct.
        let (cell, info) = unsafe { (scope.context(context)?, struct_out(info, "info")?) };
        info.set(state_info(model_at(&cell.context, model)?, state)?);
        Ok(())
    })
}

fn model_at(context: &Context, model: i64) -> Result<&'static Model> {
    let models = context.models();
    Ok(models[index(model, models.len(), "model")?])
}

fn model_info(context: &Context, position: i64) -> Result<lahar_model_info> {
    let model = model_at(context, position)?;
    let owner =
        context.plugins().iter().position(|p| p.models.iter().any(|m| std::ptr::eq(m, model)));
    Ok(lahar_model_info {
        struct_size: 0,
        kinematics: model.kinematics as i32,
        name: model.name_c.as_ptr(),
        summary: model.summary_c.as_ptr(),
        reference: model.reference_c.as_ptr(),
        plugin: owner.map_or(-1, |i| i as i64),
        parameter_count: model.parameters.len() as i64,
        state_count: model.states.len() as i64,
        outputs: model.outputs,
        capabilities: model.capabilities,
    })
}

fn parameter_info(model: &Model, position: i64) -> Result<lahar_parameter_info> {
    let parameter = &model.parameters[index(position, model.parameters.len(), "parameter")?];
    Ok(lahar_parameter_info {
        struct_size: 0,
        kind: parameter.kind as i32,
        required: parameter.required.into(),
        reserved: 0,
        name: parameter.key_c.as_ptr(),
        symbol: parameter.symbol_c.as_ptr(),
        unit: parameter.unit_c.as_ptr(),
        description: parameter.description_c.as_ptr(),
        choices: parameter.choices_c.unwrap_or(c"").as_ptr(),
        default_value: parameter.default,
        hard_min: parameter.hard_min,
        hard_max: parameter.hard_max,
        advised_min: parameter.advised_min,
        advised_max: parameter.advised_max,
    })
}

fn state_info(model: &Model, position: i64) -> Result<lahar_state_info> {
    let state = &model.states[index(position, model.states.len(), "state")?];
    Ok(lahar_state_info {
        struct_size: 0,
        kind: state.kind as i32,
        components: state.kind.components() as i32,
        rotation: state.rotation as i32,
        name: state.key_c.as_ptr(),
        unit: state.unit_c.as_ptr(),
        description: state.description_c.as_ptr(),
        initial: state.initial,
    })
}
