//! Finds and opens plugin libraries. A file is opened once in a process and stays loaded until it
//! ends.

use super::exclusive;
use super::handshake;
use super::host::{HOST, take_error};
use crate::error::{Error, Result, Status};
use crate::material::Plugin;
use lahar_plugin_abi::{LAHAR_PLUGIN_ABI_MAJOR, lahar_host_api, lahar_plugin_desc};
use libc::c_char;
use libloading::os::unix::{Library, RTLD_LOCAL, RTLD_NOW};
use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::ffi::{CStr, CString, OsStr};
use std::fs::{self, File};
use std::io::Read;
use std::os::unix::ffi::OsStrExt;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Every plugin of the process.
static LOADED: Mutex<Vec<&'static Plugin>> = Mutex::new(Vec::new());

type Entry = unsafe extern "C" fn(*const lahar_host_api) -> *const lahar_plugin_desc;

/// The adapter: a plugin that makes plugins of other libraries, such as those with a UMAT.
const ADAPTER: &str = "lahar_umat";

/// Its export.
const ADAPT: &str = "lahar_plugin_adapt_v1\0";

type Adapt = unsafe extern "C" fn(*const lahar_host_api, *const c_char) -> *const lahar_plugin_desc;

/// Major versions whose entry symbols are looked for if that of this library is missing.
const PROBED_MAJORS: std::ops::RangeInclusive<u32> = 0..=9;

/// The plugin of a path (a text with a `/`) or of a bare name; see `Context::load_plugin`.
pub(crate) fn load(name_or_path: &str) -> Result<&'static Plugin> {
    let found =
        if name_or_path.contains('/') { PathBuf::from(name_or_path) } else { find(name_or_path)? };
    let path = canonical_file(&found)?;
    let mut loaded = LOADED.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(plugin) = loaded.iter().find(|p| p.path == path) {
        return Ok(plugin);
    }
    let plugin: &'static Plugin = {
        let _alone = exclusive();
        Box::leak(Box::new(open(&path)?))
    };
    loaded.push(plugin);
    Ok(plugin)
}

/// Looks for the library of a bare name in the absolute folders of `LAHAR_PLUGIN_PATH`, then where
/// this library is installed.
fn find(name: &str) -> Result<PathBuf> {
    if name.is_empty() {
        return Err(Error::invalid("the name of the plugin is empty; give a name or a path"));
    }
    let file = format!("{DLL_PREFIX}{name}{DLL_SUFFIX}");
    let variable = std::env::var_os("LAHAR_PLUGIN_PATH");
    // An empty or relative folder would mean the current directory, from which nothing is loaded
    // unasked.
    let (asked, relative): (Vec<PathBuf>, Vec<PathBuf>) =
        std::env::split_paths(variable.as_deref().unwrap_or_default())
            .partition(|folder| folder.is_absolute());
    let installed = installed_folders();
    let folders = asked.iter().chain(&installed);
    if let Some(path) = folders.map(|folder| folder.join(&file)).find(|p| p.exists()) {
        return Ok(path);
    }
    let list = |folders: &[PathBuf]| {
        let shown: Vec<String> = folders.iter().map(|f| f.display().to_string()).collect();
        shown.join(", ")
    };
    let mut searched = match (&variable, asked.as_slice()) {
        (None, _) => "LAHAR_PLUGIN_PATH is not set".to_string(),
        (Some(_), []) => "LAHAR_PLUGIN_PATH has no absolute folder".to_string(),
        (Some(_), some) => format!("it is not in {} (LAHAR_PLUGIN_PATH)", list(some)),
    };
    if !list(&relative).is_empty() {
        let text = format!(", whose relative folders are not searched: {}", list(&relative));
        searched.push_str(&text);
    }
    Err(Error::new(
        Status::PluginNotFound,
        format!(
            "no plugin `{name}`: searched for {file}: {searched}; nor is it in {}; give a path (for a file of the \
             current directory ./{file}) or add the absolute path of the plugin's folder to LAHAR_PLUGIN_PATH",
            list(&installed)
        ),
    ))
}

/// The folder of plugins of this library's installation: `lahar/plugins-1` beside the library, or
/// under `lib` beside the folder of a program that contains it.
fn installed_folders() -> Vec<PathBuf> {
    let Some(own) = own_path() else { return Vec::new() };
    let folder = own.parent().unwrap_or(Path::new("/"));
    let plugins = format!("lahar/plugins-{LAHAR_PLUGIN_ABI_MAJOR}");
    let above = folder.parent().unwrap_or(folder);
    vec![folder.join(&plugins), above.join("lib").join(&plugins)]
}

