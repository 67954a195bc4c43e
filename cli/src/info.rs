//! `lahar plugin info`: the tables of a plugin, to read or as JSON.

use crate::plugin::{Library, json};
use crate::say;
use clap::Args;
use lahar::material::{
    Kinematics, Model, Parameter, ParameterKind, Plugin, Rotation, StateKind, StateVariable,
    Transfer,
};
use lahar_plugin_abi as abi;
use serde::Serialize;
use std::process::ExitCode;

/// Arguments of `lahar plugin info`.
#[derive(Args)]
pub struct Arguments {
    /// The plugin: a path, or the name of one in the folders of LAHAR_PLUGIN_PATH
    /// (`lahar_newtonian`)
    library: String,
    /// Only this model
    #[arg(long)]
    model: Option<String>,
    /// Prints JSON; a bound that there is not is null
    #[arg(long)]
    json: bool,
}

/// Prints the tables.
pub fn run(arguments: &Arguments) -> Result<ExitCode, String> {
    let library = Library::open(&arguments.library).map_err(|e| e.to_string())?;
    let models = library.models(arguments.model.as_deref())?;
    let described = PluginInfo::of(library.plugin, &models);
    if arguments.json {
        say(&json(&described)?);
    } else {
        say(&described.text());
    }
    Ok(ExitCode::SUCCESS)
}

#[derive(Serialize)]
struct PluginInfo {
    id: &'static str,
    version: &'static str,
    author: &'static str,
    licence: &'static str,
    url: &'static str,
    path: String,
    abi_major: u32,
    abi_minor: u32,
    models: Vec<ModelInfo>,
}

#[derive(Serialize)]
struct ModelInfo {
    name: &'static str,
    summary: &'static str,
    reference: &'static str,
    kinematics: &'static str,
    inputs: Vec<&'static str>,
    outputs: Vec<&'static str>,
    capabilities: Vec<&'static str>,
    extensions: Vec<&'static str>,
    parameters: Vec<ParameterInfo>,
    states: Vec<StateInfo>,
}

#[derive(Serialize)]
struct ParameterInfo {
    key: &'static str,
    symbol: &'static str,
    unit: &'static str,
    kind: &'static str,
    required: bool,
    /// Of a required parameter a typical value, or 0.
    default: f64,
    hard_min: f64,
    hard_max: f64,
    advised_min: f64,
    advised_max: f64,
    choices: Vec<&'static str>,
    description: &'static str,
}

#[derive(Serialize)]
struct StateInfo {
    key: &'static str,
    unit: &'static str,
    kind: &'static str,
    rotation: &'static str,
    transfer: &'static str,
    initial: f64,
    description: &'static str,
}

impl PluginInfo {
    fn of(plugin: &Plugin, models: &[&'static Model]) -> Self {
        Self {
            id: plugin.id,
            version: plugin.version,
            author: plugin.author,
            licence: plugin.licence,
            url: plugin.url,
            path: plugin.path.display().to_string(),
            abi_major: abi::LAHAR_PLUGIN_ABI_MAJOR,
            abi_minor: plugin.abi_minor,
            models: models.iter().map(|m| ModelInfo::of(m)).collect(),
        }
    }

    fn text(&self) -> String {
        let mut text = format!(
            "plugin   {} {}\nABI      {}.{}\nauthor   {}\nlicence  {}\n",
            self.id, self.version, self.abi_major, self.abi_minor, self.author, self.licence
        );
        if !self.url.is_empty() {
            text += &format!("url      {}\n", self.url);
        }
        text += &format!("file     {}\n", self.path);
        for model in &self.models {
            text += &model.text();
        }
        text
    }
}

impl ModelInfo {
    fn of(model: &'static Model) -> Self {
        let transfers = model.states.iter().any(|s| s.transfer != Transfer::Mean);
        let extensions = [
            (model.offers_tangent(), "lahar.tangent"),
            (model.offers_stored_energy(), "lahar.energy"),
            (transfers, "lahar.transfer"),
        ];
        Self {
            name: model.name,
            summary: model.summary,
            reference: model.reference,
            kinematics: kinematics(model.kinematics),
            inputs: model.inputs.iter().map(|i| i.key()).collect(),
            outputs: named(model.outputs, &OUTPUTS),
            capabilities: named(model.capabilities, &CAPABILITIES),
            extensions: extensions.iter().filter(|e| e.0).map(|e| e.1).collect(),
            parameters: model.parameters.iter().map(ParameterInfo::of).collect(),
            states: model.states.iter().map(StateInfo::of).collect(),
        }
    }

    fn text(&self) -> String {
        let list = |names: &[&str]| match names {
            [] => "none".to_string(),
            some => some.join(", "),
        };
        let mut text = format!("\nmodel {}: {}\n", self.name, self.summary);
        for (name, value) in [
            ("reference", self.reference.to_string()),
            ("kinematics", self.kinematics.replace('_', " ")),
            ("inputs", list(&self.inputs)),
            ("outputs", list(&self.outputs)),
            ("capabilities", list(&self.capabilities)),
            ("extensions", list(&self.extensions)),
        ] {
            text += &format!("  {name:<13} {value}\n");
        }
        let head = ["parameter", "symbol", "unit", "value", "allowed", "advised", "description"];
        text += &table(&head, self.parameters.iter().map(ParameterInfo::row).collect());
        let head = ["state", "unit", "kind", "rotation", "transfer", "initial", "description"];
        text += &table(&head, self.states.iter().map(StateInfo::row).collect());
        text
    }
}

impl ParameterInfo {
    fn of(p: &Parameter) -> Self {
        Self {
            key: p.key,
            symbol: p.symbol,
            unit: p.unit,
            kind: match p.kind {
                ParameterKind::Real => "real",
                ParameterKind::Integer => "integer",
                ParameterKind::Choice => "choice",
            },
            required: p.required,
            default: p.default,
            hard_min: p.hard_min,
            hard_max: p.hard_max,
            advised_min: p.advised_min,
            advised_max: p.advised_max,
            choices: p.choices.clone(),
            description: p.description,
        }
    }

