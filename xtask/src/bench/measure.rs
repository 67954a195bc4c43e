//! One scene, measured: time of a step, memory, and the copy bandwidth of the same minute.

use super::scenes::Scene;
use crate::process;
use lahar::context::Context;
use std::time::Instant;

/// The result for one scene.
pub struct Row {
    /// Name of the scene.
    pub scene: String,
    /// Number of particles.
    pub particles: u64,
    /// Threads of the engine's pool.
    pub threads: u64,
    /// Median of five [ns per particle and step].
    pub nanoseconds: f64,
    /// Peak resident memory while stepping, less that of the process before the world was made [bytes per particle].
    pub bytes: f64,
    /// Reading and writing of a large copy with the same number of threads [bytes/s].
    pub bandwidth: f64,
}

const SAMPLES: usize = 5;
const WARM_UP: usize = 20; // steps, none of them timed: sand starts to flow, buffers grow to their size
const SAMPLE_TIME: f64 = 1.0; // seconds per sample, at least one step
const MOVED: f64 = 448.0; // bytes that an elastic step must move: 56 doubles

impl Row {
    /// Time over that which memory alone would take.
    pub fn ratio(&self) -> f64 {
        self.nanoseconds * 1e-9 / (MOVED / self.bandwidth)
    }

    /// For programs.
    pub fn to_json(&self) -> serde_json::Value {
        serde_json::json!({
            "scene": self.scene, "particles": self.particles, "threads": self.threads,
            "ns_per_particle_step": self.nanoseconds, "bytes_per_particle": self.bytes,
            "copy_bandwidth": self.bandwidth, "ratio_to_memory_limit": self.ratio(),
        })
    }

    /// Reads back what `to_json` wrote.
    pub fn from_json(text: &str) -> Option<Self> {
        let value: serde_json::Value = serde_json::from_str(text).ok()?;
        Some(Self {
            scene: value["scene"].as_str()?.to_string(),
            particles: value["particles"].as_u64()?,
            threads: value["threads"].as_u64()?,
            nanoseconds: value["ns_per_particle_step"].as_f64()?,
            bytes: value["bytes_per_particle"].as_f64()?,
            bandwidth: value["copy_bandwidth"].as_f64()?,
        })
    }
}

/// Builds the scene, warms it up and measures.
pub fn measure(scene: &Scene, particles: usize, threads: usize) -> Result<Row, String> {
    let folder = process::release_folder()?;
    let bandwidth = copy_bandwidth(threads);
    let text = |e: lahar::error::Error| format!("{}: {e}", scene.name);
    let context = Context::new(Some(threads)).map_err(text)?;
    let before = resident("VmRSS")?;
    let mut world = scene.build(&context, &folder, particles).map_err(text)?;
    let count = world.totals(None).map_err(text)?.particles as f64;

    let mut step = || world.step(None).map(drop).map_err(text);
    for _ in 0..WARM_UP / 2 {
        step()?;
    }
    forget_peak()?; // what the making of the particles took is not what a step needs
    let start = Instant::now();
    for _ in 0..WARM_UP / 2 {
        step()?;
    }
    let expected = start.elapsed().as_secs_f64() / (WARM_UP / 2) as f64;
    let steps = (SAMPLE_TIME / expected).ceil() as usize;
    let mut samples = [0.0; SAMPLES];
    for sample in &mut samples {
        let start = Instant::now();
        for _ in 0..steps {
            step()?;
        }
        *sample = start.elapsed().as_secs_f64() * 1e9 / (steps as f64 * count);
    }
    Ok(Row {
        scene: scene.name.to_string(),
        particles: count as u64,
        threads: threads as u64,
        nanoseconds: median(samples),
        bytes: (resident("VmHWM")? - before) / count,
        bandwidth,
    })
}

fn median(mut samples: [f64; SAMPLES]) -> f64 {
    samples.sort_by(f64::total_cmp);
    samples[SAMPLES / 2]
}

/// Median bandwidth of copies of 128 MB by each thread, read and write counted [bytes/s].
fn copy_bandwidth(threads: usize) -> f64 {
    const DOUBLES: usize = 16 << 20;
    let mut arrays: Vec<_> =
        (0..threads).map(|_| (vec![1.0_f64; DOUBLES], vec![2.0_f64; DOUBLES])).collect();
    let mut samples = [0.0; SAMPLES];
    for sample in &mut samples {
        let start = Instant::now();
        std::thread::scope(|scope| {
            for (from, to) in &mut arrays {
                scope.spawn(move || {
                    for _ in 0..8 {
                        to.copy_from_slice(std::hint::black_box(from));
                        std::hint::black_box(&mut *to);
                    }
                });
            }
        });
        *sample = (threads * DOUBLES * 16 * 8) as f64 / start.elapsed().as_secs_f64();
    }
    median(samples)
}

/// A line of /proc/self/status [bytes].
fn resident(key: &str) -> Result<f64, String> {
    let text = std::fs::read_to_string("/proc/self/status").map_err(|e| e.to_string())?;
    let line = text.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(':'));
    let kilobytes = line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<f64>().ok());
    kilobytes.map(|kb| kb * 1024.0).ok_or_else(|| format!("/proc/self/status has no {key}"))
}

/// Sets the peak of the resident memory back to what is resident now.
fn forget_peak() -> Result<(), String> {
    std::fs::write("/proc/self/clear_refs", "5").map_err(|e| format!("/proc/self/clear_refs: {e}"))
}