/// The file that this code was loaded from.
fn own_path() -> Option<PathBuf> {
    let mut info = libc::Dl_info {
        dli_fname: std::ptr::null(),
        dli_fbase: std::ptr::null_mut(),
        dli_sname: std::ptr::null(),
        dli_saddr: std::ptr::null_mut(),
    };
    // SAFETY: the address is of this library's own code, and `info` can hold the answer.
    let found = unsafe { libc::dladdr(own_path as *const libc::c_void, &mut info) } != 0;
    if !found || info.dli_fname.is_null() {
        return None;
    }
    // SAFETY: the system gives a text that ends with a NUL and lives as long as this library is
    // loaded.
    let name = unsafe { CStr::from_ptr(info.dli_fname) };
    fs::canonicalize(OsStr::from_bytes(name.to_bytes())).ok()
}

/// The canonical path of an existing file that looks like a shared library.
fn canonical_file(path: &Path) -> Result<PathBuf> {
    let shown = path.display();
    let not_found = |e: std::io::Error| {
        let text =
            format!("plugin {shown}: the file cannot be found or read ({e}); check the path");
        Error::new(Status::PluginNotFound, text)
    };
    let invalid = |text: &str| Error::new(Status::PluginInvalid, format!("plugin {shown}: {text}"));
    let path = fs::canonicalize(path).map_err(not_found)?;
    let kind = fs::metadata(&path).map_err(not_found)?;
    if kind.is_dir() {
        return Err(invalid("this is a directory; give the path of the shared library inside it"));
    }
    if !kind.is_file() {
        return Err(invalid("this is not a regular file; give the path of a shared library"));
    }
    let mut start = Vec::new();
    File::open(&path).and_then(|f| f.take(4096).read_to_end(&mut start)).map_err(not_found)?;
    if cfg!(target_os = "linux") && !start.starts_with(b"\x7fELF") {
        return Err(invalid(
            "this is not a shared library (it does not start as an ELF file does); give the path of a .so file",
        ));
    }
    if let Some(machine) = foreign_machine(&start) {
        return Err(invalid(&format!(
            "this is a library for another kind of processor (ELF machine {machine}, expected {MACHINE}); build it for \
             this one"
        )));
    }
    if needed_length(&start).is_some_and(|needed| needed > kind.len()) {
        return Err(invalid("this shared library is cut off; copy or build it again"));
    }
    Ok(path)
}

/// Number of this processor's kind in ELF files; 0 if it is not known here.
const MACHINE: u16 = match () {
    () if cfg!(target_arch = "x86_64") => 62,
    () if cfg!(target_arch = "aarch64") => 183,
    () => 0,
};

/// The kind of processor that an ELF file is for, if it is another.
fn foreign_machine(start: &[u8]) -> Option<u16> {
    let machine = u16::from_le_bytes(start.get(18..20)?.try_into().ok()?);
    (start[..4] == *b"\x7fELF" && MACHINE != 0 && machine != MACHINE).then_some(machine)
}

/// Length that a 64-bit little-endian ELF file must have to hold its loaded segments and its table
/// of sections, which linkers write last. The system's loader maps a shorter file and then dies of
/// a bus error, and the host with it.
fn needed_length(start: &[u8]) -> Option<u64> {
    const LOAD: u32 = 1;
    let u16_at = |at: usize| Some(u16::from_le_bytes(start.get(at..at + 2)?.try_into().ok()?));
    let u32_at = |at: usize| Some(u32::from_le_bytes(start.get(at..at + 4)?.try_into().ok()?));
    let u64_at = |at: usize| Some(u64::from_le_bytes(start.get(at..at + 8)?.try_into().ok()?));
    if start.get(4..6)? != [2, 1] {
        return None; // another class or byte order: the loader says so itself
    }
    let (table, size, count) = (u64_at(32)?, u16_at(54)?, u16_at(56)?);
    let table = usize::try_from(table).ok().filter(|t| *t < start.len())?;
    let sections = u64::from(u16_at(58)?) * u64::from(u16_at(60)?);
    let mut needed = u64_at(40)?.saturating_add(sections).max(64);
    for i in 0..usize::from(count) {
        let header = table + i * usize::from(size);
        if u32_at(header)? == LOAD {
            needed = needed.max(u64_at(header + 8)?.saturating_add(u64_at(header + 32)?));
        }
    }
    Some(needed)
}

