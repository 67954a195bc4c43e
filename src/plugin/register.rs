//! Plugins that are linked into the program: their tables are checked as those of a library are.

use super::handshake;
use crate::error::Result;
use crate::material::Plugin;
use lahar_plugin_abi::lahar_plugin_desc;
use std::ffi::CString;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// The address of a plugin's table.
#[derive(Clone, Copy)]
pub(crate) struct StaticTable(*const lahar_plugin_desc);

impl StaticTable {
    /// # Safety
    ///
    /// `table` is NULL or points to a table of the plugin ABI, as long as its first member says, whose pointers are NULL
    /// or valid for the life of the process, as the table itself is.
    pub(crate) unsafe fn new(table: *const lahar_plugin_desc) -> Self {
        Self(table)
    }

    /// What is inside is a promise of whoever made the table, as it is for a library that is loaded.
    pub(crate) fn of(table: &'static lahar_plugin_desc) -> Self {
        Self(table)
    }
}

/// Every registered table of the process, by its address.
static REGISTERED: Mutex<Vec<(usize, &'static Plugin)>> = Mutex::new(Vec::new());

/// The plugin of a table; the same table gives the same plugin. Its path is its id in brackets.
pub(crate) fn register(table: StaticTable) -> Result<&'static Plugin> {
    let mut registered = REGISTERED.lock().unwrap_or_else(PoisonError::into_inner);
    let address = table.0.addr();
    if let Some((_, plugin)) = registered.iter().find(|(known, _)| *known == address) {
        return Ok(plugin);
    }
    // SAFETY: `StaticTable::new` asks for such a table; `StaticTable::of` takes one.
    let mut plugin = unsafe { handshake::read_plugin(table.0, Path::new("[registered]")) }?;
    let path = format!("[{}]", plugin.id);
    plugin.path_c = Box::leak(CString::new(path.as_str()).unwrap_or_default().into_boxed_c_str());
    plugin.path = PathBuf::from(path);
    let plugin: &'static Plugin = Box::leak(Box::new(plugin));
    registered.push((address, plugin));
    Ok(plugin)
}
