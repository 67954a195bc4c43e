//! Builds a library that the adapter can load of Fortran and C sources: what `lahar plugin umat-build` does.

use std::fs::{self, Permissions};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::{env, process};
use tempfile::TempDir;

const ABA_PARAM: &str = include_str!("../share/ABA_PARAM.INC");
const VABA_PARAM: &str = include_str!("../share/vaba_param.inc");
const UTILITIES: &str = include_str!("../share/utilities.c");

/// Sources name them in either case; file systems distinguish the cases.
const INCLUDES: [(&str, &str); 6] = [
    ("ABA_PARAM.INC", ABA_PARAM),
    ("aba_param.inc", ABA_PARAM),
    ("VABA_PARAM.INC", VABA_PARAM),
    ("vaba_param.inc", VABA_PARAM),
    ("VABA_PARAM_DP.INC", VABA_PARAM),
    ("vaba_param_dp.inc", VABA_PARAM),
];

/// Nothing else is exported: helpers of one library must not be mixed up with those of another.
const EXPORTS: &str = "{ global: umat_; umat; UMAT; vumat_; vumat; VUMAT; sdvini_; sdvini; SDVINI;\n\
                       lahar_umat_guard; lahar_umat_set_log; local: *; };\n";

const ROUTINES: [&str; 6] = ["umat_", "umat", "UMAT", "vumat_", "vumat", "VUMAT"];

/// What is to be built.
#[derive(Debug, Clone)]
pub struct Order {
    /// Fortran in fixed form (`.f`, `.for`, `.ftn`), in free form (`.f90`, `.f95`, `.f03`, `.f08`), C (`.c`), objects (`.o`).
    pub sources: Vec<PathBuf>,
    /// The library; `lib` and the first source's name with `.so` in the current folder if it is not given.
    pub output: Option<PathBuf>,
    /// The compiler: gfortran, or one that takes its options.
    pub compiler: String,
    /// More options for the compiler.
    pub options: Vec<String>,
}

impl Order {
    /// An order with gfortran and no more options.
    pub fn new(sources: impl IntoIterator<Item = PathBuf>) -> Self {
        let sources = sources.into_iter().collect();
        Self { sources, output: None, compiler: "gfortran".into(), options: Vec::new() }
    }

    /// The library that will be written.
    pub fn library(&self) -> PathBuf {
        self.output.clone().unwrap_or_else(|| {
            let first = self.sources.first().and_then(|s| s.file_stem()).unwrap_or_default();
            PathBuf::from(format!("lib{}.so", first.to_string_lossy()))
        })
    }
}

/// What came of it.
#[derive(Debug)]
pub struct Built {
    /// The library.
    pub library: PathBuf,
    /// Warnings of the compiler; none unless an option `-W...` asks for them.
    pub warnings: String,
    /// What the author should know.
    pub notes: Vec<String>,
}

/// A new folder of this user alone among the temporary files, with a name that others cannot foresee; removed when dropped.
pub(crate) fn private_folder() -> Result<TempDir, String> {
    let prefix = format!("lahar-umat-{}-", process::id());
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).permissions(Permissions::from_mode(0o700));
    builder.tempdir().map_err(|e| {
        format!("cannot make a folder in {}: {e}; set TMPDIR", env::temp_dir().display())
    })
}

/// A folder of files for the compiler.
fn folder() -> Result<TempDir, String> {
    let folder = private_folder()?;
    let files = [("utilities.c", UTILITIES), ("exports.map", EXPORTS)];
    for (name, text) in INCLUDES.into_iter().chain(files) {
        fs::write(folder.path().join(name), text).map_err(|e| {
            format!("cannot write into {}: {e}; set TMPDIR", folder.path().display())
        })?;
    }
    Ok(folder)
}

/// Compiles and links the sources with the utility routines. Errors contain the output of the
/// compiler and what to do.
pub fn build(order: &Order) -> Result<Built, String> {
    let folder = folder()?;
    let folder = folder.path();
    let library = order.library();
    let mut command = Command::new(&order.compiler);
    command.args(["-O2", "-fPIC", "-shared", "-frecursive", "-std=legacy"]);
    command.args(["-ffixed-line-length-132", "-ffree-line-length-none"]);
    if !order.options.iter().any(|o| o.starts_with("-W") && !o.starts_with("-Wl")) {
        command.arg("-w"); // old sources are full of what is warned of today
    }
    command.arg("-I").arg(folder).arg("-J").arg(folder).args(&order.options);
    if order.sources.is_empty() {
        return Err("expected at least one source, got none".into());
    }
    for source in &order.sources {
        check(source)?;
        command.arg(source);
    }
    command.arg(folder.join("utilities.c")).args(["-Wl,-Bsymbolic", "-Wl,-z,defs"]);
    command.arg(format!("-Wl,--version-script={}", folder.join("exports.map").display()));
    let output = command.arg("-o").arg(&library).args(["-lm"]).output().map_err(|e| {
        format!(
            "the compiler `{}` cannot be run: {e}; install it (`apt install gfortran`) or name another one",
            order.compiler
        )
    })?;
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    if !output.status.success() {
        return Err(failure(order, &said, folder));
    }
    let notes = look_at(&library)?;
    Ok(Built { library, warnings: said, notes })
}

