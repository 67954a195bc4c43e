//! What the commands share: opening a library, choosing a model, giving it parameter values.

use clap::Args;
use lahar::context::Context;
use lahar::error::Error;
use lahar::material::{Material, Model, Parameter, ParameterKind, Plugin};
use std::sync::Arc;

/// A library, the model that is meant, and its parameter values.
#[derive(Args, Clone)]
pub struct Choice {
    /// The plugin: a path, or the name of one in the folders of LAHAR_PLUGIN_PATH
    /// (`lahar_newtonian`)
    pub library: String,
    /// Only this model; all of the library if none is named
    #[arg(long)]
    pub model: Option<String>,
    /// The value of a parameter, of a choice its label or number; the others take their default or
    /// typical values
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub set: Vec<String>,
}

/// A context with this one plugin.
pub struct Library {
    pub context: Arc<Context>,
    pub plugin: &'static Plugin,
}

impl Library {
    /// A text that ends as a shared library does is a path even without a `/`.
    pub fn open(name_or_path: &str) -> Result<Self, Error> {
        let context = Context::new(Some(1))?;
        let path = match name_or_path {
            file if file.ends_with(".so") && !file.contains('/') => format!("./{file}"),
            other => other.to_string(),
        };
        let index = context.load_plugin(&path)?;
        let plugin = context.plugins()[index];
        Ok(Self { context, plugin })
    }

    /// The model of this name, or all.
    pub fn models(&self, name: Option<&str>) -> Result<Vec<&'static Model>, String> {
        match name {
            None => Ok(self.plugin.models.iter().collect()),
            Some(name) => Ok(vec![self.context.model(name).map_err(|e| e.to_string())?]),
        }
    }

    /// A material with the given values.
    pub fn material(&self, model: &Model, values: &Values) -> Result<Arc<Material>, String> {
        let named: Vec<(&str, f64)> = values.iter().map(|(key, value)| (*key, *value)).collect();
        Material::new(&self.context, model.name, &named).map_err(|e| e.to_string())
    }
}

/// One value per parameter of a model.
pub type Values = Vec<(&'static str, f64)>;

/// A value for every parameter: as `set` says (`key=value`), else the default or a typical value.
pub fn values(model: &'static Model, set: &[String]) -> Result<Values, String> {
    let mut values = Values::new();
    for parameter in &model.parameters {
        values.push((parameter.key, typical(parameter)));
    }
    for text in set {
        let (key, value) = text.split_once('=').ok_or_else(|| {
            format!("expected `--set key=value`, got `{text}`; write for example --set {text}=1e6")
        })?;
        let index = model.parameters.iter().position(|p| p.key == key).ok_or_else(|| {
            let what = format!("parameter of `{}`", model.name);
            let known = model.parameters.iter().map(|p| p.key);
            Error::unknown_name(&what, key, known).to_string()
        })?;
        values[index].1 = parse(&model.parameters[index], value)?;
    }
    match values.iter().find(|(_, value)| value.is_nan()) {
        None => Ok(values),
        Some((key, _)) => Err(format!(
            "the model `{}` requires `{key}` and gives no typical value of it; give one by --set {key}=...",
            model.name
        )),
    }
}

/// The default, or of a required parameter a typical value: what the author gives, else the middle
/// of the advised bounds. NaN if there is none.
fn typical(p: &Parameter) -> f64 {
    let advised = p.default >= p.advised_min && p.default <= p.advised_max;
    let allowed = p.default >= p.hard_min && p.default <= p.hard_max;
    // A required parameter without a typical value says 0.
    if !p.required || (allowed && advised && (p.default != 0.0 || p.advised_min == 0.0)) {
        return p.default;
    }
    let (low, high) = (p.advised_min.max(p.hard_min), p.advised_max.min(p.hard_max));
    match low.is_finite() && high.is_finite() {
        true if p.kind != ParameterKind::Real => (0.5 * (low + high)).floor(),
        true if low > 0.0 => (low * high).sqrt(),
        true => 0.5 * (low + high),
        false => f64::NAN,
    }
}

fn parse(p: &Parameter, text: &str) -> Result<f64, String> {
    if let Some(index) = p.choices.iter().position(|label| *label == text) {
        return Ok(index as f64);
    }
    text.trim().parse().map_err(|_| {
        let expected = match p.choices.as_slice() {
            [] => "a number".to_string(),
            labels => format!("one of {} or its number", labels.join(", ")),
        };
        format!("expected {expected} for `{}` [{}], got `{text}`", p.key, p.unit)
    })
}

/// JSON for people, with a line break at its end.
pub fn json(value: &impl serde::Serialize) -> Result<String, String> {
    let text = serde_json::to_string_pretty(value).map_err(|e| e.to_string())?;
    Ok(text + "\n")
}
