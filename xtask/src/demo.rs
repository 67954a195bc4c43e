//! `cargo xtask demo`: a sand column collapses, driven from C, and is drawn.

use crate::picture::{self, Frame};
use crate::{process, setup};
use std::path::Path;
use std::process::Command;

const DRIVER: &str = "examples-c/02_column_collapse.c";

/// Builds everything, compiles the driver as the README says, runs it and draws a few of its
/// frames.
pub fn run() -> Result<(), String> {
    setup::run(setup::Need::Demo)?;
    process::cargo(&["build", "--release", "--workspace"])?;
    let release = process::release_folder()?;
    let folder = release.join("demo");
    let frames = folder.join("frames");
    if frames.exists() {
        std::fs::remove_dir_all(&frames).map_err(|e| format!("{}: {e}", frames.display()))?;
    }
    std::fs::create_dir_all(&frames).map_err(|e| format!("{}: {e}", frames.display()))?;

    let program = folder.join("02_column_collapse");
    compile(&release, &program)?;
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut driver = Command::new(&program);
    driver
        .arg(&frames)
        .env("LAHAR_PLUGIN_PATH", &release)
        .env("LAHAR_NUM_THREADS", threads.to_string())
        .current_dir(process::root());
    eprintln!("the driver runs for a minute or two");
    let printed = process::shown_output_of(&mut driver)?;

    let all = picture::read_frames(&frames, &printed)?;
    let chosen = spread(all, 6);
    let picture = folder.join("collapse.png");
    picture::draw(&chosen, &picture)?;
    println!("\nthe collapse in {} frames: {}", chosen.len(), picture.display());
    Ok(())
}

/// The documented compile line for C.
fn compile(release: &Path, program: &Path) -> Result<(), String> {
    process::run_command(
        Command::new("cc")
            .args(["-std=c11", "-O2", "-Wall", "-Iinclude", DRIVER, "-o"])
            .arg(program)
            .arg(format!("-L{}", release.display()))
            .arg(format!("-Wl,-rpath,{}", release.display()))
            .args(["-llahar", "-lm"])
            .current_dir(process::root()),
    )
}

/// At most `count` frames, evenly spread, the first and the last among them.
fn spread(mut frames: Vec<Frame>, count: usize) -> Vec<Frame> {
    let last = frames.len().saturating_sub(1);
    if frames.len() <= count {
        return frames;
    }
    let wanted: Vec<usize> = (0..count).map(|i| i * last / (count - 1)).collect();
    let mut index = 0;
    frames.retain(|_| {
        index += 1;
        wanted.contains(&(index - 1))
    });
    frames
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spread_keeps_the_first_and_the_last_frame() {
        let frames = (0..11).map(|i| Frame { time: f64::from(i), ..Frame::default() }).collect();
        let times: Vec<f64> = spread(frames, 6).iter().map(|frame| frame.time).collect();
        assert_eq!(times, [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
    }
}
