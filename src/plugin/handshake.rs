//! Checks the tables of a plugin once, when it is loaded, and copies them into safe descriptions.
//!
//! No member of a table is used before the table's size is known to contain it. An error names the
//! plugin, the location in its tables, what was expected and what was found.

use super::adapter::Functions;
use super::extensions::Extensions;
use crate::error::{Error, Result, Status};
use crate::material::{
    Input, Kinematics, Model, Parameter, ParameterKind, Plugin, Rotation, StateKind, StateVariable,
    Transfer,
};
use lahar_plugin_abi::*;
use std::collections::HashSet;
use std::ffi::{CStr, CString, c_char};
use std::path::Path;
use std::sync::Mutex;

/// No sane plugin has more models, or a model more parameters, states or inputs.
const MOST: u32 = 4096;

/// Names that particles' own fields, and columns of files, have.
pub(crate) const RESERVED: &[&str] = &[
    "id",
    "body",
    "position",
    "velocity",
    "mass",
    "volume",
    "stress",
    "strain_energy",
    "temperature",
    "pore_pressure",
    "size",
    "body_force",
    "affine",
    "deformation_gradient",
];

const KNOWN_OUTPUTS: u64 = LAHAR_OUTPUT_WAVE_SPEED
    | LAHAR_OUTPUT_DIFFUSIVITY
    | LAHAR_OUTPUT_ENERGY
    | LAHAR_OUTPUT_DT_FACTOR
    | LAHAR_OUTPUT_STATUS;

/// A text of a plugin, as Rust and as C string.
struct Text {
    text: &'static str,
    c: &'static CStr,
}

/// Position in the tables of a plugin; makes errors.
pub(super) struct Location<'a> {
    path: &'a Path,
    pub(super) at: String,
    /// Minor version that the plugin was made for; 0 before it is known.
    minor: u32,
}

impl Location<'_> {
    pub(super) fn inside(&self, at: String) -> Location<'_> {
        Location { path: self.path, at, minor: self.minor }
    }

    pub(super) fn error(&self, what: impl AsRef<str>) -> Error {
        let (path, at) = (self.path.display(), &self.at);
        let advice = match self.minor.saturating_sub(LAHAR_PLUGIN_ABI_MINOR) > 0 {
            true => "the plugin was made for a newer lahar, which may know it",
            false => "this is a mistake in the plugin, which its author must correct",
        };
        let text = format!("plugin {path}: {at}: {}; {advice}", what.as_ref());
        Error::new(Status::PluginInvalid, text)
    }

    pub(super) fn ensure(&self, holds: bool, what: impl FnOnce() -> String) -> Result<()> {
        if holds { Ok(()) } else { Err(self.error(what())) }
    }

    /// # Safety
    ///
    /// `text` is NULL or a string that ends with a NUL and lives as long as the process.
    unsafe fn text(&self, field: &str, text: *const c_char) -> Result<Text> {
        self.ensure(!text.is_null(), || format!("expected a text for `{field}`, got NULL"))?;
        // SAFETY: not NULL, the rest by contract of the caller.
        let c = unsafe { CStr::from_ptr::<'static>(text) };
        let text = c.to_str().map_err(|_| self.error(format!("`{field}` is not UTF-8")))?;
        Ok(Text { text, c })
    }

    /// A text of ASCII letters, digits, underscores and the characters of `more` that begins with a
    /// letter.
    ///
    /// # Safety
    ///
    /// As for [`Location::text`].
    unsafe fn identifier(&self, field: &str, text: *const c_char, more: &str) -> Result<Text> {
        // SAFETY: by contract of the caller.
        let text = unsafe { self.text(field, text) }?;
        let letters = |c: char| c.is_ascii_alphanumeric() || c == '_' || more.contains(c);
        let sane = text.text.starts_with(|c: char| c.is_ascii_alphabetic())
            && text.text.chars().all(letters);
        self.ensure(sane, || {
            format!(
                "expected ASCII letters, digits and any of `_{more}`, a letter first, for `{field}`, got `{}`",
                text.text
            )
        })?;
        Ok(text)
    }

    fn unique<'t>(&self, what: &str, names: impl Iterator<Item = &'t str>) -> Result<()> {
        let mut seen = HashSet::new();
        for name in names {
            self.ensure(seen.insert(name), || format!("two {what} are named `{name}`"))?;
        }
        Ok(())
    }

    /// A table that begins with its size in bytes and is at least as long as `T`.
    ///
    /// # Safety
    ///
    /// `table` is NULL or points to a table as long as its first member says, valid for the life of
    /// the process.
    pub(super) unsafe fn table<T>(&self, table: *const T) -> Result<&'static T> {
        self.ensure(!table.is_null(), || "expected a table, got NULL".into())?;
        self.ensure(table.is_aligned(), || "the table is not aligned".into())?;
        // SAFETY: not NULL and aligned; every table of the ABI begins with its size.
        let size = unsafe { *table.cast::<u32>() } as usize;
        self.ensure(size >= size_of::<T>(), || {
            format!(
                "expected struct_size of at least {} bytes, got {size}; was it built with another lahar_plugin.h?",
                size_of::<T>()
            )
        })?;
        // SAFETY: long enough, the rest by contract of the caller.
        Ok(unsafe { &*table })
    }

    /// The entries of an array of `count` entries of `size` bytes each, of which the beginning is a
    /// `T`.
    ///
    /// # Safety
    ///
    /// `base` is NULL or points to such an array, valid for the life of the process.
    pub(super) unsafe fn entries<T>(
        &self,
        what: &str,
        base: *const T,
        count: u32,
        size: usize,
    ) -> Result<Vec<&'static T>> {
        if count == 0 {
            return Ok(Vec::new());
        }
        self.ensure(count <= MOST, || format!("{count} {what} are more than {MOST}"))?;
        self.ensure(!base.is_null(), || format!("expected {count} {what}, got NULL"))?;
        self.ensure(base.is_aligned() && size.is_multiple_of(align_of::<T>()), || {
            format!("the array of {what} is not aligned")
        })?;
        self.ensure(size >= size_of::<T>(), || {
            format!("expected {what} of at least {} bytes each, got {size}", size_of::<T>())
        })?;
        // SAFETY: entry i begins i * size bytes behind the base, inside the array; the rest by
        // contract of the caller.
        Ok((0..count as usize).map(|i| unsafe { &*base.byte_add(i * size) }).collect())
    }
}

