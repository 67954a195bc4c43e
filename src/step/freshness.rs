//! What of a world is current: one type with a verb for everything that hosts and steps do to it.
//!
//! | | positions checked | runs complete | positions marked | grid mapped | limits known |
//! |---|---|---|---|---|---|
//! | particles come or go | yes | no | no | no | no |
//! | shape functions change | no | no | no | no | no |
//! | a field is opened for writing | no | yes | no | yes | no |
//! | body forces are opened for writing | no | yes | yes | yes | yes |
//! | fields are closed | yes | yes | yes | no | yes |
//! | loads change | yes | yes | yes | no | yes |
//! | particles are sorted | yes | set | set | no | yes |
//! | a step is done | yes | yes | yes | set | set |
//! | a step is taken back | yes | yes | yes | no | yes |
//!
//! ("yes": as it was; "no": not any more; "set": from now on.) The grid is mapped again when it is
//! read.

use super::time_step::Limits;

/// What is current.
#[derive(Clone, Copy, Debug)]
pub struct Freshness {
    /// What the host wrote has been checked.
    checked: bool,
    /// Every particle stands in some run.
    grouped: bool,
    /// Every particle that may have left its block is marked.
    marked: bool,
    /// The time for which the grid holds mass, momentum and the forces of stresses and loads [s].
    mapped: Option<f64>,
    /// Limits of the next time step.
    limits: Option<Limits>,
    /// How often particles were sorted.
    sorts: u64,
}

impl Default for Freshness {
    fn default() -> Self {
        Self { checked: true, grouped: false, marked: false, mapped: None, limits: None, sorts: 0 }
    }
}

impl Freshness {
    /// Particles came or went.
    pub fn particles_came_or_went(&mut self) {
        (self.grouped, self.marked, self.mapped, self.limits) = (false, false, None, None);
    }

    /// Shape functions reach other nodes than before, and particles may stand where they must not.
    pub fn shapes_changed(&mut self) {
        self.checked = false;
        self.particles_came_or_went();
    }

    /// The host may write a field of particles from now on; for the grid that counts when it is
    /// done.
    pub fn field_opened(&mut self, field: &str) {
        self.checked = false;
        if field != "body_force" {
            // which changes neither wave speeds nor positions
            (self.marked, self.limits) = (false, None);
        }
    }

    /// Fields that were open for writing are closed.
    pub fn fields_closed(&mut self) {
        self.mapped = None;
    }

    /// A load on the particles came or went.
    pub fn loads_changed(&mut self) {
        self.mapped = None;
    }

    /// What the host wrote has been checked.
    pub fn was_checked(&mut self) {
        self.checked = true;
    }

    /// Particles are about to be moved into the runs of their blocks.
    pub fn locating(&mut self) {
        // until it is done: without memory the runs would not belong to the new blocks
        (self.grouped, self.mapped) = (false, None);
        self.sorts += 1;
    }

    /// How often particles were sorted.
    pub fn sorts(&self) -> u64 {
        self.sorts
    }

    /// All particles stand in the runs of their blocks.
    pub fn located(&mut self) {
        (self.grouped, self.marked) = (true, true);
    }

    /// The grid holds what the particles and loads give it at a time [s].
    pub fn mapped_at(&mut self, time: f64) {
        self.mapped = Some(time);
    }

    /// A step is done. It left the limits of the next one, and forces of the time `middle` [s] in
    /// the grid.
    pub fn stepped(&mut self, limits: Limits, middle: f64) {
        self.limits = Some(limits);
        self.mapped = Some(middle);
    }

    /// The materials computed the limits.
    pub fn limits_found(&mut self, limits: Limits) {
        self.limits = Some(limits);
    }

    /// A step was taken back: the grid holds what is not so any more.
    pub fn taken_back(&mut self) {
        self.mapped = None;
    }

    /// Whether what the host wrote must be checked.
    pub fn must_check(&self) -> bool {
        !self.checked
    }

    /// Whether all particles stand in runs, of their blocks or of those that they left.
    pub fn is_grouped(&self) -> bool {
        self.grouped
    }

    /// Whether all particles that may have left their blocks are marked.
    pub fn is_marked(&self) -> bool {
        self.marked
    }

    /// The time for which the grid holds what the particles are [s]; None if it does not.
    pub fn mapped(&self) -> Option<f64> {
        if self.grouped { self.mapped } else { None }
    }

    /// Limits of the next time step, if they are known.
    pub fn limits(&self) -> Option<Limits> {
        self.limits
    }
}
