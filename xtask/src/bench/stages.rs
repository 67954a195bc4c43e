//! The share of each stage in a step, from hooks that read the clock.
//!
//! The engine may not look at the clock, its hooks may. The last three stages run chunk by chunk between two hooks; they are
//! one share here.

use lahar::error::Result;
use lahar::world::World;
use lahar::world::hooks::HookPoint;
use serde_json::{Map, Value};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::Instant;

/// Stages between two marks of a step, in order. The time after the last hook belongs to the last of them.
pub const STAGES: [&str; 4] =
    ["locate", "particles_to_grid", "grid", "grid_to_particles, update_strain, update_stress"];

const HOOKS: [HookPoint; 3] =
    [HookPoint::Start, HookPoint::AfterScatter, HookPoint::AfterBoundaries];

/// Nanoseconds per stage; the time since the last mark goes to the next one that is named.
struct Clock {
    zero: Instant,
    last: AtomicU64,
    spent: [AtomicU64; STAGES.len()],
}

impl Clock {
    fn mark(&self, stage: usize) {
        let now = self.zero.elapsed().as_nanos() as u64;
        self.spent[stage].fetch_add(now - self.last.swap(now, Relaxed), Relaxed);
    }
}

/// Runs some steps with hooks and gives the share of each stage in their time: an object, stage → share.
pub fn shares(world: &mut World, steps: u64) -> Result<Value> {
    let clock = Arc::new(Clock {
        zero: Instant::now(),
        last: AtomicU64::new(0),
        spent: Default::default(),
    });
    for (stage, point) in HOOKS.into_iter().enumerate() {
        let clock = clock.clone();
        world.set_hook(point, Some(Box::new(move |_| clock.mark(stage))));
    }
    clock.last.store(clock.zero.elapsed().as_nanos() as u64, Relaxed);
    for _ in 0..steps {
        world.step(None)?;
        clock.mark(HOOKS.len());
    }
    HOOKS.into_iter().for_each(|point| world.set_hook(point, None));
    let spent = clock.spent.each_ref().map(|spent| spent.load(Relaxed) as f64);
    let all: f64 = spent.iter().sum();
    let shares: Map<String, Value> =
        STAGES.iter().zip(spent).map(|(name, ns)| ((*name).into(), (ns / all).into())).collect();
    Ok(shares.into())
}
