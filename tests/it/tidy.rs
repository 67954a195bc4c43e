//! The rules of the repository that a program can check. Each test names the file and line that
//! breaks one.

use super::compiler::read;
use super::support::repository;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Folders whose Rust files may hold `unsafe`: the two C boundaries, the lanes, and the plugin ABI
/// with its adapters. Tests may too, since they stand in for C hosts and plugins; their count is
/// held like that of the others.
const UNSAFE_FOLDERS: [&str; 6] =
    ["src/ffi/", "src/plugin/", "src/simd/", "plugins/abi/", "plugins/sdk/", "plugins/umat/"];

const MAX_LINES: usize = 600;
const NAIVE_LINES: usize = 120;

#[test]
fn unsafe_stands_only_where_it_may_and_its_count_is_known() {
    let committed: BTreeMap<String, usize> = read("tests/it/unsafe_count.txt")
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| {
            let (path, count) = line.rsplit_once(' ').expect("path and count in unsafe_count.txt");
            (path.to_string(), count.parse().expect("a number in unsafe_count.txt"))
        })
        .collect();
    let mut found = BTreeMap::new();
    for path in rust_with_unsafe() {
        let count = read(&path).lines().map(|line| words(code(line), "unsafe")).sum();
        if count > 0 {
            found.insert(path, count);
        }
    }
    let outside: Vec<_> = found.keys().filter(|path| !may_be_unsafe(path)).collect();
    assert!(outside.is_empty(), "unsafe outside the folders that may hold it: {outside:?}");
    let list: String = found.iter().map(|(path, count)| format!("{path} {count}\n")).collect();
    assert_eq!(
        found, committed,
        "the number of `unsafe` changed; look at each, then write this into tests/it/unsafe_count.txt:\n{list}"
    );
}

#[test]
fn every_unsafe_block_says_why_it_is_sound() {
    let breaks = offending_lines(&rust_with_unsafe(), |lines, index| {
        let line = code(lines[index]);
        let block = ["unsafe {", "unsafe impl"].iter().any(|word| line.contains(word));
        block && !has_safety_comment(lines, index)
    });
    assert!(breaks.is_empty(), "no SAFETY comment:\n{}", breaks.join("\n"));
}

#[test]
fn no_file_is_longer_than_the_bound() {
    let long: Vec<_> = files(&["rs", "c", "cpp", "f90"])
        .into_iter()
        .filter(|path| !path.starts_with("include/lahar/")) // much of it is generated
        .map(|path| (read(&path).lines().count(), path))
        .filter(|(lines, _)| *lines > MAX_LINES)
        .collect();
    assert!(long.is_empty(), "longer than {MAX_LINES} lines: {long:?}");
}

#[test]
fn the_oracle_stays_short() {
    let text = read("src/step/naive.rs");
    let lines = text.lines().take_while(|line| *line != "#[cfg(test)]").count();
    assert!(lines <= NAIVE_LINES, "src/step/naive.rs has {lines} lines, {NAIVE_LINES} at most");
}

#[test]
fn the_method_is_written_once_without_conditional_compilation() {
    let method: Vec<_> = files(&["rs"])
        .into_iter()
        .filter(|path| in_any(path, &["src/step", "src/shape/", "src/transfer/", "src/material"]))
        .collect();
    let breaks = offending_lines(&method, |lines, index| {
        let line = code(lines[index]);
        line.contains(concat!("cfg", "(")) && !line.contains("#[cfg(test)]")
            || line.contains("cfg!")
    });
    assert!(breaks.is_empty(), "conditional compilation:\n{}", breaks.join("\n"));
}

#[test]
fn a_step_does_not_lock_look_at_the_clock_or_know_of_c() {
    let forbidden = ["Mutex", "RwLock", "Instant", "SystemTime", "extern \"C\"", "c_void", "log("];
    let breaks = forbidden_in("src/step", &forbidden);
    assert!(breaks.is_empty(), "in src/step:\n{}", breaks.join("\n"));
}

#[test]
fn the_library_prints_nothing_and_ends_nothing() {
    let forbidden =
        ["println!", "print!", "eprintln!", "eprint!", "dbg!", "process::exit", "process::abort"];
    let breaks = forbidden_in("src", &forbidden);
    assert!(breaks.is_empty(), "in src:\n{}", breaks.join("\n"));
}

