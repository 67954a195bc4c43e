//! The child process of `lahar plugin check`: loads the library, runs rules, and reports to the
//! parent through a file. The library may end it.

use super::probe::{Probe, show};
use super::report::{Event, ModelNote, Report, Verdict};
use super::rules::RULES;
use crate::plugin::{Choice, Library, values};
use clap::Args;
use lahar::error::Status;
use lahar::material::Model;
use lahar_plugin_abi::LAHAR_CAPABILITY_MAY_PRINT;
use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of the child.
#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    choice: Choice,
    /// Where the events go
    #[arg(long)]
    report: PathBuf,
    /// The rules to run; none: only load
    #[arg(long = "rule")]
    rules: Vec<String>,
}

/// Runs the rules.
pub fn run(arguments: &Arguments) -> Result<ExitCode, String> {
    let report = Report::create(&arguments.report)?;
    work(arguments, &report);
    report.send(&Event::Finished);
    Ok(ExitCode::SUCCESS)
}

fn work(arguments: &Arguments, report: &Report) {
    let choice = &arguments.choice;
    report.send(&Event::At { call: "loading the library and calling its entry".into() });
    let library = match Library::open(&choice.library) {
        Ok(library) => library,
        Err(e) => {
            let missing = e.status == Status::PluginNotFound;
            report.send(&Event::NotLoaded { text: e.to_string(), missing });
            return;
        }
    };
    let noted = |model: &&'static Model| {
        let values = values(model, &choice.set)?;
        if !choice.set.is_empty() {
            library.material(model, &values)?; // a refusal is then the user's matter
        }
        Ok(ModelNote {
            name: model.name.into(),
            values: show(&values),
            may_print: model.capabilities & LAHAR_CAPABILITY_MAY_PRINT != 0,
        })
    };
    let models = library.models(choice.model.as_deref());
    match models.and_then(|models| models.iter().map(noted).collect::<Result<Vec<_>, String>>()) {
        Err(text) => report.send(&Event::Refused { text }),
        Ok(models) => {
            let plugin = format!("{} {}", library.plugin.id, library.plugin.version);
            let path = library.plugin.path.display().to_string();
            report.send(&Event::Loaded { plugin, path, models });
            if !arguments.rules.is_empty() {
                run_rules(arguments, &library, report);
            }
        }
    }
}

/// Runs the rules on the one model that is chosen.
fn run_rules(arguments: &Arguments, library: &Library, report: &Report) {
    let choice = &arguments.choice;
    let Ok(models) = library.models(choice.model.as_deref()) else { return };
    let Ok(values) = values(models[0], &choice.set) else { return };
    let end = |rule: &str, verdict| report.send(&Event::End { rule: rule.into(), verdict });
    let mut probe = None;
    for (i, name) in arguments.rules.iter().enumerate() {
        let Some(rule) = RULES.iter().find(|r| r.name == name) else { continue };
        report.send(&Event::Begin { rule: name.clone() });
        if i == 0 {
            match Probe::new(library, report, models[0], values.clone()) {
                Ok(made) => probe = Some(made),
                Err(verdict) => {
                    end(name, verdict);
                    continue;
                }
            }
        }
        let verdict = match &probe {
            None => Verdict::Skipped("no instance can be made".into()),
            Some(probe) => (rule.run)(probe).unwrap_or_else(|verdict| verdict),
        };
        end(name, verdict);
    }
}
