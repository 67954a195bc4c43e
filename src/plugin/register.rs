//! Plugins that are linked into the program: their entries are called and their tables checked as
//! those of a library are.

use super::exclusive;
use super::handshake;
use super::host::{HOST, take_error};
use crate::error::{Error, Result, Status};
use crate::material::Plugin;
use lahar_plugin_abi::{LinkedPlugin, lahar_host_api, lahar_plugin_desc};
use std::ffi::CString;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Entry of a plugin that is written in Rust: stores the host's table and returns its own.
pub type RustEntry = fn(&'static lahar_host_api) -> LinkedPlugin;

/// The entry of a plugin that is linked in.
#[derive(Clone, Copy)]
pub(crate) struct StaticEntry(Language);

#[derive(Clone, Copy)]
enum Language {
    C(unsafe extern "C" fn(*const lahar_host_api) -> *const lahar_plugin_desc),
    Rust(RustEntry),
}

impl StaticEntry {
    /// # Safety
    ///
    /// `entry` follows the plugin ABI: it returns NULL or a table as long as its first member says,
    /// whose pointers are NULL or valid for the life of the process, as the table itself is.
    pub(crate) unsafe fn c(
        entry: unsafe extern "C" fn(*const lahar_host_api) -> *const lahar_plugin_desc,
    ) -> Self {
        Self(Language::C(entry))
    }

    pub(crate) fn rust(entry: RustEntry) -> Self {
        Self(Language::Rust(entry))
    }

    fn address(self) -> usize {
        match self.0 {
            Language::C(entry) => entry as usize,
            Language::Rust(entry) => entry as usize,
        }
    }

    fn call(self) -> *const lahar_plugin_desc {
        match self.0 {
            // SAFETY: the host table is static, the rest was asked for by `StaticEntry::c`; the
            // caller holds the lock of exclusive functions.
            Language::C(entry) => unsafe { entry(&HOST) },
            Language::Rust(entry) => entry(&HOST).desc(),
        }
    }
}

/// Every registered plugin of the process, by the address of its entry.
static REGISTERED: Mutex<Vec<(usize, &'static Plugin)>> = Mutex::new(Vec::new());

/// The plugin of an entry; the same entry gives the same plugin. Its path is its id in brackets.
pub(crate) fn register(entry: StaticEntry) -> Result<&'static Plugin> {
    let mut registered = REGISTERED.lock().unwrap_or_else(PoisonError::into_inner);
    let address = entry.address();
    if let Some((_, plugin)) = registered.iter().find(|(known, _)| *known == address) {
        return Ok(plugin);
    }
    let _alone = exclusive();
    take_error();
    let table = entry.call();
    if table.is_null() {
        let why = take_error().unwrap_or_else(|| "without saying why".into());
        let text = format!("plugin [registered]: it refused to load: {why}");
        return Err(Error::new(Status::PluginRefused, text));
    }
    // SAFETY: an entry gives such a table.
    let mut plugin = unsafe { handshake::read_plugin(table, Path::new("[registered]")) }?;
    let path = format!("[{}]", plugin.id);
    plugin.path_c = Box::leak(CString::new(path.as_str()).unwrap_or_default().into_boxed_c_str());
    plugin.path = PathBuf::from(path);
    let plugin: &'static Plugin = Box::leak(Box::new(plugin));
    registered.push((address, plugin));
    Ok(plugin)
}
