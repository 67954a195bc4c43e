//! What the engine has to reach, and whether this run shows it.
//!
//! Ratios of figures of one run are judged, and bytes. Nanoseconds belong to a machine: they inform.
//!
//! The targets of the scenes were set in nanoseconds, on a machine on which a thread copies 40 GB/s: there 56 doubles take
//! 11.2 ns. Over that, and rounded down, they are bounds in times the memory limit: 60 ns are 5.35. With 2 threads the limit is
//! that of the copy on one thread too, since what two threads copy together varies by a factor of two from run to run.
//!
//! The trough is younger. Its nanoseconds are as far above what it took in one run with the first scene, 1.87 times as long, as
//! those of the first scene are above what that took.
//!
//! Such a bound says little where memory is slow beside the cores: there the limit is so long that instructions hide in it. The
//! ratios to the measuring stick and to a peer do not have that flaw.

use super::rounds::{MOVED, Row, paired};
use super::scenes::{APIC_ELASTIC, FAR, LINKED};
use super::stick::Stick;

/// Whether a figure keeps its bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It does.
    Holds,
    /// It does not.
    Missed,
    /// It is not judged.
    Informs,
}

/// One target: what, the figure, the bound, whether it holds.
pub struct Check {
    /// What is judged.
    pub what: String,
    /// What was measured.
    pub figure: f64,
    /// What was asked for, as text: "≤ 5.35".
    pub bound: String,
    /// Whether the figure keeps the bound.
    pub verdict: Verdict,
}

/// Targets of a scene.
struct Target {
    scene: &'static str,
    nanoseconds: [f64; 2], // a particle and step, with 1 and with 2 threads, where a thread copies `COPY`
    bytes: f64,            // a particle
    flows: bool,           // so that particles leave their blocks in every step
}

const COPY: f64 = 40e9; // of one thread of the machine for which nanoseconds were set [bytes/s]
const TARGETS: [Target; 7] = [
    target("3d-quadratic-apic-elastic", [60.0, 32.0], 400.0),
    Target { flows: true, ..target("3d-quadratic-apic-drucker-prager-flow", [95.0, 50.0], 450.0) },
    Target { flows: true, ..target("3d-defaults-drucker-prager-walls", [110.0, 58.0], 450.0) },
    target("3d-quadratic-apic-newtonian", [60.0, 32.0], 350.0),
    target("3d-linear-flip-elastic", [45.0, 24.0], 350.0),
    target("3d-cubic-apic-elastic", [110.0, 58.0], 400.0),
    target("2d-quadratic-apic-elastic", [35.0, 19.0], 350.0),
];

const fn target(scene: &'static str, nanoseconds: [f64; 2], bytes: f64) -> Target {
    Target { scene, nanoseconds, bytes, flows: false }
}

/// The bound in times the memory limit, in hundredths, that is no easier than so many nanoseconds at [`COPY`].
fn times_limit(nanoseconds: f64) -> f64 {
    (nanoseconds * 1e-9 * COPY / MOVED * 100.0).floor() / 100.0
}

const SPEED_UP: f64 = 1.85; // of 2 threads
const GROWTH_UP: f64 = 1.06; // cost of a particle from N to 4 N
const GROWTH_FROM_BELOW: f64 = 1.25; // from N / 10 to N: there the caches end
const NOISE: f64 = 1.03; // equal times differ so much
const MEMORY_NOISE: f64 = 1.01;
const PLUGIN: f64 = 1.05; // a model through the plugin ABI over the same one linked statically
const LOCATE: f64 = 0.10; // share of sorting and upkeep of blocks in flow
const STICK: f64 = 1.45; // engine over stick

/// Particles of the small world that 2 threads must not slow down.
pub const SMALL: usize = 8000;

/// Judges what the rows allow to judge; `particles` is the number that the run was asked for.
pub fn judge(rows: &[Row], particles: usize, stick: Option<&Stick>) -> Vec<Check> {
    let mut checks = Vec::new();
    for target in &TARGETS {
        judge_scene(target, rows, particles, &mut checks);
    }
    let first = APIC_ELASTIC.name;
    let row = |scene: &str, asked: usize, threads: usize| find(rows, scene, asked, threads);
    let Some(one) = row(first, particles, 1) else { return checks };
    let mut ratio = |what: String, a: Option<&Row>, b: Option<&Row>, bound: f64| {
        if let (Some(a), Some(b)) = (a, b) {
            checks.push(at_most(what, paired(&a.samples, &b.samples), bound));
        }
    };
    let below = row(first, particles / 10, 1);
    let above = row(first, 4 * particles, 1);
    let far = row(FAR.name, particles, 1);
    ratio("cost of a particle, 4 times as many over these".into(), above, Some(one), GROWTH_UP);
    ratio(
        "cost of a particle, these over a tenth as many".into(),
        Some(one),
        below,
        GROWTH_FROM_BELOW,
    );
    ratio("time, domain 1000 times larger over this one".into(), far, Some(one), NOISE);
    let linked = row(LINKED.name, particles, 1);
    ratio("time, plugin loaded over linked".into(), Some(one), linked, PLUGIN);
    let small = |threads| row(first, SMALL, threads);
    ratio(format!("time, {SMALL} particles, 2 threads over 1"), small(2), small(1), NOISE);
    if let Some(far) = far {
        let memory = far.bytes / one.bytes;
        let what = "memory, domain 1000 times larger over this one".to_string();
        checks.push(at_most(what, memory, MEMORY_NOISE));
    }
    if let Some(stick) = stick {
        let what = format!("{first}, 1 thread, over the stick ({:.1} ns)", stick.nanoseconds());
        checks.push(at_most(what, paired(&one.samples, &stick.samples), STICK));
    }
    checks
}

