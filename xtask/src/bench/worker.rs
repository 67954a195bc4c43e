//! Processes that are timed in turns: this program with one world, or a peer. See `measure` for what they understand.

use super::scenes::Scene;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use xtask_front::process;

/// A process that waits for commands.
pub struct Worker {
    /// What to call it in messages.
    pub name: String,
    /// The line with which it said that it is ready.
    pub ready: serde_json::Value,
    child: Child,
    commands: ChildStdin,
    answers: BufReader<ChildStdout>,
}

impl Worker {
    /// Starts a process and waits until it is ready.
    pub fn start(name: &str, command: &mut Command) -> Result<Self, String> {
        let mut child = command
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|e| format!("cannot start {name}: {e}"))?;
        let (Some(commands), Some(answers)) = (child.stdin.take(), child.stdout.take()) else {
            return Err(format!("{name} has no pipes"));
        };
        let mut worker = Self {
            name: name.to_string(),
            ready: serde_json::Value::Null,
            child,
            commands,
            answers: BufReader::new(answers),
        };
        worker.ready = worker.read_json()?;
        Ok(worker)
    }

    /// Starts this program with a world of its own.
    pub fn lahar(
        scene: &Scene,
        (particles, threads): (usize, usize),
        simd: Option<&str>,
        dt: Option<f64>,
    ) -> Result<Self, String> {
        let exe = process::this_program()?;
        let mut command = Command::new(exe);
        command.args(["bench", scene.name, "--child"]);
        command.args(["--particles", &particles.to_string()]);
        command.args(["--threads", &threads.to_string()]);
        if let Some(dt) = dt {
            command.args(["--dt", &format!("{dt:e}")]);
        }
        if let Some(simd) = simd {
            command.env("LAHAR_SIMD", simd);
        }
        Self::start(&format!("{}, {threads} threads", scene.name), &mut command)
    }

    /// Starts a script of a peer.
    pub fn python(name: &str, python: &Path, arguments: &[&str]) -> Result<Self, String> {
        let mut command = Command::new(python);
        command.args(arguments).env("PYTHONDONTWRITEBYTECODE", "1"); // leaves the sources' folder as it is
        Self::start(name, &mut command)
    }

    /// Seconds that so many steps take.
    pub fn steps(&mut self, steps: u64) -> Result<f64, String> {
        let line = self.ask(&format!("steps {steps}"))?;
        line.trim().parse().map_err(|e| format!("{}: `{line}`: {e}", self.name))
    }

    /// Sends a command and gives the answer.
    pub fn ask(&mut self, command: &str) -> Result<String, String> {
        writeln!(self.commands, "{command}").map_err(|e| format!("{}: {e}", self.name))?;
        self.read()
    }

    /// Sends a command that is answered with an object.
    pub fn ask_json(&mut self, command: &str) -> Result<serde_json::Value, String> {
        writeln!(self.commands, "{command}").map_err(|e| format!("{}: {e}", self.name))?;
        self.read_json()
    }

    /// What the world is now; the process ends.
    pub fn end(mut self) -> Result<serde_json::Value, String> {
        let state = self.ask_json("end")?;
        let _ = self.child.wait(); // it has answered, how it ends does not matter
        Ok(state)
    }

    fn read(&mut self) -> Result<String, String> {
        let mut line = String::new();
        match self.answers.read_line(&mut line) {
            Ok(0) => {
                let status = self.child.wait().map_err(|e| e.to_string())?;
                Err(format!("{} ended with {status}; its message stands above", self.name))
            }
            Ok(_) => Ok(line),
            Err(e) => Err(format!("{}: {e}", self.name)),
        }
    }

    fn read_json(&mut self) -> Result<serde_json::Value, String> {
        let line = self.read()?;
        serde_json::from_str(&line).map_err(|e| format!("{}: `{line}`: {e}", self.name))
    }
}

impl Drop for Worker {
    /// Ends a process that was not asked to end: after an error of another one.
    fn drop(&mut self) {
        if !matches!(self.child.try_wait(), Ok(Some(_))) {
            let _ = self.child.kill(); // it may have ended by itself meanwhile
            let _ = self.child.wait();
        }
    }
}
