//! The objects behind the handles: shared cells, so that children own their parents and handles can
//! be freed in any order.

use super::arguments::reference;
use super::context::lahar_context;
use super::entry::Scope;
use super::progress::Progress;
use super::world::lahar_world;
use crate::context::Context;
use crate::error::{Error, Result, Status};
use crate::world::{Pause, World};
use std::sync::atomic::{AtomicBool, AtomicI64, Ordering};
use std::sync::{Arc, Mutex, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard, TryLockError};
use std::time::Instant;

/// A context and the last error of any call on it or on its children.
pub(super) struct ContextCell {
    /// The engine's context.
    pub(super) context: Arc<Context>,
    last_error: Mutex<Option<Error>>,
}

impl ContextCell {
    /// A cell without an error.
    pub(super) fn new(context: Arc<Context>) -> Arc<Self> {
        Arc::new(Self { context, last_error: Mutex::new(None) })
    }

    /// Stores the error for `lahar_context_error_message`.
    pub(super) fn set_last_error(&self, error: Error) {
        *self.last_error.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
    }

    /// Calls `f` with the message of the last error of any thread.
    pub(super) fn with_error_message<R>(&self, f: impl FnOnce(&str) -> R) -> R {
        let last = self.last_error.lock().unwrap_or_else(PoisonError::into_inner);
        f(last.as_ref().map_or("", |error| &error.message))
    }
}

/// What a mutating call does to the storage of the particles, which open views look at.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Change {
    /// Parameters or values: views stay as they are.
    Values,
    /// A step, or a refresh of the grid: particles may be reordered. An open write view forbids it,
    /// read views become stale.
    Step,
    /// Bodies are added or removed. Any open view forbids it.
    Bodies,
}

/// What many steps did: number of committed ones, time that was reached [s], and the error that
/// ended them.
pub(super) type Steps = (i64, f64, Result<()>);

/// What many steps did so far: number of committed ones, and whether they are over, not paused.
pub(super) type Slice = (i64, Result<bool>);

/// A world with its lock, and what views need to know.
pub(super) struct WorldCell {
    /// The parent.
    pub(super) context: Arc<ContextCell>,
    /// 2 or 3.
    pub(super) dimension: usize,
    world: RwLock<World>,
    poisoned: AtomicBool,
    read_views: AtomicI64,
    write_views: AtomicI64,
    written_through_views: AtomicBool,
    generation: AtomicI64,
    progress: Mutex<Option<Progress>>,
    is_paused: AtomicBool,
}

impl WorldCell {
    /// A cell without views.
    pub(super) fn new(context: Arc<ContextCell>, world: World) -> Arc<Self> {
        Arc::new(Self {
            context,
            dimension: world.options().dimension,
            world: RwLock::new(world),
            poisoned: AtomicBool::new(false),
            read_views: AtomicI64::new(0),
            write_views: AtomicI64::new(0),
            written_through_views: AtomicBool::new(false),
            generation: AtomicI64::new(0),
            progress: Mutex::new(None),
            is_paused: AtomicBool::new(false),
        })
    }

    /// Sets who is called between steps.
    pub(super) fn set_progress(&self, progress: Option<Progress>) {
        *self.progress.lock().unwrap_or_else(PoisonError::into_inner) = progress;
    }

    /// After a panic: mutating calls are refused from now on.
    pub(super) fn poison(&self) {
        self.poisoned.store(true, Ordering::Release);
    }

    /// How often the storage order may have changed.
    pub(super) fn generation(&self) -> i64 {
        self.generation.load(Ordering::Acquire)
    }

    /// A vector of the host; in two dimensions its third component is ignored.
    pub(super) fn vector(&self, mut vector: [f64; 3]) -> [f64; 3] {
        vector[self.dimension..].fill(0.0);
        vector
    }

    /// Runs a query beside other queries; busy while the world changes. A poisoned world answers
    /// too.
    pub(super) fn query<R>(&self, f: impl FnOnce(&World) -> Result<R>) -> Result<R> {
        f(&*self.read()?)
    }

