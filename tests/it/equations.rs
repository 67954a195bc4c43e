//! The equations of the book and the lines that implement them: every id stands on both sides, and
//! what the book says of tests is true.

use super::compiler::read;
use super::support::repository;
use super::tidy::files;
use std::collections::{BTreeMap, BTreeSet};

/// An equation of a chapter.
struct Equation {
    /// Where it is defined.
    location: String,
    /// What stands until the next heading.
    text: String,
    /// What the chapter says of symbols before its first heading.
    symbols: String,
}

#[test]
fn every_equation_of_the_code_is_in_the_book_and_every_one_of_the_book_in_the_code() {
    let defined: BTreeSet<String> = equations().into_keys().collect();
    let (mut implemented, mut breaks) = (BTreeSet::new(), Vec::new());
    for path in code() {
        for (n, line) in read(&path).lines().enumerate() {
            for id in ids(line) {
                if !defined.contains(id) {
                    breaks.push(format!("{path}:{}: [{id}] is not in docs/book/theory", n + 1));
                }
            }
            let comment = line.rsplit_once("// ").map_or("", |(_, comment)| comment);
            if comment.starts_with('[') && comment.ends_with(']') {
                implemented.extend(ids(comment).map(String::from));
            }
        }
    }
    for id in defined.difference(&implemented) {
        breaks.push(format!("[{id}] of the book: no line of src or plugins ends with its id"));
    }
    assert!(implemented.len() > 50, "the ids in the code are not found: {implemented:?}");
    assert!(breaks.is_empty(), "{}", breaks.join("\n"));
}

#[test]
fn every_equation_has_a_formula_units_a_source_and_tests_that_exist() {
    let tests = names_of_tests();
    let equations = equations();
    let mut breaks = Vec::new();
    for (id, Equation { location, text, symbols }) in &equations {
        let mut miss = |what: &str| breaks.push(format!("{location}: [{id}] {what}"));
        if !text.contains("$$") {
            miss("has no formula between $$");
        }
        if !units(text) && !units(symbols) {
            miss("gives no unit such as [m/s] or [–], nor does the chapter under `Symbols`");
        }
        if !text.contains("Source:") && !has_year(text) {
            miss("has no source: authors (year), or `Source:`");
        }
        let named: Vec<&str> = quoted(text).filter(|name| is_test(name)).collect();
        let files = quoted(text).filter(|name| name.contains("tests/") && name.ends_with(".rs"));
        if named.is_empty() && files.count() == 0 {
            miss("names no test");
        }
    }
    for path in chapters() {
        let text = read(&path);
        for name in quoted(&text).filter(|name| is_test(name)) {
            if !tests.contains(name.rsplit("::").next().unwrap_or_default()) {
                breaks.push(format!("{path}: there is no test `{name}`"));
            }
        }
        for file in quoted(&text).filter(|name| name.contains('/') && name.ends_with(".rs")) {
            if !repository(file).exists() {
                breaks.push(format!("{path}: there is no file `{file}`"));
            }
        }
        for id in ids(&text).filter(|id| !equations.contains_key(*id)) {
            breaks.push(format!("{path}: [{id}] is spoken of and not defined"));
        }
    }
    assert!(breaks.is_empty(), "{}", breaks.join("\n"));
}

#[test]
fn the_book_lists_its_chapters() {
    let contents = read("docs/book/README.md");
    for path in files(&["md"]).iter().filter_map(|path| path.strip_prefix("docs/book/")) {
        let listed = contents.contains(&format!("({path})"));
        assert!(path == "README.md" || listed, "docs/book/README.md does not list {path}");
    }
}

fn chapters() -> Vec<String> {
    let all = files(&["md"]).into_iter();
    all.filter(|path| path.starts_with("docs/book/theory/")).collect()
}

/// The sources that implement equations.
fn code() -> Vec<String> {
    let all = files(&["rs"]).into_iter();
    all.filter(|path| path.starts_with("src/") || path.starts_with("plugins/")).collect()
}

