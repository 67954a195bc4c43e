//! The child processes: starting, watching and ending them, and what they leave.

use super::report::{Event, read};
use crate::plugin::Choice;
use std::fs::{self, File, Permissions};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// How a child ended.
pub enum Ending {
    /// It did all that it was asked for.
    Finished,
    /// It ended early.
    Died(ExitStatus),
    /// It did not come back from a call within the limit, and was killed.
    Hung(Duration),
}

/// What a child did.
pub struct Run {
    pub events: Vec<Event>,
    pub ending: Ending,
}

/// A folder of this user alone for the reports and outputs of children; it goes with this value.
pub struct Workshop {
    folder: TempDir,
    limit: Duration,
    runs: usize,
}

impl Workshop {
    pub fn new(limit: Duration) -> Result<Self, String> {
        let mut builder = tempfile::Builder::new();
        builder.prefix("lahar-check-").permissions(Permissions::from_mode(0o700));
        let folder = builder
            .tempdir()
            .map_err(|e| format!("a folder in {}: {e}", std::env::temp_dir().display()))?;
        Ok(Self { folder, limit, runs: 0 })
    }

    /// Runs rules on the chosen model in a child, or only loads the library.
    pub fn run(&mut self, choice: &Choice, rules: &[&str], checked: bool) -> Result<Run, String> {
        let number = self.runs;
        self.runs += 1;
        let file = |name: &str| self.folder.path().join(format!("{number}.{name}"));
        let report = file("report");
        let output = |name: &str| {
            File::create(file(name)).map_err(|e| format!("{}: {e}", file(name).display()))
        };
        let program =
            std::env::current_exe().map_err(|e| format!("the path of this program: {e}"))?;
        let mut command = Command::new(program);
        command.args(["plugin", "check-child", "--report"]).arg(&report);
        command.args(choice.model.iter().map(|name| format!("--model={name}")));
        command.args(choice.set.iter().map(|text| format!("--set={text}")));
        command.args(rules.iter().map(|name| format!("--rule={name}")));
        command.arg("--").arg(&choice.library);
        command.env("LAHAR_CHECK_PLUGINS", if checked { "1" } else { "0" });
        command.stdin(Stdio::null()).stdout(output("stdout")?).stderr(output("stderr")?);
        let mut child = command.spawn().map_err(|e| format!("a child process: {e}"))?;
        let status = self.watch(&mut child, &report)?;
        let events = read(&report);
        let ending = match status {
            None => Ending::Hung(self.limit),
            Some(_) if matches!(events.last(), Some(Event::Finished)) => Ending::Finished,
            Some(status) => Ending::Died(status),
        };
        Ok(Run { events, ending })
    }

    /// Waits for the end of the child; kills it when its report has not grown for the time limit.
    fn watch(&self, child: &mut Child, report: &Path) -> Result<Option<ExitStatus>, String> {
        let text = |e: std::io::Error| format!("a child process: {e}");
        let (mut length, mut since) = (0, Instant::now());
        loop {
            if let Some(status) = child.try_wait().map_err(text)? {
                return Ok(Some(status));
            }
            let now = fs::metadata(report).map_or(0, |m| m.len());
            if now != length {
                (length, since) = (now, Instant::now());
            }
            if since.elapsed() > self.limit {
                child.kill().map_err(text)?;
                child.wait().map_err(text)?;
                return Ok(None);
            }
            std::thread::sleep(Duration::from_millis(3));
        }
    }

    /// The first line that a child printed, and how many bytes all printed; None if there are none.
    pub fn printed(&self) -> Option<(String, u64)> {
        let mut bytes = 0;
        let mut first = None;
        for number in 0..self.runs {
            for name in ["stdout", "stderr"] {
                let content = fs::read(self.folder.path().join(format!("{number}.{name}")))
                    .unwrap_or_default();
                bytes += content.len() as u64;
                let text = String::from_utf8_lossy(&content).into_owned();
                let line = text.lines().find(|l| !l.trim().is_empty()).map(str::to_string);
                first = first.or(line.map(|l| l.chars().take(100).collect()));
            }
        }
        (bytes > 0).then(|| (first.unwrap_or_default(), bytes))
    }
}

impl Ending {
    /// What happened, for people.
    pub fn sentence(&self, rule: &str, call: &str) -> String {
        let call =
            call.split(':').next().filter(|c| !c.is_empty()).unwrap_or("loading the library");
        match self {
            Self::Finished => format!("the rule `{rule}` gave no result"),
            Self::Hung(limit) => format!(
                "{call} did not return within {} s; the process was killed; bound every loop",
                limit.as_secs_f64()
            ),
            Self::Died(status) => match status.signal() {
                Some(signal) => {
                    format!("the process died of signal {signal} ({}) in {call}", meaning(signal))
                }
                None => format!(
                    "the plugin ended the process with exit status {} in {call}; exit, STOP and error stop take the host down: \
                     set the status LAHAR_POINT_FAILED or return LAHAR_PLUGIN_ERROR",
                    status.code().unwrap_or(-1)
                ),
            },
        }
    }
}

fn meaning(signal: i32) -> &'static str {
    match signal {
        4 => "illegal instruction: built for another processor?",
        6 => "abort: a failed assertion, an exception that nobody caught, or memory freed twice",
        7 => "bus error: an access beyond the end of a file or to a crooked address",
        8 => {
            "floating-point exception: an integer division by zero, or a division by zero or an invalid operation with \
             traps on, which a plugin must not turn on"
        }
        9 => "killed: out of memory?",
        11 => "segmentation fault: an access to memory that is not the plugin's",
        _ => "unexpected",
    }
}
