//! `lahar plugin check`: the conformance suite. The rules run in child processes, so that a plugin
//! that crashes, exits or hangs breaks a rule and not the tool.

pub mod child;
mod probe;
pub mod process;
mod report;
mod rules;

use crate::plugin::{Choice, json};
use crate::say;
use clap::Args;
use process::{Ending, Workshop};
use report::{Event, ModelNote, Verdict};
use rules::{LOADS, PRINTS, RULES};
use serde::Serialize;
use std::process::ExitCode;
use std::time::Duration;

/// Exit status where a rule is broken.
const BROKEN: u8 = 1;
/// After so many deaths of the child the rest of a model's rules is not run.
const DEATHS: usize = 2;

/// Arguments of `lahar plugin check`.
#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    choice: Choice,
    /// Prints JSON
    #[arg(long)]
    json: bool,
    /// A call that takes longer than this counts as hanging
    #[arg(long, value_name = "SECONDS", default_value_t = 20.0)]
    time_limit: f64,
}

/// A line of the result.
#[derive(Serialize)]
struct Line {
    /// None: the rule concerns the whole library.
    model: Option<String>,
    rule: String,
    #[serde(flatten)]
    result: Judged,
}

#[derive(Serialize)]
#[serde(tag = "result", rename_all = "lowercase")]
enum Judged {
    Ok { sentence: String },
    Fail { sentence: String, input: Option<String> },
    Skip { sentence: String },
}

/// Runs the rules and prints a line for each. Errors: what makes it impossible to begin.
pub fn run(arguments: &Arguments) -> Result<ExitCode, String> {
    if !(arguments.time_limit > 0.0 && arguments.time_limit <= 1e6) {
        let got = arguments.time_limit;
        return Err(format!("expected a time limit above 0 s, got {got}"));
    }
    let mut suite = Suite {
        arguments,
        workshop: Workshop::new(Duration::from_secs_f64(arguments.time_limit))?,
        lines: Vec::new(),
    };
    if let Some(models) = suite.load()? {
        for model in &models {
            suite.heading(model);
            suite.check(model)?;
        }
        suite.judge_prints(models.iter().any(|m| m.may_print));
    }
    suite.finish()
}

struct Suite<'a> {
    arguments: &'a Arguments,
    workshop: Workshop,
    lines: Vec<Line>,
}

impl Suite<'_> {
    /// The rule `loads`: the models of the library, or none if it breaks.
    fn load(&mut self) -> Result<Option<Vec<ModelNote>>, String> {
        let run = self.workshop.run(&self.arguments.choice, &[], false)?;
        for event in run.events {
            match event {
                Event::NotLoaded { text, missing: true } | Event::Refused { text } => {
                    return Err(text);
                }
                Event::NotLoaded { text, .. } => {
                    self.add(None, LOADS, Verdict::failed(text));
                    return Ok(None);
                }
                Event::Loaded { plugin, path, models } => {
                    let says = format!("{plugin}, {path}: the tables are sound");
                    self.push(None, LOADS, Judged::Ok { sentence: says });
                    return Ok(Some(models));
                }
                _ => {}
            }
        }
        let sentence = run.ending.sentence(LOADS, "");
        self.add(None, LOADS, Verdict::failed(sentence));
        self.judge_prints(false);
        Ok(None)
    }

    fn heading(&self, model: &ModelNote) {
        if !self.arguments.json {
            say(&format!("model {} with {}\n", model.name, model.values));
        }
    }

    /// All rules on a model. Where the child dies, its rule is broken and another child goes on
    /// with the next.
    fn check(&mut self, model: &ModelNote) -> Result<(), String> {
        let mut deaths = 0;
        let mut next = 0;
        while next < RULES.len() {
            if deaths >= DEATHS {
                let why = "not run, since the process has died too often".to_string();
                self.add(Some(&model.name), RULES[next].name, Verdict::Skipped(why));
                next += 1;
                continue;
            }
            let checked = RULES[next].checked;
            let run = RULES[next..].iter().take_while(|r| r.checked == checked);
            let names: Vec<&str> = run.map(|r| r.name).collect();
            let mut choice = self.arguments.choice.clone();
            choice.model = Some(model.name.clone());
            let run = self.workshop.run(&choice, &names, checked)?;
            let (mut begun, mut call) = (String::new(), String::new());
            for event in run.events {
                match event {
                    Event::Begin { rule } => begun = rule,
                    Event::At { call: at } => call = at,
                    Event::End { rule, verdict } => {
                        self.add(Some(&model.name), &rule, verdict);
                        begun.clear();
                        next += 1;
                    }
                    _ => {}
                }
            }
            if !matches!(run.ending, Ending::Finished) {
                let rule = RULES[next.min(RULES.len() - 1)].name;
                let name = if begun.is_empty() { rule } else { &begun };
                let sentence = run.ending.sentence(name, &call);
                let input = Some(call);
                self.add(Some(&model.name), name, Verdict::Failed { sentence, input });
                next += 1;
                deaths += if matches!(run.ending, Ending::Hung(_)) { DEATHS } else { 1 };
            }
        }
        Ok(())
    }

    fn judge_prints(&mut self, may_print: bool) {
        let verdict = match self.workshop.printed() {
            None => Verdict::Ok("nothing was printed".into()),
            Some(_) if may_print => {
                Verdict::Skipped("the library prints, and a model declares that it may".into())
            }
            Some((line, bytes)) => Verdict::failed(format!(
                "the library prints ({bytes} bytes, first `{line}`); lines for people go through `log` of the host table, and \
                 legacy code declares LAHAR_CAPABILITY_MAY_PRINT"
            )),
        };
        self.add(None, PRINTS, verdict);
    }

    fn add(&mut self, model: Option<&str>, rule: &str, verdict: Verdict) {
        let says = RULES.iter().find(|r| r.name == rule).map(|r| r.says);
        let judged = match verdict {
            Verdict::Ok(detail) => {
                Judged::Ok { sentence: says.map_or(detail.clone(), |s| format!("{s} ({detail})")) }
            }
            Verdict::Failed { sentence, input } => Judged::Fail { sentence, input },
            Verdict::Skipped(sentence) => Judged::Skip { sentence },
        };
        self.push(model, rule, judged);
    }

    fn push(&mut self, model: Option<&str>, rule: &str, result: Judged) {
        let line = Line { model: model.map(str::to_string), rule: rule.into(), result };
        if !self.arguments.json {
            say(&match &line.result {
                Judged::Ok { sentence } => format!("ok   {rule}: {sentence}\n"),
                Judged::Skip { sentence } => format!("-    {rule}: {sentence}\n"),
                Judged::Fail { sentence, input } => {
                    let input = input.as_ref().map(|i| format!("     input: {i}\n"));
                    format!("FAIL {rule}: {sentence}\n{}", input.unwrap_or_default())
                }
            });
        }
        self.lines.push(line);
    }

    fn finish(self) -> Result<ExitCode, String> {
        if self.arguments.json {
            say(&json(&self.lines)?);
        }
        let broken = self.lines.iter().any(|l| matches!(l.result, Judged::Fail { .. }));
        Ok(if broken { ExitCode::from(BROKEN) } else { ExitCode::SUCCESS })
    }
}
