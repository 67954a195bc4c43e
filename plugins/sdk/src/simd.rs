//! Which vector instructions the loops of the models run on.
//!
//! A model is compiled once per [`Level`] and the processor decides which copy runs, so one library serves all. No copy
//! fuses a multiplication with an addition: every level gives the same results, bit for bit.

use std::sync::atomic::{AtomicU8, Ordering};

/// A set of vector instructions; later ones contain the earlier ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Level {
    /// What every processor of the architecture has: two doubles at a time on x86-64.
    Scalar = 1,
    /// AVX2 and FMA: four doubles at a time.
    Avx2 = 2,
    /// AVX-512 F, VL, DQ and BW: eight doubles at a time.
    Avx512 = 3,
}

impl Level {
    /// All levels, the lowest first.
    pub const ALL: [Level; 3] = [Level::Scalar, Level::Avx2, Level::Avx512];

    /// The name that the environment variable `LAHAR_SIMD` gives it.
    pub const fn name(self) -> &'static str {
        match self {
            Level::Scalar => "scalar",
            Level::Avx2 => "avx2",
            Level::Avx512 => "avx512",
        }
    }

    /// Whether this processor has the instructions.
    pub fn is_available(self) -> bool {
        self <= highest()
    }
}

/// The level in use; 0 until it is decided.
static CHOSEN: AtomicU8 = AtomicU8::new(0);

/// The level in use: the processor's highest, or a lower one that `LAHAR_SIMD` names. It is decided at the first call;
/// a value of the variable that is unknown or too high is ignored here, since the engine reports it.
#[inline]
pub fn level() -> Level {
    match CHOSEN.load(Ordering::Relaxed) {
        1 => Level::Scalar,
        2 => Level::Avx2,
        3 => Level::Avx512,
        _ => decide(),
    }
}

/// Makes all models of this program (or of this shared library) use a level, for tests and benches. Returns false and
/// changes nothing if the processor does not have it.
pub fn force(level: Level) -> bool {
    let available = level.is_available();
    if available {
        CHOSEN.store(level as u8, Ordering::Relaxed);
    }
    available
}

#[cold]
fn decide() -> Level {
    let level = level_of(std::env::var("LAHAR_SIMD").ok().as_deref().map(str::trim));
    CHOSEN.store(level as u8, Ordering::Relaxed);
    level
}

/// The level of this name if there is one and the processor has it, else the processor's highest.
fn level_of(name: Option<&str>) -> Level {
    let named = Level::ALL.into_iter().find(|level| name == Some(level.name()));
    named.filter(|level| level.is_available()).unwrap_or_else(highest)
}

#[cfg(target_arch = "x86_64")]
fn highest() -> Level {
    if !(is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")) {
        return Level::Scalar;
    }
    let wide = is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512vl")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512bw");
    if wide { Level::Avx512 } else { Level::Avx2 }
}

#[cfg(not(target_arch = "x86_64"))]
fn highest() -> Level {
    Level::Scalar
}

/// Work that is compiled once per level. `run` must be `#[inline(always)]`, and so must what it calls in its loops:
/// only what is inlined into the function of a level gets its instructions.
pub(crate) trait Work {
    fn run(self);
}

/// Runs the copy of the level in use.
#[cfg(target_arch = "x86_64")]
#[inline]
pub(crate) fn run(work: impl Work) {
    match level() {
        // SAFETY: the level is in use only if the processor has AVX2 and FMA (`highest`).
        Level::Avx2 => unsafe { run_avx2(work) },
        // SAFETY: as above, with the four parts of AVX-512.
        Level::Avx512 => unsafe { run_avx512(work) },
        Level::Scalar => run_scalar(work),
    }
}

/// Runs the only copy that there is.
#[cfg(not(target_arch = "x86_64"))]
#[inline]
pub(crate) fn run(work: impl Work) {
    run_scalar(work);
}

#[inline(never)]
fn run_scalar(work: impl Work) {
    work.run();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
#[inline(never)]
fn run_avx2(work: impl Work) {
    work.run();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,avx512f,avx512vl,avx512dq,avx512bw")]
#[inline(never)]
fn run_avx512(work: impl Work) {
    work.run();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_gives_its_level_and_anything_else_the_processors_highest() {
        let best = highest();
        for level in Level::ALL {
            assert_eq!(level_of(Some(level.name())), if level <= best { level } else { best });
        }
        for name in [None, Some(""), Some("sse9"), Some("AVX2 ")] {
            assert_eq!(level_of(name), best);
        }
    }

    #[test]
    fn levels_up_to_the_processors_can_be_forced() {
        let best = highest();
        for level in Level::ALL {
            assert_eq!(force(level), level <= best);
            assert!(super::level() <= best);
        }
        assert!(force(Level::Scalar));
        assert_eq!(level(), Level::Scalar);
    }
}
