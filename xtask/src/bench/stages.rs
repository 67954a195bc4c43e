//! The share of each stage in a step, from hooks that read the clock.
//!
//! The engine may not look at the clock, its hooks may. The last three stages run chunk by chunk between two hooks, on any
//! thread; their part is divided as the threads together divide theirs between the three. The second scatter of MUSL has
//! no hook: its time is in that part.

use lahar::error::Result;
use lahar::step::pass::ChunkStage;
use lahar::world::World;
use lahar::world::hooks::HookPoint;
use serde_json::{Map, Value};
use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::Instant;

/// Names of the stages, in order.
pub const STAGES: [&str; 6] =
    ["locate", "particles_to_grid", "grid", "grid_to_particles", "update_strain", "update_stress"];
const BEFORE_CHUNKS: usize = 3; // stages that end at a hook

const HOOKS: [HookPoint; BEFORE_CHUNKS] =
    [HookPoint::Start, HookPoint::AfterScatter, HookPoint::AfterBoundaries];

/// Nanoseconds since `zero`, and those spent between the marks of a step.
struct Clock {
    zero: Instant,
    last: AtomicU64,
    before_chunks: [AtomicU64; BEFORE_CHUNKS],
    chunks: AtomicU64,
    in_chunks: [AtomicU64; STAGES.len() - BEFORE_CHUNKS], // of all threads
}

thread_local! {
    /// The last mark of this thread in its chunk.
    static LAST_IN_CHUNK: Cell<u64> = const { Cell::new(0) };
}

impl Clock {
    fn new() -> Self {
        Self {
            zero: Instant::now(),
            last: AtomicU64::new(0),
            before_chunks: Default::default(),
            chunks: AtomicU64::new(0),
            in_chunks: Default::default(),
        }
    }

    fn now(&self) -> u64 {
        self.zero.elapsed().as_nanos() as u64
    }

    /// Gives the time since the last mark to `spent`.
    fn mark(&self, spent: &AtomicU64) {
        let now = self.now();
        spent.fetch_add(now - self.last.swap(now, Relaxed), Relaxed);
    }

    /// The same inside a chunk, on the thread that works on it.
    fn mark_in_chunk(&self, stage: ChunkStage) {
        let now = self.now();
        let since = now - LAST_IN_CHUNK.replace(now);
        match stage {
            ChunkStage::Start => {}
            ChunkStage::Gathered => drop(self.in_chunks[0].fetch_add(since, Relaxed)),
            ChunkStage::Strained => drop(self.in_chunks[1].fetch_add(since, Relaxed)),
            ChunkStage::Stressed => drop(self.in_chunks[2].fetch_add(since, Relaxed)),
        }
    }

    /// An object, stage → share.
    fn shares(&self) -> Value {
        let read = |spent: &AtomicU64| spent.load(Relaxed) as f64;
        let chunks = read(&self.chunks);
        let of_threads: f64 = self.in_chunks.iter().map(read).sum();
        let before = self.before_chunks.iter().map(read);
        let in_chunks = self.in_chunks.iter().map(|spent| chunks * read(spent) / of_threads);
        let spent: Vec<f64> = before.chain(in_chunks).collect();
        let all: f64 = spent.iter().sum();
        let shares =
            STAGES.iter().zip(&spent).map(|(name, ns)| ((*name).into(), (ns / all).into()));
        shares.collect::<Map<String, Value>>().into()
    }
}

/// Runs some steps with hooks and gives the share of each stage in their time: an object, stage → share.
pub fn shares(world: &mut World, steps: u64) -> Result<Value> {
    let clock = Arc::new(Clock::new());
    for (stage, point) in HOOKS.into_iter().enumerate() {
        let clock = clock.clone();
        world.set_hook(point, Some(Box::new(move |_| clock.mark(&clock.before_chunks[stage]))));
    }
    let of_chunks = clock.clone();
    world.set_stopwatch(Some(Arc::new(move |stage| of_chunks.mark_in_chunk(stage))));
    clock.last.store(clock.now(), Relaxed);
    for _ in 0..steps {
        world.step(None)?;
        clock.mark(&clock.chunks);
    }
    HOOKS.into_iter().for_each(|point| world.set_hook(point, None));
    world.set_stopwatch(None);
    Ok(clock.shares())
}
