//! Statics by dynamics: how far from equilibrium, steps until it is reached, and initial stresses.

use crate::background::{Background, block_nodes, nodes_of};
use crate::boundary::{Reaching, law::constrain};
use crate::error::{Error, Result, Status};
use crate::log::LogLevel;
use crate::material::Kinematics;
use crate::memory::collect;
use crate::step::parts::Parts;

use super::bodies::init_state;
use super::given_stress;
use super::{Pause, World, on};

/// Steps between two checks of the equilibrium in [`World::settle`].
pub const STEPS_BETWEEN_CHECKS: i64 = 50;

/// Most nodes of a block.
const MOST_NODES: usize = block_nodes(3);

/// How far a world is from equilibrium.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Equilibrium {
    /// Σ ½ m v² of the particles [J].
    pub kinetic_energy: f64,
    /// Strain energy of the particles [J], as in the totals.
    pub strain_energy: f64,
    /// Kinetic energy over the energy of the stresses, see [CND-6] [–].
    pub kinetic_ratio: f64,
    /// Σ |F_i|, the forces that neither stresses nor supports balance [N].
    pub unbalanced_force: f64,
    /// Sum of the sizes of the forces that load the world: gravity, tractions, reactions of
    /// prescribed velocities; if there are none, the reactions of walls [N].
    pub external_force: f64,
    /// Unbalanced over external force, see [CND-7] [–].
    pub unbalanced_ratio: f64,
}

/// When a world counts as settled.
#[derive(Clone, Copy, Debug)]
pub struct Criteria {
    /// Largest kinetic ratio [–].
    pub kinetic_ratio: f64,
    /// Largest unbalanced ratio [–].
    pub unbalanced_ratio: f64,
    /// Most steps.
    pub max_steps: i64,
    /// Time at which to give up [s]; may be infinite.
    pub until: f64,
}

impl Default for Criteria {
    fn default() -> Self {
        let (kinetic_ratio, unbalanced_ratio) = (1e-4, 1e-3);
        Self { kinetic_ratio, unbalanced_ratio, max_steps: 1_000_000, until: f64::INFINITY }
    }
}

/// What [`World::settle`] did.
#[derive(Clone, Copy, Debug, Default)]
pub struct Settled {
    /// Whether both criteria hold.
    pub converged: bool,
    /// Committed steps.
    pub steps: i64,
    /// The equilibrium at the last check.
    pub equilibrium: Equilibrium,
}

impl World {
    /// How far the world is from equilibrium: energies of the particles, and the forces on the
    /// grid, which is that of the last step or, where something has been changed since, is
    /// [refreshed](World::refresh).
    pub fn equilibrium(&mut self) -> Result<Equilibrium> {
        self.refresh()?;
        self.equilibrium_of_grid()
    }

    /// The same for a world that is [fresh](World::is_fresh).
    pub fn equilibrium_of_grid(&self) -> Result<Equilibrium> {
        on!(&self, s => {
            let mapped = match s.freshness.mapped() {
                None if self.is_poisoned() => Some(s.clock.time), // of a grid that is half done
                mapped => mapped,
            };
            s.equilibrium(mapped.ok_or_else(|| Error::invalid(
                "the grid does not show the particles as they are: refresh the world first",
            ))?)
        })
    }

    /// Makes steps of the stable length until the world is in equilibrium, or until `max_steps` or
    /// `until` is reached. Gives what was reached, and the error that ended it.
    ///
    /// Equilibrium is checked every [`STEPS_BETWEEN_CHECKS`] steps, and not accepted before the
    /// time of the last row of every table in use.
    pub fn settle(&mut self, criteria: &Criteria) -> (Settled, Result<()>) {
        let mut settled = Settled::default();
        let result = self.settle_or_pause(criteria, &mut settled, &mut || false);
        (settled, result.map(drop))
    }

