//! `cargo xtask demo`: a sand column collapses, driven from C, and is drawn.

use crate::{process, setup};
use std::path::Path;
use std::process::Command;
use std::time::Instant;

const DRIVER: &str = "examples-c/02_column_collapse.c";

/// Builds what the demo needs, compiles the driver as the README says, runs it and draws a few of
/// its frames.
pub fn run() -> Result<(), String> {
    setup::run(setup::Need::Demo)?;
    let release = process::release_folder()?;
    let folder = release.join("demo");
    let (frames, picture) = (folder.join("frames"), folder.join("collapse.png"));
    let program = folder.join("02_column_collapse");

    stage(1, "builds the engine, a model of sand and the plotter; minutes the first time", || {
        let packages = ["-p", "lahar", "-p", "lahar-drucker-prager", "-p", "lahar-picture"];
        process::cargo(&[["build", "--release"].as_slice(), &packages].concat())
    })?;
    stage(2, &format!("compiles {DRIVER}, seconds"), || {
        if frames.exists() {
            std::fs::remove_dir_all(&frames).map_err(|e| format!("{}: {e}", frames.display()))?;
        }
        std::fs::create_dir_all(&frames).map_err(|e| format!("{}: {e}", frames.display()))?;
        compile(&release, &program)
    })?;
    stage(3, "lets a column of 12 800 particles collapse; a minute or two", || {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        process::run_command(
            Command::new(&program)
                .arg("a=2")
                .arg(&frames)
                .env("LAHAR_PLUGIN_PATH", &release)
                .env("LAHAR_NUM_THREADS", threads.to_string())
                .current_dir(process::root()),
        )
    })?;
    stage(4, "draws six frames, seconds", || {
        let mut draw = Command::new(release.join("lahar-picture"));
        process::run_command(draw.args([&frames, &picture]))
    })?;
    println!("\nthe picture: {}", picture.display());
    println!("the frames, for ParaView: {}", frames.display());
    Ok(())
}

/// Says what is done, does it, and says how long it took.
fn stage(number: u32, what: &str, work: impl FnOnce() -> Result<(), String>) -> Result<(), String> {
    println!("\n{number}/4 {what}");
    let start = Instant::now();
    work()?;
    println!("{number}/4 took {:.0} s", start.elapsed().as_secs_f64());
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
