//! What `lahar.h` says: its functions with their arguments, and its structs. The statuses that the
//! header lists for a function come from the list that the header is generated from.

use std::collections::{BTreeMap, BTreeSet};

use lahar::error::Status;
use lahar::ffi::answers::documented;

/// A field or an argument.
#[derive(Clone, Debug)]
pub struct Declaration {
    /// The type without `const` and pointers, such as `double`.
    pub base: String,
    /// Number of pointers; an array counts as one in arguments.
    pub pointers: usize,
    /// Number of elements; 1 if it is no array.
    pub length: usize,
    pub name: String,
    pub is_const: bool,
}

/// An exported function.
#[derive(Debug)]
pub struct Function {
    pub name: String,
    pub arguments: Vec<Declaration>,
    /// Whether it returns a status.
    pub has_status: bool,
    /// The statuses that its text lists.
    pub statuses: Vec<Status>,
}

/// All of the header.
#[derive(Debug, Default)]
pub struct Header {
    pub functions: Vec<Function>,
    pub structs: BTreeMap<String, Vec<Declaration>>,
    pub callbacks: BTreeSet<String>,
}

impl Header {
    /// Reads the text of a header.
    pub fn read(text: &str) -> Self {
        let mut header = Self::default();
        let mut code = String::new();
        let (_, text) = text.split_once("extern \"C\" {").expect("declarations for C++ too");
        for line in text.lines().map(str::trim) {
            if line.is_empty() || line.starts_with(['#', '/', '*']) {
                continue;
            }
            code.push_str(line.split("//").next().unwrap_or_default());
            code.push(' ');
            let is_open = code.matches('{').count() > code.matches('}').count();
            if line.ends_with(';') && !is_open {
                header.declaration(&code);
                code.clear();
            }
        }
        header
    }

    /// Takes a whole declaration.
    fn declaration(&mut self, code: &str) -> Option<()> {
        if let Some(rest) = code.strip_prefix("typedef struct ") {
            let (name, rest) = rest.split_once('{')?;
            let fields = rest.split('}').next()?.split(';').map(str::trim);
            let fields = fields.filter(|f| !f.is_empty()).map(|f| declared(f, false)).collect();
            self.structs.insert(name.trim().into(), fields);
            return None;
        }
        if let Some(rest) = code.strip_prefix("typedef ") {
            let name = rest.split_once("(*")?.1.split(')').next()?;
            self.callbacks.insert(name.into());
            return None;
        }
        let (head, rest) = code.split_once('(')?;
        let name = head.split_whitespace().last()?.trim_start_matches('*').to_string();
        if !name.starts_with("lahar_") {
            return None; // an assertion
        }
        let list = rest.split(')').next()?;
        let arguments = match list {
            "void" => Vec::new(),
            list => list.split(',').map(|a| declared(a.trim(), true)).collect(),
        };
        let has_status = head.starts_with("lahar_status");
        let statuses = documented(&name).unwrap_or_default();
        self.functions.push(Function { name, arguments, has_status, statuses });
        Some(())
    }
}

fn declared(text: &str, is_argument: bool) -> Declaration {
    let (text, length) = match text.split_once('[') {
        Some((text, rest)) => (text, rest.trim_end_matches(']').parse().expect("a length")),
        None => (text, 1),
    };
    let start = text.rfind(|c: char| !c.is_alphanumeric() && c != '_').expect("a type and a name");
    let (kind, name) = text.split_at(start + 1);
    let is_array = length > 1;
    Declaration {
        base: kind.replace("const", "").replace('*', "").trim().into(),
        pointers: kind.matches('*').count() + usize::from(is_array && is_argument),
        length,
        name: name.into(),
        is_const: kind.contains("const"),
    }
}
