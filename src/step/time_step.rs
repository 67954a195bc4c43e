//! Stage 0: how far may we go?
//!
//! The largest dt with (c + |v| + |g| dt) dt ≤ CFL h and dt ≤ CFL h² / (2 D ν), with the wave speed
//! c and the kinematic diffusivity ν of the materials, after R. Courant, K. Friedrichs, H. Lewy,
//! Math. Ann. 100 (1928) 32–74; the term with gravity g prevents what is at rest and carries no
//! wave from falling through a wall in one step. Each stress update leaves the limits of the next
//! step; after the host changed particles the materials compute them anew.

use lahar_plugin_abi::LAHAR_POINT_FAILED;

use super::options::Options;
use crate::boundary::Conditions;
use crate::boundary::table::length;
use crate::error::{Error, Place, Result, Status};
use crate::material::StressBatch;
use crate::material::scratch::with_scratch;
use crate::particles::inputs::{fill_density, fill_inputs};
use crate::particles::{Body, CHUNK};

/// What limits the next time step.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Largest c + |v| of all particles [m/s].
    pub speed: f64,
    /// Largest kinematic diffusivity [m²/s].
    pub diffusivity: f64,
    /// Longest step that a material requested [s]; infinity if none did.
    pub wanted_dt: f64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { speed: 0.0, diffusivity: 0.0, wanted_dt: f64::INFINITY }
    }
}

impl Limits {
    /// The stricter of both in every respect.
    pub fn merge(self, other: Self) -> Self {
        Self {
            speed: self.speed.max(other.speed),
            diffusivity: self.diffusivity.max(other.diffusivity),
            wanted_dt: self.wanted_dt.min(other.wanted_dt),
        }
    }

    /// The stable time step [s] with gravity `g` [m/s²]; infinity if nothing moves, pulls or
    /// resists.
    pub fn stable_dt(&self, options: &Options, g: f64) -> f64 {
        let (h, cfl, s) = (options.spacing, options.cfl, self.speed);
        let wave = 2.0 * cfl * h / (s + (s * s + 4.0 * g * cfl * h).sqrt()); // [CFL-1]
        let axes = options.dimension as f64;
        let viscous = cfl * h * h / (2.0 * axes * self.diffusivity); // [CFL-2]
        wave.min(viscous).min(self.wanted_dt)
    }
}

/// The stable time step [s] at the time `now` [s], from the limits of particles and materials.
///
/// What comes by tables counts with its largest value in the longest step that could be taken
/// without it.
pub fn stable_dt(limits: &Limits, options: &Options, conditions: &Conditions, now: f64) -> f64 {
    let free = limits.stable_dt(options, 0.0);
    let gravity = match &conditions.gravity {
        None => length(&options.gravity),
        Some(table) => table.largest(now, now + 0.5 * free),
    };
    let dt = limits.stable_dt(options, gravity);
    conditions.limit(now, dt, options.cfl * options.spacing)
}

/// Computes the limits from the materials' wave speeds and diffusivities in the present state.
pub fn limits_of_state<const D: usize>(bodies: &[Body], spacing: f64) -> Result<Limits> {
    let mut limits = Limits::default();
    for body in bodies {
        for first in (0..body.particles.len()).step_by(CHUNK) {
            let n = CHUNK.min(body.particles.len() - first);
            limits = limits.merge(limits_of_chunk::<D>(body, first, n, spacing)?);
        }
    }
    Ok(limits)
}

fn limits_of_chunk<const D: usize>(
    body: &Body,
    first: usize,
    n: usize,
    spacing: f64,
) -> Result<Limits> {
    let particles = &body.particles;
    let layout = particles.layout;
    with_scratch(&body.material, n, |s| {
        for c in 0..6 {
            s.stress0[c * s.stride..][..n]
                .copy_from_slice(&particles.column(layout.stress + c)[first..first + n]);
        }
        for c in 0..layout.state.count {
            s.state0[c * s.stride..][..n]
                .copy_from_slice(&particles.column(layout.state.first + c)[first..first + n]);
        }
        if let Some(gradient) =
            layout.deformation_gradient.filter(|_| !s.deformation_gradient.is_empty())
        {
            for c in 0..gradient.count {
                s.deformation_gradient[c * s.stride..][..n]
                    .copy_from_slice(&particles.column(gradient.first + c)[first..first + n]);
            }
        }
        let column = |c: usize| &particles.column(c)[first..first + n];
        fill_density(s, &layout, column);
        fill_inputs(s, &layout, column, &particles.id[first..first + n], spacing);
        let mut batch = StressBatch { dt: 0.0, time: 0.0, ..s.batch() };
        body.material
            .wave_speed(&mut batch)
            .map_err(|error| refused(body, None, &error.message))?;
        if let Some(k) = s.status[..n].iter().position(|status| *status >= LAHAR_POINT_FAILED) {
            return Err(refused(body, Some(first + k), "it says that the point failed"));
        }
        let mut limits = Limits::default();
        for k in 0..n {
            let v = particles.get::<D>(layout.velocity, first + k);
            let speed = s.wave_speed[k] + v.iter().map(|c| c * c).sum::<f64>().sqrt();
            if !speed.is_finite() || s.wave_speed[k] < 0.0 {
                let text = format!("the speed is {} m/s", s.wave_speed[k]);
                return Err(refused(body, Some(first + k), &text));
            }
            limits.speed = limits.speed.max(speed);
            if let Some(nu) = s.diffusivity.get(k) {
                limits.diffusivity = larger(limits.diffusivity, *nu);
            }
        }
        if !limits.diffusivity.is_finite() {
            let text = format!("the diffusivity is {} m^2/s", limits.diffusivity);
            return Err(refused(body, None, &text));
        }
        Ok(limits)
    })
}

/// A material that gives no wave speed at a particle, or at some of a body.
fn refused(body: &Body, k: Option<usize>, why: &str) -> Error {
    let particle = k.map(|k| body.particles.id[k]);
    let model = body.material.model().name;
    let at = particle.map_or(String::new(), |id| format!("particle {id} of "));
    let text = format!(
        "the model `{model}` gives no wave speed for {at}body {}: {why}; nothing was done: check velocity, stress, state, energy and \
         parameters",
        body.id
    );
    let place = Place { body: Some(body.id), particle, ..Place::default() };
    Error::new(Status::MaterialRefused, text).at(place)
}

/// The larger of two numbers, not a number if one of them is.
pub fn larger(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stable_step_is_the_longest_that_obeys_both_bounds() {
        for dimension in [2, 3] {
            let options = Options { dimension, spacing: 0.2, cfl: 0.4, ..Options::default() };
            for (speed, g) in [(30.0, 0.0), (30.0, 9.81), (0.0, 9.81), (1e-3, 1e4)] {
                let limits = Limits { speed, ..Limits::default() };
                let dt = limits.stable_dt(&options, g);
                let way = (speed + g * dt) * dt; // [CFL-1] holds as an equation
                assert!((way / (0.4 * 0.2) - 1.0).abs() < 1e-14, "{speed} m/s, {g} m/s²: {way} m");
            }
            let limits = Limits { diffusivity: 3.0, ..Limits::default() };
            let (dt, axes) = (limits.stable_dt(&options, 0.0), dimension as f64);
            assert!((dt * 2.0 * axes * 3.0 / (0.4 * 0.04) - 1.0).abs() < 1e-14, "{dt} s");
            let both = Limits { speed: 30.0, diffusivity: 3.0, wanted_dt: 1e-4 };
            assert_eq!(both.stable_dt(&options, 0.0), 1e-4);
        }
    }
}