/// Reads all tables of a plugin.
///
/// # Safety
///
/// `desc` came from the entry of our major or from a host that registers it: it is a table of the
/// ABI whose pointers are NULL or valid for the life of the process.
pub(super) unsafe fn read_plugin(desc: *const lahar_plugin_desc, path: &Path) -> Result<Plugin> {
    let mut location = Location { path, at: "plugin table".into(), minor: 0 };
    // SAFETY: by contract of the caller.
    let desc = unsafe { location.table(desc) }?;
    if desc.abi_major != LAHAR_PLUGIN_ABI_MAJOR {
        return Err(Error::new(
            Status::PluginAbi,
            format!(
                "plugin {}: expected major {LAHAR_PLUGIN_ABI_MAJOR} of the plugin ABI in its table, found major {}; \
                 build the plugin with the lahar_plugin.h of this library",
                path.display(),
                desc.abi_major
            ),
        ));
    }
    location.minor = desc.abi_minor;
    location.ensure(desc.model_count > 0, || "expected at least one model, got none".into())?;
    // SAFETY: the pointers of the table are NULL or valid for the life of the process.
    let (id, version, author, licence, url, tables) = unsafe {
        (
            location.identifier("id", desc.id, ".-")?,
            location.text("version", desc.version)?,
            location.text("author", desc.author)?,
            location.text("licence", desc.licence)?,
            location.text("url", desc.url)?,
            location.entries("models", desc.models, desc.model_count, size_of::<*const u8>())?,
        )
    };
    let mut models = Vec::new();
    for (i, table) in tables.into_iter().enumerate() {
        // SAFETY: as above.
        models
            .push(unsafe { read_model(*table, &location.inside(format!("model {i}")), id.text) }?);
    }
    location.unique("models", models.iter().map(|m| m.name))?;
    serialise(&mut models);
    let path_c = CString::new(path.as_os_str().as_encoded_bytes()).unwrap_or_default();
    Ok(Plugin {
        id: id.text,
        id_c: id.c,
        version: version.text,
        version_c: version.c,
        author: author.text,
        author_c: author.c,
        licence: licence.text,
        licence_c: licence.c,
        url: url.text,
        url_c: url.c,
        path: path.to_path_buf(),
        path_c: Box::leak(path_c.into_boxed_c_str()),
        abi_minor: desc.abi_minor,
        models,
    })
}

