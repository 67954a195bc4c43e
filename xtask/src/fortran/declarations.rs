//! A reader of `lahar.h` and `lahar_plugin.h`. It knows the regular C that cbindgen writes and
//! refuses everything else.

/// What the header declares, in its order.
#[derive(Debug, Default)]
pub struct Header {
    /// `#define LAHAR_NAME number`.
    pub constants: Vec<(String, i64)>,
    /// Structs whose fields are known.
    pub structs: Vec<Struct>,
    /// Structs that are only handled by pointer.
    pub opaque: Vec<String>,
    /// Pointers to functions of the host.
    pub callbacks: Vec<String>,
    /// The functions.
    pub functions: Vec<Function>,
    /// Other names of integer types, `(lahar_status, int32_t)`.
    pub aliases: Vec<(String, String)>,
}

/// A struct with its fields.
#[derive(Debug)]
pub struct Struct {
    /// Its tag.
    pub name: String,
    /// Its fields.
    pub fields: Vec<Variable>,
}

/// A function.
#[derive(Debug)]
pub struct Function {
    /// Its name.
    pub name: String,
    /// What it returns.
    pub returns: Type,
    /// Its arguments.
    pub arguments: Vec<Variable>,
}

/// A field or an argument.
#[derive(Debug)]
pub struct Variable {
    /// Its name.
    pub name: String,
    /// Its type.
    pub kind: Type,
    /// Length of an array, given in the declaration.
    pub length: Option<usize>,
}

/// Base of a pointer to a function that is a field of a struct.
pub const FUNCTION_POINTER: &str = "(*)";

/// A base type with its pointers: `const char *const *` is a constant `char` with depth 2.
#[derive(Debug, PartialEq, Eq)]
pub struct Type {
    /// `double`, `lahar_world`, ...
    pub base: String,
    /// Whether the base is constant.
    pub constant: bool,
    /// Number of stars.
    pub depth: usize,
}

impl Header {
    /// Reads the text of a header.
    pub fn parse(text: &str) -> Result<Self, String> {
        let text = without_comments(text);
        let mut header = Self::default();
        let mut rest = String::new();
        let mut lines = text.lines();
        while let Some(line) = lines.next() {
            let Some(directive) = line.trim_start().strip_prefix('#') else {
                rest.push_str(line);
                rest.push('\n');
                continue;
            };
            if let Some(definition) = directive.trim_start().strip_prefix("define ") {
                header.constants.extend(constant(definition));
            }
            let mut last = line;
            while last.ends_with('\\') {
                last = lines.next().unwrap_or_default();
            }
        }
        for declaration in declarations(&rest) {
            header.declaration(&declaration)?;
        }
        Ok(header)
    }

    fn declaration(&mut self, text: &str) -> Result<(), String> {
        // What a plugin exports is written by its author.
        if text.starts_with("LAHAR_ASSERT_LAYOUT") || text.starts_with("LAHAR_PLUGIN_EXPORT") {
            return Ok(());
        }
        let Some(text) = text.strip_prefix("typedef ") else {
            if let Some(tag) = text.strip_prefix("struct ").filter(|tag| !tag.contains(['{', '(']))
            {
                self.opaque.push(tag.trim().to_string());
                return Ok(());
            }
            self.functions.push(function(text)?);
            return Ok(());
        };
        if let Some(body) = text.strip_prefix("struct ") {
            match body.split_once('{') {
                Some((tag, fields)) => self.structs.push(structure(tag.trim(), fields)?),
                None => self.opaque.extend(body.split_whitespace().last().map(str::to_string)),
            }
        } else if let Some((_, name)) = text.split_once("(*") {
            self.callbacks.extend(name.split_once(')').map(|(name, _)| name.trim().to_string()));
        } else if let [base, alias] = text.split_whitespace().collect::<Vec<_>>()[..] {
            self.aliases.push((alias.to_string(), base.to_string()));
        } else {
            return Err(format!("cannot read `typedef {text}`"));
        }
        Ok(())
    }

    /// The type behind an alias.
    pub fn resolve<'a>(&'a self, base: &'a str) -> &'a str {
        self.aliases.iter().find(|(alias, _)| alias == base).map_or(base, |(_, base)| base)
    }
}

fn without_comments(text: &str) -> String {
    let mut code = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(start) = rest.find("/*").into_iter().chain(rest.find("//")).min() {
        code.push_str(&rest[..start]);
        let (mark, length) = if rest[start..].starts_with("/*") { ("*/", 2) } else { ("\n", 0) };
        let end = rest[start + 2..].find(mark).map_or(rest.len(), |end| start + 2 + end + length);
        rest = &rest[end..];
    }
    code.push_str(rest);
    code
}

/// `LAHAR_NAME 1` or `LAHAR_NAME -1`; what is not a number is not a constant for Fortran.
fn constant(definition: &str) -> Option<(String, i64)> {
    let (name, value) = definition.split_once(' ')?;
    let value = value.trim().trim_matches(['(', ')']).trim_end_matches(['u', 'U', 'l', 'L']);
    Some((name.to_string(), value.parse().ok()?)).filter(|(name, _)| name.starts_with("LAHAR_"))
}