    /// As [`WorldCell::query`], for what depends on the storage order: first sorts the particles if
    /// needed, so that only a step or a refresh changes the order.
    pub(super) fn query_order<R>(&self, f: impl FnOnce(&World) -> Result<R>) -> Result<R> {
        self.query_when(World::is_sorted, f)
    }

    /// As [`WorldCell::query`], for what depends on the grid: first makes it current. What is
    /// written through views counts once all write views are closed.
    pub(super) fn query_grid<R>(&self, f: impl FnOnce(&World) -> Result<R>) -> Result<R> {
        let written = &self.written_through_views;
        if self.write_views.load(Ordering::Acquire) == 0 && written.load(Ordering::Acquire) {
            match self.write(Change::Values) {
                Ok(mut world) => {
                    written.store(false, Ordering::Release);
                    world.views_closed();
                }
                Err(error) if error.status == Status::Poisoned => {}
                Err(error) => return Err(error),
            }
        }
        self.query_when(World::is_fresh, f)
    }

    fn query_when<R>(
        &self,
        is_good: impl Fn(&World) -> bool,
        f: impl FnOnce(&World) -> Result<R>,
    ) -> Result<R> {
        let stale = |world: &World| !is_good(world) && !self.is_poisoned(world);
        let is_stale = stale(&*self.read()?);
        if is_stale {
            self.change(Change::Step, World::refresh)?;
        }
        let world = self.read()?;
        if stale(&world) { Err(busy()) } else { f(&world) }
    }

    /// Runs a mutating call: alone, on a world that is not poisoned, and if the open views allow
    /// it.
    pub(super) fn change<R>(
        &self,
        change: Change,
        f: impl FnOnce(&mut World) -> Result<R>,
    ) -> Result<R> {
        let is_refused =
            |result: &Result<R>| matches!(result, Err(error) if error.status as i32 > 0);
        let mut world = self.write(change)?;
        self.run(&mut world, change, f, is_refused)?
    }

    /// Runs many steps. `steps` makes them until it is over, or until its argument says to pause;
    /// then the host is called, and it is called again.
    pub(super) fn advance(
        &self,
        mut steps: impl FnMut(&mut World, Pause<'_>) -> Slice,
    ) -> Result<Steps> {
        let mut world = self.write(Change::Step)?;
        loop {
            let progress = *self.progress.lock().unwrap_or_else(PoisonError::into_inner);
            let start = Instant::now();
            let mut is_due = || progress.is_some_and(|p| start.elapsed() >= p.interval);
            let slice = |w: &mut World| steps(w, &mut is_due);
            let (done, result) = self.run(&mut world, Change::Step, slice, |(n, _)| *n == 0)?;
            let time = world.time();
            let (Ok(false), Some(progress)) = (&result, progress) else {
                return Ok((done, time, result.map(drop)));
            };
            let answer;
            (world, answer) = self.pause(world, || progress.call(done, time));
            if answer.is_err() || self.is_poisoned(&world) {
                return Ok((done, time, answer.and(Err(poisoned()))));
            }
        }
    }

    /// Runs `f` between two steps: the world answers queries and cannot be changed.
    fn pause<'a, R>(
        &'a self,
        world: RwLockWriteGuard<'a, World>,
        f: impl FnOnce() -> R,
    ) -> (RwLockWriteGuard<'a, World>, R) {
        self.is_paused.store(true, Ordering::Release);
        drop(world);
        let result = f();
        // waits for queries of other threads
        let world = self.world.write().unwrap_or_else(PoisonError::into_inner);
        self.is_paused.store(false, Ordering::Release);
        (world, result)
    }