/// The models of a plugin that are not thread-safe share one lock: they may share data in the
/// library.
fn serialise(models: &mut [Model]) {
    let mut lock: Option<&'static Mutex<()>> = None;
    for model in models {
        if model.capabilities & LAHAR_CAPABILITY_THREAD_SAFE == 0 {
            model.functions.serial = Some(lock.get_or_insert_with(|| Box::leak(Box::default())));
        }
    }
}

/// # Safety
///
/// As for [`read_plugin`].
unsafe fn read_model(
    desc: *const lahar_model_desc,
    location: &Location<'_>,
    plugin_id: &'static str,
) -> Result<Model> {
    // SAFETY: by contract of the caller, for this table and its pointers.
    let (desc, name) = unsafe {
        let desc = location.table(desc)?;
        (desc, location.identifier("name", desc.name, "")?)
    };
    let location = &location.inside(format!("model `{}`", name.text));
    check_minor(desc, location)?;
    let kinematics = match desc.kinematics {
        LAHAR_KINEMATICS_STRAIN_INCREMENT => Kinematics::StrainIncrement,
        LAHAR_KINEMATICS_VELOCITY_GRADIENT => Kinematics::VelocityGradient,
        LAHAR_KINEMATICS_DEFORMATION_GRADIENT => Kinematics::DeformationGradient,
        LAHAR_KINEMATICS_GREEN_NAGHDI => Kinematics::GreenNaghdi,
        other => {
            return Err(location.error(format!("expected kinematics 0, 1, 2 or 3, got {other}")));
        }
    };
    location.ensure(desc.outputs & LAHAR_OUTPUT_WAVE_SPEED != 0, || {
        format!(
            "expected outputs with LAHAR_OUTPUT_WAVE_SPEED, which is mandatory, got {:#x}",
            desc.outputs
        )
    })?;
    location.ensure(desc.outputs & !KNOWN_OUTPUTS == 0, || {
        format!("expected outputs among {KNOWN_OUTPUTS:#x}, got {:#x}", desc.outputs)
    })?;
    // SAFETY: by contract of the caller.
    let (summary, reference, parameters, states, inputs) = unsafe {
        (
            location.text("summary", desc.summary)?,
            location.text("reference", desc.reference)?,
            location.entries(
                "parameters",
                desc.parameters,
                desc.parameter_count,
                desc.parameter_size as usize,
            )?,
            location.entries("states", desc.states, desc.state_count, desc.state_size as usize)?,
            location.entries("inputs", desc.inputs, desc.input_count, size_of::<i32>())?,
        )
    };
    // SAFETY: by contract of the caller.
    let parameters: Vec<Parameter> = parameters
        .into_iter()
        .enumerate()
        .map(|(i, p)| unsafe { read_parameter(p, location, i) })
        .collect::<Result<_>>()?;
    // SAFETY: by contract of the caller.
    let extensions = unsafe { Extensions::read(desc, location) }?;
    // SAFETY: by contract of the caller.
    let states = unsafe { read_states(&states, &extensions, location) }?;
    location.unique("parameters", parameters.iter().map(|p| p.key))?;
    Ok(Model {
        name: name.text,
        name_c: name.c,
        summary: summary.text,
        summary_c: summary.c,
        reference: reference.text,
        reference_c: reference.c,
        plugin_id,
        kinematics,
        parameters,
        states,
        inputs: read_inputs(&inputs, location)?,
        outputs: desc.outputs,
        capabilities: desc.capabilities,
        functions: read_functions(desc, &extensions, location)?,
    })
}

