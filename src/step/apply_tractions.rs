//! Stage 2b, tractions: every loaded particle gives t A to the nodes around its place on the surface.
//!
//! A force at the centre of a particle would reach the nodes as if the surface stood half a particle inside the body, and the outermost
//! cell would carry a part of the stress alone. So the force acts at x_s = x_p ± n V / (2 A), the middle of the particle's outer face.
//! Nodes without mass get nothing: the weights of the others are scaled up, so that the sum of the forces is t A. The loop is
//! serial, in the order of the particles' ids: surfaces are thin.

use crate::background::{Grid, Lanes};
use crate::shape::stencil::At;
use crate::step::kernels::Kernels;
use crate::world::conditions::TractionEntry;
use crate::world::state::State;

/// Adds the forces of the tractions at the middle of the step to those of the stresses.
pub fn apply_tractions<const D: usize>(world: &mut State<D>, dt: f64) {
    let (space, middle) = (world.space(), world.time + 0.5 * dt);
    let State { bodies, grid, kernels, conditions, options, .. } = world;
    let mut forces = std::mem::take(&mut grid.force);
    for TractionEntry { load, surface, force: total, .. } in &mut conditions.tractions {
        *total = [0.0; 3];
        let Some(body) = bodies.iter().find(|body| body.id == load.body) else {
            continue;
        };
        let (particles, layout) = (&body.particles, body.particles.layout);
        let traction = load.traction.at(middle);
        surface.look_up(&particles.id);
        let faces = surface.areas.iter().zip(&surface.edges);
        for (place, (area, edge)) in surface.places.iter().zip(faces) {
            let center = particles.get::<D>(layout.position, *place);
            let [volume] = particles.get::<1>(layout.volume, *place);
            let mut face = center;
            let section = if options.axisymmetric { edge * center[0] } else { *edge };
            face[load.axis] += 0.5 * f64::from(load.side) * volume / section; // [CND-4]
            let force = traction.map(|t| t * area);
            // a face that has left the nodes of the body behind: its particle's own nodes have mass
            let near_face =
                spread(kernels, grid, space.at_point(face, [0.0; D]), force, &mut forces);
            if near_face
                || spread(kernels, grid, space.at_point(center, [0.0; D]), force, &mut forces)
            {
                (0..D).for_each(|a| total[a] += force[a]);
            }
        }
    }
    grid.force = forces;
}

/// Gives a force to the nodes with mass around a place; false if there is none.
fn spread<const D: usize>(
    kernels: &Kernels<D>,
    grid: &Grid<D>,
    at: [At<f64>; D],
    force: [f64; 3],
    forces: &mut [Lanes],
) -> bool {
    let mut sum = 0.0;
    let present = |node: usize| grid.velocity[grid.record(node)][0] > 0.0;
    (kernels.nodes_at)(grid, at, &mut |node, w| sum += if present(node) { w } else { 0.0 });
    if sum <= 0.0 {
        return false;
    }
    (kernels.nodes_at)(grid, at, &mut |node, w| {
        if present(node) {
            let record = &mut forces[grid.record(node)];
            (0..D).for_each(|a| record[a + 1] += w / sum * force[a]); // [CND-5]
        }
    });
    true
}
