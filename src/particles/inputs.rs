//! The inputs of models, from columns of particles.

use super::Layout;
use crate::material::Input;
use crate::material::scratch::Scratch;

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
