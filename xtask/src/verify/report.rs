//! The text of `docs/verification.md`.

use lahar_verification::case::{Case, Fit, Size};
use lahar_verification::judge::{Row, Verdict};
use std::fmt::Write;

use super::store::Kept;

/// A case and what is known of it.
pub struct Part<'a> {
    /// The case.
    pub case: &'a Case,
    /// What its runs gave.
    pub kept: Kept,
    /// Its table.
    pub rows: Vec<Row>,
    /// Files of the plots, relative to `docs/`.
    pub plots: Vec<String>,
}

const HEAD: &str = "# Verification

Written by `cargo xtask verify --full`; the set-ups and references are the files of `tests/cases`. `cargo xtask verify` runs the
small sizes, those that the test suite runs too, and `cargo xtask verify D2` one case; what was not run anew stays as it was.
`--json` prints one object a line.

A gate *relative x* asks for |value / reference − 1| ≤ x, *absolute x* for |value − reference| ≤ x. A *known miss* is a gate that the
method is known not to reach, or must not reach as a negative control. What its run is known to give stands beside the gate: a band of
the value; for an order of convergence, a band of the order and one of the error of the last run; for a run that the engine ends, which
is a *known error*, the status and a band of the time. A check is *amiss* if its gate is missed without that being known, or if a known
miss gives anything else: another value, none, another error, or a value that the gate accepts.
";

