//! Whether the stresses that a host gave to particles are kept by their model.
//!
//! The stress of an elastic solid grows from the one before, so that any can be given. That of a
//! hyperelastic solid follows from the deformation gradient, that of a fluid from its state, that
//! of a gas from its energy: another one would be gone after a step. So the model is asked for the
//! stress after an instant without strain. Where that is another one, the answer to a small change
//! of it tells a model that forgets (an error) from one that keeps what it can bear, as plasticity
//! does (a warning).

use lahar_plugin_abi::{LAHAR_OUTPUT_DIFFUSIVITY, LAHAR_POINT_FAILED};

use crate::error::{Error, Place, Result, Status};
use crate::material::scratch::{Scratch, with_scratch};
use crate::material::{Input, Kinematics, StressBatch};
use crate::memory::collect;
use crate::particles::inputs::fill_start;
use crate::particles::{Body, CHUNK};

/// What memory is for, if there is none.
const WHAT: &str = "the stresses after an instant";
/// Length of the instant [s], in which nothing flows; its square is still a number.
const INSTANT: f64 = 1e-150;
/// What counts as the same stress: this part of the largest in the body, and the stress of this
/// strain.
const SAME: f64 = 1e-6;
const SAME_STRAIN: f64 = 1e-12;
/// Strain of the small change: far above round-off, far below any yield.
const PROBE_STRAIN: f64 = 1e-9;

/// Where a model changes the stresses that were given.
#[derive(Default)]
struct Changes {
    points: usize,
    /// The first: its index in the body, the stress that it was given, the one that it would have.
    first: Option<(usize, [f64; 6], [f64; 6])>,
    /// The first that is forgotten, likewise.
    forgotten: Option<(usize, [f64; 6], [f64; 6])>,
}

/// Refuses stresses of a body that its model would forget. Gives a line for the log if the model
/// changes others.
pub fn check(body: &Body, spacing: f64) -> Result<Option<String>> {
    let model = body.material.model();
    // A viscous part of the stress belongs to the motion.
    if model.gives(LAHAR_OUTPUT_DIFFUSIVITY) && moves(body) {
        return Ok(None);
    }
    let Changes { points, first, forgotten } = changes(body, spacing)?;
    if let Some(change) = forgotten {
        return Err(forgets(body, change));
    }
    Ok(first.map(|(k, given, kept)| {
        format!(
            "the stress given to {points} particles of body {} is one that the model `{}` cannot \
             bear: the next step makes {kept:?} of {given:?} at particle {}, the first",
            body.id, model.name, body.particles.id[k]
        )
    }))
}

/// Whether the particles of a body have different velocities.
fn moves(body: &Body) -> bool {
    let (particles, layout) = (&body.particles, body.particles.layout);
    (layout.velocity..layout.velocity + layout.dimension).any(|c| {
        let column = particles.column(c);
        column.iter().any(|v| *v != column[0])
    })
}

fn changes(body: &Body, spacing: f64) -> Result<Changes> {
    let (particles, layout) = (&body.particles, body.particles.layout);
    let size = |c: usize| particles.column(c).iter().fold(0.0, |m: f64, s| m.max(s.abs()));
    let largest = (layout.stress..layout.stress + 6).map(size).fold(0.0, f64::max);
    let mut all = Changes::default();
    for start in (0..particles.len()).step_by(CHUNK) {
        let n = CHUNK.min(particles.len() - start);
        with_scratch(&body.material, n, |s| {
            fill_start(s, particles, start, spacing);
            changes_of_chunk(body, s, (start, SAME * largest), &mut all)
        })?;
    }
    Ok(all)
}

