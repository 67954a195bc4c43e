//! The threads of a context, and how work is divided among them. Nothing else in lahar decides
//! whether work is parallel.
//!
//! The threads are a rayon pool that is joined at its end, which rayon's own do not offer.

use crate::error::{Error, Result, Status};
use crate::log::{self, LogQueue, LogScope};
use crate::platform;
use crate::simd::environment;
use rayon::{BroadcastContext, ThreadPool, ThreadPoolBuilder};
use std::mem;
use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};

/// Below this number of particles a step is serial: threads would cost more than they bring.
const SERIAL_BELOW: usize = 4096;

/// The threads of a context; with one, everything runs on the calling thread.
pub struct Threads {
    pool: Option<Pool>,
    used: Vec<AtomicBool>,
    log: Arc<LogQueue>,
}

impl Threads {
    /// Starts them. Error: [`Status::Threads`] if the system refuses one.
    pub(crate) fn new(count: usize, log: &Arc<LogQueue>) -> Result<Arc<Self>> {
        let pool = if count > 1 { Some(Pool::new(count, log)?) } else { None };
        let used = (0..count).map(|_| AtomicBool::new(false)).collect();
        Ok(Arc::new(Self { pool, used, log: Arc::clone(log) }))
    }

    /// Number of threads that run a step, the calling one included if it is the only one.
    pub fn count(&self) -> usize {
        self.used.len()
    }

    /// How many distinct threads have run tasks so far; see [`Threads::mark`].
    pub fn used(&self) -> usize {
        self.used.iter().filter(|u| u.load(Ordering::Relaxed)).count()
    }

    /// Runs `f` inside the pool, or on the calling thread if there is one thread. Panics of `f` go
    /// through.
    pub fn install<R: Send>(&self, f: impl FnOnce() -> R + Send) -> R {
        match &self.pool {
            Some(pool) => pool.install(f),
            None => {
                let _scope = LogScope::enter(&self.log);
                f()
            }
        }
    }

    /// Runs `a` and `b`, at the same time if the calling code is inside [`Threads::install`] of a
    /// pool.
    ///
    /// With one thread both run here one after the other; `rayon::join` would start rayon's global
    /// pool.
    pub fn join<A: Send, B: Send>(
        &self,
        a: impl FnOnce() -> A + Send,
        b: impl FnOnce() -> B + Send,
    ) -> (A, B) {
        match &self.pool {
            Some(pool) if pool.is_inside() => rayon::join(a, b),
            _ => (a(), b()),
        }
    }

    /// Records that the running thread has worked for this context.
    pub fn mark(&self) {
        let worker = match &self.pool {
            Some(pool) => pool.worker(),
            None => Some(0),
        };
        if let Some(used) = worker.and_then(|w| self.used.get(w))
            && !used.load(Ordering::Relaxed)
        {
            used.store(true, Ordering::Relaxed);
        }
    }

    /// Error [`Status::Threads`] if this process was forked after the threads had been started:
    /// they did not come along.
    pub fn check_process(&self) -> Result<()> {
        self.pool.as_ref().map_or(Ok(()), Pool::check_process)
    }
}

/// The threads that work on a step of a world: all of its context, or one.
#[derive(Clone)]
pub struct Team {
    threads: Arc<Threads>,
    together: bool,
}

impl Team {
    /// One thread, until there are enough particles.
    pub fn new(threads: &Arc<Threads>) -> Self {
        Self { threads: Arc::clone(threads), together: false }
    }

    /// All threads if so many particles are enough work for them.
    pub fn fit(&mut self, particles: usize) {
        self.together = self.threads.count() > 1 && particles >= SERIAL_BELOW;
    }

    /// Runs a step, or what else calls the methods below, where the team works.
    pub fn run<R: Send>(&self, f: impl FnOnce() -> R + Send) -> R {
        if self.together { self.threads.install(f) } else { f() }
    }

    /// Calls `f` on every thread that works, one after the other, and gives the first error: what
    /// one thread tries to reserve must not be missing on another.
    pub fn on_each_thread(&self, f: impl Fn() -> Result<()> + Sync) -> Result<()> {
        match &self.threads.pool {
            Some(pool) if self.together => pool.on_each_thread(f),
            _ => f(),
        }
    }

    /// Whether all threads work, or one.
    pub fn is_together(&self) -> bool {
        self.together
    }

    /// Calls `work` with the whole, or with its parts on all threads. What it does must not depend
    /// on how the whole was divided.
    pub fn for_each<W: Divide>(&self, whole: W, work: impl Fn(W) + Sync) {
        if self.together { self.part(whole, &work, &|(), ()| ()) } else { work(whole) }
    }

