//! Checks the tables of a plugin once, when it is loaded, and copies them into safe descriptions.
//!
//! Nothing of a table is used before its size is known to reach that far. An error names the plugin, the place in its
//! tables, what was expected and what was found.

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
pub(crate) const RESERVED: [&str; 14] = [
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

/// A text of a plugin, twice.
struct Text {
    text: &'static str,
    c: &'static CStr,
}

/// Where in the tables we are; makes errors.
pub(super) struct Place<'a> {
    path: &'a Path,
    pub(super) at: String,
    /// Minor version that the plugin was made for; 0 before it is known.
    minor: u32,
}

impl Place<'_> {
    pub(super) fn inside(&self, at: String) -> Place<'_> {
        Place { path: self.path, at, minor: self.minor }
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
        // SAFETY: not NULL, the rest is told by the caller.
        let c = unsafe { CStr::from_ptr::<'static>(text) };
        let text = c.to_str().map_err(|_| self.error(format!("`{field}` is not UTF-8")))?;
        Ok(Text { text, c })
    }

    /// A text of ASCII letters, digits, underscores and the characters of `more` that begins with a letter.
    ///
    /// # Safety
    ///
    /// As for [`Place::text`].
    unsafe fn identifier(&self, field: &str, text: *const c_char, more: &str) -> Result<Text> {
        // SAFETY: told by the caller.
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
    /// `table` is NULL or points to a table as long as its first member says, valid for the life of the process.
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
        // SAFETY: long enough, the rest is told by the caller.
        Ok(unsafe { &*table })
    }

    /// The entries of an array of `count` entries of `size` bytes each, of which the beginning is a `T`.
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
        // SAFETY: entry i begins i * size bytes behind the base, inside the array; the rest is told by the caller.
        Ok((0..count as usize).map(|i| unsafe { &*base.byte_add(i * size) }).collect())
    }
}

/// Reads everything that a plugin says of itself.
///
/// # Safety
///
/// `desc` came from the entry of our major or from a host that registers it: it is a table of the ABI whose pointers are NULL or valid for the life of
/// the process.
pub(super) unsafe fn read_plugin(desc: *const lahar_plugin_desc, path: &Path) -> Result<Plugin> {
    let mut place = Place { path, at: "plugin table".into(), minor: 0 };
    // SAFETY: told by the caller.
    let desc = unsafe { place.table(desc) }?;
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
    place.minor = desc.abi_minor;
    place.ensure(desc.model_count > 0, || "expected at least one model, got none".into())?;
    // SAFETY: the pointers of the table are NULL or valid for the life of the process.
    let (id, version, author, licence, url, tables) = unsafe {
        (
            place.identifier("id", desc.id, ".-")?,
            place.text("version", desc.version)?,
            place.text("author", desc.author)?,
            place.text("licence", desc.licence)?,
            place.text("url", desc.url)?,
            place.entries("models", desc.models, desc.model_count, size_of::<*const u8>())?,
        )
    };
    let mut models = Vec::new();
    for (i, table) in tables.into_iter().enumerate() {
        // SAFETY: as above.
        models.push(unsafe { read_model(*table, &place.inside(format!("model {i}")), id.text) }?);
    }
    place.unique("models", models.iter().map(|m| m.name))?;
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

/// The models of a plugin that are not thread-safe share one lock: they may share data in the library.
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
    place: &Place<'_>,
    plugin_id: &'static str,
) -> Result<Model> {
    // SAFETY: told by the caller, for this table and for the pointers inside.
    let (desc, name) = unsafe {
        let desc = place.table(desc)?;
        (desc, place.identifier("name", desc.name, "")?)
    };
    let place = &place.inside(format!("model `{}`", name.text));
    check_minor(desc, place)?;
    let kinematics = match desc.kinematics {
        LAHAR_KINEMATICS_STRAIN_INCREMENT => Kinematics::StrainIncrement,
        LAHAR_KINEMATICS_VELOCITY_GRADIENT => Kinematics::VelocityGradient,
        LAHAR_KINEMATICS_DEFORMATION_GRADIENT => Kinematics::DeformationGradient,
        LAHAR_KINEMATICS_GREEN_NAGHDI => Kinematics::GreenNaghdi,
        other => return Err(place.error(format!("expected kinematics 0, 1, 2 or 3, got {other}"))),
    };
    place.ensure(desc.outputs & LAHAR_OUTPUT_WAVE_SPEED != 0, || {
        format!(
            "expected outputs with LAHAR_OUTPUT_WAVE_SPEED, which is mandatory, got {:#x}",
            desc.outputs
        )
    })?;
    place.ensure(desc.outputs & !KNOWN_OUTPUTS == 0, || {
        format!("expected outputs among {KNOWN_OUTPUTS:#x}, got {:#x}", desc.outputs)
    })?;
    // SAFETY: told by the caller.
    let (summary, reference, parameters, states, inputs) = unsafe {
        (
            place.text("summary", desc.summary)?,
            place.text("reference", desc.reference)?,
            place.entries(
                "parameters",
                desc.parameters,
                desc.parameter_count,
                desc.parameter_size as usize,
            )?,
            place.entries("states", desc.states, desc.state_count, desc.state_size as usize)?,
            place.entries("inputs", desc.inputs, desc.input_count, size_of::<i32>())?,
        )
    };
    // SAFETY: told by the caller.
    let parameters: Vec<Parameter> = parameters
        .into_iter()
        .enumerate()
        .map(|(i, p)| unsafe { read_parameter(p, place, i) })
        .collect::<Result<_>>()?;
    // SAFETY: told by the caller.
    let extensions = unsafe { Extensions::read(desc, place) }?;
    // SAFETY: told by the caller.
    let states = unsafe { read_states(&states, &extensions, place) }?;
    place.unique("parameters", parameters.iter().map(|p| p.key))?;
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
        inputs: read_inputs(&inputs, place)?,
        outputs: desc.outputs,
        capabilities: desc.capabilities,
        functions: read_functions(desc, &extensions, place)?,
    })
}