fn changes_of_chunk(
    body: &Body,
    s: &mut Scratch<'_>,
    (start, same): (usize, f64),
    all: &mut Changes,
) -> Result<()> {
    let given = collect((0..s.n).map(|k| s.stress0_of(k)), WHAT)?;
    let kept = after_an_instant(body, s)?;
    let particles = &body.particles;
    let modulus = |s: &Scratch<'_>, k: usize| {
        let at = |c: usize| particles.column(c)[start + k];
        let layout = particles.layout;
        at(layout.mass) / at(layout.volume) * s.wave_speed[k] * s.wave_speed[k]
    };
    let moduli = collect((0..s.n).map(|k| modulus(s, k)), WHAT)?;
    let changed = |k: usize| {
        let same = same + SAME_STRAIN * moduli[k];
        kept[k].is_some_and(|kept| parts(given[k], kept).into_iter().any(|part| part > same))
    };
    if !(0..s.n).any(changed) {
        return Ok(());
    }
    let probe = |k: usize| {
        let change = PROBE_STRAIN * moduli[k] + same; // cold gas has no modulus
        let [xx, yy, zz, xy, yz, zx] = kept[k].unwrap_or(given[k]).map(|v| 0.9 * v);
        [xx - change, yy - change, zz - change, xy + 0.01 * change, yz, zx]
    };
    let probes = collect((0..s.n).map(probe), WHAT)?;
    for (k, probe) in probes.iter().enumerate() {
        (0..6).for_each(|c| s.stress0[c * s.stride + k] = probe[c]);
    }
    let answers = after_an_instant(body, s)?;
    for k in (0..s.n).filter(|k| changed(*k)) {
        let (Some(kept), Some(answer)) = (kept[k], answers[k]) else { continue };
        let change = (start + k, given[k], kept);
        all.points += 1;
        all.first.get_or_insert(change);
        let same = same + SAME_STRAIN * moduli[k];
        let [lost, wanted, missed] =
            [parts(given[k], kept), parts(kept, probes[k]), parts(answer, probes[k])];
        if (0..2).any(|part| lost[part] > same && missed[part] > 0.5 * wanted[part]) {
            all.forgotten.get_or_insert(change);
        }
    }
    Ok(())
}

/// The stresses after an instant without strain; none where the model fails, which the step tells.
fn after_an_instant(body: &Body, s: &mut Scratch<'_>) -> Result<Vec<Option<[f64; 6]>>> {
    s.strain_increment.fill(0.0);
    s.velocity_gradient.fill(0.0);
    s.status.fill(0);
    body.material.update(&mut StressBatch { dt: INSTANT, ..s.batch() }).map_err(|error| {
        let place = Place { body: Some(body.id), ..Place::default() };
        let status = match error.status {
            Status::MaterialFailed => Status::MaterialRefused,
            other => other,
        };
        Error { status, ..error }.at(place)
    })?;
    let stress = |k: usize| {
        let stress: [f64; 6] = std::array::from_fn(|c| s.stress1[c * s.stride + k]);
        let good = s.status[k] < LAHAR_POINT_FAILED && stress.iter().all(|v| v.is_finite());
        (good && s.wave_speed[k].is_finite()).then_some(stress)
    };
    collect((0..s.n).map(stress), WHAT)
}

/// By how much two stresses differ: in the mean, and in the deviator.
fn parts(a: [f64; 6], b: [f64; 6]) -> [f64; 2] {
    let d: [f64; 6] = std::array::from_fn(|c| a[c] - b[c]);
    let mean = (d[0] + d[1] + d[2]) / 3.0;
    let part = |c: usize| if c < 3 { d[c] - mean } else { d[c] };
    [mean.abs(), (0..6).map(|c| part(c).abs()).fold(0.0, f64::max)]
}

fn forgets(body: &Body, (k, given, kept): (usize, [f64; 6], [f64; 6])) -> Error {
    let model = body.material.model();
    let (from, advice) = if model.kinematics == Kinematics::DeformationGradient {
        let advice = "write `deformation_gradient` and the `volume` that belongs to it";
        ("its deformation gradient".to_string(), advice)
    } else if model.input(Input::InternalEnergy).is_some() {
        let advice = "write `strain_energy`, of a gas mass p / ((gamma - 1) density)";
        ("its energy".to_string(), advice)
    } else {
        let states: Vec<&str> = model.states.iter().map(|s| s.key).collect();
        let advice = "call lahar_body_init_state after writing a stress that the model can have, of a fluid a pressure without shear \
                      (k0 = 1)";
        (format!("its state ({})", states.join(", ")), advice)
    };
    let id = body.particles.id[k];
    let text = format!(
        "the model `{}` would forget the stress {given:?} given to particle {id} of body {}: what follows from {from} is \
         {kept:?}; {advice}, or leave the stress as it was and bring the load up",
        model.name, body.id
    );
    let place = Place { body: Some(body.id), particle: Some(id), ..Place::default() };
    Error::new(Status::MaterialRefused, text).at(place)
}
