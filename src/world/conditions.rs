//! Conditions that depend on time: gravity by a table, velocities prescribed on the grid, tractions on surfaces.

use crate::boundary::table::length;
use crate::boundary::{PrescribedVelocity, Surface, Table, Traction};
use crate::error::Result;
use crate::step::time_step::Limits;

use super::state::State;
use super::{World, not_found, on};

/// The conditions of a world beside its walls.
#[derive(Debug, Default)]
pub struct Conditions {
    /// Gravity by a table [m/s²]; None: that of the options.
    pub gravity: Option<Table>,
    /// Prescribed velocities, in the order in which they were added.
    pub prescribed: Vec<PrescribedEntry>,
    /// Tractions, in the order in which they were added.
    pub tractions: Vec<TractionEntry>,
    next_prescribed: i64,
    next_traction: i64,
}

/// A prescribed velocity with its id.
#[derive(Clone, Debug)]
pub struct PrescribedEntry {
    /// Id, never reused.
    pub id: i64,
    /// The condition.
    pub condition: PrescribedVelocity,
    /// Velocity of the nodes at the end of the step [m/s].
    pub target: [f64; 3],
    /// Force on the material in the last step [N].
    pub reaction: [f64; 3],
}

/// A traction with its id.
#[derive(Clone, Debug)]
pub struct TractionEntry {
    /// Id, never reused.
    pub id: i64,
    /// The load.
    pub load: Traction,
    /// The particles that carry it.
    pub surface: Surface,
    /// Force on the body in the last step [N].
    pub force: [f64; 3],
}

impl Conditions {
    /// The last time at which a table changes something [s]; negative infinity if none does.
    pub fn end(&self) -> f64 {
        let tables = self.prescribed.iter().map(|entry| &entry.condition.velocity);
        let tables = tables.chain(self.tractions.iter().map(|entry| &entry.load.traction));
        tables.chain(&self.gravity).map(Table::end).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Forgets the loads on a body that is removed.
    pub fn remove_body(&mut self, body: i64) {
        self.tractions.retain(|entry| entry.load.body != body);
    }
}

impl<const D: usize> State<D> {
    /// Gravity at a time [m/s²].
    pub fn gravity(&self, time: f64) -> [f64; 3] {
        self.conditions.gravity.as_ref().map_or(self.options.gravity, |table| table.at(time))
    }

    /// The stable time step [s], from the limits of particles and materials.
    ///
    /// What comes by tables counts with its largest value in the longest step that could be taken without it.
    pub fn stable_dt(&self, limits: &Limits) -> f64 {
        let options = &self.options;
        let (now, free) = (self.time, limits.stable_dt(options, 0.0));
        let gravity = match &self.conditions.gravity {
            None => length(&options.gravity),
            Some(table) => table.largest(now, now + 0.5 * free),
        };
        let mut dt = limits.stable_dt(options, gravity);
        for entry in &self.conditions.prescribed {
            let speed = entry.condition.velocity.largest(now, now + dt);
            dt = dt.min(options.cfl * options.spacing / speed);
        }
        dt
    }
}

impl World {
    /// Sets gravity by a table [m/s²] from the next step on; None: back to the constant of the options.
    pub fn set_gravity_table(&mut self, table: Option<Table>) -> Result<()> {
        self.check_alive()?;
        for gravity in table.iter().flat_map(Table::rows) {
            self.options().check_gravity(*gravity)?;
        }
        on!(&mut self, s => s.conditions.gravity = table);
        Ok(())
    }

    /// Sets constant gravity [m/s²] from the next step on; a table is forgotten.
    pub fn set_gravity(&mut self, gravity: [f64; 3]) -> Result<()> {
        self.check_alive()?;
        self.options().check_gravity(gravity)?;
        on!(&mut self, s => {
            s.options.gravity = gravity;
            s.conditions.gravity = None;
        });
        Ok(())
    }

    /// Adds a prescribed velocity and gives its id.
    pub fn add_prescribed_velocity(&mut self, mut condition: PrescribedVelocity) -> Result<i64> {
        self.check_alive()?;
        condition.check(self.options().dimension)?;
        let components = condition.components; // what is free must not limit the step
        condition.velocity = condition.velocity.keeping(|a| components >> a & 1 == 1);
        on!(&mut self, s => {
            let id = s.conditions.next_prescribed;
            s.conditions.next_prescribed += 1;
            let (target, reaction) = (condition.velocity.at(s.time), [0.0; 3]);
            s.conditions.prescribed.push(PrescribedEntry { id, condition, target, reaction });
            Ok(id)
        })
    }

    /// Removes a prescribed velocity.
    pub fn remove_prescribed_velocity(&mut self, id: i64) -> Result<()> {
        self.check_alive()?;
        on!(&mut self, s => {
            let at = s.prescribed_position(id)?;
            s.conditions.prescribed.remove(at);
        });
        Ok(())
    }

    /// Force of a prescribed velocity on the material in the last step [N].
    pub fn prescribed_velocity_reaction(&self, id: i64) -> Result<[f64; 3]> {
        on!(&self, s => Ok(s.conditions.prescribed[s.prescribed_position(id)?].reaction))
    }

    /// Adds a traction and gives its id.
    pub fn add_traction(&mut self, load: Traction) -> Result<i64> {
        self.check_alive()?;
        load.check(self.options().dimension)?;
        on!(&mut self, s => {
            let surface = s.surface_of(&load)?;
            let id = s.conditions.next_traction;
            s.conditions.next_traction += 1;
            s.conditions.tractions.push(TractionEntry { id, load, surface, force: [0.0; 3] });
            Ok(id)
        })
    }

    /// Removes a traction.
    pub fn remove_traction(&mut self, id: i64) -> Result<()> {
        self.check_alive()?;
        on!(&mut self, s => {
            let at = s.traction_position(id)?;
            s.conditions.tractions.remove(at);
        });
        Ok(())
    }

    /// Number of particles that carry a traction, their area [m²], and the force on the body in the last step [N].
    pub fn traction_force(&self, id: i64) -> Result<(usize, f64, [f64; 3])> {
        on!(&self, s => {
            let entry = &s.conditions.tractions[s.traction_position(id)?];
            let surface = &entry.surface;
            Ok((surface.ids.len(), surface.areas.iter().sum(), entry.force))
        })
    }
}

impl<const D: usize> State<D> {
    fn surface_of(&self, load: &Traction) -> Result<Surface> {
        load.surface::<D>(self.body(load.body)?, self.options.axisymmetric)
    }

    fn prescribed_position(&self, id: i64) -> Result<usize> {
        let known = self.conditions.prescribed.iter().map(|entry| entry.id);
        let found = known.clone().position(|known| known == id);
        found.ok_or_else(|| not_found("prescribed velocity", id, known))
    }

    fn traction_position(&self, id: i64) -> Result<usize> {
        let known = self.conditions.tractions.iter().map(|entry| entry.id);
        let found = known.clone().position(|known| known == id);
        found.ok_or_else(|| not_found("traction", id, known))
    }
}
