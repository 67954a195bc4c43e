//! Several worlds timed in turns: what a shared machine does to one of them in a minute, it does to the others.

use super::bandwidth::Bandwidth;
use super::scenes::Scene;
use super::stick::Stick;
use super::worker::Worker;
use serde_json::{Value, json};

/// What is measured: a scene, particles asked for, threads.
#[derive(Clone, Copy)]
pub struct Case {
    /// The scene.
    pub scene: &'static Scene,
    /// Particles, about.
    pub particles: usize,
    /// Threads of the engine's pool.
    pub threads: usize,
}

/// The result for one case.
pub struct Row {
    /// Name of the scene.
    pub scene: String,
    /// Number of particles asked for.
    pub asked: usize,
    /// Number of particles.
    pub particles: f64,
    /// Threads of the engine's pool.
    pub threads: usize,
    /// The path of the kernels.
    pub simd: String,
    /// One a round [ns per particle and step].
    pub samples: Vec<f64>,
    /// Peak resident memory while stepping, less that of the process before the world was made [bytes per particle].
    pub bytes: f64,
    /// Reading and writing of a large copy with the same number of threads, one a round [bytes/s].
    pub bandwidth: Vec<f64>,
    /// Stage → share, from a run of its own with hooks.
    pub stages: Value,
}

/// Rounds, and samples of each case.
pub const ROUNDS: usize = 5;
const WARM_UP: u64 = 10; // steps before the peak of memory is forgotten, and again after: buffers grow to their size
/// What an elastic step must move: 56 doubles a particle [bytes].
pub const MOVED: f64 = 448.0;

impl Row {
    /// Median of the samples [ns per particle and step].
    pub fn nanoseconds(&self) -> f64 {
        median(&self.samples)
    }

    /// Median bandwidth [bytes/s].
    pub fn copy(&self) -> f64 {
        median(&self.bandwidth)
    }

    /// Time over that which memory alone would take with as many threads: the median of the rounds.
    pub fn ratio(&self) -> f64 {
        self.ratio_at(&self.bandwidth)
    }

    /// The same for the bandwidths of another row of these rounds [bytes/s].
    pub fn ratio_at(&self, bandwidth: &[f64]) -> f64 {
        let ratios = self.samples.iter().zip(bandwidth);
        median(&ratios.map(|(ns, speed)| ns * 1e-9 * speed / MOVED).collect::<Vec<_>>())
    }

    /// For programs.
    pub fn to_json(&self) -> Value {
        json!({
            "scene": self.scene,
            "particles": self.particles as u64,
            "threads": self.threads,
            "simd": self.simd,
            "ns_per_particle_step": self.nanoseconds(),
            "bytes_per_particle": self.bytes,
            "copy_gb_s": self.copy() / 1e9,
            "ratio_to_memory_limit": self.ratio(),
            "stages": self.stages,
        })
    }
}

/// Times the cases in turns, `seconds` a sample, and the measuring stick with them if there is one.
pub fn measure(
    cases: &[Case],
    (seconds, simd): (f64, Option<&str>),
    bandwidth: &mut Bandwidth,
    mut stick: Option<&mut Stick>,
) -> Result<Vec<Row>, String> {
    let mut workers = Vec::new();
    let mut rows: Vec<Row> = Vec::new();
    let mut steps: Vec<u64> = Vec::new();
    for (k, case) in cases.iter().enumerate() {
        eprintln!(
            "{}, {} particles, {} threads ...",
            case.scene.name, case.particles, case.threads
        );
        let mut worker = Worker::lahar(case.scene, (case.particles, case.threads), simd, None)?;
        worker.steps(WARM_UP)?;
        worker.ask("forget")?;
        let expected = worker.steps(WARM_UP)? / WARM_UP as f64;
        let same = |other: &Case| {
            std::ptr::eq(other.scene, case.scene) && other.particles == case.particles
        };
        let of_pair = cases[..k].iter().position(same).map(|first| steps[first]);
        steps.push(of_pair.unwrap_or((seconds / expected).ceil() as u64)); // so that both see the same flow
        rows.push(row(case, &worker)?);
        workers.push(worker);
    }
    for _ in 0..ROUNDS {
        for (k, worker) in workers.iter_mut().enumerate() {
            let row = &mut rows[k];
            let taken = worker.steps(steps[k])?;
            row.samples.push(taken * 1e9 / (steps[k] as f64 * row.particles));
            row.bandwidth.push(bandwidth.measure(row.threads));
        }
        if let Some(stick) = &mut stick {
            stick.measure()?;
        }
    }
    for (k, mut worker) in workers.into_iter().enumerate() {
        rows[k].stages = worker.ask_json(&format!("stages {}", steps[k].div_ceil(2)))?;
        let end = worker.end()?;
        rows[k].bytes = number(&end, "bytes")? / rows[k].particles;
    }
    Ok(rows)
}

fn row(case: &Case, worker: &Worker) -> Result<Row, String> {
    Ok(Row {
        scene: case.scene.name.to_string(),
        asked: case.particles,
        particles: number(&worker.ready, "particles")?,
        threads: case.threads,
        simd: worker.ready["simd"].as_str().unwrap_or("unknown").to_string(),
        samples: Vec::new(),
        bytes: 0.0,
        bandwidth: Vec::new(),
        stages: Value::Null,
    })
}

/// A number of an answer.
pub fn number(answer: &Value, key: &str) -> Result<f64, String> {
    answer[key].as_f64().ok_or_else(|| format!("no number `{key}` in {answer}"))
}

/// The median; NaN of nothing.
pub fn median(samples: &[f64]) -> f64 {
    let mut sorted = samples.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}

/// The median of the ratios a/b of the rounds.
pub fn paired(a: &[f64], b: &[f64]) -> f64 {
    median(&a.iter().zip(b).map(|(a, b)| a / b).collect::<Vec<_>>())
}