    fn row(&self) -> [String; 7] {
        let default = match self.choices.get(self.default as usize) {
            Some(label) => (*label).to_string(),
            None => number(self.default),
        };
        let value = match self.required {
            false => default,
            true if self.default == 0.0 && self.advised_min > 0.0 => "required".to_string(),
            true => format!("required, typically {default}"),
        };
        let allowed = match self.choices.as_slice() {
            [] if self.kind == "integer" => {
                format!("whole, {}", range(self.hard_min, self.hard_max))
            }
            [] => range(self.hard_min, self.hard_max),
            labels => labels.join(" | "),
        };
        let advised = range(self.advised_min, self.advised_max);
        let [key, symbol, unit, text] =
            [self.key, self.symbol, self.unit, self.description].map(str::to_string);
        [key, symbol, unit, value, allowed, advised, text]
    }
}

impl StateInfo {
    fn of(s: &StateVariable) -> Self {
        Self {
            key: s.key,
            unit: s.unit,
            kind: match s.kind {
                StateKind::Scalar => "scalar",
                StateKind::Vector => "vector",
                StateKind::Symmetric => "symmetric",
                StateKind::Tensor => "tensor",
            },
            rotation: match s.rotation {
                Rotation::None => "none",
                Rotation::Objective => "objective",
            },
            transfer: match s.transfer {
                Transfer::Mean => "mean",
                Transfer::Max => "max",
                Transfer::Never => "never",
            },
            initial: s.initial,
            description: s.description,
        }
    }

    fn row(&self) -> [String; 7] {
        let texts =
            [self.key, self.unit, self.kind, self.rotation, self.transfer].map(str::to_string);
        let [key, unit, kind, rotation, transfer] = texts;
        [key, unit, kind, rotation, transfer, number(self.initial), self.description.to_string()]
    }
}

/// Columns as wide as their widest entry; nothing if there are no rows.
fn table(head: &[&str; 7], rows: Vec<[String; 7]>) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let mut all = vec![head.map(str::to_string)];
    all.extend(rows);
    let mut text = String::from("\n");
    for row in &all {
        let mut line = String::from("  ");
        for (c, entry) in row.iter().enumerate() {
            let width = all.iter().map(|r| r[c].chars().count()).max().unwrap_or(0);
            line += &format!("{entry:<width$}  ");
        }
        text += line.trim_end();
        text.push('\n');
    }
    text
}

/// A number without needless digits: 0.3, 1e7.
pub fn number(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_string(),
        1e-3..1e5 => format!("{value}"),
        _ => format!("{value:e}"),
    }
}

fn range(low: f64, high: f64) -> String {
    match (low.is_finite(), high.is_finite()) {
        (false, false) => "any".to_string(),
        (true, false) if low == f64::MIN_POSITIVE => "above 0".to_string(),
        (true, false) => format!("from {}", number(low)),
        (false, true) => format!("to {}", number(high)),
        (true, true) => format!("{} to {}", number(low), number(high)),
    }
}

const OUTPUTS: [(u64, &str); 5] = [
    (abi::LAHAR_OUTPUT_WAVE_SPEED, "wave_speed"),
    (abi::LAHAR_OUTPUT_DIFFUSIVITY, "diffusivity"),
    (abi::LAHAR_OUTPUT_ENERGY, "energy"),
    (abi::LAHAR_OUTPUT_DT_FACTOR, "dt_factor"),
    (abi::LAHAR_OUTPUT_STATUS, "status"),
];

const CAPABILITIES: [(u64, &str); 6] = [
    (abi::LAHAR_CAPABILITY_THREAD_SAFE, "thread_safe"),
    (abi::LAHAR_CAPABILITY_POINTWISE, "pointwise"),
    (abi::LAHAR_CAPABILITY_DETERMINISTIC, "deterministic"),
    (abi::LAHAR_CAPABILITY_TANGENT, "tangent"),
    (abi::LAHAR_CAPABILITY_MAY_STOP, "may_stop"),
    (abi::LAHAR_CAPABILITY_MAY_PRINT, "may_print"),
];

fn named(bits: u64, names: &[(u64, &'static str)]) -> Vec<&'static str> {
    names.iter().filter(|(bit, _)| bits & bit != 0).map(|(_, name)| *name).collect()
}

fn kinematics(kinematics: Kinematics) -> &'static str {
    match kinematics {
        Kinematics::StrainIncrement => "strain_increment",
        Kinematics::VelocityGradient => "velocity_gradient",
        Kinematics::DeformationGradient => "deformation_gradient",
        Kinematics::GreenNaghdi => "green_naghdi",
    }
}
