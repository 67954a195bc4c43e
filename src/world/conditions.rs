//! Conditions: walls, gravity by a table, velocities prescribed on the grid, tractions on surfaces.

use crate::boundary::{
    Conditions, Entry, Listed, Loaded, Prescribed, PrescribedVelocity, Table, Traction, Wall,
};
use crate::error::{Error, Result, Status};
use crate::shape::WallTreatment;
use crate::step::parts::Parts;

use super::{World, on};

impl World {
    pub(crate) fn conditions(&self) -> &Conditions {
        on!(&self, s => &s.conditions)
    }

    fn conditions_mut(&mut self) -> Result<&mut Conditions> {
        self.check_alive()?;
        Ok(on!(&mut self, s => &mut s.conditions))
    }

    /// Adds a checked condition of any kind and gives its id.
    pub fn add_condition<C: Listed>(&mut self, condition: C) -> Result<i64> {
        C::list_mut(self.conditions_mut()?).add(condition)
    }

    /// Removes a condition.
    pub fn remove_condition<C: Listed>(&mut self, id: i64) -> Result<()> {
        C::list_mut(self.conditions_mut()?).remove(id)
    }

    /// A condition, and its force on the material in the last step [N].
    pub fn condition<C: Listed>(&self, id: i64) -> Result<&Entry<C>> {
        C::list(self.conditions()).get(id)
    }

    /// Sets gravity by a table [m/s²] from the next step on; None: back to the constant of the
    /// options.
    pub fn set_gravity_table(&mut self, table: Option<Table>) -> Result<()> {
        self.check_alive()?;
        let table =
            table.map(|table| self.options().normalised_gravity_table(table)).transpose()?;
        self.conditions_mut()?.gravity = table;
        Ok(())
    }

    /// Sets constant gravity [m/s²] from the next step on; a table is forgotten.
    pub fn set_gravity(&mut self, gravity: [f64; 3]) -> Result<()> {
        self.check_alive()?;
        let gravity = self.options().normalised_gravity(gravity)?;
        on!(&mut self, s => s.method.options.gravity = gravity);
        self.conditions_mut()?.gravity = None;
        Ok(())
    }

    /// Adds a wall and gives its id.
    pub fn add_wall(&mut self, wall: &Wall) -> Result<i64> {
        self.check_alive()?;
        wall.check(self.options().dimension)?;
        on!(&mut self, s => {
            s.check_wall(wall)?;
            let id = s.conditions.walls.add(*wall)?;
            s.walls_changed();
            Ok(id)
        })
    }

    /// Removes a wall.
    pub fn remove_wall(&mut self, wall: i64) -> Result<()> {
        self.remove_condition::<Wall>(wall)?;
        on!(&mut self, s => s.walls_changed());
        Ok(())
    }

    /// Force of a wall on the material in the last step [N]; the force on the wall is the opposite.
    pub fn wall_reaction(&self, wall: i64) -> Result<[f64; 3]> {
        Ok(self.condition::<Wall>(wall)?.force)
    }

    /// Adds a prescribed velocity and gives its id.
    pub fn add_prescribed_velocity(&mut self, mut condition: PrescribedVelocity) -> Result<i64> {
        self.check_alive()?;
        condition.check(self.options().dimension)?;
        let components = condition.components; // what is free must not limit the step
        condition.velocity = condition.velocity.keeping(|a| components >> a & 1 == 1);
        let target = condition.velocity.at(self.time());
        self.add_condition(Prescribed { condition, target })
    }

    /// Removes a prescribed velocity.
    pub fn remove_prescribed_velocity(&mut self, id: i64) -> Result<()> {
        self.remove_condition::<Prescribed>(id)
    }

    /// Force of a prescribed velocity on the material in the last step [N].
    pub fn prescribed_velocity_reaction(&self, id: i64) -> Result<[f64; 3]> {
        Ok(self.condition::<Prescribed>(id)?.force)
    }

    /// Adds a traction and gives its id.
    pub fn add_traction(&mut self, load: Traction) -> Result<i64> {
        self.check_alive()?;
        load.check(self.options().dimension)?;
        on!(&mut self, s => {
            let axisymmetric = s.method.options.axisymmetric;
            let surface = s.with_surface(&load, axisymmetric)?;
            let id = s.conditions.tractions.add(Loaded { load, surface, applied: [0.0; 3] })?;
            s.freshness.loads_changed();
            Ok(id)
        })
    }

    /// Removes a traction.
    pub fn remove_traction(&mut self, id: i64) -> Result<()> {
        self.remove_condition::<Loaded>(id)?;
        on!(&mut self, s => s.freshness.loads_changed());
        Ok(())
    }

    /// Number of particles that carry a traction, their area [m²], and the force on the body in the
    /// last step [N].
    pub fn traction_force(&self, id: i64) -> Result<(usize, f64, [f64; 3])> {
        let entry = self.condition::<Loaded>(id)?;
        let surface = &entry.condition.surface;
        Ok((surface.ids.len(), surface.areas.iter().sum(), entry.force))
    }
}

impl<const D: usize> Parts<D> {
    fn with_surface(
        &self,
        load: &Traction,
        axisymmetric: bool,
    ) -> Result<crate::boundary::Surface> {
        load.surface::<D>(self.body(load.body)?, axisymmetric)
    }

    /// Refuses a wall that leaves no room between itself and another one.
    fn check_wall(&self, wall: &Wall) -> Result<()> {
        let options = &self.method.options;
        if options.wall_treatment != WallTreatment::Modified {
            return Ok(());
        }
        let least = 0.5 * options.spacing;
        let facing =
            |w: &&Entry<Wall>| w.condition.axis == wall.axis && w.condition.side != wall.side;
        for other in self.conditions.walls.iter().filter(facing) {
            let gap = f64::from(wall.side) * (other.condition.position - wall.position);
            if !(gap >= least) {
                return Err(Error::new(
                    Status::Unsupported,
                    format!(
                        "this wall leaves {gap} m between itself and wall {} at {}, less than half a cell ({least} m): \
                     move or remove one of them, or use wall_treatment plain",
                        other.id, other.condition.position
                    ),
                ));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::context::Context;
    use crate::step::options::Options;

    #[test]
    fn worlds_of_rust_callers_use_normalised_options_and_gravity() {
        let context = Context::new(Some(1)).expect("a context");
        let careless = Options {
            dimension: 2,
            spacing: 0.1,
            gravity: [1.0, -9.81, f64::INFINITY],
            filter_order: 0,
            ..Options::default()
        };
        let mut world = World::new(&context, &careless).expect("a world");
        assert_eq!(world.options().gravity, [1.0, -9.81, 0.0]);
        assert_eq!(world.options().filter_order, 2);

        world.set_gravity([0.0, -1.0, 7.0]).expect("a gravity");
        assert_eq!(world.options().gravity, [0.0, -1.0, 0.0]);
        let rows = [[0.0, -2.0, 7.0], [0.0, -3.0, 8.0]];
        let table = Table::new("gravity", &[0.0, 1.0], &rows).expect("a table");
        world.set_gravity_table(Some(table)).expect("a table of gravity");
        assert_eq!(on!(&world, s => s.gravity(0.5)), [0.0, -2.5, 0.0]);
    }
}
