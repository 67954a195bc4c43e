//! Fortran text for the declarations of a header.
//!
//! | C | Fortran |
//! |---|---|
//! | `int32_t`, `uint32_t`, a status | `integer(c_int32_t), value` |
//! | `int64_t` | `integer(c_int64_t), value` |
//! | `double` | `real(c_double), value` |
//! | pointer to one of these or to a struct | array or struct by reference, `optional`: absent is NULL |
//! | `const char *` | `character(kind=c_char)`, ended by `c_null_char` |
//! | handle, `void *` | `type(c_ptr), value` |
//! | pointer to a handle | `type(c_ptr), intent(out)` |
//! | pointer to a function | `type(c_funptr), value` |

use super::declarations::{FUNCTION_POINTER, Function, Header, Struct, Type, Variable};
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// Beginnings of the names of constants that are ids or bits of 64; all others are codes.
const LONG_CONSTANTS: [&str; 3] = ["LAHAR_ALL_BODIES", "LAHAR_OUTPUT_", "LAHAR_CAPABILITY_"];

/// The generated section: constants, types, interfaces.
pub fn section(header: &Header) -> Result<String, String> {
    let mut text = String::new();
    for (name, value) in &header.constants {
        let is_long = LONG_CONSTANTS.iter().any(|start| name.starts_with(start));
        let kind = if is_long { "c_int64_t" } else { "c_int32_t" };
        let _ = writeln!(text, "  integer({kind}), parameter, public :: {name} = {value}_{kind}");
    }
    for structure in &header.structs {
        text.push_str(&derived_type(header, structure)?);
    }
    text.push('\n');
    if header.functions.is_empty() {
        return Ok(text);
    }
    text.push_str("  interface\n");
    for function in &header.functions {
        text.push_str(&interface(header, function)?);
    }
    text.truncate(text.trim_end().len());
    text.push_str("\n  end interface\n\n");
    for function in &header.functions {
        let _ = writeln!(text, "  public :: {}", fortran_name(header, &function.name));
    }
    Ok(text)
}

fn derived_type(header: &Header, structure: &Struct) -> Result<String, String> {
    let mut text = format!("\n  type, bind(c), public :: {}\n", structure.name);
    for field in &structure.fields {
        let kind = value_type(header, field)?;
        let length = field.length.map_or(String::new(), |n| format!("({n})"));
        let start = initial(header, field);
        let _ = writeln!(text, "    {kind} :: {}{length}{start}", field.name);
    }
    let _ = writeln!(text, "  end type {}", structure.name);
    Ok(text)
}

/// Everything starts at zero or NULL, as the reserved fields have to.
fn initial(header: &Header, field: &Variable) -> &'static str {
    match (field.kind.depth, header.resolve(&field.kind.base)) {
        (1.., _) => " = c_null_ptr",
        (0, "double") => " = 0.0_c_double",
        (0, FUNCTION_POINTER) => " = c_null_funptr",
        (0, base) if integer_kind(base).is_some() => " = 0",
        _ => "", // a struct has its own
    }
}

fn interface(header: &Header, function: &Function) -> Result<String, String> {
    let fortran = fortran_name(header, &function.name);
    let name = &function.name;
    let list: Vec<&str> = function.arguments.iter().map(|a| a.name.as_str()).collect();
    let (head, end, result) = match returned(header, &function.returns)? {
        Some(kind) => ("function", "end function", format!("      {kind} :: answer\n")),
        None => ("subroutine", "end subroutine", String::new()),
    };
    let list = list.join(", ");
    let suffix = if result.is_empty() { "" } else { " result(answer)" };
    let mut text = format!("    {head} {fortran}({list}) &\n");
    let _ = writeln!(text, "        bind(c, name=\"{name}\"){suffix}");
    let imports = imports(header, function)?;
    let _ =
        writeln!(text, "      import :: {}", imports.into_iter().collect::<Vec<_>>().join(", "));
    text.push_str("      implicit none\n");
    for argument in &function.arguments {
        let _ = writeln!(text, "      {}", dummy(header, argument)?);
    }
    let _ = writeln!(text, "{result}    {end} {fortran}\n");
    if let Some(long) = text.lines().find(|line| line.len() > 132) {
        return Err(format!("a line of Fortran has more than 132 characters: {long}"));
    }
    Ok(text)
}