    /// The same, but returns early if `pause` says so: whether it is over. To call it again with
    /// what it has left in `settled` goes on as if there had been no pause.
    pub fn settle_or_pause(
        &mut self,
        criteria: &Criteria,
        settled: &mut Settled,
        pause: Pause<'_>,
    ) -> Result<bool> {
        if settled.steps == 0 {
            self.check_alive().and_then(|()| self.check_criteria(criteria))?;
        }
        loop {
            let unchecked = STEPS_BETWEEN_CHECKS - settled.steps % STEPS_BETWEEN_CHECKS;
            let steps = unchecked.min(criteria.max_steps - settled.steps);
            let (done, result) = self.advance_or_pause(criteria.until.min(f64::MAX), steps, pause);
            settled.steps += done;
            result?;
            let over = settled.steps >= criteria.max_steps || self.time() >= criteria.until;
            if done < steps && !over {
                return Ok(false);
            }
            settled.equilibrium = self.equilibrium()?;
            let now = settled.equilibrium;
            let constant = on!(&self, s => s.conditions.end() <= s.clock.time);
            settled.converged = constant
                && settled.steps > 0
                && now.kinetic_ratio <= criteria.kinetic_ratio
                && now.unbalanced_ratio <= criteria.unbalanced_ratio;
            if settled.converged || over {
                return Ok(true);
            }
        }
    }

    fn check_criteria(&self, criteria: &Criteria) -> Result<()> {
        let positive = |ratio: f64| ratio > 0.0 && ratio.is_finite();
        if !(positive(criteria.kinetic_ratio) && positive(criteria.unbalanced_ratio)) {
            return Err(Error::invalid(format!(
                "kinetic_ratio and unbalanced_ratio must be positive and finite, got {} and {}",
                criteria.kinetic_ratio, criteria.unbalanced_ratio
            )));
        }
        if criteria.max_steps < 1 || !(criteria.until > self.time()) {
            return Err(Error::invalid(format!(
                "settle needs max_steps >= 1 and `until` after now ({} s), got {} and {}",
                self.time(),
                criteria.max_steps,
                criteria.until
            )));
        }
        let empty = on!(&self, s => s.particle_count() == 0);
        if empty || criteria.until.is_infinite() && self.stable_dt()?.is_infinite() {
            return Err(Error::invalid(
                "the stable step is infinite (no particles, or none that carries a wave): nothing can settle; add a body, or give `until`",
            ));
        }
        Ok(())
    }

    /// Gives the particles of a body the stress of level ground at rest: σ_v = −γ z along gravity
    /// at the depth z below `surface` [m], k0 σ_v along the other axes, no shear; nothing above the
    /// surface. The model derives its state from that.
    ///
    /// `unit_weight` γ [N/m³]; None: the body's mass over its volume times gravity, as it is now.
    pub fn set_k0_stress(
        &mut self,
        body: i64,
        surface: f64,
        unit_weight: Option<f64>,
        k0: f64,
    ) -> Result<()> {
        self.check_alive()?;
        let warning = on!(&mut self, s => {
            let at = s.body_position(body)?;
            let ground = s.level_ground(at, surface, unit_weight, k0)?;
            s.start_anew(at, Some(&ground))
        })?;
        warning.iter().for_each(|text| self.context.log(LogLevel::Warning, text));
        Ok(())
    }

    /// Makes the model of a body derive its state from the stresses anew, as when the body was
    /// added; the old state is lost.
    pub fn init_body_state(&mut self, body: i64) -> Result<()> {
        self.check_alive()?;
        let warning = on!(&mut self, s => s.start_anew(s.body_position(body)?, None))?;
        warning.iter().for_each(|text| self.context.log(LogLevel::Warning, text));
        Ok(())
    }
}

/// Level ground along an axis.
struct Ground {
    axis: usize,
    /// +1 if depth grows with the coordinate, else −1.
    down: f64,
    surface: f64,
    unit_weight: f64,
    k0: f64,
}

