//! What several test modules need.
#![allow(dead_code)] // not every module uses everything

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{self, Command};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Path of a shipped plugin, `drucker_prager` for example, in the target folder of this test. A
/// missing plugin fails.
pub fn plugin_path(name: &str) -> String {
    let path = target_folder().join(format!("liblahar_{name}.so"));
    assert!(
        path.is_file(),
        "the plugin {} is missing: build the workspace first (cargo build --release --workspace), as `cargo xtask \
         test` does",
        path.display()
    );
    path.to_str().expect("a UTF-8 path").to_string()
}

/// The names of the shipped plugins; an adapter of foreign libraries is none itself.
pub fn shipped() -> Vec<String> {
    let folders = std::fs::read_dir(repository("plugins")).expect("the folder of plugins");
    let names = folders.map(|entry| entry.expect("an entry")).filter_map(|entry| {
        let name = entry.file_name().into_string().expect("UTF-8");
        let is_plugin = entry.path().join("plugin/Cargo.toml").is_file() && name != "umat";
        is_plugin.then(|| name.replace('-', "_"))
    });
    let mut names: Vec<String> = names.collect();
    names.sort();
    assert!(names.len() >= 5, "{names:?}");
    names
}

/// The folder of the profile that this test was built in: `target/release`.
pub fn target_folder() -> PathBuf {
    let test = std::env::current_exe().expect("the path of the running test");
    test.ancestors().nth(2).expect("the test runs from target/<profile>/deps").to_path_buf()
}

/// Path of a file of the repository.
pub fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// A folder of its own for each call.
pub fn scratch_folder() -> PathBuf {
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    let folder =
        Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("it-{}-{count}", process::id()));
    std::fs::create_dir_all(&folder).expect("a scratch folder");
    folder
}

/// Compiles `tests/bad_plugins/<name>.c` with the system's compiler into a scratch folder; the path
/// of the library.
pub fn bad_plugin(name: &str) -> String {
    let library = scratch_folder().join(format!("lib{name}.so"));
    let source = repository("tests/bad_plugins").join(format!("{name}.c"));
    let compiler = std::env::var_os("CC").unwrap_or_else(|| OsString::from("cc"));
    let output = Command::new(&compiler)
        .args(["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-O1", "-shared", "-fPIC"])
        .arg("-I")
        .arg(repository("include"))
        .args([&source, Path::new("-o"), &library])
        .output()
        .unwrap_or_else(|e| panic!("{} cannot run: {e}", compiler.display()));
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{} does not compile: {errors}", source.display());
    library.to_str().expect("a UTF-8 path").to_string()
}

/// Runs one test of this binary again as a child process with other environment variables; `test`
/// is its full name. Returns whether the running process is such a child.
pub fn in_child(test: &str, variables: &[(&str, &str)]) -> bool {
    const MARK: &str = "LAHAR_TEST_CHILD";
    if std::env::var(MARK).as_deref() == Ok(test) {
        return true;
    }
    let test_binary = std::env::current_exe().expect("the path of the running test");
    let output = Command::new(test_binary)
        .args(["--exact", test, "--nocapture"])
        .env(MARK, test)
        .envs(variables.iter().copied())
        .output()
        .expect("the test runs again");
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(
        output.status.success() && text.contains("1 passed"),
        "{test} in a child process with {variables:?}:\n{text}{}",
        String::from_utf8_lossy(&output.stderr)
    );
    false
}