#[test]
fn nothing_is_left_to_do_in_the_sources() {
    let words = [
        concat!("TO", "DO"),
        concat!("FIX", "ME"),
        concat!("XX", "X"),
        concat!("todo", "!("),
        concat!("unimplemented", "!("),
        concat!("#[", "ignore"),
    ];
    let breaks = offending_lines(&files(&["rs", "c", "h", "hpp", "cpp", "f90"]), |lines, index| {
        words.iter().any(|word| lines[index].contains(word))
    });
    assert!(breaks.is_empty(), "unfinished:\n{}", breaks.join("\n"));
}

/// The layers of `src` from the ground up. A file uses its own line and those above it, nothing
/// below.
const ROOMS: [&[&str]; 16] = [
    &["error", "choice"],
    &["simd"],
    &["memory"],
    &["log"],
    &["platform"],
    &["tensor"],
    &["parallel"],
    &["background"],
    &["shape"],
    &["transfer"],
    &["material", "plugin", "context"],
    &["particles"],
    &["boundary"],
    &["step"],
    &["world"],
    &["output", "ffi"],
];

#[test]
fn arrows_between_the_rooms_of_the_engine_point_down() {
    let line_of = |room: &str| ROOMS.iter().position(|line| line.contains(&room));
    let engine: Vec<_> = files(&["rs"])
        .into_iter()
        .filter(|path| path.starts_with("src/") && path != "src/lib.rs")
        .collect();
    let mut breaks = Vec::new();
    for path in &engine {
        let room = path["src/".len()..].split(['/', '.']).next().unwrap_or_default();
        let own = line_of(room).unwrap_or_else(|| panic!("{path}: add `{room}` to ROOMS"));
        breaks.extend(offending_lines(std::slice::from_ref(path), |lines, index| {
            let line = code(lines[index]);
            // a list of rooms in one line could hide one
            line.contains("use crate::{")
                || line.split("crate::").skip(1).any(|rest| {
                    let named = rest.split(|c: char| !c.is_alphanumeric() && c != '_').next();
                    named.and_then(line_of).is_some_and(|line| line > own)
                })
        }));
    }
    assert!(breaks.is_empty(), "arrows that point up:\n{}", breaks.join("\n"));
}

/// What bundles all parts of a world, and who may take it: the orders, and the integrator that
/// calls them.
#[test]
fn stages_take_parts_and_not_the_whole() {
    let whole = ["src/step/mod.rs", "src/step/parts.rs", "src/step/integrate.rs"];
    let stages: Vec<_> = files(&["rs"])
        .into_iter()
        .filter(|path| path.starts_with("src/step/") && !whole.contains(&path.as_str()))
        .collect();
    let breaks = offending_lines(&stages, |lines, index| {
        let line = code(lines[index]);
        words(line, "Parts") > 0 || line.contains("mem::take") || words(line, "rayon") > 0
    });
    assert!(breaks.is_empty(), "in a stage:\n{}", breaks.join("\n"));
}

#[test]
fn who_works_in_parallel_is_decided_in_one_place() {
    let others: Vec<_> = files(&["rs"])
        .into_iter()
        .filter(|path| path.starts_with("src/") && path != "src/parallel.rs")
        .collect();
    let breaks = offending_lines(&others, |lines, index| words(code(lines[index]), "rayon") > 0);
    assert!(breaks.is_empty(), "outside src/parallel.rs:\n{}", breaks.join("\n"));
}

#[test]
fn plugins_do_not_depend_on_the_engine() {
    let manifests: Vec<_> = files(&["toml"])
        .into_iter()
        .filter(|path| path.starts_with("plugins/") && path.ends_with("Cargo.toml"))
        .collect();
    assert!(manifests.len() > 2, "the manifests of the plugins are not found");
    let breaks = offending_lines(&manifests, |lines, index| {
        let name = lines[index].split(['=', '.', ' ']).next().unwrap_or_default();
        name == "lahar"
    });
    assert!(breaks.is_empty(), "a plugin depends on the engine:\n{}", breaks.join("\n"));
}

