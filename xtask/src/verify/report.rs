//! The text of `docs/verification.md`.

use lahar_verification::case::{Case, Fit, Size};
use lahar_verification::judge::Row;
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

A gate *relative x* asks for |value / reference − 1| ≤ x, *absolute x* for |value − reference| ≤ x. A check that *fails as known* is one
that the method is known to miss, or has to miss as a negative control: it is part of the table and would be an error if it held.
";

/// The whole report.
pub fn document(parts: &[Part<'_>]) -> String {
    let mut text = String::from(HEAD);
    let made: std::collections::BTreeSet<&str> =
        parts.iter().map(|part| part.kept.made.as_str()).filter(|made| !made.is_empty()).collect();
    let made: Vec<&str> = made.into_iter().collect();
    let _ = writeln!(text, "\nRun on: {}.\n", made.join("; "));
    text += "| case | | checks | hold | fail as known | amiss |\n|---|---|---:|---:|---:|---:|\n";
    let mut sums = [0; 4];
    for part in parts {
        let counts = counts(&part.rows);
        let [all, hold, known, amiss] = counts;
        let (id, title) = (&part.case.case, &part.case.title);
        let link = anchor(&format!("{id}: {title}"));
        let _ =
            writeln!(text, "| [{id}](#{link}) | {title} | {all} | {hold} | {known} | {amiss} |");
        (0..4).for_each(|k| sums[k] += counts[k]);
    }
    let [all, hold, known, amiss] = sums;
    let _ = writeln!(text, "| all | | {all} | {hold} | {known} | {amiss} |");
    parts.iter().for_each(|part| chapter(&mut text, part));
    text
}

/// All, those that hold as they should, those that fail as known, the others.
fn counts(rows: &[Row]) -> [usize; 4] {
    let count = |wanted: &dyn Fn(&Row) -> bool| rows.iter().filter(|row| wanted(row)).count();
    [
        rows.len(),
        count(&|row| row.holds && row.passes()),
        count(&|row| !row.holds && row.passes()),
        count(&|row| !row.passes()),
    ]
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
        *text += "| run: quantity | value | reference | error | gate | | |\n|---|---:|---:|---:|---|---|---|\n";
        values.iter().for_each(|row| table_row(text, row));
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
        *text +=
            "| order | value | reference | error | gate | | |\n|---|---:|---:|---:|---|---|---|\n";
        orders.iter().for_each(|row| table_row(text, row));
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

fn table_row(text: &mut String, row: &Row) {
    let shown = |value: Option<f64>| value.map_or_else(String::new, digits);
    let value = row.value.map_or_else(|| "none".to_string(), digits);
    let error = match row.error {
        Some(error) if row.gate.starts_with("relative") => format!("{} %", digits(100.0 * error)),
        other => shown(other),
    };
    let (quantity, reference) = (&row.quantity, shown(row.reference));
    let _ = writeln!(
        text,
        "| {quantity} | {value} | {reference} | {error} | {} | {} | {} |",
        row.gate,
        verdict(row),
        row.note
    );
}

fn verdict(row: &Row) -> &'static str {
    match (row.holds, row.expected_failure) {
        (true, false) => "holds",
        (false, true) => "fails as known",
        (false, false) => "**fails**",
        (true, true) => "**holds, though known to fail**",
    }
}

/// A line for the terminal.
pub fn plain(row: &Row) -> String {
    let value = row.value.map_or_else(|| "none".to_string(), digits);
    let reference =
        row.reference.map_or_else(String::new, |r| format!(" (reference {})", digits(r)));
    let verdict = verdict(row).replace("**", "");
    format!("{}  {} = {value}{reference}, {}: {verdict}", row.case, row.quantity, row.gate)
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
