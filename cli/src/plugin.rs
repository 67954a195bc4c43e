//! What the commands share: opening a library and choosing a model.

use lahar::context::Context;
use lahar::material::{Model, Plugin};
use std::sync::Arc;

/// A context with this one plugin.
pub struct Library {
    pub context: Arc<Context>,
    pub plugin: &'static Plugin,
}

impl Library {
    /// A text that ends as a shared library does is a path even without a `/`.
    pub fn open(name_or_path: &str) -> Result<Self, String> {
        let text = |e: lahar::error::Error| e.to_string();
        let context = Context::new(Some(1)).map_err(text)?;
        let path = match name_or_path {
            file if file.ends_with(".so") && !file.contains('/') => format!("./{file}"),
            other => other.to_string(),
        };
        let index = context.load_plugin(&path).map_err(text)?;
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
}