    /// Calls `work` with the parts, and folds the results from left to right: neither parts nor
    /// order depend on the number of threads.
    pub fn fold<W: Divide, R: Send>(
        &self,
        whole: W,
        work: &(impl Fn(W) -> R + Sync),
        fold: &(impl Fn(R, R) -> R + Sync),
    ) -> R {
        self.part(whole, work, fold)
    }

    fn part<W: Divide, R: Send>(
        &self,
        whole: W,
        work: &(impl Fn(W) -> R + Sync),
        fold: &(impl Fn(R, R) -> R + Sync),
    ) -> R {
        let (left, right) = whole.divide();
        let Some(right) = right else {
            if self.together {
                self.threads.mark();
            }
            return work(left);
        };
        let (run_left, run_right) =
            (|| self.part(left, work, fold), || self.part(right, work, fold));
        let (a, b) = if self.together {
            rayon::join(run_left, run_right)
        } else {
            (run_left(), run_right())
        };
        fold(a, b)
    }

    /// Calls `work` with number and slices of every piece; threads take at least `grain` pieces at
    /// a time.
    pub fn for_each_piece<S: Slices>(
        &self,
        slices: S,
        grain: usize,
        work: impl Fn(usize, S::Piece) + Sync,
    ) {
        self.for_each(Pieces { slices, first: 0, grain }, |mut pieces| {
            while let Some(piece) = pieces.slices.next() {
                work(pieces.first, piece);
                pieces.first += 1;
            }
        });
    }
}

/// Work that can be divided among threads.
pub trait Divide: Sized + Send {
    /// Two parts, or the whole if it is small enough for one thread.
    fn divide(self) -> (Self, Option<Self>);
}

/// Slices that are cut into pieces of a given length, in parallel: piece n of one goes with piece n
/// of the others.
pub trait Slices: Sized + Send {
    /// A piece of each.
    type Piece;
    /// Number of pieces.
    fn count(&self) -> usize;
    /// The first `pieces` pieces, and the others.
    fn split(self, pieces: usize) -> (Self, Self);
    /// Takes the first piece.
    fn next(&mut self) -> Option<Self::Piece>;
}

/// A slice, and the length of its pieces; the last one may be shorter.
pub struct Cut<S>(pub S, pub usize);

impl<'a, T: Send> Slices for Cut<&'a mut [T]> {
    type Piece = &'a mut [T];

    #[inline(always)]
    fn count(&self) -> usize {
        self.0.len().div_ceil(self.1)
    }

    fn split(self, pieces: usize) -> (Self, Self) {
        let at = (pieces * self.1).min(self.0.len());
        let (a, b) = self.0.split_at_mut(at);
        (Self(a, self.1), Self(b, self.1))
    }

    #[inline(always)]
    fn next(&mut self) -> Option<Self::Piece> {
        let at = self.1.min(self.0.len());
        (at > 0).then(|| self.0.split_off_mut(..at)).flatten()
    }
}

impl<'a, T: Sync> Slices for Cut<&'a [T]> {
    type Piece = &'a [T];

    #[inline(always)]
    fn count(&self) -> usize {
        self.0.len().div_ceil(self.1)
    }

    fn split(self, pieces: usize) -> (Self, Self) {
        let (a, b) = self.0.split_at((pieces * self.1).min(self.0.len()));
        (Self(a, self.1), Self(b, self.1))
    }

    #[inline(always)]
    fn next(&mut self) -> Option<Self::Piece> {
        let at = self.1.min(self.0.len());
        (at > 0).then(|| self.0.split_off(..at)).flatten()
    }
}

/// Tuples of slices; all have as many pieces as the first.
macro_rules! tuples {
    ($($name:ident $field:tt),+) => {
        impl<$($name: Slices),+> Slices for ($($name,)+) {
            type Piece = ($($name::Piece,)+);

            #[inline(always)]
            fn count(&self) -> usize {
                self.0.count()
            }

            fn split(self, pieces: usize) -> (Self, Self) {
                let parts = ($(self.$field.split(pieces),)+);
                (($(parts.$field.0,)+), ($(parts.$field.1,)+))
            }

            #[inline(always)]
            fn next(&mut self) -> Option<Self::Piece> {
                Some(($(self.$field.next()?,)+))
            }
        }
    };
}
tuples!(A 0, B 1);
tuples!(A 0, B 1, C 2);
tuples!(A 0, B 1, C 2, E 3);
tuples!(A 0, B 1, C 2, E 3, F 4);

