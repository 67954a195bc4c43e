//! `lahar plugin replay`: runs the point of a failure capsule again, alone.

use crate::plugin::{Library, json};
use crate::say;
use clap::Args;
use lahar::material::{Capsule, End, Number, Replay};
use lahar_plugin_abi::LAHAR_POINT_FAILED;
use serde::Serialize;
use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of `lahar plugin replay`.
#[derive(Args)]
pub struct Arguments {
    /// The capsule, a file `lahar-capsule-....json` that a failed step has written
    capsule: PathBuf,
    /// The plugin that is to answer, a path or a name; if none is given, the file that the capsule
    /// names
    #[arg(long)]
    plugin: Option<String>,
    /// Prints JSON
    #[arg(long)]
    json: bool,
}

/// Prints what the model was given, what it answered, and what it answers now. Succeeds if that is
/// the same.
pub fn run(arguments: &Arguments) -> Result<ExitCode, String> {
    let capsule = Capsule::read(&arguments.capsule).map_err(|e| e.to_string())?;
    let library = match arguments.plugin.as_deref().unwrap_or(&capsule.plugin_path) {
        path if path.is_empty() || path.starts_with('[') => {
            return Err(format!(
                "the model `{}` was linked into the host; give the library of its plugin, {} {}, by --plugin",
                capsule.model, capsule.plugin, capsule.plugin_version
            ));
        }
        path => Library::open(path).map_err(|e| match arguments.plugin {
            Some(_) => e.to_string(),
            None => format!("{e}; the capsule names this file, --plugin another"),
        })?,
    };
    if !arguments.json {
        // Before the call: a library that ends the process has at least been asked in the open.
        say(&start(&capsule));
    }
    let replay = capsule.replay(&library.context).map_err(|e| e.to_string())?;
    let [plugin, version] = &replay.plugin;
    if arguments.json {
        let (reproduced, again) = (replay.reproduced, &replay.end);
        say(&json(&Answer { reproduced, plugin, version, again, capsule: &capsule })?);
    } else {
        say(&end(&capsule, &replay));
    }
    Ok(ExitCode::from(u8::from(!replay.reproduced)))
}

#[derive(Serialize)]
struct Answer<'a> {
    reproduced: bool,
    plugin: &'a str,
    version: &'a str,
    again: &'a End,
    capsule: &'a Capsule,
}

const SYMMETRIC: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "zx"];
const STATUS: [&str; 4] = ["ok", "unreliable", "wants a smaller step", "failed"];

/// What the model is given.
fn start(capsule: &Capsule) -> String {
    let Capsule { model, body, particle, step, time, dt, .. } = capsule;
    let mut text = format!(
        "model {model} at particle {particle} of body {body}, step {step}, t = {} s, dt = {} s\n",
        time.0, dt.0
    );
    text += &format!("plugin   {} {}\n", capsule.plugin, capsule.plugin_version);
    for (title, values) in [("parameters", &capsule.parameters.0), ("inputs", &capsule.inputs.0)] {
        text += &format!("\n{title}\n");
        for (name, value) in values {
            text += &format!("  {name:<34} {}\n", number(value));
        }
    }
    text += "\nstart\n";
    let stress = [("stress0".to_string(), capsule.stress0.clone())];
    for (name, values) in capsule.kinematics.0.iter().chain(&stress).chain(&capsule.state0.0) {
        for (c, value) in values.iter().enumerate() {
            text += &format!("  {:<34} {}\n", component(name, values.len(), c), number(value));
        }
    }
    text + "\ncalling update ...\n"
}

/// What it answered then and now.
fn end(capsule: &Capsule, replay: &Replay) -> String {
    let mut text = String::new();
    if replay.plugin != [capsule.plugin.clone(), capsule.plugin_version.clone()] {
        text += &format!("\nnow      {}\n", replay.plugin.join(" "));
    }
    text += &format!("\n{:<36} {:<26} now\n", "end", "in the capsule");
    for ((name, before), (_, now)) in rows(&capsule.end).iter().zip(rows(&replay.end)) {
        let mark = if *before == now { "" } else { "   differs" };
        text += &format!("  {name:<34} {before:<26} {now}{mark}\n");
    }
    text += match replay.reproduced {
        true if capsule.end.status == LAHAR_POINT_FAILED => {
            "\nreproduced: the point fails alone as it did in the step (what else a failed point leaves is not compared)\n"
        }
        true => "\nreproduced: the point answers alone as it did in the step\n",
        false => {
            "\nnot reproduced: another plugin, an edited capsule, or a model that depends on more than it is given\n"
        }
    };
    text
}

/// Names and values of an answer.
fn rows(end: &End) -> Vec<(String, String)> {
    let status = usize::try_from(end.status).ok().and_then(|status| STATUS.get(status));
    let status = format!("{} {}", end.status, status.unwrap_or(&"(there is no such status)"));
    let mut rows = vec![("status".to_string(), status)];
    let stress = [("stress1".to_string(), end.stress1.clone())];
    for (name, values) in stress.iter().chain(&end.state1.0) {
        for (c, value) in values.iter().enumerate() {
            rows.push((component(name, values.len(), c), number(value)));
        }
    }
    rows.extend(end.outputs.0.iter().map(|(name, value)| (name.clone(), number(value))));
    rows
}

/// `stress0 xy`, `deformation_gradient 12`, `memory`.
fn component(name: &str, count: usize, c: usize) -> String {
    match count {
        1 => name.to_string(),
        6 => format!("{name} {}", SYMMETRIC[c]),
        9 => format!("{name} {}{}", c / 3 + 1, c % 3 + 1),
        _ => format!("{name} {}", c + 1),
    }
}

/// All digits.
fn number(value: &Number) -> String {
    format!("{:?}", value.0)
}
