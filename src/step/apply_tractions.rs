//! Stage 2b, tractions: every loaded particle adds t A to the nodes around its point of the
//! surface.
//!
//! A force at the centre of a particle would reach the nodes as if the surface stood half a
//! particle inside the body, and the outermost cell would carry a part of the stress alone. So the
//! force acts at x_s = x_p ± n V / (2 A), the middle of the particle's outer face. Nodes without
//! mass get nothing: the weights of the others are scaled up, so that the sum of the forces is t A.
//! The loop is serial, in the order of the particles' ids: surfaces are thin.

use super::parts::Method;
use crate::background::{Background, Blocks, Nodes};
use crate::boundary::{List, Loaded};
use crate::particles::Body;
use crate::shape::stencil::{At, at_point};

/// Adds the forces of the tractions at a time [s] to those of the stresses.
pub fn apply_tractions<const D: usize>(
    tractions: &mut List<Loaded>,
    bodies: &[Body],
    background: &mut Background<D>,
    method: &Method<D>,
    time: f64,
) {
    let Background { space, blocks, nodes, .. } = background;
    let mut spread = |layer: u32, x: [f64; D], force: [f64; 3]| {
        let point = (layer, at_point(space, x, [0.0; D]));
        spread(method, blocks, nodes, point, force)
    };
    for entry in tractions.iter_mut() {
        let Loaded { load, surface, applied } = &mut entry.condition;
        *applied = [0.0; 3];
        let Some(body) = bodies.iter().find(|body| body.id == load.body) else {
            continue;
        };
        let (particles, layout) = (&body.particles, body.particles.layout);
        let traction = load.traction.at(time);
        surface.look_up(&particles.id);
        let faces = surface.areas.iter().zip(&surface.edges);
        for (k, (area, edge)) in surface.places.iter().zip(faces) {
            let center = particles.get::<D>(layout.position, *k);
            let [volume] = particles.get::<1>(layout.volume, *k);
            let mut face = center;
            let section = if method.options.axisymmetric { edge * center[0] } else { *edge };
            face[load.axis] += 0.5 * f64::from(load.side) * volume / section; // [CND-4]
            let force = traction.map(|t| t * area);
            // a face that has left the nodes of the body behind: its particle's own nodes have mass
            if spread(body.layer, face, force) || spread(body.layer, center, force) {
                (0..D).for_each(|a| applied[a] += force[a]);
            }
        }
    }
}

/// Reports the forces that the grid holds as those of the step.
pub fn report_tractions(tractions: &mut List<Loaded>) {
    tractions.iter_mut().for_each(|entry| entry.force = entry.condition.applied);
}

/// Adds a force to the nodes with mass around a point in a layer; false if there is none.
fn spread<const D: usize>(
    method: &Method<D>,
    blocks: &Blocks<D>,
    Nodes { velocity, force: forces, .. }: &mut Nodes,
    (layer, at): (u32, [At<f64>; D]),
    force: [f64; 3],
) -> bool {
    let nodes_at = method.kernels.nodes_at;
    let mut sum = 0.0;
    let present = |node: usize| velocity[blocks.record(node)].mass() > 0.0;
    nodes_at(blocks, layer, at, &mut |node, w| sum += if present(node) { w } else { 0.0 });
    if sum <= 0.0 {
        return false;
    }
    nodes_at(blocks, layer, at, &mut |node, w| {
        if present(node) {
            let record = &mut forces[blocks.record(node)];
            (0..D).for_each(|a| *record.component_mut(a) += w / sum * force[a]); // [CND-5]
        }
    });
    true
}
