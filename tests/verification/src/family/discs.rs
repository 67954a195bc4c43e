//! Two elastic discs fly at each other, touch and rebound.

use lahar::error::Result;
use lahar::world::World;
use serde::Deserialize;

use crate::run::Outcome;
use crate::world::{Elastic, Method, disc, fill, positions, write};

/// r = 0.2 m at (0.2, 0.2) and (0.8, 0.8), E = 1000 Pa, ν = 0.3, ρ = 1000 kg/m³, v = ±(0.1, 0.1) m/s, until t = 3.5 s.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setup {
    method: Method,
    /// Cells along 1 m.
    cells: usize,
    /// Model.
    #[serde(default)]
    model: Elastic,
}

const YOUNG: f64 = 1000.0;
const POISSON: f64 = 0.3;
const END: f64 = 3.5;
const RADIUS: f64 = 0.2;
/// When the discs would touch, were they rigid: their gap over their speed of approach [s].
const TOUCH: f64 = 1.585_786_437_626_905;

/// Gives `momentum` (largest drift over Σ |m v|), `energy_min`, `energy_max`, `energy_end` ((K + U) / K0), `kinetic_end`,
/// `kinetic_min`, `kinetic_min_time` [s], `gap` of the discs at the end [m], `contact` [s], `contact_early` (how much too early),
/// and the curves `kinetic` and `energy`.
pub fn run(setup: &Setup) -> Result<Outcome> {
    let (mut world, bodies) = two_discs(setup)?;
    let start = world.totals(None)?;
    let (scale, k0) = (start.mass * 0.02_f64.sqrt(), start.kinetic_energy);
    let (mut momentum, mut least, mut when) = (0.0_f64, f64::INFINITY, 0.0);
    let (mut kinetic, mut energy, mut contact) = (Vec::new(), Vec::new(), None);
    while world.time() < END {
        world.advance(END, 1).1?;
        let (totals, t) = (world.totals(None)?, world.time());
        momentum = totals.momentum.iter().fold(momentum, |m, p| m.max(p.abs() / scale));
        let k = totals.kinetic_energy / k0;
        if k < least {
            (least, when) = (k, t);
        }
        let e = k + totals.strain_energy / k0;
        // undisturbed flight has no strain at all, the first common node makes some
        if contact.is_none() && totals.strain_energy > 1e-9 * k0 {
            contact = Some(t);
        }
        kinetic.push([t, k]);
        energy.push([t, e]);
    }
    let contact = contact.unwrap_or(f64::NAN);
    let bounds =
        energy.iter().fold((f64::INFINITY, 0.0_f64), |b, e| (b.0.min(e[1]), b.1.max(e[1])));
    let last = |curve: &[[f64; 2]]| curve.last().map_or(f64::NAN, |point| point[1]);
    let mut out = Outcome::new();
    out.set("momentum", momentum);
    out.set("energy_min", bounds.0);
    out.set("energy_max", bounds.1);
    out.set("energy_end", last(&energy));
    out.set("kinetic_end", last(&kinetic));
    out.set("kinetic_min", least);
    out.set("kinetic_min_time", when);
    out.set("contact", contact);
    out.set("contact_early", TOUCH - contact);
    out.set("gap", gap(&world, bodies)?);
    out.curve("kinetic", kinetic);
    out.curve("energy", energy);
    Ok(out)
}

fn two_discs(setup: &Setup) -> Result<(World, [i64; 2])> {
    let (context, material) = setup.model.material(YOUNG, POISSON)?;
    let mut world = World::new(&context, &setup.method.options(1.0 / setup.cells as f64))?;
    let mut bodies = [0; 2];
    for (body, (c, v)) in bodies.iter_mut().zip([(0.2, 0.1), (0.8, -0.1)]) {
        *body = fill(&mut world, &material, &disc([c, c], RADIUS), 1000.0, 2)?;
        let velocity = vec![v; 2 * world.particle_count(*body)?];
        write(&mut world, *body, "velocity", &velocity)?;
    }
    Ok((world, bodies))
}

/// Smallest distance of particles of different bodies [m].
fn gap(world: &World, [a, b]: [i64; 2]) -> Result<f64> {
    let (a, b) = (positions(world, a)?, positions(world, b)?);
    let pairs = a.iter().flat_map(|p| b.iter().map(move |q| (p[0] - q[0]).hypot(p[1] - q[1])));
    Ok(pairs.fold(f64::INFINITY, f64::min))
}