impl<const D: usize> Parts<D> {
    /// From a grid that holds the forces of the time `mapped` [s].
    fn equilibrium(&self, mapped: f64) -> Result<Equilibrium> {
        let totals = self.totals(None);
        let stored = totals.strain_energy.abs().max(self.energy_of_stresses()?);
        let [unbalanced_force, external_force] = self.forces(self.gravity(mapped));
        Ok(Equilibrium {
            kinetic_energy: totals.kinetic_energy,
            strain_energy: totals.strain_energy,
            kinetic_ratio: ratio(totals.kinetic_energy, stored), // [CND-6]
            unbalanced_force,
            external_force,
            unbalanced_ratio: ratio(unbalanced_force, external_force), // [CND-7]
        })
    }

    /// Σ V σ:σ / (2 ρ c²) with the largest wave speed c: about the elastic energy of the stresses,
    /// initial ones included [J].
    fn energy_of_stresses(&self) -> Result<f64> {
        let limits = self.limits()?;
        let mut sum = 0.0;
        for body in &self.bodies {
            let (p, layout) = (&body.particles, body.particles.layout);
            for k in 0..p.len() {
                let [xx, yy, zz, xy, yz, zx] = p.get::<6>(layout.stress, k);
                let square = xx * xx + yy * yy + zz * zz + 2.0 * (xy * xy + yz * yz + zx * zx);
                let ([m], [v]) = (p.get::<1>(layout.mass, k), p.get::<1>(layout.volume, k));
                sum += square * v * v / m;
            }
        }
        let c = limits.speed;
        Ok(if c > 0.0 { 0.5 * sum / (c * c) } else { 0.0 })
    }

    /// Sums of |F_i| and of the forces that load the world, block by block in Morton order.
    ///
    /// What supports take up follows from the force alone, as on a node at rest: a wall takes from
    /// the force the components that it would take from a velocity.
    fn forces(&self, gravity: [f64; 3]) -> [f64; 2] {
        let loads = self.conditions.tractions.iter().map(|entry| size(&entry.condition.applied));
        let (mut unbalanced, mut external, mut walls) = (0.0, loads.sum::<f64>(), 0.0);
        let Background { space, blocks, nodes, .. } = &self.background;
        for slot in blocks.owned() {
            let key = &blocks.keys()[slot];
            let mut force = [[0.0; D]; MOST_NODES];
            for (n, node) in nodes_of::<D>(slot).enumerate() {
                let (m, f) = (nodes.velocity[node].mass(), &nodes.force[node]);
                force[n] = std::array::from_fn(|a| f.component(a) + m * gravity[a]);
                external += m * size(&gravity);
            }
            for entry in self.conditions.prescribed.iter() {
                let condition = &entry.condition.condition;
                condition.for_nodes_inside(space, key, |n| {
                    let held = |a: usize| condition.holds(a);
                    let free = std::array::from_fn(|a| if held(a) { 0.0 } else { force[n][a] });
                    external += difference(&force[n], &free);
                    force[n] = free;
                });
            }
            for (n, force) in force.iter_mut().enumerate() {
                let before = *force;
                let reaching = Reaching::new(&self.conditions.walls, space, key, n);
                constrain(reaching, force, &mut |_, _, _| {});
                walls += difference(&before, force);
            }
            unbalanced += force.iter().map(size).sum::<f64>();
        }
        [unbalanced, if external > 0.0 { external } else { walls }]
    }

