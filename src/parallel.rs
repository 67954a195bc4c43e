//! The threads of a context: a rayon pool whose threads are joined, which rayon's own do not offer.

use crate::error::{Error, Result, Status};
use crate::log::{self, LogQueue};
use crate::platform;
use crate::simd::environment;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::mem;
use std::process;
use std::sync::Arc;
use std::thread::{self, JoinHandle};

/// A pool (until it is dropped) and the handles of its threads.
pub(crate) struct Pool {
    pool: Option<ThreadPool>,
    handles: Vec<JoinHandle<()>>,
    process: u32,
}

impl Pool {
    pub(crate) fn new(threads: usize, log: &Arc<LogQueue>) -> Result<Pool> {
        let mut handles = Vec::with_capacity(threads);
        let queue = Arc::clone(log);
        let built = ThreadPoolBuilder::new()
            .num_threads(threads)
            .start_handler(move |_| {
                // Threads inherit the floating-point environment of the thread that starts them, traps included.
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

    pub(crate) fn install<R: Send>(&self, f: impl FnOnce() -> R + Send) -> R {
        match &self.pool {
            Some(pool) => pool.install(f),
            None => f(),
        }
    }

    pub(crate) fn is_inside(&self) -> bool {
        self.worker().is_some()
    }

    /// Number of the running thread, if it belongs to this pool.
    pub(crate) fn worker(&self) -> Option<usize> {
        self.pool.as_ref().and_then(ThreadPool::current_thread_index)
    }

    pub(crate) fn check_process(&self) -> Result<()> {
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
        self.pool = None; // tells the threads to end
        join(handles);
    }
}

/// Waits for the threads to end; the running one cannot wait for itself.
fn join(handles: Vec<JoinHandle<()>>) {
    for handle in handles {
        if handle.thread().id() != thread::current().id() {
            let _ = handle.join(); // a panic of a task was reported by `install`
        }
    }
}