fn check_minor(desc: &lahar_model_desc, place: &Place<'_>) -> Result<()> {
    if desc.required_minor.saturating_sub(LAHAR_PLUGIN_ABI_MINOR) == 0 {
        return Ok(());
    }
    Err(Error::new(
        Status::PluginAbi,
        format!(
            "plugin {}: {}: it needs at least minor {} of the plugin ABI, this library speaks \
             {LAHAR_PLUGIN_ABI_MAJOR}.{LAHAR_PLUGIN_ABI_MINOR}; use a newer lahar or an older version of the plugin",
            place.path.display(),
            place.at,
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
    place: &Place<'_>,
) -> Result<Vec<StateVariable>> {
    let rules = extensions.rules(states.len(), place)?;
    let mut known = Vec::new();
    for (i, (state, transfer)) in states.iter().zip(rules).enumerate() {
        // SAFETY: told by the caller.
        let state = unsafe { read_state(state, place, i) }?;
        known.push(StateVariable { transfer, ..state });
    }
    place.unique("state variables", known.iter().map(|s| s.key))?;
    if let Some(state) = known.iter().find(|s| RESERVED.contains(&s.key)) {
        return Err(place.error(format!(
            "its state variable `{}` has the name of a field that every particle may have; choose another",
            state.key
        )));
    }
    Ok(known)
}

fn read_functions(
    desc: &'static lahar_model_desc,
    extensions: &Extensions,
    place: &Place<'_>,
) -> Result<Functions> {
    let missing = |name: &str| place.error(format!("expected the function `{name}`, got NULL"));
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

fn read_inputs(inputs: &[&'static i32], place: &Place<'_>) -> Result<Vec<Input>> {
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
                return Err(place.error(format!(
                    "it wants input {other}; this library offers 1 (density) to 9 (particle id)"
                )));
            }
        };
        place.ensure(!known.contains(&input), || format!("it wants {input:?} twice"))?;
        known.push(input);
    }
    Ok(known)
}

/// # Safety
///
/// As for [`read_plugin`].
unsafe fn read_parameter(
    desc: &'static lahar_parameter_desc,
    place: &Place<'_>,
    index: usize,
) -> Result<Parameter> {
    let numbered = place.inside(format!("{}, parameter {index}", place.at));
    // SAFETY: told by the caller.
    let key = unsafe { numbered.identifier("key", desc.key, "") }?;
    let place = &place.inside(format!("{}, parameter `{}`", place.at, key.text));
    // SAFETY: told by the caller.
    let (symbol, unit, description, choices) = unsafe {
        let choices = if desc.kind == LAHAR_PARAMETER_CHOICE {
            Some(place.text("choices", desc.choices)?)
        } else {
            None
        };
        (
            place.text("symbol", desc.symbol)?,
            place.text("unit", desc.unit)?,
            place.text("description", desc.description)?,
            choices,
        )
    };
    let kind = match desc.kind {
        LAHAR_PARAMETER_REAL => ParameterKind::Real,
        LAHAR_PARAMETER_INTEGER => ParameterKind::Integer,
        LAHAR_PARAMETER_CHOICE => ParameterKind::Choice,
        other => return Err(place.error(format!("expected kind 0, 1 or 2, got {other}"))),
    };
    place.ensure(matches!(desc.required, 0 | 1), || {
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
    check_bounds(&parameter, place)?;
    Ok(parameter)
}

fn check_bounds(p: &Parameter, place: &Place<'_>) -> Result<()> {
    // Comparisons with NaN are false, so these also refuse bounds that are not numbers.
    place.ensure(p.hard_min <= p.hard_max, || {
        format!("expected hard_min <= hard_max, got {} and {}", p.hard_min, p.hard_max)
    })?;
    place.ensure(p.advised_min <= p.advised_max, || {
        format!("expected advised_min <= advised_max, got {} and {}", p.advised_min, p.advised_max)
    })?;
    if p.kind == ParameterKind::Choice {
        place.ensure(p.choices.iter().all(|c| !c.is_empty()), || {
            "expected labels separated by `|`, got an empty label".into()
        })?;
        place.unique("choices", p.choices.iter().copied())?;
    }
    if p.required {
        return Ok(());
    }
    let whole = p.kind == ParameterKind::Real || p.default.fract() == 0.0;
    let labelled =
        p.kind != ParameterKind::Choice || (p.default >= 0.0 && p.default < p.choices.len() as f64);
    let inside = p.default.is_finite() && p.default >= p.hard_min && p.default <= p.hard_max;
    place.ensure(inside && whole && labelled, || {
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
    place: &Place<'_>,
    index: usize,
) -> Result<StateVariable> {
    let numbered = place.inside(format!("{}, state variable {index}", place.at));
    // SAFETY: told by the caller.
    let key = unsafe { numbered.identifier("key", desc.key, "") }?;
    let place = &place.inside(format!("{}, state variable `{}`", place.at, key.text));
    // SAFETY: told by the caller.
    let (unit, description) =
        unsafe { (place.text("unit", desc.unit)?, place.text("description", desc.description)?) };
    let kind = match desc.kind {
        LAHAR_STATE_SCALAR => StateKind::Scalar,
        LAHAR_STATE_VECTOR => StateKind::Vector,
        LAHAR_STATE_SYMMETRIC => StateKind::Symmetric,
        LAHAR_STATE_TENSOR => StateKind::Tensor,
        other => return Err(place.error(format!("expected kind 0 to 3, got {other}"))),
    };
    let rotation = match desc.rotation {
        LAHAR_ROTATION_NONE => Rotation::None,
        LAHAR_ROTATION_OBJECTIVE => Rotation::Objective,
        other => return Err(place.error(format!("expected rotation 0 or 1, got {other}"))),
    };
    place.ensure(desc.initial.is_finite(), || {
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