fn open(path: &Path) -> Result<Plugin> {
    let shown = path.display();
    // SAFETY: the user asked for this library; its initialisers run with the rights of the process,
    // which the documentation of `lahar_context_load_plugin` says.
    let library = unsafe { Library::open(Some(path), RTLD_NOW | RTLD_LOCAL) }.map_err(|e| {
        let reason = with_source(&e);
        let hint = if reason.contains("undefined symbol") {
            "; link what defines it into the plugin (`lahar plugin umat-build` does that for the utility routines of Abaqus)"
        } else {
            ""
        };
        let text = format!("plugin {shown}: the system cannot load it: {reason}{hint}");
        Error::new(Status::PluginInvalid, text)
    })?;
    let entry = find_entry(&library, path);
    // SAFETY: the symbol is only looked for.
    let is_adapter = unsafe { library.get::<Adapt>(ADAPT.as_bytes()) }.is_ok();
    // Thread-local destructors and static texts of a library live on: it is never unloaded, usable
    // or not.
    std::mem::forget(library);
    let entry = match entry {
        Err(_) if is_adapter => {
            let text = "this is an adapter, which makes plugins of foreign libraries: give the library with the UMAT or VUMAT itself";
            return Err(Error::new(Status::PluginInvalid, format!("plugin {shown}: {text}")));
        }
        Err(error) if error.status == Status::PluginInvalid => return adapted(path, error),
        entry => entry?,
    };
    take_error();
    // SAFETY: the symbol's name fixes its type; the host table is static; the caller holds the lock
    // of exclusive functions.
    let desc = unsafe { entry(&HOST) };
    if desc.is_null() {
        let why = take_error().unwrap_or_else(|| "without saying why".into());
        let text = format!("plugin {shown}: it refused to load: {why}");
        return Err(Error::new(Status::PluginRefused, text));
    }
    // SAFETY: the entry of this major returns a table of this major, valid for the life of the
    // process.
    unsafe { handshake::read_plugin(desc, path) }
}

/// What the adapter makes of a library that is not a plugin.
fn adapted(path: &Path, not_a_plugin: Error) -> Result<Plugin> {
    let with = |text: &str| {
        let message = format!("{}; {text}", not_a_plugin.message);
        Err(Error { message, ..not_a_plugin.clone() })
    };
    let Ok(adapter) = find(ADAPTER).and_then(|found| canonical_file(&found)) else {
        return with(
            "if it holds an Abaqus UMAT, put liblahar_umat.so into a folder of LAHAR_PLUGIN_PATH",
        );
    };
    let shown = adapter.display();
    // SAFETY: as in `open`; the adapter is one of lahar's own.
    let library = match unsafe { Library::open(Some(&adapter), RTLD_NOW | RTLD_LOCAL) } {
        Ok(library) => library,
        Err(error) => return with(&format!("{shown} cannot be loaded: {}", with_source(&error))),
    };
    // SAFETY: the symbol's name fixes its type.
    let adapt = unsafe { library.get::<Adapt>(ADAPT.as_bytes()) }.ok().map(|symbol| *symbol);
    std::mem::forget(library);
    let Some(adapt) = adapt else { return with(&format!("{shown} is not an adapter")) };
    let foreign = CString::new(path.as_os_str().as_bytes()).unwrap_or_default();
    take_error();
    // SAFETY: the host table is static, the path ends with a NUL; the caller holds the lock of
    // exclusive functions.
    let desc = unsafe { adapt(&HOST, foreign.as_ptr()) };
    if desc.is_null() {
        let why = take_error().unwrap_or_else(|| "without saying why".into());
        let path = path.display();
        let text = format!(
            "plugin {path}: not a lahar plugin (it has no lahar_plugin_entry_v{LAHAR_PLUGIN_ABI_MAJOR}), and the adapter {shown} does \
             not take it: {why}"
        );
        return Err(Error::new(Status::PluginInvalid, text));
    }
    // SAFETY: an adapter of this major returns a table of this major, valid for the life of the
    // process.
    unsafe { handshake::read_plugin(desc, path) }
}

/// The entry of this library's major, or an error that lists the majors of which there are entries.
fn find_entry(library: &Library, path: &Path) -> Result<Entry> {
    let symbol = |major: u32| {
        let name = format!("lahar_plugin_entry_v{major}\0");
        // SAFETY: only the entry of the major that we speak is called; its name fixes its type.
        unsafe { library.get::<Entry>(name.as_bytes()) }.ok().map(|s| *s)
    };
    let ours = LAHAR_PLUGIN_ABI_MAJOR;
    if let Some(entry) = symbol(ours) {
        return Ok(entry);
    }
    let shown = path.display();
    let found: Vec<String> =
        PROBED_MAJORS.filter(|m| symbol(*m).is_some()).map(|m| m.to_string()).collect();
    if found.is_empty() {
        return Err(Error::new(
            Status::PluginInvalid,
            format!(
                "plugin {shown}: this shared library is not a lahar plugin: expected the function \
                 lahar_plugin_entry_v{ours}, found none of that name or of another major"
            ),
        ));
    }
    Err(Error::new(
        Status::PluginAbi,
        format!(
            "plugin {shown}: expected major {ours} of the plugin ABI (lahar_plugin_entry_v{ours}), found major {}; \
             build the plugin with the lahar_plugin.h of this library",
            found.join(", ")
        ),
    ))
}

fn with_source(error: &dyn std::error::Error) -> String {
    error.source().map_or_else(|| error.to_string(), |source| format!("{error}: {source}"))
}
