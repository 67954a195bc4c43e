//! How fast this machine copies memory, measured in turns with the scenes.

use std::time::Instant;

/// Two large arrays for each thread.
pub struct Bandwidth {
    arrays: Vec<(Vec<f64>, Vec<f64>)>,
}

const DOUBLES: usize = 16 << 20; // 128 MB, far more than a cache
const COPIES: usize = 4;

impl Bandwidth {
    /// Arrays for up to so many threads.
    pub fn new(threads: usize) -> Self {
        Self { arrays: (0..threads).map(|_| (vec![1.0; DOUBLES], vec![2.0; DOUBLES])).collect() }
    }

    /// What so many threads read and write together while they copy [bytes/s].
    pub fn measure(&mut self, threads: usize) -> f64 {
        let start = Instant::now();
        std::thread::scope(|scope| {
            for (from, to) in &mut self.arrays[..threads] {
                scope.spawn(move || {
                    for _ in 0..COPIES {
                        to.copy_from_slice(std::hint::black_box(from));
                        std::hint::black_box(&mut *to);
                    }
                });
            }
        });
        (threads * DOUBLES * 16 * COPIES) as f64 / start.elapsed().as_secs_f64()
    }
}
