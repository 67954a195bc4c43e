//! The C headers, generated: `include/lahar/lahar.h` from `src/ffi`, `include/lahar/lahar_plugin.h`
//! from `plugins/abi`.
//!
//! cbindgen translates one Rust file at a time, so that the header has the sections of `src/ffi`;
//! the sizes and offsets that the headers assert come from `src/ffi/layout.rs`, where Rust asserts
//! them too. The constants of choices come from their lists, see [`lahar::choice`]; the statuses that
//! a function may return come from [`lahar::ffi::answers`]. The list of
//! exported symbols, `include/lahar/symbols.txt`, is made from the same sources.

use lahar::background::GridPolicy;
use lahar::boundary::WallKind;
use lahar::choice::List;
use lahar::context::LogLevel;
use lahar::error::Status;
use lahar::ffi::answers;
use lahar::shape::{ShapeKind, WallTreatment};
use lahar::step::StepOrder;
use lahar::transfer::TransferKind;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Files of `src/ffi` in the order of the header, where a type stands before its first use, and the
/// choices whose constants stand there.
const SECTIONS: &[(&str, &[List])] = &[
    ("status", &[Status::LIST]),
    ("version", &[]),
    ("context", &[LogLevel::LIST]),
    ("error", &[]),
    ("model", &[]),
    ("material", &[]),
    ("world", &WORLD_CHOICES),
    ("body", &[]),
    ("field", &[]),
    ("view", &[]),
    ("wall", &[WallKind::LIST]),
    ("table", &[]),
    ("prescribed_velocity", &[]),
    ("traction", &[]),
    ("progress", &[]),
    ("statics", &[]),
    ("grid", &[]),
    ("output", &[]),
];

/// The choices among the options of a world.
const WORLD_CHOICES: [List; 5] =
    [ShapeKind::LIST, WallTreatment::LIST, TransferKind::LIST, StepOrder::LIST, GridPolicy::LIST];

/// Writes the headers and the symbol list, or with `check` reports those that differ from the
/// sources.
pub fn run(check: bool) -> Result<(), String> {
    let root = root()?;
    let folder = root.join("include/lahar");
    let symbols = symbols(&root)?;
    let files = [
        ("lahar.h", host_header(&root)?),
        ("lahar_plugin.h", plugin_header(&root)?),
        ("symbols.txt", symbols),
    ];
    let mut stale = Vec::new();
    for (name, text) in files {
        let path = folder.join(name);
        let is_same = std::fs::read_to_string(&path).is_ok_and(|old| old == text);
        if is_same {
            continue;
        }
        if check {
            stale.push(name);
        } else {
            std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
            std::fs::write(&path, text).map_err(|e| format!("{}: {e}", path.display()))?;
        }
    }
    match stale.is_empty() {
        true => Ok(()),
        false => Err(format!(
            "{} differ from src/ffi and plugins/abi; run `cargo xtask headers`",
            stale.join(", ")
        )),
    }
}

fn root() -> Result<PathBuf, String> {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let parent = package.parent().ok_or_else(|| format!("{} has no parent", package.display()))?;
    Ok(parent.to_path_buf())
}

fn read(path: &Path) -> Result<String, String> {
    std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))
}

fn host_header(root: &Path) -> Result<String, String> {
    let mut text = format!("{HOST_INTRODUCTION}{}{PLUGIN_TABLE}", opening("LAHAR_H"));
    // a type that no function of its section names
    let not_in_functions = ["lahar_table".to_string()];
    for (section, choices) in SECTIONS {
        let path = root.join(format!("src/ffi/{section}.rs"));
        write_banner(&mut text, section, &path)?;
        choices.iter().for_each(|choice| write_constants(&mut text, choice));
        let mut items = String::new();
        write_items(&mut items, &path, &not_in_functions)?;
        text += &with_answers(&items)?;
    }
    // Typedefs of lahar_plugin.h, which may be included after this header or not at all.
    for name in ["lahar_plugin_desc", "lahar_host_api"] {
        text = text.replace(&format!("const {name} *"), &format!("const struct {name} *"));
    }
    let layout = read(&root.join("src/ffi/layout.rs"))?;
    text += &asserts(&layout, "super::public")?;
    text += &closing("LAHAR_H");
    Ok(text)
}

