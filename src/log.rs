//! The log: lines are queued wherever they arise and delivered on the thread of the caller.
//!
//! Each thread that works for a context has the context's queue, so that a plugin, which knows no
//! context, can log: workers for all their life, callers inside a [`LogScope`].

use crate::choice::choices;
use crate::error::one_line;
use crate::memory;
use std::cell::RefCell;
use std::mem;
use std::sync::atomic::{AtomicI32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

choices! {
    /// How important a line of the log is.
    #[derive(PartialOrd, Ord)]
    pub enum LogLevel: "log level" {
        /// Log level: something failed.
        Error = 0, "error", LAHAR_LOG_ERROR;
        /// Log level: something is unusual, such as a parameter outside its advised bounds.
        Warning = 1, "warning", LAHAR_LOG_WARNING;
        /// Log level: milestones, such as a loaded plugin.
        Information = 2, "information", LAHAR_LOG_INFORMATION;
        /// Log level: details for finding a fault.
        Detail = 3, "detail", LAHAR_LOG_DETAIL;
    }
}

/// Sink of log lines: called with the level and the text.
pub type LogSink = Arc<dyn Fn(i32, &str) + Send + Sync>;

/// Lines beyond this number are counted and dropped until the next delivery.
const CAPACITY: usize = 1000;

/// Longest line [bytes]; what is longer is cut.
const LONGEST_LINE: usize = 4096;

/// The lines of one context that wait for delivery.
pub(crate) struct LogQueue {
    max_level: AtomicI32,
    waiting: Mutex<Waiting>,
    sink: Mutex<Option<LogSink>>,
}

#[derive(Default)]
struct Waiting {
    lines: Vec<(i32, String)>,
    lost: usize,
}

impl Default for LogQueue {
    fn default() -> Self {
        Self { max_level: AtomicI32::new(-1), waiting: Mutex::default(), sink: Mutex::default() }
    }
}

impl LogQueue {
    pub(crate) fn push(&self, level: i32, text: &str) {
        if level > self.max_level.load(Ordering::Relaxed) {
            return;
        }
        let mut waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        // a line that there is no memory for is lost too
        if waiting.lines.len() < CAPACITY
            && memory::reserve(&mut waiting.lines, 1, "the log").is_ok()
            && memory::ensure(2 * LONGEST_LINE, "the log").is_ok()
        {
            waiting.lines.push((level, one_line(text, LONGEST_LINE)));
        } else {
            waiting.lost += 1;
        }
    }

    pub(crate) fn set_sink(&self, sink: Option<LogSink>, max_level: i32) {
        let level = if sink.is_some() { max_level } else { -1 };
        self.max_level.store(level, Ordering::Relaxed);
        *self.sink.lock().unwrap_or_else(PoisonError::into_inner) = sink;
    }

    pub(crate) fn flush(&self) {
        let waiting = mem::take(&mut *self.waiting.lock().unwrap_or_else(PoisonError::into_inner));
        if waiting.lines.is_empty() {
            return;
        }
        let sink = self.sink.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let Some(sink) = sink else { return };
        for (level, text) in &waiting.lines {
            sink(*level, text);
        }
        if waiting.lost > 0 {
            let text = format!("{} more lines of the log were dropped", waiting.lost);
            sink(LogLevel::Warning as i32, &text);
        }
    }
}

thread_local! {
    static CURRENT: RefCell<Option<Arc<LogQueue>>> = const { RefCell::new(None) };
}

/// Sets the queue of the running thread until it ends: for the start of a worker.
pub(crate) fn adopt(queue: &Arc<LogQueue>) {
    CURRENT.set(Some(Arc::clone(queue)));
}

/// Queues a line in the queue of the running thread; without a queue the line is dropped.
pub(crate) fn push_current(level: i32, text: &str) {
    // A thread that is being destroyed has no queue any more.
    let _ = CURRENT.try_with(|current| {
        if let Ok(current) = current.try_borrow()
            && let Some(queue) = current.as_ref()
        {
            queue.push(level, text);
        }
    });
}

/// Sets the queue of the running thread until it is dropped.
pub(crate) struct LogScope {
    previous: Option<Arc<LogQueue>>,
}

impl LogScope {
    pub(crate) fn enter(queue: &Arc<LogQueue>) -> Self {
        Self { previous: CURRENT.replace(Some(Arc::clone(queue))) }
    }

    /// Sets the queue only if the thread has none: cheap on workers.
    pub(crate) fn enter_if_none(queue: &Arc<LogQueue>) -> Option<Self> {
        CURRENT.with_borrow(Option::is_none).then(|| Self::enter(queue))
    }
}

impl Drop for LogScope {
    fn drop(&mut self) {
        CURRENT.set(self.previous.take());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_stays_one_line_and_ends_somewhere() {
        let (queue, seen) = (LogQueue::default(), Arc::new(Mutex::new(Vec::new())));
        let sink = Arc::clone(&seen);
        let push = move |_: i32, line: &str| sink.lock().expect("a lock").push(line.to_string());
        queue.set_sink(Some(Arc::new(push)), 3);
        queue.push(1, "one\nlahar error: two\r\x07");
        queue.push(1, &"x".repeat(1_000_000));
        queue.flush();
        let seen = seen.lock().expect("a lock");
        assert_eq!(seen[0], "one\\nlahar error: two\\r\\u{7}");
        assert!((4096..4200).contains(&seen[1].len()), "{} bytes", seen[1].len());
    }
}
