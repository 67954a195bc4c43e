//! A known miss gives what it is known to give: another value, none, another error and a gate that
//! is reached all fail.

use lahar::error::{Error, Place, Status};
use lahar_verification::case::{Case, load};
use lahar_verification::judge::{Row, Verdict, judge, outcomes_of};
use lahar_verification::run::{Outcome, run_all};
use std::collections::BTreeMap;

const CASE: &str = r#"{
    "case": "X1", "title": "t", "source": "s", "setup": "w", "family": "bar",
    "common": { "mode": 1, "particles_per_cell": 2, "periods": 1, "method": {} },
    "runs": [{ "name": "a", "setup": { "cells": 10 } }, { "name": "b", "setup": { "cells": 20 } }],
    "checks": [
        { "run": "a", "quantity": "period", "reference": 10.0, "gate": { "relative": 0.01 }, "known": [11, 12], "note": "n" },
        { "run": "b", "quantity": "failed", "gate": { "at_most": 0 },
          "known": { "ends_with": "non_finite", "time": [2, 3] }, "note": "n" },
        { "run": "b", "quantity": "drift", "gate": { "at_most": 0.1 } }
    ],
    "orders": [
        { "name": "o", "runs": ["a", "b"], "quantity": "error", "gate": { "at_least": 1.9 },
          "known": { "order": [0.9, 1.1], "last_error": [0.01, 0.02] }, "note": "n" }
    ]
}"#;

fn case() -> Case {
    Case::parse(CASE).expect("a good case")
}

/// A run that went through, with values.
fn through(values: &[(&str, f64)]) -> Outcome {
    let mut outcome = Outcome::new();
    outcome.set("failed", 0.0);
    values.iter().for_each(|(name, value)| outcome.set(name, *value));
    outcome
}

/// A run that the engine ended.
fn ended(status: Status, time: Option<f64>) -> Outcome {
    let error = Error::new(status, "it broke").at(Place { time, ..Place::default() });
    Outcome::ended(error)
}

/// The verdicts of checks and order, in this sequence.
fn verdicts(a: &Outcome, b: &Outcome) -> Vec<Verdict> {
    let outcomes = BTreeMap::from([("a".to_string(), a), ("b".to_string(), b)]);
    let rows = judge(&case(), &outcomes).expect("a table");
    rows.iter().map(|row| row.verdict).collect()
}

#[test]
fn a_value_outside_the_band_of_a_known_miss_fails() {
    let b = ended(Status::NonFinite, Some(2.5));
    let of = |period: f64| verdicts(&through(&[("period", period), ("error", 0.03)]), &b)[0];
    assert_eq!([11.0, 11.5, 12.0].map(of), [Verdict::KnownMiss; 3]);
    assert_eq!([10.5, 12.1, 11.5e6, -11.5].map(of), [Verdict::MissesOtherwise; 4]);
    assert_eq!(of(f64::NAN), Verdict::MissesOtherwise, "no number, no value");
}

#[test]
fn a_gate_that_holds_though_a_known_miss_fails() {
    let a = through(&[("period", 10.0), ("error", 0.04)]);
    let b = through(&[("drift", 0.0), ("error", 0.01)]);
    let through = [Verdict::HoldsThoughKnown; 2];
    assert_eq!(verdicts(&a, &b)[..2], through, "of a value, and of a run that should have ended");
    assert_eq!(verdicts(&a, &b)[3], Verdict::HoldsThoughKnown, "of an order");
}

#[test]
fn a_missing_value_passes_only_where_the_run_is_known_to_end() {
    let a = ended(Status::NonFinite, Some(2.5));
    let seen = verdicts(&a, &a);
    let missed = Verdict::MissesOtherwise;
    assert_eq!(seen, [missed, Verdict::KnownError, Verdict::Misses, missed]);
}

#[test]
fn a_run_that_is_known_to_end_fails_if_it_ends_otherwise() {
    let a = through(&[("period", 11.5), ("error", 0.03)]);
    let of = |status: Status, time: Option<f64>| verdicts(&a, &ended(status, time))[1];
    assert_eq!(of(Status::NonFinite, Some(3.0)), Verdict::KnownError);
    assert_eq!(of(Status::MaterialFailed, Some(2.5)), Verdict::MissesOtherwise, "another error");
    assert_eq!(of(Status::NonFinite, Some(0.0)), Verdict::MissesOtherwise, "too early");
    assert_eq!(of(Status::NonFinite, None), Verdict::MissesOtherwise, "not in a step");
}

#[test]
fn the_order_of_a_known_miss_fails_if_all_its_errors_grow() {
    let of = |a: f64, b: f64| {
        let (a, b) = (through(&[("period", 11.5), ("error", a)]), [("drift", 0.0), ("error", b)]);
        verdicts(&a, &through(&b))[3]
    };
    assert_eq!(of(0.03, 0.015), Verdict::KnownMiss);
    assert_eq!(of(-0.03, 0.015), Verdict::KnownMiss, "of the sizes of errors");
    assert_eq!(of(3e4, 1.5e4), Verdict::MissesOtherwise, "the same order");
    assert_eq!(of(0.015, 0.015), Verdict::MissesOtherwise, "the same last error");
}