fn plugin_header(root: &Path) -> Result<String, String> {
    let path = root.join("plugins/abi/src/lib.rs");
    let source = read(&path)?;
    let named = |line: &str| {
        let rest = line.strip_prefix("pub struct ").or_else(|| line.strip_prefix("pub type "))?;
        Some(rest.split(|c: char| !(c.is_alphanumeric() || c == '_')).next()?.to_string())
    };
    let types: Vec<String> = source.lines().filter_map(named).collect();
    let mut text = format!("{PLUGIN_INTRODUCTION}{}", opening("LAHAR_PLUGIN_H"));
    write_banner(&mut text, "plugin", &path)?;
    write_items(&mut text, &path, &types)?;
    text += PLUGIN_ENTRY;
    let layout = read(&root.join("src/ffi/layout.rs"))?;
    // The table names itself before its typedef is complete.
    text = text.replace("(const lahar_model_desc *", "(const struct lahar_model_desc *");
    text += &asserts(&layout, "lahar_plugin_abi")?;
    text += &closing("LAHAR_PLUGIN_H");
    Ok(text)
}

/// The banner of a section with the documentation of its module.
fn write_banner(text: &mut String, name: &str, path: &Path) -> Result<(), String> {
    let source = read(path)?;
    let about = source.lines().map_while(|l| l.strip_prefix("//!")).map(|l| l.trim_end());
    let rule = "-".repeat(100usize.saturating_sub(name.len() + 10));
    let _ = write!(text, "\n/* ---- {name} {rule}\n *\n");
    for line in about {
        let _ = writeln!(text, " *{line}");
    }
    text.push_str(" */\n\n");
    Ok(())
}

/// The items of a section with the line `Errors:` of each function before its line `Thread:`.
fn with_answers(items: &str) -> Result<String, String> {
    let mut out = String::new();
    let (mut doc, mut tag) = (String::new(), None);
    for line in items.lines() {
        if line.starts_with("//") {
            if line.starts_with("// Thread:") {
                tag = Some(doc.len());
            }
            doc = doc + line + "\n";
            continue;
        }
        let function = line.strip_prefix("lahar_status ").and_then(|l| l.split('(').next());
        if let (Some(function), Some(tag)) = (function, tag) {
            let text = answers::text(function)
                .ok_or_else(|| format!("{function} is missing in src/ffi/answers.rs"))?;
            doc.insert_str(tag, &wrapped(&format!("Errors: {text}.")));
        }
        out = out + &std::mem::take(&mut doc) + line + "\n";
        tag = None;
    }
    Ok(out + &doc)
}

/// A text in lines of comments of at most 100 columns.
fn wrapped(text: &str) -> String {
    let mut lines = String::new();
    let mut line = String::from("//");
    for word in text.split(' ') {
        if line.len() + 1 + word.len() > 100 {
            lines += &format!("{line}\n");
            line = "//".into();
        }
        line = line + " " + word;
    }
    lines + &line + "\n"
}

/// A constant for each value of a choice.
fn write_constants(text: &mut String, choice: &List) {
    for value in choice.values {
        for line in value.doc {
            let _ = writeln!(text, "//{line}");
        }
        let _ = writeln!(text, "#define {} {}\n", value.constant, value.number);
    }
}

/// The items of one file.
fn write_items(text: &mut String, path: &Path, types: &[String]) -> Result<(), String> {
    let items = translate(path, types)?;
    text.push_str(items.trim());
    text.push('\n');
    Ok(())
}

