//! A measuring stick: an outside program that steps something comparable, timed in turns with the first scene.

use super::rounds::median;
use std::path::{Path, PathBuf};
use std::process::Command;
use xtask_front::process;

/// A built stick and what it printed so far.
pub struct Stick {
    folder: PathBuf,
    /// One a round [ns per particle and step].
    pub samples: Vec<f64>,
}

impl Stick {
    /// Copies the project, which may be read-only, beside the release build, and builds it there.
    pub fn build(source: &Path) -> Result<Self, String> {
        let folder = process::release_folder()?.join("stick");
        copy_folder(source, &folder)?;
        leave_this_workspace(&folder.join("Cargo.toml"))?;
        let stick = Self { folder, samples: Vec::new() };
        process::run_command(stick.cargo().args(["build", "--release"]))?;
        Ok(stick)
    }

    /// Runs it once.
    pub fn measure(&mut self) -> Result<(), String> {
        let printed = process::output_of(self.cargo().args(["run", "--release", "--quiet"]))?;
        let sample = figure(&printed).ok_or_else(|| {
            format!("the stick should print `ns/particle/step: ... all FIGURE`, got `{printed}`")
        })?;
        self.samples.push(sample);
        Ok(())
    }

    /// Median of the samples [ns per particle and step].
    pub fn nanoseconds(&self) -> f64 {
        median(&self.samples)
    }

    /// Cargo in the copy, whose own configuration holds; nothing of this run's environment.
    fn cargo(&self) -> Command {
        let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_string());
        let mut command = Command::new(cargo);
        command.current_dir(&self.folder).env("CARGO_TARGET_DIR", self.folder.join("target"));
        command
    }
}

/// The figure after `all` in the line with `ns/particle/step`.
fn figure(printed: &str) -> Option<f64> {
    let line = printed.lines().find(|line| line.contains("ns/particle/step"))?;
    line.rsplit_once(" all ")?.1.split_whitespace().next()?.parse().ok()
}

/// The copy stands inside this repository but is not of its workspace.
fn leave_this_workspace(manifest: &Path) -> Result<(), String> {
    let text = |e: std::io::Error| format!("{}: {e}", manifest.display());
    let mut content = std::fs::read_to_string(manifest).map_err(text)?;
    if !content.lines().any(|line| line.trim() == "[workspace]") {
        content.push_str("\n[workspace]\n");
    }
    std::fs::write(manifest, content).map_err(text)
}

fn copy_folder(from: &Path, to: &Path) -> Result<(), String> {
    let text =
        |e: std::io::Error| format!("cannot copy {} to {}: {e}", from.display(), to.display());
    std::fs::create_dir_all(to).map_err(text)?;
    for entry in std::fs::read_dir(from).map_err(text)? {
        let entry = entry.map_err(text)?;
        let (source, target) = (entry.path(), to.join(entry.file_name()));
        if source.is_dir() {
            if entry.file_name() != "target" && entry.file_name() != ".git" {
                copy_folder(&source, &target)?;
            }
        } else {
            let content = std::fs::read(&source).map_err(text)?;
            std::fs::write(&target, content).map_err(text)?; // not `copy`, which keeps a file read-only
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_figure_of_all_stages_is_read() {
        let printed =
            "particles 9  ns/particle/step: P2G 1.5  grid 0.5  G2P+stress 2.0  all 4.0\nmore 5.0\n";
        assert_eq!(figure(printed), Some(4.0));
        assert_eq!(figure("all 4.0"), None);
    }
}