/// The text cut at the semicolons outside of braces, white space made single.
fn declarations(text: &str) -> Vec<String> {
    let text = text.replace("extern \"C\" {", "");
    let mut found = Vec::new();
    let (mut depth, mut current) = (0_i32, String::new());
    for c in text.chars() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => continue, // the end of extern "C"
            '}' => depth -= 1,
            _ => {}
        }
        if c == ';' && depth == 0 {
            found.push(std::mem::take(&mut current));
        } else {
            current.push(c);
        }
    }
    found
        .iter()
        .map(|text| text.split_whitespace().collect::<Vec<_>>().join(" "))
        .filter(|text| !text.is_empty())
        .collect()
}

fn structure(name: &str, body: &str) -> Result<Struct, String> {
    let (fields, _) = body.rsplit_once('}').ok_or_else(|| format!("struct {name} has no end"))?;
    let fields = fields.split(';').map(str::trim).filter(|field| !field.is_empty());
    Ok(Struct { name: name.to_string(), fields: fields.map(field).collect::<Result<_, _>>()? })
}

/// A variable, or `int32_t (*update)(const void *instance)`.
fn field(text: &str) -> Result<Variable, String> {
    let pointer = text.split_once("(*").and_then(|(_, rest)| rest.split_once(")("));
    let Some((name, _)) = pointer else { return variable(text) };
    let kind = Type { base: FUNCTION_POINTER.to_string(), constant: false, depth: 0 };
    Ok(Variable { name: name.trim().to_string(), kind, length: None })
}

fn function(text: &str) -> Result<Function, String> {
    let unread = || format!("cannot read `{text}`");
    let (head, rest) = text.split_once('(').ok_or_else(unread)?;
    let list = rest.strip_suffix(')').ok_or_else(unread)?.trim();
    let head = variable(head)?;
    let arguments = match list {
        "" | "void" => Vec::new(),
        list => list.split(',').map(variable).collect::<Result<_, _>>()?,
    };
    Ok(Function { name: head.name, returns: head.kind, arguments })
}

/// `const double (*min)[3]`, `const double min[3]`, `struct lahar_world **world`, `int64_t n`.
fn variable(text: &str) -> Result<Variable, String> {
    let unread = || format!("cannot read the declaration `{text}`");
    let (declarator, length) = match text.trim().split_once('[') {
        Some((declarator, length)) => {
            let length = length.trim_end().trim_end_matches(']').parse().map_err(|_| unread())?;
            (declarator, Some(length))
        }
        None => (text.trim(), None),
    };
    // A pointer to an array and an array argument are the same thing to a caller.
    let declarator = declarator.replace("(*", " ").replace(')', " ");
    let end = declarator.trim_end();
    let start = end.rfind(|c: char| !c.is_alphanumeric() && c != '_').ok_or_else(unread)? + 1;
    let name = end[start..].to_string();
    let stars = end[..start].matches('*').count();
    let words: Vec<&str> = end[..start].split([' ', '*']).filter(|word| !word.is_empty()).collect();
    let base: Vec<&str> =
        words.iter().copied().filter(|word| *word != "const" && *word != "struct").collect();
    match base[..] {
        [base] => {
            let kind = Type { base: base.to_string(), constant: words[0] == "const", depth: stars };
            Ok(Variable { name, kind, length })
        }
        _ => Err(unread()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "
        #ifndef LAHAR_H
        #define LAHAR_H
        /* a world; */
        #define LAHAR_OK 0
        #define LAHAR_ERROR_PANIC -1
        #ifdef __cplusplus
        extern \"C\" {
        #endif // __cplusplus
        typedef int32_t lahar_status;
        typedef struct lahar_world lahar_world;
        typedef struct lahar_fill { uint32_t struct_size; double stress[6]; const double *data;
            void (*log)(int32_t level, const char *message); } lahar_fill;
        typedef void (*lahar_log_callback)(int32_t level, const char *message, void *user);
        lahar_status lahar_add(struct lahar_world *world, const double (*min)[3],
                               const char *const *names, lahar_world **out);
        const char *lahar_name(lahar_status status);
        #ifdef __cplusplus
        }
        #endif
        LAHAR_PLUGIN_EXPORT const lahar_fill *lahar_entry(const lahar_world *world);
        LAHAR_ASSERT_LAYOUT(sizeof(lahar_fill) == 8);
        #endif";

    #[test]
    fn the_regular_forms_are_read() {
        let header = Header::parse(TEXT).unwrap();
        assert_eq!(header.constants, [("LAHAR_OK".into(), 0), ("LAHAR_ERROR_PANIC".into(), -1)]);
        assert_eq!(header.opaque, ["lahar_world"]);
        assert_eq!(header.callbacks, ["lahar_log_callback"]);
        assert_eq!(header.resolve("lahar_status"), "int32_t");
        assert_eq!(header.structs[0].fields[1].length, Some(6));
        let log = &header.structs[0].fields[3];
        assert_eq!((log.name.as_str(), log.kind.base.as_str()), ("log", FUNCTION_POINTER));
        let [add, name] = &header.functions[..] else { panic!("{:?}", header.functions) };
        assert_eq!((add.arguments.len(), name.arguments.len()), (4, 1));
        assert_eq!((add.arguments[1].name.as_str(), add.arguments[1].length), ("min", Some(3)));
        let names = Type { base: "char".into(), constant: true, depth: 2 };
        assert_eq!(add.arguments[2].kind, names);
        assert_eq!(name.returns, Type { base: "char".into(), constant: true, depth: 1 });
    }
}