/// cbindgen's C for one Rust file, with every type called by its typedef.
fn translate(path: &Path, types: &[String]) -> Result<String, String> {
    let mut config = cbindgen::Config {
        language: cbindgen::Language::C,
        style: cbindgen::Style::Both,
        no_includes: true,
        documentation_style: cbindgen::DocumentationStyle::C99,
        line_length: 110,
        tab_width: 4,
        ..Default::default()
    };
    config.export.include = types.to_vec();
    config.function.sort_by = Some(cbindgen::SortKey::None);
    config.constant.sort_by = Some(cbindgen::SortKey::None);
    let bindings = cbindgen::Builder::new()
        .with_config(config)
        .with_src(path)
        .generate()
        .map_err(|e| format!("{}: {e}", path.display()))?;
    let mut bytes = Vec::new();
    bindings.write(&mut bytes);
    let text = String::from_utf8(bytes).map_err(|e| format!("{}: {e}", path.display()))?;
    let mut out = String::new();
    let mut lines = text.lines().map(str::trim_end).peekable();
    while let Some(line) = lines.next() {
        // What cbindgen's annotations leave behind: an empty comment line before the declaration.
        if line == "//" && lines.peek().is_some_and(|next| !next.starts_with("//")) {
            continue;
        }
        let is_code = !line.starts_with("typedef struct") && !line.trim_start().starts_with("//");
        let line = if is_code { line.replace("struct lahar_", "lahar_") } else { line.to_string() };
        out.push_str(&line);
        out.push('\n');
    }
    Ok(out)
}

/// Static assertions from one block of `src/ffi/layout.rs`.
fn asserts(layout: &str, module: &str) -> Result<String, String> {
    let start = layout
        .find(&format!("    {module},\n"))
        .ok_or_else(|| format!("layout.rs: no block {module}"))?;
    let block = &layout[start..];
    let block = &block[..block.find("\n}\n").ok_or("layout.rs: a block is not closed")?];
    let words = block.split_whitespace().skip(1).map(|w| w.trim_end_matches([',', ':']));
    let mut lines = String::new();
    let mut current = "";
    let mut words = words.peekable();
    while let Some(word) = words.next() {
        match word {
            "{" => {}
            "}" => current = "",
            name => {
                let number =
                    words.next().ok_or_else(|| format!("layout.rs: {name} has no number"))?;
                let what = match current {
                    "" => format!("sizeof({name})"),
                    of => format!("offsetof({of}, {name})"),
                };
                if current.is_empty() {
                    current = name;
                }
                let _ = writeln!(lines, "LAHAR_ASSERT_LAYOUT({what} == {number});");
            }
        }
    }
    Ok(format!("\n{ASSERTS_OPEN}{lines}{ASSERTS_CLOSE}"))
}

fn opening(guard: &str) -> String {
    format!(
        "#ifndef {guard}\n#define {guard}\n\n#include <stddef.h>\n#include <stdint.h>\n\n\
         #ifdef __cplusplus\nextern \"C\" {{\n#endif\n"
    )
}

fn closing(guard: &str) -> String {
    format!("\n#ifdef __cplusplus\n}} /* extern \"C\" */\n#endif\n\n#endif /* {guard} */\n")
}

/// The names of all `extern "C"` functions of `src/ffi`, sorted, one a line.
fn symbols(root: &Path) -> Result<String, String> {
    let mut names = Vec::new();
    for (section, _) in SECTIONS {
        let source = read(&root.join(format!("src/ffi/{section}.rs")))?;
        for part in source.split("extern \"C\" fn lahar_").skip(1) {
            let end = part.find('(').unwrap_or(0);
            names.push(format!("lahar_{}\n", &part[..end]));
        }
    }
    names.sort();
    Ok(names.concat())
}