/// The whole report.
pub fn document(parts: &[Part<'_>]) -> String {
    let mut text = String::from(HEAD);
    let made: std::collections::BTreeSet<&str> =
        parts.iter().map(|part| part.kept.made.as_str()).filter(|made| !made.is_empty()).collect();
    let made: Vec<&str> = made.into_iter().collect();
    let _ = writeln!(text, "\nRun on: {}.\n", made.join("; "));
    text += "| case | | checks | hold | known misses | known errors | amiss |\n\
         |---|---|---:|---:|---:|---:|---:|\n";
    let mut sums = [0; 5];
    for part in parts {
        let counts = counts(&part.rows);
        let (id, title) = (&part.case.case, &part.case.title);
        let link = anchor(&format!("{id}: {title}"));
        let _ = writeln!(text, "| [{id}](#{link}) | {title} | {} |", cells(&counts));
        sums.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
    }
    let _ = writeln!(text, "| all | | {} |", cells(&sums));
    parts.iter().for_each(|part| chapter(&mut text, part));
    text
}

/// All; those that hold, known misses, runs that end with a known error, and the others.
pub fn counts(rows: &[Row]) -> [usize; 5] {
    let count = |wanted: Verdict| rows.iter().filter(|row| row.verdict == wanted).count();
    let passing = [Verdict::Holds, Verdict::KnownMiss, Verdict::KnownError].map(count);
    let amiss = rows.iter().filter(|row| !row.verdict.passes()).count();
    [rows.len(), passing[0], passing[1], passing[2], amiss]
}

fn cells(counts: &[usize]) -> String {
    let texts: Vec<String> = counts.iter().map(usize::to_string).collect();
    texts.join(" | ")
}

fn chapter(text: &mut String, part: &Part<'_>) {
    let case = part.case;
    let _ = writeln!(
        text,
        "\n## {}: {}\n\n{}\n\n*Source.* {}\n",
        case.case, case.title, case.setup, case.source
    );
    let (orders, values): (Vec<&Row>, Vec<&Row>) = part.rows.iter().partition(|row| row.is_order);
    if !values.is_empty() {
        table(text, "run: quantity", &values);
    }
    if !orders.is_empty() {
        let fits = case.orders.iter().any(|order| order.fit == Fit::LeastSquares);
        let how = if fits {
            "the last two runs, or all by least squares where the note says so"
        } else {
            "the last two runs"
        };
        let _ = writeln!(
            text,
            "\nOrders of convergence, the slope of log error over log h, from {how}:\n"
        );
        table(text, "order", &orders);
    }
    let missing: Vec<&str> = case
        .runs
        .iter()
        .filter(|run| {
            run.size == Size::Full && !part.kept.runs.iter().any(|kept| kept.name == run.name)
        })
        .map(|run| run.name.as_str())
        .collect();
    if !missing.is_empty() {
        let _ = writeln!(text, "\nNot run yet: {}.", missing.join("; "));
    }
    for run in &part.kept.runs {
        if let Some(failure) = &run.outcome.failure {
            let _ = writeln!(text, "\n*{}* ended: {}", run.name, failure.message);
        }
    }
    case.remarks.iter().for_each(|remark| {
        let _ = writeln!(text, "\n{remark}");
    });
    for (plot, file) in case.plots.iter().zip(&part.plots) {
        let _ = writeln!(text, "\n![{}]({file})", plot.title);
    }
}

/// A table; what is known of misses has a column where there are any.
fn table(text: &mut String, what: &str, rows: &[&Row]) {
    let with_known = rows.iter().any(|row| row.known.is_some());
    let (title, line) = if with_known { (" known to give |", "---|") } else { ("", "") };
    let _ = writeln!(text, "| {what} | value | reference | error | gate |{title} | |");
    let _ = writeln!(text, "|---|---:|---:|---:|---|{line}---|---|");
    rows.iter().for_each(|row| table_row(text, row, with_known));
}

fn table_row(text: &mut String, row: &Row, with_known: bool) {
    let shown = |value: Option<f64>| value.map_or_else(String::new, digits);
    let value = row.value.map_or_else(|| "none".to_string(), digits);
    let error = match row.error {
        Some(error) if row.gate.starts_with("relative") => format!("{} %", digits(100.0 * error)),
        other => shown(other),
    };
    let (quantity, reference, gate) = (&row.quantity, shown(row.reference), &row.gate);
    let known = row.known.as_deref().unwrap_or_default();
    let known = if with_known { format!(" {known} |") } else { String::new() };
    let verdict = verdict(row);
    let verdict = if row.verdict.passes() { verdict } else { format!("**{verdict}**") };
    let _ = writeln!(
        text,
        "| {quantity} | {value} | {reference} | {error} | {gate} |{known} {verdict} | {} |",
        row.note
    );
}

/// The verdict, and what was seen beside the value where it is no plain one.
fn verdict(row: &Row) -> String {
    match &row.seen {
        Some(seen) if row.verdict != Verdict::Holds => format!("{}: {seen}", row.verdict),
        _ => row.verdict.to_string(),
    }
}

/// A line for the terminal.
pub fn plain(row: &Row) -> String {
    let value = row.value.map_or_else(|| "none".to_string(), digits);
    let reference =
        row.reference.map_or_else(String::new, |r| format!(" (reference {})", digits(r)));
    let known =
        row.known.as_ref().map_or_else(String::new, |known| format!(" (known to give {known})"));
    let (case, quantity, gate) = (&row.case, &row.quantity, &row.gate);
    format!("{case}  {quantity} = {value}{reference}, {gate}{known}: {}", verdict(row))
}

/// Four digits and more where they are few.
fn digits(x: f64) -> String {
    let size = x.abs();
    if x == 0.0 {
        "0".to_string()
    } else if !(1e-3..1e6).contains(&size) {
        format!("{x:.2e}")
    } else {
        let places = (4 - size.log10().floor() as i32).clamp(0, 7) as usize;
        let text = format!("{x:.places$}");
        if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_string()
        } else {
            text
        }
    }
}

/// The anchor that a heading gets.
fn anchor(heading: &str) -> String {
    let kept = heading.to_lowercase();
    kept.chars()
        .filter(|c| c.is_alphanumeric() || *c == ' ' || *c == '-')
        .map(|c| if c == ' ' { '-' } else { c })
        .collect()
}
