//! What the engine has to reach, and whether this run shows it.

use super::rounds::{Row, paired};
use super::scenes::{APIC_ELASTIC, FAR, LINKED};
use super::stick::Stick;

/// One target: what, the figure, the bound, whether it holds.
pub struct Check {
    /// What is judged.
    pub what: String,
    /// What was measured.
    pub figure: f64,
    /// What was asked for, as text: "≤ 60".
    pub bound: String,
    /// Whether the figure keeps the bound.
    pub holds: bool,
}

/// Targets of a scene: ns per particle and step with 1 and with 2 threads, bytes per particle.
struct Target {
    scene: &'static str,
    nanoseconds: [f64; 2],
    bytes: f64,
}

const TARGETS: [Target; 6] = [
    Target { scene: "3d-quadratic-apic-elastic", nanoseconds: [60.0, 32.0], bytes: 400.0 },
    Target {
        scene: "3d-quadratic-apic-drucker-prager-flow",
        nanoseconds: [95.0, 50.0],
        bytes: 450.0,
    },
    Target { scene: "3d-quadratic-apic-newtonian", nanoseconds: [60.0, 32.0], bytes: 350.0 },
    Target { scene: "3d-linear-flip-elastic", nanoseconds: [45.0, 24.0], bytes: 350.0 },
    Target { scene: "3d-cubic-apic-elastic", nanoseconds: [110.0, 58.0], bytes: 400.0 },
    Target { scene: "2d-quadratic-apic-elastic", nanoseconds: [35.0, 19.0], bytes: 350.0 },
];

const MEMORY_LIMIT: f64 = 6.0; // of the first scene with 1 thread
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
    checks.push(at_most(
        format!("{first}, 1 thread: times memory limit"),
        one.ratio(),
        MEMORY_LIMIT,
    ));
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
        let Some(row) = row(threads) else { continue };
        let threads = if threads == 1 { "1 thread" } else { "2 threads" };
        checks.push(at_most(format!("{scene}, {threads}: ns"), row.nanoseconds(), bound));
        checks.push(at_most(format!("{scene}, {threads}: bytes"), row.bytes, target.bytes));
        if scene.ends_with("flow")
            && let Some(share) = row.stages["locate"].as_f64()
        {
            checks.push(at_most(format!("{scene}, {threads}: share of locate"), share, LOCATE));
        }
    }
    if let (Some(one), Some(two)) = (row(1), row(2)) {
        let figure = paired(&one.samples, &two.samples);
        checks.push(Check {
            what: format!("{scene}: times faster with 2 threads"),
            figure,
            bound: format!("≥ {SPEED_UP}"),
            holds: figure >= SPEED_UP,
        });
    }
}

fn find<'a>(rows: &'a [Row], scene: &str, asked: usize, threads: usize) -> Option<&'a Row> {
    rows.iter().find(|r| r.scene == scene && r.asked == asked && r.threads == threads)
}

/// A figure that must not exceed its bound.
pub fn at_most(what: String, figure: f64, bound: f64) -> Check {
    Check { what, figure, bound: format!("≤ {bound}"), holds: figure <= bound }
}

/// A figure that must reach its bound.
pub fn at_least(what: String, figure: f64, bound: f64) -> Check {
    Check { what, figure, bound: format!("≥ {bound}"), holds: figure >= bound }
}

#[cfg(test)]
mod tests {
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
        let first = APIC_ELASTIC.name;
        let rows = [
            row(first, 1000, 1, &[50.0, 100.0, 50.0]),
            row(first, 1000, 2, &[25.0, 50.0, 40.0]),
            row(first, 4000, 1, &[55.0, 110.0, 55.0]),
        ];
        let checks = judge(&rows, 1000, None);
        let of = |text: &str| {
            let found = checks.iter().find(|check| check.what.contains(text));
            found.map(|check| (check.figure, check.holds))
        };
        assert_eq!(of("1 thread: ns"), Some((50.0, true)));
        assert_eq!(of("times faster"), Some((2.0, true)));
        assert_eq!(of("times memory limit"), Some((5.0, true)));
        assert_eq!(of("4 times as many"), Some((1.1, false)));
        assert_eq!(of("1000 times larger"), None);
    }
}
