//! The table of a plugin that is linked into a Rust program.

use crate::lahar_plugin_desc;

/// The table of a linked plugin that is guaranteed to follow the ABI, see [`LinkedPlugin::new`].
#[derive(Clone, Copy)]
pub struct LinkedPlugin(&'static lahar_plugin_desc);

impl LinkedPlugin {
    /// # Safety
    ///
    /// The table is as long as its first member says, its pointers are NULL or valid for the life
    /// of the process, and its functions do what the ABI says.
    pub const unsafe fn new(desc: &'static lahar_plugin_desc) -> Self {
        Self(desc)
    }

    /// The table.
    pub const fn desc(self) -> &'static lahar_plugin_desc {
        self.0
    }
}