fn check(source: &Path) -> Result<(), String> {
    const KNOWN: [&str; 9] = ["f", "for", "ftn", "f90", "f95", "f03", "f08", "c", "o"];
    let shown = source.display();
    let extension = source.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    if !KNOWN.contains(&extension.as_str()) {
        return Err(format!(
            "expected Fortran in fixed form (.f, .for), in free form (.f90), C (.c) or an object (.o), got `{shown}`"
        ));
    }
    match fs::metadata(source) {
        Ok(file) if file.is_file() => Ok(()),
        Ok(_) => Err(format!("`{shown}` is not a file")),
        Err(e) => Err(format!("`{shown}` cannot be read: {e}")),
    }
}

/// Most lines of a compiler's message that help.
const LINES: usize = 40;

fn failure(order: &Order, said: &str, folder: &Path) -> String {
    let said = said.replace(&format!("{}/", folder.display()), "");
    let mut text = format!("{} could not build {}:\n", order.compiler, order.library().display());
    let lines: Vec<&str> = said.lines().collect();
    for line in lines.iter().take(LINES) {
        text.push_str(line);
        text.push('\n');
    }
    if lines.len() > LINES {
        text.push_str(&format!("... and {} more lines\n", lines.len() - LINES));
    }
    for (sign, advice) in [
        (
            "undefined reference",
            "A routine that is called is missing: add the file that has it, or take the call out if it is a utility routine of Abaqus \
             that the README of the adapter does not list.",
        ),
        (
            "statement label",
            "Is the form right? `.f` and `.for` are fixed form, `.f90` is free form; rename the file if it is the other.",
        ),
        ("Cannot open included file", "Name the folder of the file: `-- -I folder`."),
    ] {
        if said.contains(sign) {
            text.push_str(advice);
            text.push('\n');
        }
    }
    text
}

/// Whether the library has the routine, and what may surprise. Without `nm` nothing is said.
fn look_at(library: &Path) -> Result<Vec<String>, String> {
    let symbols = |options: &[&str]| -> Option<Vec<String>> {
        let Output { stdout, status, .. } =
            Command::new("nm").args(options).arg(library).output().ok()?;
        let text = String::from_utf8_lossy(&stdout).into_owned();
        let names = text.lines().filter_map(|l| Some(l.split_whitespace().last()?.to_string()));
        status.success().then(|| names.collect())
    };
    let Some(defined) = symbols(&["-D", "--defined-only"]) else { return Ok(Vec::new()) };
    if !ROUTINES.iter().any(|routine| defined.iter().any(|d| d == routine)) {
        let all = symbols(&["--defined-only"]).unwrap_or_default();
        let theirs: Vec<_> =
            all.iter().filter(|n| n.ends_with('_') && !n.starts_with('_')).cloned().collect();
        let _ = fs::remove_file(library);
        return Err(format!(
            "the sources have no subroutine UMAT or VUMAT; with an underscore added they have: {}",
            theirs.join(", ")
        ));
    }
    let mut notes = Vec::new();
    let used = symbols(&["-D", "--undefined-only"]).unwrap_or_default();
    let has = |start: &str| used.iter().any(|name| name.starts_with(start));
    if has("_gfortran_stop") || has("_gfortran_error_stop") || has("exit@") {
        notes.push(
            "it may end the process (STOP): write CALL XIT in its place, which ends the call only"
                .into(),
        );
    }
    if has("_gfortran_st_write") {
        notes.push("it may print or write files (WRITE): once per call that is slow".into());
    }
    Ok(notes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_new_is_of_its_user_alone_and_goes() {
        let (a, b) = (private_folder().expect("a folder"), private_folder().expect("another"));
        assert_ne!(a.path(), b.path());
        let mode = fs::metadata(a.path()).expect("a folder").permissions().mode();
        assert_eq!(mode & 0o777, 0o700);
        let path = a.path().to_path_buf();
        drop(a);
        assert!(!path.exists());
    }
}
