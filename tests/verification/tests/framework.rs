//! Bad files of cases are refused with the place of the error; gates and orders are what they say.

use lahar::error::{Error, Status};
use lahar_verification::case::{Case, Gate, load};
use lahar_verification::judge::judge;
use lahar_verification::run::Outcome;
use std::collections::BTreeMap;

const BAR: &str = r#"{
    "case": "X1", "title": "t", "source": "s", "setup": "w", "family": "bar",
    "common": { "mode": 1, "particles_per_cell": 2, "periods": 1, "method": {} },
    "runs": [
        { "name": "a", "setup": { "cells": 10 } },
        { "name": "b", "setup": { "cells": 20, "method": { "shape": "linear" } } }
    ],
    "checks": [{ "run": "a", "quantity": "period", "reference": 10.0, "gate": { "relative": 0.1 } }],
    "orders": [{ "name": "o", "runs": ["a", "b"], "quantity": "error", "gate": { "at_least": 1.9 } }]
}"#;

/// The error of the case with one piece of its text replaced.
fn error_of(old: &str, new: &str) -> String {
    assert!(BAR.contains(old), "{old}");
    Case::parse(&BAR.replacen(old, new, 1)).err().unwrap_or_else(|| panic!("{new} is taken"))
}

#[test]
fn errors_in_files_tell_where_they_stand() {
    assert!(Case::parse(BAR).is_ok());
    let errors = [
        ("\"cells\": 10", "\"cell\": 10", ["run \"a\"", "unknown field `cell`"]),
        ("\"shape\": \"linear\"", "\"shape\": \"cuboid\"", ["`method.shape`", "`cuboid`"]),
        ("\"reference\"", "\"refrence\"", ["`checks[0].refrence`", "unknown field"]),
        ("\"family\": \"bar\"", "\"family\": \"bat\"", ["no family \"bat\"", "\"bar\""]),
        ("\"run\": \"a\"", "\"run\": \"aa\"", ["no run \"aa\"", "\"a\""]),
        ("\"reference\": 10.0,", "", ["period", "needs a `reference`"]),
        ("[\"a\", \"b\"]", "[\"a\", \"a\"]", ["run \"b\"", "not checked"]),
        ("\"name\": \"b\"", "\"name\": \"a\"", ["two runs", "\"a\""]),
    ];
    for (old, new, parts) in errors {
        let error = error_of(old, new);
        assert!(parts.iter().all(|part| error.contains(part)), "{new}: {error}");
    }
}

#[test]
fn an_unknown_case_is_answered_with_the_nearest() {
    let error = load(&["D22".to_string()]).expect_err("an error");
    assert!(error.contains("D22") && error.contains("did you mean D2?"), "{error}");
}

#[test]
fn gates_accept_what_they_say_and_nothing_that_is_not_a_number() {
    let gates = [
        (Gate::Relative(0.1), -2.1, -2.3),
        (Gate::Absolute(0.1), -1.95, -2.11),
        (Gate::AtMost(1.0), 1.0, 1.1),
        (Gate::AtLeast(1.0), 1.0, 0.9),
        (Gate::Between(1.0, 2.0), 1.5, 2.1),
    ];
    for (gate, good, bad) in gates {
        assert!(gate.accepts(good, Some(-2.0)), "{gate}: {good}");
        assert!(!gate.accepts(bad, Some(-2.0)), "{gate}: {bad}");
        assert!(!gate.accepts(f64::NAN, Some(-2.0)), "{gate}");
    }
}

#[test]
fn an_order_is_the_slope_of_the_errors_and_a_failed_run_holds_nothing() {
    let case = Case::parse(BAR).expect("a good case");
    let mut outcomes = [Outcome::new(), Outcome::new()];
    outcomes[0].set("period", 10.5);
    outcomes[0].set("error", 0.04);
    outcomes[1].set("error", 0.01);
    let table = |outcomes: &[Outcome; 2]| {
        let names = ["a", "b"].map(String::from).into_iter();
        judge(&case, &names.zip(outcomes).collect::<BTreeMap<_, _>>())
    };
    let rows = table(&outcomes).expect("a table");
    assert!(rows[0].holds && (rows[0].error.expect("an error") - 0.05).abs() < 1e-12);
    assert!(rows[1].holds && (rows[1].value.expect("an order") - 2.0).abs() < 1e-12);
    outcomes[1] = Outcome {
        failure: Some(Error::new(Status::NonFinite, "it broke").into()),
        ..Outcome::new()
    };
    let rows = table(&outcomes).expect("a table");
    assert!(!rows[1].holds && rows[1].value.is_none());
    outcomes[1] = Outcome::new();
    assert!(table(&outcomes).expect_err("a wrong name").contains("does not give `error`"));
}