/// The equations of all chapters by their ids; an id that is defined twice is a failure.
fn equations() -> BTreeMap<String, Equation> {
    let mut equations: BTreeMap<String, Equation> = BTreeMap::new();
    for path in chapters() {
        let (chapter, mut current) = (read(&path), None::<String>);
        let head = chapter.split("\n#").next().unwrap_or_default();
        let symbols = head.find("Symbols").map_or("", |at| &head[at..]);
        for (n, line) in chapter.lines().enumerate() {
            if line.starts_with('#') {
                current =
                    line.strip_prefix("### ").and_then(|rest| ids(rest).next()).map(String::from);
                if let Some(id) = &current {
                    let location = format!("{path}:{}", n + 1);
                    assert!(
                        line.starts_with(&format!("### [{id}] ")),
                        "{location}: ### [{id}] Title"
                    );
                    let (text, symbols) = (String::new(), symbols.to_string());
                    let new = Equation { location: location.clone(), text, symbols };
                    if let Some(old) = equations.insert(id.clone(), new) {
                        panic!("[{id}] is defined twice: {} and {location}", old.location);
                    }
                }
            } else if let Some(equation) = current.as_ref().and_then(|id| equations.get_mut(id)) {
                equation.text += line;
                equation.text.push('\n');
            }
        }
    }
    equations
}

/// The ids in a text, such as P2G-1 where `[P2G-1]` stands.
fn ids(text: &str) -> impl Iterator<Item = &str> {
    let inside = text.split('[').skip(1).filter_map(|rest| rest.split(']').next());
    inside.filter(|id| {
        let (letters, number) = id.split_once('-').unwrap_or_default();
        letters.len() == 3
            && letters.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit())
            && letters.starts_with(|c: char| c.is_ascii_uppercase())
            && !number.is_empty()
            && number.chars().all(|c| c.is_ascii_digit())
    })
}

/// What stands between backticks.
fn quoted(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// Whether a quoted name is that of a test: a sentence of five words at least, or a path of modules
/// with one of four; functions of the C interface begin with `lahar_`.
fn is_test(name: &str) -> bool {
    let words =
        name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || "_:".contains(c));
    let underscores = name.rsplit("::").next().unwrap_or_default().matches('_').count();
    let least = if name.contains("::") { 3 } else { 4 };
    words && underscores >= least && !name.starts_with("lahar_")
}

/// Names of all tests: functions below `#[test]`, and one for each verification case.
fn names_of_tests() -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for path in files(&["rs"]) {
        let text = read(&path);
        for after in text.split("#[test]").skip(1) {
            let function = after.split_once("fn ").and_then(|(_, rest)| rest.split_once('('));
            names.extend(function.map(|(name, _)| name.to_string()));
        }
    }
    let cases = files(&["json"]).into_iter();
    names.extend(cases.filter_map(|path| {
        let case = path.strip_prefix("tests/cases/")?.strip_suffix(".json")?;
        Some(format!("case_{case}_reaches_its_gates"))
    }));
    assert!(names.len() > 100, "the tests are not found: {names:?}");
    names
}

/// Whether a unit stands in brackets.
fn units(text: &str) -> bool {
    let inside = text.split('[').skip(1).filter_map(|rest| rest.split(']').next());
    let starts = ["–", "1/", "m", "s", "kg", "N", "Pa", "J", "rad"];
    inside.filter(|unit| unit.chars().count() <= 8).any(|unit| {
        starts.iter().any(|start| {
            unit.strip_prefix(start).is_some_and(|rest| {
                rest.chars().all(|c| c.is_alphanumeric() || "/ ².³".contains(c))
            })
        })
    })
}

/// Whether a year from 1700 on stands in the text.
fn has_year(text: &str) -> bool {
    let numbers = text.split(|c: char| !c.is_ascii_digit()).filter(|number| number.len() == 4);
    numbers.filter_map(|number| number.parse::<u32>().ok()).any(|year| (1700..2100).contains(&year))
}