    /// `is_unchanged`: whether nothing was done, by the result.
    fn run<R>(
        &self,
        world: &mut World,
        change: Change,
        f: impl FnOnce(&mut World) -> R,
        is_unchanged: impl FnOnce(&R) -> bool,
    ) -> Result<R> {
        let sorts = world.sorts();
        if change == Change::Step {
            if self.written_through_views.swap(false, Ordering::AcqRel) {
                world.views_closed();
            }
            self.context.context.check_process()?;
            // Before the call, so that views are stale after a panic too; nobody reads it under the
            // write lock.
            self.generation.fetch_add(1, Ordering::AcqRel);
        }
        let result = f(world);
        let same_order = world.sorts() == sorts && is_unchanged(&result) && !world.is_poisoned();
        if change == Change::Step && same_order {
            self.generation.fetch_sub(1, Ordering::AcqRel);
        }
        Ok(result)
    }

    fn is_poisoned(&self, world: &World) -> bool {
        self.poisoned.load(Ordering::Acquire) || self.world.is_poisoned() || world.is_poisoned()
    }

    fn read(&self) -> Result<RwLockReadGuard<'_, World>> {
        match self.world.try_read() {
            Ok(world) => Ok(world),
            Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => Err(busy()),
        }
    }

    fn write(&self, change: Change) -> Result<RwLockWriteGuard<'_, World>> {
        let world = match self.world.try_write() {
            Ok(world) => world,
            Err(TryLockError::Poisoned(_)) => return Err(poisoned()),
            Err(TryLockError::WouldBlock) => return Err(busy()),
        };
        if self.is_paused.load(Ordering::Acquire) {
            return Err(busy());
        }
        if self.is_poisoned(&world) {
            return Err(poisoned());
        }
        let reading = self.read_views.load(Ordering::Acquire);
        let writing = self.write_views.load(Ordering::Acquire);
        match change {
            Change::Step if writing > 0 => {
                Err(view_open(writing, "write view", "a step or a query that maps the grid anew"))
            }
            Change::Bodies if reading + writing > 0 => {
                Err(view_open(reading + writing, "view", "adding or removing a body"))
            }
            _ => Ok(world),
        }
    }
}

/// Counts as an open view while it lives.
pub(super) struct OpenView {
    /// The world whose field is viewed; it lives as long as the view.
    pub(super) cell: Arc<WorldCell>,
    write: bool,
}

impl OpenView {
    /// Must be called under the world's lock, so that no step comes between the check and the
    /// count.
    pub(super) fn new(cell: &Arc<WorldCell>, write: bool) -> Self {
        let view = Self { cell: cell.clone(), write };
        view.counter().fetch_add(1, Ordering::AcqRel);
        view
    }

    /// Whether the view may be written through.
    pub(super) fn is_write(&self) -> bool {
        self.write
    }

    fn counter(&self) -> &AtomicI64 {
        if self.write { &self.cell.write_views } else { &self.cell.read_views }
    }
}

impl Drop for OpenView {
    fn drop(&mut self) {
        if self.write {
            self.cell.written_through_views.store(true, Ordering::Release);
        }
        self.counter().fetch_sub(1, Ordering::AcqRel);
    }
}

impl Scope {
    /// The context behind a handle; errors and log lines of this call belong to it.
    pub(super) unsafe fn context(
        &mut self,
        handle: *const lahar_context,
    ) -> Result<Arc<ContextCell>> {
        // SAFETY: by contract of the caller the handle is NULL or alive.
        let cell = unsafe { reference(handle, "context") }?.cell.clone();
        self.attach_context(&cell);
        Ok(cell)
    }

    /// The world behind a handle; a panic in this call poisons it.
    pub(super) unsafe fn world(&mut self, handle: *const lahar_world) -> Result<Arc<WorldCell>> {
        // SAFETY: by contract of the caller the handle is NULL or alive.
        let cell = unsafe { reference(handle, "world") }?.cell.clone();
        self.attach_world(&cell);
        Ok(cell)
    }
}

fn busy() -> Error {
    Error::new(
        Status::Busy,
        "the world is in use, by another thread or by the call that this callback belongs to; expected one mutating call \
         at a time: try again",
    )
}

fn poisoned() -> Error {
    let text =
        "the world was poisoned by an earlier call that failed; it can only be queried and freed";
    Error::new(Status::Poisoned, text)
}