/// The name in Fortran, where case does not count: a function called like a constant gets a suffix.
fn fortran_name(header: &Header, name: &str) -> String {
    let taken = header.constants.iter().any(|(constant, _)| constant.eq_ignore_ascii_case(name));
    if taken { format!("{name}_function") } else { name.to_string() }
}

fn returned(header: &Header, kind: &Type) -> Result<Option<String>, String> {
    match (kind.depth, header.resolve(&kind.base)) {
        (0, "void") => Ok(None),
        (1, "char") => Ok(Some("type(c_ptr)".to_string())),
        (0, base) => integer_kind(base)
            .map(|kind| Some(format!("integer({kind})")))
            .ok_or_else(|| format!("cannot return `{base}`")),
        _ => Err(format!("cannot return {kind:?}")),
    }
}

/// Type of a value or a struct's field.
fn value_type(header: &Header, variable: &Variable) -> Result<String, String> {
    let base = header.resolve(&variable.kind.base);
    let text = match (variable.kind.depth, base) {
        (1.., _) => "type(c_ptr)".to_string(),
        (0, "double") => "real(c_double)".to_string(),
        (0, FUNCTION_POINTER) => "type(c_funptr)".to_string(),
        (0, base) if header.callbacks.iter().any(|name| name == base) => "type(c_funptr)".into(),
        (0, base) if header.structs.iter().any(|s| s.name == base) => format!("type({base})"),
        (0, base) => {
            let kind = integer_kind(base).ok_or_else(|| format!("no Fortran for `{base}`"))?;
            format!("integer({kind})")
        }
    };
    Ok(text)
}

/// Declaration of a dummy argument.
fn dummy(header: &Header, argument: &Variable) -> Result<String, String> {
    let name = &argument.name;
    let base = header.resolve(&argument.kind.base);
    let by_pointer =
        argument.kind.depth + usize::from(argument.length.is_some() && argument.kind.depth == 0);
    let intent = if argument.kind.constant { "intent(in)" } else { "intent(inout)" };
    let shape = argument.length.map_or_else(|| "*".to_string(), |n| n.to_string());
    let is_struct = header.structs.iter().any(|s| s.name == base);
    let is_handle = header.opaque.iter().any(|handle| handle == base);
    let text = match (by_pointer, base) {
        (0, _) => format!("{}, value :: {name}", value_type(header, argument)?),
        (1, "void") => format!("type(c_ptr), value :: {name}"),
        (1, "char") => format!("character(kind=c_char), {intent}, optional :: {name}(*)"),
        (1, "double") => format!("real(c_double), {intent}, optional :: {name}({shape})"),
        (1, base) if is_struct => format!("type({base}), {intent}, optional :: {name}"),
        (1, _) if is_handle => format!("type(c_ptr), value :: {name}"),
        (1, base) => {
            let kind = integer_kind(base).ok_or_else(|| format!("no Fortran for `{base} *`"))?;
            format!("integer({kind}), {intent}, optional :: {name}({shape})")
        }
        (2, "char") => format!("type(c_ptr), intent(in), optional :: {name}(*)"),
        (2, _) if is_handle => format!("type(c_ptr), intent(out) :: {name}"),
        _ => return Err(format!("no Fortran for {argument:?}")),
    };
    Ok(text)
}

fn integer_kind(base: &str) -> Option<&'static str> {
    match base {
        "int32_t" | "uint32_t" => Some("c_int32_t"),
        "int64_t" | "uint64_t" => Some("c_int64_t"),
        _ => None,
    }
}

/// Kinds and types that the interface body names.
fn imports(header: &Header, function: &Function) -> Result<BTreeSet<String>, String> {
    let mut names = BTreeSet::new();
    let returned = returned(header, &function.returns)?.unwrap_or_default();
    let arguments: Result<Vec<String>, String> =
        function.arguments.iter().map(|argument| dummy(header, argument)).collect();
    for text in arguments?.iter().chain([&returned]) {
        let head = text.split("::").next().unwrap_or_default();
        for word in head.split(|c: char| !c.is_alphanumeric() && c != '_') {
            if word.starts_with("c_") || word.starts_with("lahar_") {
                names.insert(word.to_string());
            }
        }
    }
    Ok(names)
}
