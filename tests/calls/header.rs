//! What `lahar.h` says: its functions with their arguments and statuses, and its structs.

use std::collections::{BTreeMap, BTreeSet};

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
    /// Names of the statuses that its text lists, those of functions that it refers to included.
    pub statuses: BTreeSet<String>,
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
        let (mut comment, mut code) = (String::new(), String::new());
        let (mut texts, mut sections) = (BTreeMap::new(), BTreeMap::new());
        let mut section = BTreeSet::new();
        let (_, text) = text.split_once("extern \"C\" {").expect("declarations for C++ too");
        for line in text.lines().map(str::trim) {
            if let Some(text) = line.strip_prefix("//") {
                // a field's comment is none of its struct
                if code.is_empty() {
                    comment.push_str(text);
                }
            } else if line.is_empty() || line.starts_with(['#', '/', '*']) {
                comment.clear();
                // what any function of a section may return
                if line.starts_with("/* ---- ") {
                    section.clear();
                }
                section.extend(words(line).filter(|word| is_status(word)).map(String::from));
            } else {
                code.push_str(line.split("//").next().unwrap_or_default());
                code.push(' ');
                let is_open = code.matches('{').count() > code.matches('}').count();
                if line.ends_with(';') && !is_open {
                    let name = header.declaration(&code);
                    if let Some(name) = name {
                        sections.insert(name.clone(), section.clone());
                        texts.insert(name, comment.clone());
                    }
                    code.clear();
                    comment.clear();
                }
            }
        }
        for function in &mut header.functions {
            function.statuses = statuses(&function.name, &texts, 3);
            function.statuses.extend(sections[&function.name].iter().cloned());
        }
        header
    }

    /// Takes a whole declaration; the name of a function.
    fn declaration(&mut self, code: &str) -> Option<String> {
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
        let statuses = BTreeSet::new();
        self.functions.push(Function { name: name.clone(), arguments, has_status, statuses });
        Some(name)
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

/// The statuses that a function's text lists after "Errors", and those of the functions that it
/// names there.
fn statuses(function: &str, texts: &BTreeMap<String, String>, depth: usize) -> BTreeSet<String> {
    let text = texts.get(function).map_or("", String::as_str);
    let Some((_, errors)) = text.split_once("Errors") else { return BTreeSet::new() };
    let errors = errors.split(" Thread:").next().unwrap_or_default();
    let mut found = BTreeSet::new();
    for word in words(errors) {
        if is_status(word) {
            found.insert(word.to_string());
        } else if depth > 0 && word != function && texts.contains_key(word) {
            found.extend(statuses(word, texts, depth - 1));
        }
    }
    found
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_alphanumeric() && c != '_')
}

fn is_status(word: &str) -> bool {
    word.starts_with("LAHAR_ERROR_")
}