fn judge_scene(target: &Target, rows: &[Row], particles: usize, checks: &mut Vec<Check>) {
    let scene = target.scene;
    let row = |threads| find(rows, scene, particles, threads);
    for (threads, bound) in [1, 2].into_iter().zip(target.nanoseconds) {
        let Some(this) = row(threads) else { continue };
        let what = if threads == 1 { "1 thread" } else { "2 threads" };
        if let Some(one) = row(1) {
            let ratio = this.ratio_at(&one.bandwidth);
            let of = if threads == 1 { "" } else { " of one" };
            let what = format!("{scene}, {what}: times memory limit{of}");
            checks.push(at_most(what, ratio, times_limit(bound)));
        }
        checks.push(at_most(format!("{scene}, {what}: bytes"), this.bytes, target.bytes));
        if target.flows
            && let Some(share) = this.stages["locate"].as_f64()
        {
            checks.push(at_most(format!("{scene}, {what}: share of locate"), share, LOCATE));
        }
        checks.push(Check {
            what: format!("{scene}, {what}: ns"),
            figure: this.nanoseconds(),
            bound: format!("{bound} at {} GB/s", COPY / 1e9),
            verdict: Verdict::Informs,
        });
    }
    if let (Some(one), Some(two)) = (row(1), row(2)) {
        let figure = paired(&one.samples, &two.samples);
        checks.push(at_least(format!("{scene}: times faster with 2 threads"), figure, SPEED_UP));
    }
}

fn find<'a>(rows: &'a [Row], scene: &str, asked: usize, threads: usize) -> Option<&'a Row> {
    rows.iter().find(|r| r.scene == scene && r.asked == asked && r.threads == threads)
}

/// A figure that must not exceed its bound.
pub fn at_most(what: String, figure: f64, bound: f64) -> Check {
    Check { what, figure, bound: format!("≤ {bound}"), verdict: verdict(figure <= bound) }
}

/// A figure that must reach its bound.
pub fn at_least(what: String, figure: f64, bound: f64) -> Check {
    Check { what, figure, bound: format!("≥ {bound}"), verdict: verdict(figure >= bound) }
}

fn verdict(holds: bool) -> Verdict {
    if holds { Verdict::Holds } else { Verdict::Missed }
}

#[cfg(test)]
mod tests {
    use super::super::scenes::SCENES;
    use super::*;

    fn row(scene: &str, asked: usize, threads: usize, samples: &[f64]) -> Row {
        Row {
            scene: scene.into(),
            asked,
            particles: asked as f64,
            threads,
            simd: String::new(),
            samples: samples.to_vec(),
            bytes: 300.0,
            bandwidth: vec![44.8e9; samples.len()],
            stages: serde_json::json!({ "locate": 0.2 }),
        }
    }

    #[test]
    fn rows_that_are_there_are_judged_round_by_round() {
        use Verdict::{Holds, Informs, Missed};
        let first = APIC_ELASTIC.name;
        let mut two = row(first, 1000, 2, &[25.0, 50.0, 40.0]);
        two.bandwidth.fill(80e9); // must not count: the limit is that of one thread
        let rows = [
            row(first, 1000, 1, &[50.0, 100.0, 50.0]),
            two,
            row(first, 4000, 1, &[55.0, 110.0, 55.0]),
        ];
        let checks = judge(&rows, 1000, None);
        let of = |text: &str| {
            let found = checks.iter().find(|check| check.what.contains(text));
            found.map(|check| (check.figure, check.verdict))
        };
        assert_eq!(of("1 thread: ns"), Some((50.0, Informs)));
        assert_eq!(of("1 thread: times memory limit"), Some((5.0, Holds)));
        assert_eq!(of("2 threads: times memory limit of one"), Some((4.0, Missed)));
        assert_eq!(of("times faster"), Some((2.0, Holds)));
        assert_eq!(of("4 times as many"), Some((1.1, Missed)));
        assert_eq!(of("1000 times larger"), None);
    }

    #[test]
    fn no_bound_is_easier_than_its_nanoseconds_were() {
        for ns in TARGETS.iter().flat_map(|target| target.nanoseconds) {
            let back = times_limit(ns) * MOVED / COPY * 1e9;
            assert!(back <= ns && back > 0.99 * ns, "{ns} became {back}");
        }
        let scenes = SCENES.iter().map(|scene| scene.name);
        assert!(scenes.eq(TARGETS.iter().map(|target| target.scene)));
    }
}
