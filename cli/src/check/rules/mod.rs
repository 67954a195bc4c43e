//! The rules that a model must follow, in the order in which they are run.

mod frame;
mod life;
mod memory;
mod slopes;
mod steps;

use super::probe::{Outcome, Probe};

/// A rule.
pub struct Rule {
    pub name: &'static str,
    /// What holds where the rule holds.
    pub says: &'static str,
    /// Whether the engine checks every call, with LAHAR_CHECK_PLUGINS=1.
    pub checked: bool,
    pub run: fn(&Probe<'_>) -> Outcome,
}

/// Rules of the parent: the library loads; nothing is printed.
pub const LOADS: &str = "loads";
pub const PRINTS: &str = "prints";

pub const RULES: [Rule; 16] = [
    rule("instances", "instances can be made and freed a thousand times", life::instances),
    rule("starts", "there is a start from which the model goes on", steps::starts),
    Rule {
        checked: true,
        ..rule(
            "contract",
            "the model writes what it must and nothing else, and points do not see each other",
            steps::contract,
        )
    },
    rule("zero_increment", "a step without strain changes nothing", steps::zero_increment),
    rule("loading", "random paths end in finite numbers or say that they failed", steps::loading),
    rule("small_steps", "steps that vanish do no harm", steps::small_steps),
    rule("spin", "a rigid spin turns the stress and does no more", frame::spin),
    rule("objectivity", "the response turns with the material", frame::objectivity),
    rule("memory", "equal input gives equal output, whatever was called before", memory::memory),
    rule("threads", "two threads get what one gets", memory::threads),
    rule("tangent", "the tangent is the derivative of the stress", slopes::tangent),
    rule("wave_speed", "no wave is faster than the model says", slopes::wave_speed),
    rule("stored_energy", "elastic work is stored and had back", slopes::stored_energy),
    rule("bounds", "values at the bounds are taken or refused with a reason", life::bounds),
    rule("garbage", "what is not a number fails or stays visible", steps::garbage),
    rule("files", "no file is left open", life::files),
];

const fn rule(name: &'static str, says: &'static str, run: fn(&Probe<'_>) -> Outcome) -> Rule {
    Rule { name, says, checked: false, run }
}