struct Pieces<S> {
    slices: S,
    first: usize,
    grain: usize,
}

impl<S: Slices> Divide for Pieces<S> {
    fn divide(self) -> (Self, Option<Self>) {
        let count = self.slices.count();
        if count < 2 * self.grain {
            return (self, None);
        }
        let (left, right) = self.slices.split(count / 2);
        let part = |slices, first| Self { slices, first, grain: self.grain };
        (part(left, self.first), Some(part(right, self.first + count / 2)))
    }
}

/// A pool (until it is dropped) and the handles of its threads.
struct Pool {
    pool: Option<ThreadPool>,
    handles: Vec<JoinHandle<()>>,
    process: u32,
}

impl Pool {
    fn new(threads: usize, log: &Arc<LogQueue>) -> Result<Pool> {
        let mut handles = Vec::with_capacity(threads);
        let queue = Arc::clone(log);
        let built = ThreadPoolBuilder::new()
            .num_threads(threads)
            .start_handler(move |_| {
                // Threads inherit the floating-point environment of the thread that starts them,
                // traps included.
                environment::set_default();
                platform::silence();
                log::adopt(&queue);
            })
            .spawn_handler(|worker| {
                let name = format!("lahar-{}", worker.index());
                handles.push(thread::Builder::new().name(name).spawn(|| worker.run())?);
                Ok(())
            })
            .build();
        match built {
            Ok(pool) => Ok(Pool { pool: Some(pool), handles, process: process::id() }),
            Err(error) => {
                join(handles);
                Err(Error::new(
                    Status::Threads,
                    format!("{threads} threads could not be started: {error}; ask for fewer"),
                ))
            }
        }
    }

    fn install<R: Send>(&self, f: impl FnOnce() -> R + Send) -> R {
        match &self.pool {
            Some(pool) => pool.install(f),
            None => f(),
        }
    }

    fn on_each_thread(&self, f: impl Fn() -> Result<()> + Sync) -> Result<()> {
        match &self.pool {
            Some(pool) => {
                let alone = Mutex::new(());
                let one_by_one = |_: BroadcastContext<'_>| {
                    let _alone = alone.lock().unwrap_or_else(PoisonError::into_inner);
                    f()
                };
                pool.broadcast(one_by_one).into_iter().collect()
            }
            None => f(),
        }
    }

    fn is_inside(&self) -> bool {
        self.worker().is_some()
    }

    /// Number of the running thread, if it belongs to this pool.
    fn worker(&self) -> Option<usize> {
        self.pool.as_ref().and_then(ThreadPool::current_thread_index)
    }

    fn check_process(&self) -> Result<()> {
        if process::id() == self.process {
            return Ok(());
        }
        Err(Error::new(
            Status::Threads,
            "the process was forked after this context had started its threads, and they stayed in the parent; create \
             the context after the fork",
        ))
    }
}

impl Drop for Pool {
    fn drop(&mut self) {
        let handles = mem::take(&mut self.handles);
        if self.check_process().is_err() {
            // The threads are the parent's: there is nothing to stop, and joining would never end.
            mem::forget(self.pool.take());
            return;
        }
        self.pool = None; // the drop ends the threads
        join(handles);
    }
}

/// Waits for the threads to end; the running one cannot wait for itself.
fn join(handles: Vec<JoinHandle<()>>) {
    for handle in handles {
        if handle.thread().id() != thread::current().id() {
            let _ = handle.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All pieces of a list, whose elements get the numbers of their pieces.
    fn numbered(threads: usize, length: usize) -> Vec<usize> {
        let threads = Threads::new(threads, &Arc::default()).expect("threads");
        let mut team = Team::new(&threads);
        team.fit(SERIAL_BELOW);
        let (mut list, other) = (vec![0; length], vec![1; length]);
        team.run(|| {
            let slices = (Cut(&mut list[..], 3), Cut(&other[..], 3));
            team.for_each_piece(slices, 2, |n, (piece, other)| {
                assert_eq!(piece.len(), other.len());
                piece.fill(n);
            });
        });
        list
    }

    #[test]
    fn pieces_have_the_same_numbers_for_any_number_of_threads() {
        for length in [0, 1, 3, 50, 1000] {
            let one: Vec<usize> = (0..length).map(|k| k / 3).collect();
            assert_eq!(numbered(1, length), one);
            assert_eq!(numbered(3, length), one);
        }
    }
}
