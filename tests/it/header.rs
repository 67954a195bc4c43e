//! The C headers: they compile by themselves and together, agree with the library, and document
//! their thread rules.

use super::compiler::{WARNINGS, library_folder, program, read, run};
use super::support::{repository, scratch_folder};
use lahar::background::GridPolicy;
use lahar::boundary::WallKind;
use lahar::choice::List;
use lahar::context::LogLevel;
use lahar::error::Status;
use lahar::ffi::answers::ANSWERS;
use lahar::shape::{ShapeKind, WallTreatment};
use lahar::step::StepOrder;
use lahar::transfer::TransferKind;
use std::collections::BTreeMap;
use std::fs;
use std::process::Command;

const HEADERS: [&str; 2] = ["lahar/lahar.h", "lahar/lahar_plugin.h"];

/// Every function of lahar.h with its arguments as they are written.
pub fn prototypes() -> Vec<(String, Vec<String>)> {
    let header = read("include/lahar/lahar.h");
    let code: String =
        header.lines().filter(|l| !l.starts_with("//")).flat_map(|l| [l, " "]).collect();
    let mut functions = Vec::new();
    for statement in code.split(';').filter(|s| s.ends_with(')') && !s.contains("typedef")) {
        let Some((head, arguments)) = statement.trim_end_matches(')').rsplit_once('(') else {
            continue;
        };
        let name = head.rsplit([' ', '*']).next().unwrap_or_default();
        let arguments = arguments.split(',').map(|a| a.trim().to_string()).collect();
        if name.starts_with("lahar_") {
            functions.push((name.to_string(), arguments));
        }
    }
    functions
}

/// Whether a written argument is a pointer; callbacks are a type of their own.
pub fn is_pointer(argument: &str) -> bool {
    argument.contains('*') || argument.ends_with(']')
}

#[test]
fn the_headers_compile_alone_and_together_in_every_language() {
    let scratch = scratch_folder();
    let both = format!("#include <{}>\n#include <{}>\n", HEADERS[0], HEADERS[1]);
    let reversed = format!("#include <{}>\n#include <{}>\n", HEADERS[1], HEADERS[0]);
    let twice = format!("#include <{0}>\n#include <{0}>\n", HEADERS[0]);
    let alone = HEADERS.map(|header| format!("#include <{header}>\n"));
    for text in alone.into_iter().chain([both, reversed, twice]) {
        for (compiler, standard, ending) in
            [("cc", "c99", "c"), ("cc", "c11", "c"), ("c++", "c++17", "cpp")]
        {
            let file = scratch.join(format!("header.{ending}"));
            fs::write(&file, format!("{text}int main(void) {{ return 0; }}\n")).expect("a source");
            let mut command = Command::new(compiler);
            command.arg(format!("-std={standard}")).args(WARNINGS).arg("-fsyntax-only");
            run(command.arg("-I").arg(repository("include")).arg(&file));
        }
    }
}

#[test]
fn the_layout_is_asserted_by_the_headers() {
    let scratch = scratch_folder();
    let header = read("include/lahar/lahar.h");
    let broken = header.replacen("sizeof(lahar_totals) == 120", "sizeof(lahar_totals) == 128", 1);
    assert_ne!(broken, header);
    let file = scratch.join("broken.h");
    fs::write(&file, broken).expect("a header");
    for (compiler, standard, language) in [("cc", "c11", "c"), ("c++", "c++17", "c++")] {
        let mut command = Command::new(compiler);
        command.args([&format!("-std={standard}"), "-fsyntax-only", "-x", language]);
        let output = command.arg(&file).output().expect("a compiler");
        assert!(
            String::from_utf8_lossy(&output.stderr).contains("lahar_totals"),
            "a wrong size must not compile"
        );
    }
}

#[test]
fn the_constants_are_the_statuses_of_the_engine_and_have_their_names() {
    let header = read("include/lahar/lahar.h");
    let in_header: BTreeMap<i32, &str> = header
        .lines()
        .filter_map(|line| line.strip_prefix("#define ")?.split_once(' '))
        .filter(|(name, _)| *name == "LAHAR_OK" || name.starts_with("LAHAR_ERROR_"))
        .map(|(name, value)| (value.parse().expect("a number"), name))
        .collect();
    let expected: BTreeMap<i32, String> =
        Status::ALL.iter().map(|status| (*status as i32, constant_of(*status))).collect();
    assert_eq!(expected.len(), Status::ALL.len(), "two statuses share a number");
    let as_text: BTreeMap<i32, String> =
        in_header.iter().map(|(value, name)| (*value, name.to_string())).collect();
    assert_eq!(as_text, expected);

    let cases: String = in_header
        .values()
        .map(|name| format!("  if (strcmp(lahar_status_name({name}), \"{name}\")) return 1;\n"))
        .chain([format!(
            "  if (strcmp(lahar_status_name({}), \"unknown status\")) return 2;\n",
            i32::MAX
        )])
        .collect();
    let text = format!(
        "#include <lahar/lahar.h>\n#include <string.h>\nint main(void) {{\n{cases}  return 0;\n}}\n"
    );
    run_source(&text);
}