fn view_open(count: i64, what: &str, action: &str) -> Error {
    Error::new(
        Status::ViewOpen,
        format!("{count} {what}(s) open; free them with lahar_view_free before {action}"),
    )
}

#[cfg(test)]
mod tests {
    use super::super::entry::entry;
    use super::*;
    use crate::step::options::Options;

    fn cell() -> Arc<WorldCell> {
        let context = ContextCell::new(Context::new(Some(1)).expect("a context"));
        let options = Options { spacing: 1.0, ..Options::default() };
        let world = World::new(&context.context, &options).expect("a world");
        WorldCell::new(context, world)
    }

    fn status(result: Result<()>) -> Status {
        result.map_or_else(|error| error.status, |()| Status::Ok)
    }

    #[test]
    fn a_panic_in_a_mutating_call_poisons_the_world_and_queries_go_on() {
        let cell = cell();
        let code = entry("lahar_test", |scope| {
            scope.attach_world(&cell);
            cell.change(Change::Values, |_| panic!("on purpose"))
        });
        assert_eq!(code, Status::Panic as i32);
        assert!(cell.context.with_error_message(|message| message.contains("on purpose")));
        assert_eq!(status(cell.change(Change::Values, |_| Ok(()))), Status::Poisoned);
        assert_eq!(cell.query(|w| Ok(w.time())), Ok(0.0));
        assert_eq!(status(cell.query_order(|_| Ok(()))), Status::Ok);
    }

    #[test]
    fn a_panic_in_a_query_poisons_the_world_too() {
        let cell = cell();
        entry("lahar_test", |scope| {
            scope.attach_world(&cell);
            cell.query(|_| panic!("on purpose"))
        });
        assert_eq!(status(cell.change(Change::Step, |_| Ok(()))), Status::Poisoned);
        assert_eq!(status(cell.query(|_| Ok(()))), Status::Ok);
    }

    #[test]
    fn queries_run_together_and_a_mutating_call_runs_alone() {
        let cell = cell();
        let inside = |_: &World| {
            assert_eq!(status(cell.query(|_| Ok(()))), Status::Ok);
            assert_eq!(status(cell.change(Change::Values, |_| Ok(()))), Status::Busy);
            Ok(())
        };
        assert_eq!(status(cell.query(inside)), Status::Ok);
        let inside = |_: &mut World| {
            assert_eq!(status(cell.query(|_| Ok(()))), Status::Busy);
            assert_eq!(status(cell.change(Change::Values, |_| Ok(()))), Status::Busy);
            Ok(())
        };
        assert_eq!(status(cell.change(Change::Values, inside)), Status::Ok);
    }

    #[test]
    fn open_views_forbid_what_would_move_their_memory() {
        let cell = cell();
        let allowed = || {
            [Change::Values, Change::Step, Change::Bodies]
                .map(|c| status(cell.change(c, |_| Ok(()))))
        };
        let reading = OpenView::new(&cell, false);
        assert_eq!(allowed(), [Status::Ok, Status::Ok, Status::ViewOpen]);
        let writing = OpenView::new(&cell, true);
        assert_eq!(allowed(), [Status::Ok, Status::ViewOpen, Status::ViewOpen]);
        drop((reading, writing));
        assert_eq!(allowed(), [Status::Ok; 3]);
    }

    #[test]
    fn a_refused_step_leaves_the_generation_and_a_step_changes_it() {
        let cell = cell();
        cell.change(Change::Step, World::refresh).expect("an empty world is made fresh");
        let before = cell.generation();
        let refuse = |_: &mut World| Err::<(), _>(Error::new(Status::StepTooLarge, ""));
        assert_eq!(status(cell.change(Change::Step, refuse)), Status::StepTooLarge);
        assert_eq!(cell.generation(), before);
        assert_eq!(status(cell.change(Change::Step, |_| Ok(()))), Status::Ok);
        assert_eq!(cell.generation(), before + 1);
    }
}
