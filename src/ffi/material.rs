//! Materials: a model with values of its parameters. A material may be used by many bodies and
//! worlds.

use super::arguments::{count, handle_out, out, reference, slice, text};
use super::cells::ContextCell;
use super::context::lahar_context;
use super::entry::{entry, quiet_entry};
use super::status::lahar_status;
use crate::error::Result;
use crate::material::Material;
use crate::memory::reserve;
use std::ffi::c_char;
use std::sync::Arc;

/// A model with values of its parameters. Freed by lahar_material_free; existing
/// bodies do not need it.
pub struct lahar_material {
    pub(super) material: Arc<Material>,
    pub(super) context: Arc<ContextCell>,
}

/// Makes a material from named values. Parameters that are not named have their defaults.
///
/// `model`: name of a model of a loaded plugin.
/// `count`, `names`, `values`: the parameters that are given, `count` of each, in the host's
/// units; NULL is allowed if `count` is 0.
/// `material`: set to the new handle, or to NULL on failure; the host frees it with
/// lahar_material_free.
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_material_create(
    context: *mut lahar_context,
    model: *const c_char,
    count: i64,
    names: *const *const c_char,
    values: *const f64,
    material: *mut *mut lahar_material,
) -> lahar_status {
    entry("lahar_material_create", |scope| {
        // SAFETY: the host passes NULL or a writable pointer, a live handle, a text.
        let (target, cell, model) = unsafe {
            (handle_out(material, "material")?, scope.context(context)?, text(model, "model")?)
        };
        // SAFETY: the host passes `count` names and values.
        let named = unsafe { named_values(count, names, values) }?;
        let material = Material::new(&cell.context, model, &named)?;
        target.set(Box::into_raw(Box::new(lahar_material { material, context: cell })));
        Ok(())
    })
}

unsafe fn named_values<'a>(
    n: i64,
    names: *const *const c_char,
    values: *const f64,
) -> Result<Vec<(&'a str, f64)>> {
    let n = count(n, "count")?;
    // SAFETY: by contract of the caller `n` names and `n` values stand there.
    let (names, values) = unsafe { (slice(names, n, "names")?, slice(values, n, "values")?) };
    let mut named = Vec::new();
    reserve(&mut named, n, "the parameters")?;
    for (i, (name, value)) in names.iter().zip(values).enumerate() {
        // SAFETY: by contract of the caller each name is NULL or a NUL-terminated text.
        named.push((unsafe { text(*name, &format!("names[{i}]")) }?, *value));
    }
    Ok(named)
}

/// Frees the handle; bodies of the material remain valid. NULL is ignored.
/// Thread: owner
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_material_free(material: *mut lahar_material) {
    quiet_entry(|| {
        if !material.is_null() {
            // SAFETY: the handle came from Box::into_raw in lahar_material_create and is freed
            // once.
            drop(unsafe { Box::from_raw(material) });
        }
    });
}

/// Value of a parameter, given or default.
///
/// `value`: gets the value, in the unit of lahar_parameter_info.
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_material_value(
    material: *const lahar_material,
    parameter: *const c_char,
    value: *mut f64,
) -> lahar_status {
    entry("lahar_material_value", |scope| {
        // SAFETY: the host passes NULL or a live handle.
        let material = unsafe { reference(material, "material") }?;
        scope.attach_context(&material.context);
        // SAFETY: the host passes NULL or a text, and NULL or a writable double.
        let (parameter, target) = unsafe { (text(parameter, "parameter")?, out(value, "value")?) };
        target.set(material.material.value(parameter)?);
        Ok(())
    })
}
