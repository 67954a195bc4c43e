//! The conditions of a world, kind by kind: ids, forces, limits of the time step, ends of tables. A
//! new kind is a line of [`Conditions`] and an implementation of [`Condition`].

use super::{Loaded, Prescribed, Table, Wall};
use crate::background::Background;
use crate::error::{Error, Result, Status};
use crate::memory::reserve;

/// What a condition that holds nodes must know of the step.
#[derive(Clone, Copy, Debug)]
pub struct Holding {
    /// Time at the start of the step [s].
    pub time: f64,
    /// Its length [s].
    pub dt: f64,
}

/// What the registry asks of every kind of condition.
pub trait Condition {
    /// What to call it in messages.
    const WHAT: &'static str;

    /// The last time at which its table changes something [s]; negative infinity without a table.
    fn end(&self) -> f64 {
        f64::NEG_INFINITY
    }

    /// The largest speed that it gives to nodes in a span of time [m/s].
    fn largest_speed(&self, _from: f64, _until: f64) -> f64 {
        0.0
    }

    /// Changes velocities and increments of nodes, after the walls, and gives the momentum that the
    /// material got [N s]; None if it does nothing to nodes here.
    fn hold<const D: usize>(
        &mut self,
        _background: &mut Background<D>,
        _step: &Holding,
    ) -> Option<[f64; 3]> {
        None
    }

    /// Does the same to another field of velocities of the step, which stand in the increments.
    fn hold_again<const D: usize>(&self, _background: &mut Background<D>) -> Option<[f64; 3]> {
        None
    }

    /// Whether it goes when this body goes.
    fn belongs_to(&self, _body: i64) -> bool {
        false
    }
}

/// A condition with its id.
#[derive(Clone, Debug)]
pub struct Entry<C> {
    /// Id, never reused among the conditions of a kind.
    pub id: i64,
    /// The condition.
    pub condition: C,
    /// Its force on the material in the last step [N].
    pub force: [f64; 3],
}

/// The conditions of a kind, in the order in which they were added.
#[derive(Clone, Debug)]
pub struct List<C> {
    entries: Vec<Entry<C>>,
    next: i64,
}

impl<C> Default for List<C> {
    fn default() -> Self {
        Self { entries: Vec::new(), next: 0 }
    }
}

impl<C: Condition> List<C> {
    /// Adds a condition and gives its id.
    pub fn add(&mut self, condition: C) -> Result<i64> {
        reserve(&mut self.entries, 1, "the conditions")?;
        let id = self.next;
        self.next += 1;
        self.entries.push(Entry { id, condition, force: [0.0; 3] });
        Ok(id)
    }

    /// Removes a condition. Error: [`Status::NotFound`].
    pub fn remove(&mut self, id: i64) -> Result<()> {
        let at = self.position(id)?;
        self.entries.remove(at);
        Ok(())
    }

    /// The condition with this id. Error: [`Status::NotFound`].
    pub fn get(&self, id: i64) -> Result<&Entry<C>> {
        Ok(&self.entries[self.position(id)?])
    }

    fn position(&self, id: i64) -> Result<usize> {
        let known = self.entries.iter().map(|entry| entry.id);
        let found = known.clone().position(|known| known == id);
        found.ok_or_else(|| not_found(C::WHAT, id, known))
    }
}

impl<C> std::ops::Deref for List<C> {
    type Target = [Entry<C>];

    fn deref(&self) -> &[Entry<C>] {
        &self.entries
    }
}

impl<C> std::ops::DerefMut for List<C> {
    fn deref_mut(&mut self) -> &mut [Entry<C>] {
        &mut self.entries
    }
}

/// A kind that the registry knows.
pub trait Listed: Condition + Sized {
    /// The conditions of this kind.
    fn list(conditions: &Conditions) -> &List<Self>;
    /// The same, to write.
    fn list_mut(conditions: &mut Conditions) -> &mut List<Self>;
}

macro_rules! conditions {
    ($($(#[$doc:meta])* $name:ident: $kind:ty,)+) => {
        /// All conditions of a world.
        #[derive(Debug, Default)]
        pub struct Conditions {
            /// Gravity by a table [m/s²]; None: that of the options.
            pub gravity: Option<Table>,
            $($(#[$doc])* pub $name: List<$kind>,)+
        }

        impl Conditions {
            /// Forces on the material in the last step [N]: what a step that is taken back must
            /// restore.
            pub fn forces(&mut self) -> impl Iterator<Item = &mut [f64; 3]> {
                let all = std::iter::empty();
                $(let all = all.chain(self.$name.iter_mut().map(|entry| &mut entry.force));)+
                all
            }

            /// The last time at which a table changes something [s]; negative infinity if none
            /// does.
            pub fn end(&self) -> f64 {
                let gravity = self.gravity.as_ref().map_or(f64::NEG_INFINITY, Table::end);
                let all = std::iter::once(gravity);
                $(let all = all.chain(self.$name.iter().map(|entry| entry.condition.end()));)+
                all.fold(f64::NEG_INFINITY, f64::max)
            }

            /// The longest step from `now` on that is at most `dt` [s] and in which no condition
            /// moves a node farther than `distance` [m].
            pub fn limit(&self, now: f64, mut dt: f64, distance: f64) -> f64 {
                $(for entry in self.$name.iter() {
                    dt = dt.min(distance / entry.condition.largest_speed(now, now + dt));
                })+
                dt
            }

            /// Lets all conditions hold the nodes; their forces are those of the step.
            pub fn hold<const D: usize>(&mut self, background: &mut Background<D>, step: &Holding) {
                $(for entry in self.$name.iter_mut() {
                    if let Some(impulse) = entry.condition.hold(background, step) {
                        entry.force = impulse.map(|impulse| impulse / step.dt);
                    }
                })+
            }

            /// The same for another field of velocities. If particles take it, `dt` [s] is the
            /// step, and the forces count it.
            pub fn hold_again<const D: usize>(
                &mut self,
                background: &mut Background<D>,
                dt: Option<f64>,
            ) {
                $(for entry in self.$name.iter_mut() {
                    let impulse = entry.condition.hold_again(background);
                    if let Some((impulse, dt)) = impulse.zip(dt) {
                        (0..D).for_each(|a| entry.force[a] += impulse[a] / dt);
                    }
                })+
            }

            /// Forgets the conditions on a body that is removed.
            pub fn remove_body(&mut self, body: i64) {
                $(self.$name.entries.retain(|entry| !entry.condition.belongs_to(body));)+
            }
        }

        $(impl Listed for $kind {
            fn list(conditions: &Conditions) -> &List<Self> {
                &conditions.$name
            }

            fn list_mut(conditions: &mut Conditions) -> &mut List<Self> {
                &mut conditions.$name
            }
        })+
    };
}

conditions! {
    /// Walls.
    walls: Wall,
    /// Prescribed velocities.
    prescribed: Prescribed,
    /// Tractions.
    tractions: Loaded,
}

impl Conditions {
    /// Gravity at a time [m/s²]; `constant` without a table.
    pub fn gravity(&self, constant: [f64; 3], time: f64) -> [f64; 3] {
        self.gravity.as_ref().map_or(constant, |table| table.at(time))
    }
}

/// The error that there is nothing with this id.
pub fn not_found(what: &str, id: i64, known: impl Iterator<Item = i64>) -> Error {
    let known: Vec<String> = known.take(24).map(|k| k.to_string()).collect();
    let list = if known.is_empty() { "there is none".into() } else { known.join(", ") };
    Error::new(Status::NotFound, format!("no {what} has the id {id} (known: {list})"))
}