/// `NullArgument` is `LAHAR_ERROR_NULL_ARGUMENT`.
fn constant_of(status: Status) -> String {
    if status == Status::Ok {
        return "LAHAR_OK".into();
    }
    let mut name = String::from("LAHAR_ERROR");
    for letter in format!("{status:?}").chars() {
        if letter.is_uppercase() {
            name.push('_');
        }
        name.extend(letter.to_uppercase());
    }
    name
}

/// Choices and how the names of their constants begin.
const CHOICES: [(&str, List); 7] = [
    ("LAHAR_SHAPE_", ShapeKind::LIST),
    ("LAHAR_WALLS_", WallTreatment::LIST),
    ("LAHAR_TRANSFER_", TransferKind::LIST),
    ("LAHAR_ORDER_", StepOrder::LIST),
    ("LAHAR_GRID_", GridPolicy::LIST),
    ("LAHAR_WALL_", WallKind::LIST),
    ("LAHAR_LOG_", LogLevel::LIST),
];

#[test]
fn the_constants_of_choices_are_those_of_their_lists_in_c_and_in_fortran() {
    let header = read("include/lahar/lahar.h");
    let module = read("include/lahar/lahar.f90");
    let in_header = header.lines().filter_map(|l| l.strip_prefix("#define ")?.split_once(' '));
    let in_module = module.lines().filter_map(|line| {
        let (_, constant) = line.split_once(", parameter, public :: ")?;
        constant.strip_suffix("_c_int32_t")?.split_once(" = ")
    });
    let (in_header, in_module): (Vec<_>, Vec<_>) = (in_header.collect(), in_module.collect());
    for (start, choice) in CHOICES {
        let numbers: Vec<String> = choice.values.iter().map(|v| v.number.to_string()).collect();
        let list: Vec<(&str, &str)> =
            choice.values.iter().zip(&numbers).map(|(v, n)| (v.constant, n.as_str())).collect();
        for all in [&in_header, &in_module] {
            let found = all.iter().filter(|(name, _)| name.starts_with(start));
            assert_eq!(found.copied().collect::<Vec<_>>(), list);
        }
        for value in choice.values {
            assert_eq!(value.constant, format!("{start}{}", value.key.to_uppercase()));
        }
    }
}

#[test]
fn the_version_of_the_header_is_that_of_the_package_and_of_the_library() {
    let header = read("include/lahar/lahar.h");
    let part = |name: &str| {
        let line =
            header.lines().find_map(|l| l.strip_prefix(&format!("#define LAHAR_VERSION_{name} ")));
        line.expect("a version").to_string()
    };
    let version = format!("{}.{}.{}", part("MAJOR"), part("MINOR"), part("PATCH"));
    assert_eq!(version, env!("CARGO_PKG_VERSION"));
    let text = "#include <lahar/lahar.h>\nint main(void) {\n  int32_t a = -1, b = -1, c = -1;\n  \
                if (lahar_version(&a, &b, &c) != LAHAR_OK || lahar_abi_version() != LAHAR_ABI_VERSION) return 1;\n  \
                return a != LAHAR_VERSION_MAJOR || b != LAHAR_VERSION_MINOR || c != LAHAR_VERSION_PATCH;\n}\n";
    run_source(text);
}

/// Compiles a text, links it with the library and runs it.
fn run_source(text: &str) {
    let source = scratch_folder().join("program.c");
    fs::write(&source, text).expect("a source");
    run(&mut Command::new(program(&source)));
}

#[test]
fn the_library_exports_the_symbols_of_the_list_and_no_others() {
    let mut nm = Command::new("nm");
    let table = run(nm.args(["-D", "--defined-only"]).arg(library_folder().join("liblahar.so")));
    let mut exported: Vec<&str> =
        table.lines().filter_map(|l| l.split_whitespace().next_back()).collect();
    exported.sort_unstable();
    let list = read("include/lahar/symbols.txt");
    assert_eq!(exported, list.lines().collect::<Vec<_>>());
}

#[test]
fn the_header_declares_the_exported_functions_and_no_others() {
    let mut declared: Vec<String> = prototypes().into_iter().map(|(name, _)| name).collect();
    declared.sort_unstable();
    let list = read("include/lahar/symbols.txt");
    assert_eq!(declared, list.lines().collect::<Vec<_>>());
}

#[test]
fn the_list_of_statuses_has_every_function_that_returns_one_in_the_order_of_the_header() {
    let header = read("include/lahar/lahar.h");
    let declared = header.lines().filter_map(|l| l.strip_prefix("lahar_status ")?.split_once('('));
    let declared: Vec<&str> = declared.map(|(name, _)| name).collect();
    let listed: Vec<&str> = ANSWERS.iter().map(|(name, _)| *name).collect();
    assert_eq!(listed, declared);
    assert_eq!(header.matches("// Errors: ").count(), listed.len());
}

#[test]
fn every_function_states_its_thread_rule_in_the_line_before_it() {
    let header = read("include/lahar/lahar.h");
    let lines: Vec<&str> = header.lines().collect();
    let mut found = 0;
    for (name, _) in prototypes() {
        let at = lines.iter().position(|l| !l.starts_with("//") && l.contains(&format!("{name}(")));
        let rule = lines[at.expect("the prototype") - 1];
        let rules = ["// Thread: any", "// Thread: owner", "// Thread: callback-ok"];
        assert!(rules.contains(&rule), "{name}: `{rule}` is no thread rule");
        found += 1;
    }
    assert!(found > 60, "only {found} functions were found");
}