    fn level_ground(
        &self,
        at: usize,
        surface: f64,
        unit_weight: Option<f64>,
        k0: f64,
    ) -> Result<Ground> {
        let gravity = self.gravity(self.clock.time);
        let pulling: Vec<usize> = (0..D).filter(|a| gravity[*a] != 0.0).collect();
        let [axis] = pulling[..] else {
            return Err(Error::invalid(format!(
                "a K0 stress needs gravity along one axis at the present time, {} s, got {:?} m/s^2: set gravity, or the \
                 table of gravity, first",
                self.clock.time,
                &gravity[..D]
            )));
        };
        if !(surface.is_finite() && k0 >= 0.0 && k0.is_finite()) {
            return Err(Error::invalid(format!(
                "surface_level must be finite [m] and k0 finite and not negative, got {surface} and {k0}"
            )));
        }
        let particles = &self.bodies[at].particles;
        let sum = |column: usize| particles.column(column).iter().sum::<f64>();
        let (mass, volume) = (sum(particles.layout.mass), sum(particles.layout.volume));
        let unit_weight = unit_weight.unwrap_or(mass / volume * gravity[axis].abs());
        if !(unit_weight > 0.0 && unit_weight.is_finite()) {
            return Err(Error::invalid(format!(
                "unit_weight must be positive and finite [N/m^3], or 0 for that of the body, got {unit_weight}"
            )));
        }
        let material = &self.bodies[at].material;
        if material.model().kinematics == Kinematics::DeformationGradient {
            return Err(Error::new(
                Status::Unsupported,
                format!(
                    "the stress of `{}` follows from the deformation gradient and cannot be set: bring gravity up by a \
                     table and settle instead",
                    material.model().name
                ),
            ));
        }
        Ok(Ground { axis, down: gravity[axis].signum(), surface, unit_weight, k0 })
    }

    fn set_ground_stress(&mut self, at: usize, ground: &Ground) {
        let particles = &mut self.bodies[at].particles;
        let layout = particles.layout;
        for k in 0..particles.len() {
            let x = particles.get::<D>(layout.position, k);
            let depth = (ground.down * (x[ground.axis] - ground.surface)).max(0.0);
            let vertical = -ground.unit_weight * depth; // [CND-8]
            for c in 0..6 {
                particles.column_mut(layout.stress + c)[k] = match c {
                    c if c == ground.axis => vertical,
                    0..3 => ground.k0 * vertical,
                    _ => 0.0,
                };
            }
        }
    }

    /// Sets the stresses if `ground` is given, and makes the model derive its state from them; on
    /// error the old ones stay.
    fn start_anew(&mut self, at: usize, ground: Option<&Ground>) -> Result<Option<String>> {
        let layout = self.bodies[at].particles.layout;
        let ranges = [(layout.stress, 6), (layout.state.first, layout.state.count)];
        let mut old = [Vec::new(), Vec::new()];
        for ((c, n), old) in ranges.into_iter().zip(&mut old) {
            let columns = self.bodies[at].particles.columns(c, n).iter().copied();
            *old = collect(columns, "the old stress and state")?;
        }
        if let Some(ground) = ground {
            self.set_ground_stress(at, ground);
        }
        let spacing = self.method.options.spacing;
        let warning = init_state(&mut self.bodies[at], spacing)
            .map_err(|error| match error.status {
                Status::MaterialRefused => Error { status: Status::InvalidArgument, ..error },
                _ => error,
            })
            .and_then(|()| {
                let body = &self.bodies[at];
                let stressed = body.particles.columns(layout.stress, 6).iter().any(|s| *s != 0.0);
                let given = stressed || body.stress_given;
                if given { given_stress::check(body, spacing) } else { Ok(None) }
            });
        match &warning {
            Ok(_) => self.bodies[at].stress_given = false,
            Err(_) => {
                for ((c, n), old) in ranges.into_iter().zip(old) {
                    self.bodies[at].particles.columns_mut(c, n).copy_from_slice(&old);
                }
                return warning;
            }
        }
        self.freshness.field_opened("stress");
        self.freshness.fields_closed();
        warning
    }
}

/// Length of a vector.
fn size<const N: usize>(v: &[f64; N]) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}

/// Length of the difference of two vectors.
fn difference<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    size(&std::array::from_fn::<f64, N, _>(|c| a[c] - b[c]))
}

/// a / b; nothing over nothing is zero.
fn ratio(a: f64, b: f64) -> f64 {
    if a == 0.0 { 0.0 } else { a / b }
}