#[test]
fn every_dependency_has_its_reason_beside_it() {
    let text = read("Cargo.toml");
    let mut section = "";
    for line in text.lines() {
        if line.starts_with('[') {
            section = line;
        } else if line.contains('=')
            && ["[dependencies]", "[dev-dependencies]", "[build-dependencies]"].contains(&section)
        {
            assert!(line.contains('#'), "no reason in {section} for: {line}");
        }
    }
}

#[test]
fn docs_do_not_name_files_that_do_not_exist() {
    for document in ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"] {
        let text = read(document);
        for quoted in text.split('`').skip(1).step_by(2) {
            let is_path = quoted.contains('/')
                && quoted.chars().all(|c| c.is_ascii_alphanumeric() || "/._-".contains(c))
                && !quoted.starts_with(['/', '.', '-'])
                && !quoted.starts_with("target/");
            let known =
                is_path && repository(quoted.split('/').next().unwrap_or_default()).exists();
            assert!(!known || repository(quoted).exists(), "{document} names `{quoted}`");
        }
    }
}

/// Every file of the repository with one of the extensions, as a path from its root, sorted.
pub fn files(extensions: &[&str]) -> Vec<String> {
    fn visit(folder: &Path, extensions: &[&str], found: &mut Vec<String>) {
        for entry in fs::read_dir(folder).expect("a folder that can be read") {
            let path = entry.expect("an entry that can be read").path();
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            if path.is_dir() {
                if name != "target" && !name.starts_with('.') {
                    visit(&path, extensions, found);
                }
            } else if path.extension().is_some_and(|e| extensions.iter().any(|x| e == *x)) {
                let inside =
                    path.strip_prefix(repository("")).expect("a path inside the repository");
                found.push(inside.to_string_lossy().into_owned());
            }
        }
    }
    let mut found = Vec::new();
    visit(&repository(""), extensions, &mut found);
    found.sort();
    assert!(!found.is_empty(), "no files with {extensions:?}");
    found
}

/// All Rust files but this one, which speaks of what it looks for.
fn rust_with_unsafe() -> Vec<String> {
    files(&["rs"]).into_iter().filter(|path| path != "tests/it/tidy.rs").collect()
}

fn may_be_unsafe(path: &str) -> bool {
    UNSAFE_FOLDERS.iter().any(|folder| path.starts_with(folder))
        || path.starts_with("tests/")
        || path.contains("/tests/")
}

fn in_any(path: &str, starts: &[&str]) -> bool {
    starts.iter().any(|start| path.starts_with(start))
}

fn forbidden_in(folder: &str, forbidden: &[&str]) -> Vec<String> {
    let inside: Vec<_> =
        files(&["rs"]).into_iter().filter(|path| path.starts_with(folder)).collect();
    offending_lines(&inside, |lines, index| {
        forbidden.iter().any(|word| code(lines[index]).contains(word))
    })
}

/// `path:line: text` of every line for which `breaks(lines, index)` holds.
fn offending_lines(paths: &[String], breaks: impl Fn(&[&str], usize) -> bool) -> Vec<String> {
    let mut found = Vec::new();
    for path in paths {
        let text = read(path);
        let lines: Vec<&str> = text.lines().collect();
        for (index, line) in lines.iter().enumerate() {
            if breaks(&lines, index) {
                found.push(format!("{path}:{}: {}", index + 1, line.trim()));
            }
        }
    }
    found
}

/// The line without its comment; contents of string literals are not recognised.
fn code(line: &str) -> &str {
    line.split("//").next().unwrap_or_default()
}

/// How often `word` stands in the text as a whole word.
fn words(text: &str, word: &str) -> usize {
    text.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|part| *part == word).count()
}

/// Whether the comment above the statement, or the line itself, says SAFETY.
fn has_safety_comment(lines: &[&str], index: usize) -> bool {
    if lines[index].contains("SAFETY") {
        return true;
    }
    // The block may stand inside a statement that began some lines above.
    let above = lines[..index].iter().rev().take(12).map(|line| line.trim());
    above
        .take_while(|line| !line.is_empty() && *line != "}")
        .any(|line| line.starts_with("//") && line.contains("SAFETY"))
}
