//! Constitutive models in the engine: descriptions, materials (a model with its parameter values),
//! batches.

mod batch;
mod capsule;
mod description;
pub mod scratch;

pub use batch::StressBatch;
pub use capsule::{Capsule, End, Named, Number, Occasion, Replay};
pub use description::{
    Input, Kinematics, Model, Parameter, ParameterKind, Plugin, Rotation, StateKind, StateVariable,
    Transfer,
};

use crate::context::Context;
use crate::error::{Error, Result, Status};
use crate::log::{LogLevel, LogQueue, LogScope};
use crate::plugin::Instance;
use std::sync::Arc;

/// A model with parameter values. Shared by bodies and threads; it stores nothing of a body.
pub struct Material {
    values: Vec<f64>,
    instance: Instance,
    log: Arc<LogQueue>,
}

impl Material {
    /// A material from a model's name and named values; parameters that are not named take their
    /// defaults.
    ///
    /// Errors: [`Status::UnknownName`] (model or parameter, with the closest name),
    /// [`Status::InvalidArgument`] (given twice, not finite), [`Status::OutOfBounds`] (hard bounds,
    /// not one of the choices, or values that the model says do not go together),
    /// [`Status::MissingParameter`]. A value outside the advised bounds is logged as a warning.
    pub fn new(context: &Context, model: &str, named: &[(&str, f64)]) -> Result<Arc<Material>> {
        let model = context.model(model)?;
        let values = collect_values(context, model, named)?;
        let _scope = LogScope::enter(context.log_queue());
        let instance = Instance::new(model, &values)?;
        Ok(Arc::new(Material { values, instance, log: Arc::clone(context.log_queue()) }))
    }

    /// The model.
    pub fn model(&self) -> &'static Model {
        self.instance.model()
    }

    /// Value of a parameter, given or default. Error: [`Status::UnknownName`].
    pub fn value(&self, parameter: &str) -> Result<f64> {
        Ok(self.values[index_of(self.model(), parameter)?])
    }

    /// One step of all points of the batch: end stress, end state, outputs.
    ///
    /// Errors: [`Status::MaterialFailed`] with the plugin's text; [`Status::InvalidArgument`] if an
    /// array that the model needs is missing or too short. Points that fail alone are reported in
    /// `status`.
    pub fn update(&self, batch: &mut StressBatch<'_>) -> Result<()> {
        let _scope = LogScope::enter_if_none(&self.log);
        self.instance.update(batch)
    }

    /// Wave speed, and diffusivity if the model gives it, from start stress, start state and
    /// inputs. Errors as above.
    pub fn wave_speed(&self, batch: &mut StressBatch<'_>) -> Result<()> {
        let _scope = LogScope::enter_if_none(&self.log);
        self.instance.wave_speed(batch)
    }

    /// dσ1/dΔε [Pa] of the step that [`Material::update`] makes of the same batch: component `6 i +
    /// j` of point `k` at `out[(6 * i + j) * stride + k]`. None if the model does not offer it.
    /// Errors as above.
    pub fn tangent(&self, batch: &mut StressBatch<'_>, out: &mut [f64]) -> Option<Result<()>> {
        let _scope = LogScope::enter_if_none(&self.log);
        self.instance.tangent(batch, out)
    }

    /// Energy per volume [J/m^3] that can be had back, one value per point, from the start of the
    /// batch. None if the model does not offer it. Errors as above.
    pub fn stored_energy(
        &self,
        batch: &mut StressBatch<'_>,
        out: &mut [f64],
    ) -> Option<Result<()>> {
        let _scope = LogScope::enter_if_none(&self.log);
        self.instance.stored_energy(batch, out)
    }

    /// Makes the model derive the first state from start stress and inputs into `state1`, which
    /// holds the initial values. Nothing happens if the model has no such function. Errors as
    /// above.
    pub fn init_state(&self, batch: &mut StressBatch<'_>) -> Result<()> {
        let _scope = LogScope::enter_if_none(&self.log);
        self.instance.init_state(batch)
    }
}

fn index_of(model: &Model, parameter: &str) -> Result<usize> {
    model.parameters.iter().position(|p| p.key == parameter).ok_or_else(|| {
        let what = format!("parameter of `{}`", model.name);
        Error::unknown_name(&what, parameter, model.parameters.iter().map(|p| p.key))
    })
}

/// One value per parameter of the model.
fn collect_values(context: &Context, model: &Model, named: &[(&str, f64)]) -> Result<Vec<f64>> {
    let mut given = vec![None; model.parameters.len()];
    for (name, value) in named {
        let index = index_of(model, name)?;
        if given[index].replace(*value).is_some() {
            return Err(Error::invalid(format!("`{name}` of `{}` is given twice", model.name)));
        }
        check_value(context, model, &model.parameters[index], *value)?;
    }
    let missing: Vec<String> = model
        .parameters
        .iter()
        .zip(&given)
        .filter(|(p, v)| p.required && v.is_none())
        .map(|(p, _)| match labels(p) {
            labels if labels.is_empty() => format!("`{}` [{}]", p.key, p.unit),
            labels => format!("`{}`, one of {labels}: {}", p.key, p.description),
        })
        .collect();
    if !missing.is_empty() {
        return Err(Error::new(
            Status::MissingParameter,
            format!("`{}` needs a value for {}", model.name, missing.join(", and for ")),
        ));
    }
    Ok(model.parameters.iter().zip(given).map(|(p, v)| v.unwrap_or(p.default)).collect())
}

/// The labels of a choice with their numbers; empty for other kinds.
fn labels(p: &Parameter) -> String {
    let labels = p.choices.iter().enumerate().map(|(i, label)| format!("{i} ({label})"));
    labels.collect::<Vec<_>>().join(", ")
}

fn check_value(context: &Context, model: &Model, p: &Parameter, value: f64) -> Result<()> {
    let name = format!("`{}` of `{}`", p.key, model.name);
    if !value.is_finite() {
        return Err(Error::invalid(format!("{name} must be a finite number, got {value}")));
    }
    let is_label = value.fract() == 0.0 && value >= 0.0 && value < p.choices.len() as f64;
    if p.kind == ParameterKind::Choice && !is_label {
        let text = format!("{name} must be one of {}, got {value}", labels(p));
        return Err(Error::new(Status::OutOfBounds, text));
    }
    if p.kind == ParameterKind::Integer && value.fract() != 0.0 {
        let text = format!("{name} must be a whole number, got {value}");
        return Err(Error::new(Status::OutOfBounds, text));
    }
    if value < p.hard_min || value > p.hard_max {
        return Err(Error::new(
            Status::OutOfBounds,
            format!(
                "{name} must be from {:e} to {:e} [{}], got {value}",
                p.hard_min, p.hard_max, p.unit
            ),
        ));
    }
    if value < p.advised_min || value > p.advised_max {
        context.log(
            LogLevel::Warning,
            &format!(
                "{name} is {value} [{}]; values from {} to {} are advised",
                p.unit, p.advised_min, p.advised_max
            ),
        );
    }
    Ok(())
}
