//! `lahar.f90` says what `lahar.h` says, `lahar_plugin.f90` what `lahar_plugin.h` says, and both
//! compile as strictly as gfortran can.
//!
//! gfortran cannot compare a `bind(c)` interface with a C prototype, so names, the order, number
//! and kinds of arguments, the fields and sizes of structs, and the constants are compared here, by
//! a reader that shares nothing with the generator.

use super::compiler::{self, library_folder, read, run};
use super::support::{repository, scratch_folder, target_folder};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Drivers that exist in both languages, with arguments for a short run.
const TWINS: [(&str, &[&str]); 4] = [
    ("01_hello", &["100"]),
    ("02_column_collapse", &["a=0.5", "a=2", "cells=16", "steps=300"]),
    ("05_host_arrays", &["8", "100"]),
    ("06_convergence", &["8", "3", "0.02"]),
];

/// Modules that are made from headers.
const MODULES: [&str; 2] = ["lahar", "lahar_plugin"];

const STRICT: [&str; 4] = ["-std=f2018", "-Wall", "-Werror", "-fimplicit-none"];

/// A name and what stands behind it: `("dt", "f64")`.
type Named = (String, &'static str);

#[test]
fn every_function_has_its_interface_with_the_same_arguments() {
    let header = prototypes(&read("include/lahar/lahar.h"));
    let module = interfaces(&read("include/lahar/lahar.f90"));
    assert!(header.len() > 40, "only {} prototypes were found", header.len());
    assert_eq!(header, module);
}

#[test]
fn every_constant_has_the_same_value() {
    for name in MODULES {
        let header = read(&format!("include/lahar/{name}.h"));
        let in_header: BTreeMap<&str, i64> = header
            .lines()
            .filter_map(|line| line.strip_prefix("#define ")?.split_once(' '))
            .filter_map(|(name, value)| Some((name, value.parse().ok()?)))
            .collect();
        let module = read(&format!("include/lahar/{name}.f90"));
        let in_module: BTreeMap<&str, i64> = module
            .lines()
            .filter_map(|line| line.trim().strip_prefix("integer(")?.split_once(":: "))
            .filter_map(|(_, rest)| rest.split_once(" = ").filter(|_| rest.starts_with("LAHAR_")))
            .map(|(name, value)| (name, value.split('_').next().unwrap().parse().unwrap()))
            .collect();
        assert!(in_header.len() > 30, "only {} constants were found", in_header.len());
        assert_eq!(in_header, in_module);
    }
}

#[test]
fn every_struct_has_the_same_fields_and_size() {
    for name in MODULES {
        let header = read(&format!("include/lahar/{name}.h"));
        let module = format!("include/lahar/{name}.f90");
        let in_header = structs(&without_comments(&header));
        assert!(in_header.len() > 8, "only {} structs were found", in_header.len());
        assert_eq!(in_header, derived_types(&read(&module)));

        let sizes: BTreeMap<String, u64> = header
            .lines()
            .filter_map(|l| l.strip_prefix("LAHAR_ASSERT_LAYOUT(sizeof(")?.split_once(") == "))
            .map(|(name, size)| (name.to_string(), size.trim_end_matches(");").parse().unwrap()))
            .collect();
        assert!(sizes.len() >= in_header.len());
        let blocks: String = sizes
            .iter()
            .map(|(name, size)| {
                format!(
                    "block\n  type({name}) :: s\n  if (c_sizeof(s) /= {size}) error stop '{name}'\nend block\n"
                )
            })
            .collect();
        let text = format!(
            "program sizes\nuse, intrinsic :: iso_c_binding\nuse {name}\nimplicit none\n{blocks}end program\n"
        );
        let source = scratch_folder().join("sizes.f90");
        fs::write(&source, text).expect("a source");
        let module = repository(&module).to_str().expect("a UTF-8 path").to_string();
        let more: &[&str] = if name == "lahar" { &[] } else { &[&module] };
        run(&mut Command::new(program(&source, more)));
    }
}

#[test]
fn the_modules_compile_without_warnings_at_every_level_of_optimisation() {
    for (level, name) in ["-O0", "-O2"].iter().flat_map(|l| MODULES.map(|name| (l, name))) {
        let mut compiler = Command::new("gfortran");
        compiler.args(STRICT).arg(level).arg("-c");
        compiler.arg(repository(&format!("include/lahar/{name}.f90")));
        run(compiler.current_dir(scratch_folder()));
    }
}

#[test]
fn fortran_twins_print_the_numbers_of_the_c_drivers() {
    // Traps are on: a program that leaves its own floating-point environment to lahar would end at
    // once.
    const TRAPS: [&str; 1] = ["-ffpe-trap=invalid,zero,overflow"];
    for (driver, arguments) in TWINS {
        let source = |language| repository("examples-c").join(format!("{driver}.{language}"));
        let c = numbers(&compiler::program(&source("c")), arguments);
        let fortran = numbers(&program(&source("f90"), &TRAPS), arguments);
        assert!(c.len() > 8, "{driver} printed only {} numbers", c.len());
        assert_eq!(c, fortran, "{driver}");
    }
}

#[test]
fn the_readable_layer_has_every_condition_and_gives_the_numbers_of_c() {
    let c = numbers(&compiler::program(&repository("tests/c/conditions.c")), &[]);
    let twin = repository("tests/fortran/conditions.f90");
    let fortran = numbers(&program(&twin, &["-ffpe-trap=invalid,zero,overflow"]), &[]);
    assert_eq!(c.len(), 11);
    assert_eq!(c, fortran);
}

/// Compiles a Fortran program with the module, by the documented line and stricter; the path of the
/// program.
pub fn program(source: &Path, more: &[&str]) -> PathBuf {
    let library = library_folder();
    let folder = scratch_folder();
    let target = folder.join(source.file_stem().expect("a file name"));
    let mut compiler = Command::new("gfortran");
    compiler.args(STRICT).arg("-O2").args(more).arg(repository("include/lahar/lahar.f90"));
    compiler.arg(source).arg("-o").arg(&target).arg("-L").arg(&library).arg("-llahar");
    compiler.arg(format!("-Wl,-rpath,{}", library.display()));
    run(compiler.current_dir(&folder)); // where lahar.mod goes
    target
}

/// The lines `name = value` that a driver prints.
fn numbers(program: &Path, arguments: &[&str]) -> Vec<(String, f64)> {
    let mut driver = Command::new(program);
    driver.args(arguments).env("LAHAR_PLUGIN_PATH", target_folder());
    let printed = run(&mut driver);
    let lines = printed.lines().filter_map(|line| line.split_once('='));
    lines
        .map(|(name, value)| (name.trim().to_string(), value.trim().parse().expect("a number")))
        .collect()
}

// ---- the header

fn without_comments(text: &str) -> String {
    let mut code = String::new();
    let mut in_block = false;
    for line in text.lines() {
        let mut line = line;
        if in_block {
            let Some((_, rest)) = line.split_once("*/") else { continue };
            line = rest;
            in_block = false;
        }
        let line = line.split("//").next().unwrap_or_default();
        let line = match line.split_once("/*") {
            Some((before, after)) => {
                in_block = !after.contains("*/");
                before
            }
            None => line,
        };
        if !line.starts_with('#') && !line.starts_with("LAHAR_ASSERT") {
            code.push_str(line);
            code.push(' ');
        }
    }
    code
}

fn prototypes(header: &str) -> BTreeMap<String, Vec<Named>> {
    let mut found = BTreeMap::new();
    for statement in without_comments(header).split(';') {
        let statement = statement.rsplit('}').next().unwrap_or_default();
        if statement.contains("typedef") || statement.contains('{') && !statement.contains("\"C\"")
        {
            continue;
        }
        let Some((head, rest)) = statement.split_once('(') else { continue };
        let name = last_word(head);
        let list = rest.trim_end().trim_end_matches(')').trim();
        let list = if list == "void" { "" } else { list };
        let arguments = list.split(',').filter(|text| !text.trim().is_empty()).map(c_variable);
        found.insert(name, arguments.collect());
    }
    found
}

fn structs(code: &str) -> BTreeMap<String, Vec<Named>> {
    let mut found = BTreeMap::new();
    for part in code.split("typedef struct ").skip(1) {
        let Some((name, rest)) = part.split_once('{') else { continue };
        if name.contains(';') {
            continue;
        }
        let fields = rest.split('}').next().unwrap_or_default();
        let fields = fields.split(';').filter(|field| !field.trim().is_empty());
        // A pointer to numbers or to a text is a type(c_ptr) in a struct.
        let fields = fields.map(|field| match (field.split_once("(*"), field.contains('*')) {
            (Some((_, rest)), _) => (rest.split(')').next().unwrap_or_default().into(), "other"),
            (None, true) => (c_variable(field).0, "other"),
            (None, false) => c_variable(field),
        });
        found.insert(name.trim().to_string(), fields.collect());
    }
    found
}

/// Name and kind of `const double stress[6]`: a pointer has the kind of what it points at, but a
/// handle is "ptr".
fn c_variable(text: &str) -> Named {
    let declarator = text.split('[').next().unwrap_or_default();
    let words: Vec<&str> = declarator.split([' ', '*']).filter(|word| !word.is_empty()).collect();
    let base = words[..words.len() - 1].iter().find(|w| !["const", "struct"].contains(w));
    let kind = match *base.unwrap_or(&"") {
        "double" => "f64",
        "int64_t" | "uint64_t" => "i64",
        "int32_t" | "uint32_t" | "lahar_status" => "i32",
        "char" if declarator.matches('*').count() == 1 => "char",
        _ => "other",
    };
    (last_word(declarator), kind)
}

fn last_word(text: &str) -> String {
    let word = text.trim_end().rsplit(|c: char| !c.is_alphanumeric() && c != '_').next();
    word.unwrap_or_default().to_string()
}

// ---- the module

fn interfaces(module: &str) -> BTreeMap<String, Vec<Named>> {
    let lines: Vec<&str> = module.lines().map(str::trim).collect();
    let mut found = BTreeMap::new();
    for (index, line) in lines.iter().enumerate() {
        let Some(rest) = line.strip_prefix("bind(c, name=\"") else { continue };
        let name = rest.split('"').next().unwrap_or_default();
        let head = lines[index - 1];
        let (_, list) = head.split_once('(').expect("a list of arguments");
        let list = list.split(')').next().unwrap_or_default();
        let body: Vec<Named> = lines[index..]
            .iter()
            .take_while(|l| !l.starts_with("end "))
            .flat_map(declared)
            .collect();
        assert!(lines[index..index + 3].contains(&"implicit none"), "no implicit none in {name}");
        let arguments = list.split(',').map(str::trim).filter(|a| !a.is_empty());
        let arguments = arguments.map(|argument| {
            let of_name = body.iter().find(|(name, _)| name == argument);
            of_name.unwrap_or_else(|| panic!("{name}: {argument} is not declared")).clone()
        });
        found.insert(name.to_string(), arguments.collect());
    }
    found
}

fn derived_types(module: &str) -> BTreeMap<String, Vec<Named>> {
    let mut found = BTreeMap::new();
    for part in module.split("type, bind(c), public :: ").skip(1) {
        let (name, rest) = part.split_once('\n').expect("lines");
        let fields = rest.lines().map(str::trim).take_while(|line| !line.starts_with("end type"));
        found.insert(name.to_string(), fields.filter_map(|line| declared(&line)).collect());
    }
    found
}

/// Name and kind of `real(c_double), intent(in) :: x(3)`.
fn declared(line: &&str) -> Option<Named> {
    let (kind, name) = line.split_once(" :: ")?;
    if kind.starts_with("import") {
        return None;
    }
    let kind = match kind.split([',', ' ']).next()? {
        "real(c_double)" => "f64",
        "integer(c_int64_t)" => "i64",
        "integer(c_int32_t)" => "i32",
        "character(kind=c_char)" => "char",
        _ => "other",
    };
    Some((name.split(['(', ' ']).next()?.to_string(), kind))
}
