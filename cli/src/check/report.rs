//! Reports of the child that runs the rules to its parent: a line of JSON per event, in a file,
//! since standard output belongs to the plugin.

use serde::{Deserialize, Serialize};
use std::cell::RefCell;
use std::fs::File;
use std::io::Write;
use std::path::Path;

/// One line of the file.
#[derive(Serialize, Deserialize, Clone, Debug)]
pub enum Event {
    /// The library was loaded and the parameter values are sane.
    Loaded { plugin: String, path: String, models: Vec<ModelNote> },
    /// The library could not be loaded; `missing` if there is no such file.
    NotLoaded { text: String, missing: bool },
    /// What the user asked for cannot be done.
    Refused { text: String },
    /// A rule begins.
    Begin { rule: String },
    /// The next call.
    At { call: String },
    /// A rule ended.
    End { rule: String, verdict: Verdict },
    /// All that was asked for is done.
    Finished,
}

/// What the parent must know of a model.
#[derive(Serialize, Deserialize, Clone, Debug)]
pub struct ModelNote {
    pub name: String,
    /// Its parameter values.
    pub values: String,
    pub may_print: bool,
}

/// How a rule came out.
#[derive(Serialize, Deserialize, Clone, Debug)]
pub enum Verdict {
    /// The rule holds; what was looked at.
    Ok(String),
    /// The rule is broken: how, and with which input.
    Failed { sentence: String, input: Option<String> },
    /// The rule does not concern the model, or could not be run; why.
    Skipped(String),
}

impl Verdict {
    pub fn failed(sentence: impl Into<String>) -> Self {
        Self::Failed { sentence: sentence.into(), input: None }
    }
}

/// Writes the events.
pub struct Report(RefCell<File>);

impl Report {
    pub fn create(path: &Path) -> Result<Self, String> {
        let file = File::create(path).map_err(|e| format!("{}: {e}", path.display()))?;
        Ok(Self(RefCell::new(file)))
    }

    /// An event that cannot be written is lost: the parent then sees that the end is missing.
    pub fn send(&self, event: &Event) {
        if let Ok(mut line) = serde_json::to_string(event) {
            line.push('\n');
            let _ = self.0.borrow_mut().write_all(line.as_bytes());
        }
    }
}

/// The events of a file; a last line that was cut off is left out.
pub fn read(path: &Path) -> Vec<Event> {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect()
}
