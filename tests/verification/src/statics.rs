//! What drivers of cases at rest share: loads that grow, and settling.

use lahar::boundary::{BoxRegion, Table, Traction};
use lahar::error::Result;
use lahar::world::World;
use lahar::world::statics::Criteria;

use crate::run::Outcome;

/// A value that grows from nothing until a time [s] and stays.
pub fn ramp(until: f64, value: [f64; 3]) -> Result<Table> {
    Table::new("a ramp", &[0.0, until], &[[0.0; 3], value])
}

/// Steps until the world is at rest, or until a time [s]. Gives `settled` (1 or 0) and `unbalanced`, the ratio of forces at the end.
pub fn settle(world: &mut World, until: f64, out: &mut Outcome) -> Result<()> {
    let criteria =
        Criteria { kinetic_ratio: 1e-9, unbalanced_ratio: 1e-5, until, ..Criteria::default() };
    let (settled, result) = world.settle(&criteria);
    result?;
    out.set("settled", f64::from(u8::from(settled.converged)));
    out.set("unbalanced", settled.equilibrium.unbalanced_ratio);
    Ok(())
}

/// A load on the outermost layer of particles of a body, a box that reaches `depth` [m] inwards from a face at `position`.
pub fn pull(
    world: &mut World,
    body: i64,
    (axis, side): (usize, i32),
    (position, depth): (f64, f64),
    traction: Table,
) -> Result<i64> {
    let (mut min, mut max) = ([f64::NEG_INFINITY; 3], [f64::INFINITY; 3]);
    min[axis] = if side > 0 { position - depth } else { f64::NEG_INFINITY };
    max[axis] = if side > 0 { f64::INFINITY } else { position + depth };
    world.add_traction(Traction { body, region: BoxRegion { min, max }, axis, side, traction })
}

/// The straight line through some points (x, y), by least squares, at x = 0.
pub fn at_zero(points: &[[f64; 2]]) -> f64 {
    let n = points.len() as f64;
    let mean = |c: usize| points.iter().map(|p| p[c]).sum::<f64>() / n;
    mean(1) - crate::judge::slope(points) * mean(0)
}
