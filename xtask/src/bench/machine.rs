//! What was measured on: date, commit, processor and how busy it was, for the heading of a table.

use std::fmt;
use std::process::{Command, Stdio};
use xtask_front::process;

/// The heading of a run.
pub struct Machine {
    date: String,
    commit: String,
    processor: String,
    cores: usize,
    load: String,
}

impl Machine {
    /// Reads what the system says now; what it does not say is "unknown". The load is that of others if this is read before
    /// anything is built or timed.
    pub fn read() -> Self {
        let processor = std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| {
            let line = text.lines().find(|line| line.starts_with("model name"))?;
            Some(line.split_once(':')?.1.trim().to_string())
        });
        let load = std::fs::read_to_string("/proc/loadavg").ok();
        let load = load.and_then(|text| Some(text.split_whitespace().next()?.to_string()));
        Self {
            date: first_line("date", &["-u", "+%F"]),
            commit: first_line("git", &["describe", "--always", "--dirty"]),
            processor: processor.unwrap_or_else(|| "unknown processor".to_string()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            load: load.unwrap_or_else(|| "unknown".to_string()),
        }
    }

    /// Date, processor and cores, without commit and load.
    pub fn class(&self) -> String {
        format!("{}, {}, {} cores", self.date, self.processor, self.cores)
    }
}

impl fmt::Display for Machine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { date, commit, processor, cores, load } = self;
        write!(f, "{date}, {commit}, {processor}, {cores} cores, load {load} before the run")
    }
}

fn first_line(program: &str, arguments: &[&str]) -> String {
    let output = Command::new(program)
        .args(arguments)
        .current_dir(process::root())
        .stderr(Stdio::null())
        .output();
    let text = output.ok().filter(|output| output.status.success()).map(|output| output.stdout);
    let text = text.map(|bytes| String::from_utf8_lossy(&bytes).trim().to_string());
    text.filter(|text| !text.is_empty()).unwrap_or_else(|| "unknown".to_string())
}