const HOST_INTRODUCTION: &str = r#"/* lahar.h: the host interface of lahar, a material point method engine.
 *
 * Generated from src/ffi by `cargo xtask headers`; do not edit.
 *
 * Statuses. Functions return a lahar_status: 0: done; positive: refused, nothing has changed;
 * negative: the object is poisoned, it answers queries and can be freed. lahar_last_error_message gives
 * a text that says what was expected, what was received and what to do. Each function lists the statuses
 * that it returns; any may return LAHAR_ERROR_PANIC besides, for a defect of lahar, and
 * LAHAR_ERROR_OUT_OF_MEMORY if not even 64 kB can be had. No function prints, exits or aborts.
 *
 * Handles. lahar_context, lahar_material, lahar_world and lahar_view are opaque. Functions that make an
 * object first set the handle to NULL, and to the object only if they succeed. Functions that free
 * ignore NULL. Objects may be freed in any order: a context lives as long as its worlds and materials, a
 * world as long as its views. A handle must not be used after it was freed. Bodies, walls, prescribed
 * velocities and tractions have int64_t ids, which are never used again.
 *
 * Pointers must not be NULL unless the text says so. Arrays of the host are read or written only during
 * the call, except through views. Texts are NUL-terminated UTF-8, of 4096 bytes at most. Texts that lahar
 * returns by pointer are static: they are valid until the process ends.
 *
 * Structs begin with `struct_size`, their sizeof, so that fields can be added at the end. Structs that
 * have an init function are filled by it. In the others, which lahar fills, the host sets
 * `struct_size`, and lahar sets fields that it does not know to zero.
 *
 * Units are SI in this text; any consistent units may be used. Tension is positive. Symmetric tensors
 * have the components xx, yy, zz, xy, yz, zx, in two dimensions too.
 *
 * Threads. Each function has a tag.
 *   Thread: any          from any thread at any time, and from callbacks
 *   Thread: callback-ok  a query: from any thread and from callbacks; LAHAR_ERROR_BUSY while another
 *                        thread changes the object
 *   Thread: owner        changes or frees the object: by one thread at a time, not from callbacks. A
 *                        second thread gets LAHAR_ERROR_BUSY; but before an object is freed the host
 *                        must have ended all other use of its handle.
 *
 * Floating point. Every function saves the host's floating-point environment (rounding, traps), works in
 * the default one, and restores the host's. Callbacks run in the host's environment.
 */

"#;

const PLUGIN_TABLE: &str = "\n// The tables of plugins and of the engine, defined in lahar_plugin.h.\nstruct lahar_plugin_desc;\nstruct lahar_host_api;\n";

const PLUGIN_INTRODUCTION: &str = r#"/* lahar_plugin.h: the interface between lahar and constitutive models. It has types and tables only: a
 * plugin is not linked with lahar.
 *
 * Generated from plugins/abi by `cargo xtask headers`; do not edit.
 */

"#;

const PLUGIN_ENTRY: &str = r#"
#if defined(_WIN32)
#define LAHAR_PLUGIN_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define LAHAR_PLUGIN_EXPORT __attribute__((visibility("default")))
#else
#define LAHAR_PLUGIN_EXPORT
#endif

// Ids of extensions.
#define LAHAR_EXTENSION_TANGENT "lahar.tangent"
#define LAHAR_EXTENSION_ENERGY "lahar.energy"
#define LAHAR_EXTENSION_TRANSFER "lahar.transfer"

// The one function that a plugin defines: its tables, or NULL to refuse, after `set_error`.
// [exclusive; once in a process, again only after it has refused]
LAHAR_PLUGIN_EXPORT const lahar_plugin_desc *lahar_plugin_entry_v1(const lahar_host_api *host);

// Defined by adapters instead of the entry: the tables of a plugin made of the foreign library at
// `path`, or NULL to refuse, after `set_error`.
// [exclusive; once for each library, again only after it has refused]
LAHAR_PLUGIN_EXPORT const lahar_plugin_desc *lahar_plugin_adapt_v1(const lahar_host_api *host, const char *path);
"#;

const ASSERTS_OPEN: &str = r#"/* ---- layout: what the library was built with, on 64-bit systems */

#if UINTPTR_MAX > 0xffffffffu
#if defined(__cplusplus) && __cplusplus >= 201103L
#define LAHAR_ASSERT_LAYOUT(condition) static_assert(condition, #condition)
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L
#define LAHAR_ASSERT_LAYOUT(condition) _Static_assert(condition, #condition)
#endif
#endif
#ifdef LAHAR_ASSERT_LAYOUT
"#;

const ASSERTS_CLOSE: &str = "#undef LAHAR_ASSERT_LAYOUT\n#endif\n";
