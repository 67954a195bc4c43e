//! The inputs of models, from columns of particles.

use super::{Layout, Particles};
use crate::material::Input;
use crate::material::scratch::Scratch;

/// Fills the start (stress, state, deformation gradient) and the inputs of the particles from
/// `first` on; `spacing` is that of the grid [m].
pub fn fill_start(scratch: &mut Scratch<'_>, particles: &Particles, first: usize, spacing: f64) {
    let (layout, n, stride) = (particles.layout, scratch.n, scratch.stride);
    let column = |c: usize| &particles.column(c)[first..first + n];
    let gradient = layout.deformation_gradient.map_or(0, |columns| columns.first);
    for (rows, from) in [
        (&mut *scratch.stress0, layout.stress),
        (&mut *scratch.state0, layout.state.first),
        (&mut *scratch.deformation_gradient, gradient),
    ] {
        for (c, row) in rows.chunks_mut(stride).enumerate() {
            row[..n].copy_from_slice(column(from + c));
        }
    }
    fill_density(scratch, &layout, column);
    fill_inputs(scratch, &layout, column, &particles.id[first..first + n], spacing);
}

/// Fills the inputs that the model takes, but density; `column` gives a column of the points, `ids`
/// those of their particles, `spacing` is that of the grid [m].
pub fn fill_inputs<'c>(
    scratch: &mut Scratch<'_>,
    layout: &Layout,
    column: impl Fn(usize) -> &'c [f64],
    ids: &[i64],
    spacing: f64,
) {
    let (n, stride) = (scratch.n, scratch.stride);
    for (values, input) in scratch.inputs.chunks_mut(stride).zip(&scratch.model.inputs) {
        let values = &mut values[..n];
        let mut fill_from = |c: usize| values.copy_from_slice(column(c));
        match input {
            Input::Density => {}
            Input::ElementLength => values.fill(spacing),
            Input::Temperature => layout.temperature.iter().for_each(|c| fill_from(c.first)),
            Input::PorePressure => layout.pore_pressure.iter().for_each(|c| fill_from(c.first)),
            Input::InternalEnergy => {
                let pairs = column(layout.strain_energy).iter().zip(column(layout.mass));
                values.iter_mut().zip(pairs).for_each(|(value, (energy, mass))| {
                    *value = energy / mass;
                });
            }
            Input::PositionZ if layout.dimension < 3 => values.fill(0.0),
            Input::PositionX | Input::PositionY | Input::PositionZ => {
                let axis = *input as usize - Input::PositionX as usize;
                fill_from(layout.position + axis);
            }
            Input::ParticleId => {
                values.iter_mut().zip(ids).for_each(|(value, id)| *value = *id as f64);
            }
        }
    }
}

/// Fills the density from mass and volume, if the model takes it.
pub fn fill_density<'c>(
    scratch: &mut Scratch<'_>,
    layout: &Layout,
    column: impl Fn(usize) -> &'c [f64],
) {
    if let Some(density) = scratch.input(Input::Density) {
        let pairs = column(layout.mass).iter().zip(column(layout.volume));
        density.iter_mut().zip(pairs).for_each(|(value, (m, v))| *value = m / v);
    }
}