fn check_minor(desc: &lahar_model_desc, location: &Location<'_>) -> Result<()> {
    if desc.required_minor.saturating_sub(LAHAR_PLUGIN_ABI_MINOR) == 0 {
        return Ok(());
    }
    Err(Error::new(
        Status::PluginAbi,
        format!(
            "plugin {}: {}: it needs at least minor {} of the plugin ABI, this library speaks \
             {LAHAR_PLUGIN_ABI_MAJOR}.{LAHAR_PLUGIN_ABI_MINOR}; use a newer lahar or an older version of the plugin",
            location.path.display(),
            location.at,
            desc.required_minor
        ),
    ))
}

/// # Safety
///
/// As for [`read_plugin`].
unsafe fn read_states(
    states: &[&'static lahar_state_desc],
    extensions: &Extensions,
    location: &Location<'_>,
) -> Result<Vec<StateVariable>> {
    let rules = extensions.rules(states.len(), location)?;
    let mut known = Vec::new();
    for (i, (state, transfer)) in states.iter().zip(rules).enumerate() {
        // SAFETY: by contract of the caller.
        let state = unsafe { read_state(state, location, i) }?;
        known.push(StateVariable { transfer, ..state });
    }
    location.unique("state variables", known.iter().map(|s| s.key))?;
    if let Some(state) = known.iter().find(|s| RESERVED.contains(&s.key)) {
        return Err(location.error(format!(
            "its state variable `{}` has the name of a field that every particle may have; choose another",
            state.key
        )));
    }
    Ok(known)
}

fn read_functions(
    desc: &'static lahar_model_desc,
    extensions: &Extensions,
    location: &Location<'_>,
) -> Result<Functions> {
    let missing = |name: &str| location.error(format!("expected the function `{name}`, got NULL"));
    Ok(Functions {
        desc,
        create: desc.create.ok_or_else(|| missing("create"))?,
        destroy: desc.destroy.ok_or_else(|| missing("destroy"))?,
        check: desc.check,
        init_state: desc.init_state,
        update: desc.update.ok_or_else(|| missing("update"))?,
        wave_speed: desc.wave_speed.ok_or_else(|| missing("wave_speed"))?,
        tangent: extensions.tangent.and_then(|t| t.tangent),
        stored_energy: extensions.energy.and_then(|t| t.stored),
        serial: None,
    })
}

fn read_inputs(inputs: &[&'static i32], location: &Location<'_>) -> Result<Vec<Input>> {
    let mut known = Vec::new();
    for input in inputs {
        let input = match **input {
            LAHAR_INPUT_DENSITY => Input::Density,
            LAHAR_INPUT_ELEMENT_LENGTH => Input::ElementLength,
            LAHAR_INPUT_TEMPERATURE => Input::Temperature,
            LAHAR_INPUT_INTERNAL_ENERGY => Input::InternalEnergy,
            LAHAR_INPUT_PORE_PRESSURE => Input::PorePressure,
            LAHAR_INPUT_POSITION_X => Input::PositionX,
            LAHAR_INPUT_POSITION_Y => Input::PositionY,
            LAHAR_INPUT_POSITION_Z => Input::PositionZ,
            LAHAR_INPUT_PARTICLE_ID => Input::ParticleId,
            other => {
                return Err(location.error(format!(
                    "it wants input {other}; this library offers 1 (density) to 9 (particle id)"
                )));
            }
        };
        location.ensure(!known.contains(&input), || format!("it wants {input:?} twice"))?;
        known.push(input);
    }
    Ok(known)
}

/// # Safety
///
/// As for [`read_plugin`].
unsafe fn read_parameter(
    desc: &'static lahar_parameter_desc,
    location: &Location<'_>,
    index: usize,
) -> Result<Parameter> {
    let numbered = location.inside(format!("{}, parameter {index}", location.at));
    // SAFETY: by contract of the caller.
    let key = unsafe { numbered.identifier("key", desc.key, "") }?;
    let location = &location.inside(format!("{}, parameter `{}`", location.at, key.text));
    // SAFETY: by contract of the caller.
    let (symbol, unit, description, choices) = unsafe {
        let choices = if desc.kind == LAHAR_PARAMETER_CHOICE {
            Some(location.text("choices", desc.choices)?)
        } else {
            None
        };
        (
            location.text("symbol", desc.symbol)?,
            location.text("unit", desc.unit)?,
            location.text("description", desc.description)?,
            choices,
        )
    };
    let kind = match desc.kind {
        LAHAR_PARAMETER_REAL => ParameterKind::Real,
        LAHAR_PARAMETER_INTEGER => ParameterKind::Integer,
        LAHAR_PARAMETER_CHOICE => ParameterKind::Choice,
        other => return Err(location.error(format!("expected kind 0, 1 or 2, got {other}"))),
    };
    location.ensure(matches!(desc.required, 0 | 1), || {
        format!("expected 0 or 1 for `required`, got {}", desc.required)
    })?;
    let parameter = Parameter {
        key: key.text,
        key_c: key.c,
        symbol: symbol.text,
        symbol_c: symbol.c,
        unit: unit.text,
        unit_c: unit.c,
        description: description.text,
        description_c: description.c,
        kind,
        required: desc.required == 1,
        default: desc.default_value,
        hard_min: desc.hard_min,
        hard_max: desc.hard_max,
        advised_min: desc.advised_min,
        advised_max: desc.advised_max,
        choices: choices.as_ref().map_or(Vec::new(), |c| c.text.split('|').collect()),
        choices_c: choices.map(|c| c.c),
    };
    check_bounds(&parameter, location)?;
    Ok(parameter)
}

fn check_bounds(p: &Parameter, location: &Location<'_>) -> Result<()> {
    // Comparisons with NaN are false, so these also refuse bounds that are not numbers.
    location.ensure(p.hard_min <= p.hard_max, || {
        format!("expected hard_min <= hard_max, got {} and {}", p.hard_min, p.hard_max)
    })?;
    location.ensure(p.advised_min <= p.advised_max, || {
        format!("expected advised_min <= advised_max, got {} and {}", p.advised_min, p.advised_max)
    })?;
    if p.kind == ParameterKind::Choice {
        location.ensure(p.choices.iter().all(|c| !c.is_empty()), || {
            "expected labels separated by `|`, got an empty label".into()
        })?;
        location.unique("choices", p.choices.iter().copied())?;
    }
    if p.required {
        return Ok(());
    }
    let whole = p.kind == ParameterKind::Real || p.default.fract() == 0.0;
    let labelled =
        p.kind != ParameterKind::Choice || (p.default >= 0.0 && p.default < p.choices.len() as f64);
    let inside = p.default.is_finite() && p.default >= p.hard_min && p.default <= p.hard_max;
    location.ensure(inside && whole && labelled, || {
        format!(
            "its default {} is not a value that it accepts (from {} to {})",
            p.default, p.hard_min, p.hard_max
        )
    })
}

/// # Safety
///
/// As for [`read_plugin`].
unsafe fn read_state(
    desc: &'static lahar_state_desc,
    location: &Location<'_>,
    index: usize,
) -> Result<StateVariable> {
    let numbered = location.inside(format!("{}, state variable {index}", location.at));
    // SAFETY: by contract of the caller.
    let key = unsafe { numbered.identifier("key", desc.key, "") }?;
    let location = &location.inside(format!("{}, state variable `{}`", location.at, key.text));
    // SAFETY: by contract of the caller.
    let (unit, description) = unsafe {
        (location.text("unit", desc.unit)?, location.text("description", desc.description)?)
    };
    let kind = match desc.kind {
        LAHAR_STATE_SCALAR => StateKind::Scalar,
        LAHAR_STATE_VECTOR => StateKind::Vector,
        LAHAR_STATE_SYMMETRIC => StateKind::Symmetric,
        LAHAR_STATE_TENSOR => StateKind::Tensor,
        other => return Err(location.error(format!("expected kind 0 to 3, got {other}"))),
    };
    let rotation = match desc.rotation {
        LAHAR_ROTATION_NONE => Rotation::None,
        LAHAR_ROTATION_OBJECTIVE => Rotation::Objective,
        other => return Err(location.error(format!("expected rotation 0 or 1, got {other}"))),
    };
    location.ensure(desc.initial.is_finite(), || {
        format!("expected a finite initial value, got {}", desc.initial)
    })?;
    Ok(StateVariable {
        key: key.text,
        key_c: key.c,
        unit: unit.text,
        unit_c: unit.c,
        description: description.text,
        description_c: description.c,
        kind,
        rotation,
        transfer: Transfer::Mean,
        initial: desc.initial,
    })
}