#[test]
fn bands_that_say_nothing_and_misses_without_a_reason_are_refused() {
    let time = "\"time\": [2, 3]";
    let errors = [
        ("[11, 12]", "[12, 11]", "is empty"),
        ("[11, 12]", "[10.05, 12]", "reaches into what the gate accepts"),
        ("[11, 12]", "[11, 40]", "too wide to say anything"),
        ("[11, 12]", "11", "a band [low, high] or"),
        ("[0.9, 1.1]", "[0.9, 1.95]", "reaches into what the gate accepts"),
        ("[0.01, 0.02]", "[0.0, 0.02]", "too wide to say anything"),
        ("\"non_finite\"", "\"nonfinite\"", "did you mean \"non_finite\"?"),
        (time, "\"time\": [0, 3]", "too wide to say anything"),
        ("{ \"ends_with\": \"non_finite\", \"time\": [2, 3] }", "[0.9, 1.1]", "accepts any error"),
        ("{ \"at_most\": 0 }", "{ \"at_least\": 1 }", "accepts any error"),
        ("[11, 12], \"note\": \"n\"", "[11, 12]", "needs its reason"),
        (
            "\"last_error\": [0.01, 0.02] }, \"note\": \"n\"",
            "\"last_error\": [0.01, 0.02] }",
            "needs its reason",
        ),
    ];
    for (old, new, part) in errors {
        assert!(CASE.contains(old), "{old}");
        let error = Case::parse(&CASE.replacen(old, new, 1)).err();
        let error = error.unwrap_or_else(|| panic!("{new} is taken"));
        assert!(error.contains(part), "{new}: {error}");
    }
}

/// Every case, and for each of its runs an outcome.
fn tables(outcome: impl Fn(&Case, &str) -> Outcome) -> Vec<Row> {
    let mut rows = Vec::new();
    for case in load(&[]).expect("the cases") {
        let outcomes: BTreeMap<String, Outcome> =
            case.runs.iter().map(|run| (run.name.clone(), outcome(&case, &run.name))).collect();
        let outcomes = outcomes.iter().map(|(name, outcome)| (name.clone(), outcome)).collect();
        rows.extend(judge(&case, &outcomes).expect("a table"));
    }
    rows
}

#[test]
fn no_known_miss_of_any_case_passes_if_its_run_crashes() {
    for (status, time) in [(Status::NonFinite, Some(1.0)), (Status::PluginNotFound, None)] {
        let rows = tables(|_, _| ended(status, time));
        let known: Vec<&Row> = rows.iter().filter(|row| row.known.is_some()).collect();
        assert!(known.len() > 100, "the known misses are not found");
        for row in known {
            assert_eq!(row.verdict, Verdict::MissesOtherwise, "{}: {}", row.case, row.quantity);
        }
    }
}

/// Runs one run of a case whose text was changed.
fn rows_of_changed_run(id: &str, run: &str, old: &str, new: &str) -> Vec<Row> {
    let file = lahar_verification::case::folder().join(format!("{id}.json"));
    let text = std::fs::read_to_string(file).expect("a case");
    let changed = text.lines().map(|line| {
        let is_run = line.contains(&format!("\"name\": \"{run}\"")) && line.contains("\"setup\"");
        assert!(!is_run || line.contains(old), "{line}");
        if is_run { line.replacen(old, new, 1) } else { line.to_string() }
    });
    let changed: Vec<String> = changed.collect();
    assert_ne!(changed.join("\n"), text.trim_end(), "the run \"{run}\" is not found");
    let mut case = Case::parse(&changed.join("\n")).expect("a good case");
    case.runs.retain(|other| other.name == run);
    let cases = [case];
    let done = run_all(&cases, true, |_, _| ()).expect("a run");
    judge(&cases[0], &outcomes_of(&cases[0], &done)).expect("a table")
}

#[test]
fn mutation_a_known_miss_that_the_engine_ends_fails_its_case() {
    let (quadratic, linear) = (r#""order": "usl""#, r#""shape": "linear", "order": "usl""#);
    let rows = rows_of_changed_run("d1", "quadratic FLIP USL", quadratic, linear);
    assert!(!rows.is_empty());
    for row in rows {
        let seen = row.seen.as_deref().expect("an error");
        assert!(seen.contains("material_failed"), "{seen}");
        assert_eq!(row.verdict, Verdict::MissesOtherwise, "{row:?}");
    }
}

#[test]
fn mutation_a_run_that_is_known_to_end_and_goes_through_fails_its_case() {
    let (linear, quadratic) = (r#""shape": "linear""#, r#""shape": "quadratic""#);
    let rows = rows_of_changed_run("d1", "linear FLIP USL", linear, quadratic);
    let verdicts: Vec<Verdict> = rows.iter().map(|row| row.verdict).collect();
    assert_eq!(verdicts, [Verdict::HoldsThoughKnown]);
}
