//! Context: threads, log, and the plugins that have been loaded. Everything else is made from a
//! context.

use super::arguments::{
    Grows, c_string, count, handle_out, index, null, optional_out, out, struct_out, text,
};
use super::cells::ContextCell;
use super::entry::{call_host, entry, quiet_entry};
use super::status::lahar_status;
use crate::context::{Context, LogLevel, LogSink};
use crate::error::Result;
use crate::plugin::StaticEntry;
use lahar_plugin_abi::{lahar_host_api, lahar_plugin_desc};
use std::ffi::{CStr, c_char, c_void};
use std::io::Write;
use std::path::Path;
use std::sync::Arc;

/// Threads, log and loaded plugins. Freed by lahar_context_free; it lives as long as one of its
/// worlds, materials or views.
pub struct lahar_context {
    pub(super) cell: Arc<ContextCell>,
}

/// Receives a line of the log: a level (LAHAR_LOG_*), a text in UTF-8 without a newline, valid only
/// during the call, and the pointer given to lahar_context_set_log. Called on the thread that
/// called lahar, in the host's floating-point environment, with no lock held, just before the
/// function returns. It may call functions tagged `callback-ok` or `any`. It must not unwind, throw
/// or longjmp.
pub type lahar_log_callback =
    Option<unsafe extern "C" fn(level: i32, message: *const c_char, user: *mut c_void)>;

/// Entry of a plugin that is linked into the program: its `lahar_plugin_entry_v1`, see
/// lahar_plugin.h.
pub type lahar_plugin_entry_callback =
    Option<unsafe extern "C" fn(host: *const lahar_host_api) -> *const lahar_plugin_desc>;

/// A loaded plugin. The texts are static: they live as long as the process.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct lahar_plugin_info {
    /// sizeof(lahar_plugin_info); set by the host.
    pub struct_size: u32,
    /// 0.
    pub reserved: i32,
    /// Number of models.
    pub model_count: i64,
    /// Identifier, such as "org.lahar.linear_elastic".
    pub id: *const c_char,
    /// Version of the plugin.
    pub version: *const c_char,
    /// Who wrote it.
    pub author: *const c_char,
    /// Licence, an SPDX expression.
    pub licence: *const c_char,
    /// Its address in the web; may be empty.
    pub url: *const c_char,
    /// The file that was loaded; for a registered plugin its id in brackets.
    pub path: *const c_char,
}

// SAFETY: repr(C), begins with a u32, no padding (layout.rs), numbers and raw pointers only.
unsafe impl Grows for lahar_plugin_info {
    const NAME: &'static str = "lahar_plugin_info";
    const FIRST: usize = 64;
}

/// Makes a context.
///
/// `threads`: number of threads that steps run on; 0: the environment variable LAHAR_NUM_THREADS,
/// or 1 if it is not set. With more than 1 the context starts that many threads of its own, which
/// end with the context.
/// `context`: set to the new handle, or to NULL on failure; the host frees it with
/// lahar_context_free.
///
/// The environment variable LAHAR_SIMD (scalar, avx2 or avx512) selects an instruction set, see
/// lahar_context_simd. With LAHAR_CHECK_PLUGINS=1, read once in a process, every call of a model
/// works on guarded copies, which is many times slower. If a model breaks its contract, for
/// instance by a write past its points, LAHAR_ERROR_PLUGIN_BROKEN is returned and the message says
/// how.
///
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_context_create(
    threads: i32,
    context: *mut *mut lahar_context,
) -> lahar_status {
    entry("lahar_context_create", |scope| {
        // SAFETY: the host passes NULL or a writable pointer.
        let target = unsafe { handle_out(context, "context") }?;
        let threads = count(threads.into(), "threads")?;
        let cell = ContextCell::new(Context::new((threads > 0).then_some(threads))?);
        scope.attach_context(&cell);
        target.set(Box::into_raw(Box::new(lahar_context { cell })));
        Ok(())
    })
}

/// Frees the handle. The context ends, and its threads are joined, when its worlds, materials and
/// views are freed too. NULL is ignored.
/// Thread: owner
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_context_free(context: *mut lahar_context) {
    quiet_entry(|| {
        if !context.is_null() {
            // SAFETY: the handle came from Box::into_raw in lahar_context_create and is freed once.
            drop(unsafe { Box::from_raw(context) });
        }
    });
}

/// Number of threads of the context.
///
/// `threads`: gets the number.
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_context_thread_count(
    context: *const lahar_context,
    threads: *mut i32,
) -> lahar_status {
    entry("lahar_context_thread_count", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a writable integer.
        let (cell, threads) = unsafe { (scope.context(context)?, out(threads, "threads")?) };
        threads.set(cell.context.threads() as i32);
        Ok(())
    })
}

/// Name of the instruction set that the context's kernels use: "scalar", "avx2" or "avx512".
///
/// It is the best one of the processor, or the one that the environment variable LAHAR_SIMD named
/// when the context was made. Models written with lahar's SDK select theirs in the same way, once
/// in a process. Results are the same to the last bit for any number of threads; between
/// instruction sets they differ by round-off.
///
/// The text is static: do not free it. NULL for a NULL context. Cannot fail.
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_context_simd(context: *const lahar_context) -> *const c_char {
    // SAFETY: the host passes NULL or a live handle.
    let handle = unsafe { context.as_ref() };
    handle.map_or(std::ptr::null(), |context| context.cell.context.isa().name_c().as_ptr())
}

/// Number of different threads that have run work of the context's worlds so far; small worlds run
/// on one thread.
///
/// `threads`: gets the number.
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_context_threads_used(
    context: *const lahar_context,
    threads: *mut i32,
) -> lahar_status {
    entry("lahar_context_threads_used", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a writable integer.
        let (cell, threads) = unsafe { (scope.context(context)?, out(threads, "threads")?) };
        threads.set(cell.context.threads_used() as i32);
        Ok(())
    })
}

/// The host's pointer, to be passed to the host's callback.
struct User(*mut c_void);

// SAFETY: the pointer is never followed here; lahar_context_set_log documents that it is passed to
// the callback on every thread that calls lahar.
unsafe impl Send for User {}
// SAFETY: as above.
unsafe impl Sync for User {}

impl User {
    fn pointer(&self) -> *mut c_void {
        self.0
    }
}

/// Sets where log lines go. Without this call lahar is silent.
///
/// Callback and `user` must stay valid until others are set and the calls that other threads made
/// before have returned, or until the context has ended, which may be long after
/// lahar_context_free: its worlds, materials and views keep it, and log.
///
/// `callback`: see lahar_log_callback; lahar_log_stderr is a ready one; NULL: no log.
/// `user`: passed to the callback on every thread that calls functions of this context; lahar does
/// not follow it.
/// `max_level`: the most detailed level to be passed on, one of LAHAR_LOG_*.
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_context_set_log(
    context: *mut lahar_context,
    callback: lahar_log_callback,
    user: *mut c_void,
    max_level: i32,
) -> lahar_status {
    entry("lahar_context_set_log", |scope| {
        // SAFETY: the host passes NULL or a live handle.
        let cell = unsafe { scope.context(context) }?;
        LogLevel::from_i32(max_level)?;
        cell.context.set_log(callback.map(|callback| sink(callback, User(user))), max_level);
        Ok(())
    })
}

type Callback = unsafe extern "C" fn(level: i32, message: *const c_char, user: *mut c_void);

fn sink(callback: Callback, user: User) -> LogSink {
    Arc::new(move |level, line| {
        let line = c_string(line);
        // SAFETY: the host's callback follows the contract of lahar_log_callback; the text lives
        // during the call.
        call_host(|| unsafe { callback(level, line.as_ptr(), user.pointer()) });
    })
}

/// A ready log callback: writes one line to standard error. `user` is not used.
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_log_stderr(level: i32, message: *const c_char, user: *mut c_void) {
    let _ = user;
    quiet_entry(|| {
        if message.is_null() {
            return;
        }
        // SAFETY: not NULL, and NUL-terminated by the contract of lahar_log_callback.
        let line = unsafe { CStr::from_ptr(message) }.to_string_lossy();
        let level =
            ["error", "warning", "information", "detail"].get(level as usize).unwrap_or(&"log");
        let _ = writeln!(std::io::stderr(), "lahar {level}: {line}");
    });
}

/// Loads a plugin into the context. If it is loaded already, its index is returned again. A plugin
/// stays in memory until the process ends.
///
/// `name_or_path`: a path (with a '/') or a bare name such as "lahar_drucker_prager". For a bare
/// name lib<name>.so is searched in the folders of the environment variable LAHAR_PLUGIN_PATH,
/// separated by ':', then in lahar/plugins-1 beside this library. A library that is not a plugin
/// but contains an Abaqus UMAT or VUMAT is accepted too if the plugin lahar_umat is found by its
/// name.
/// `plugin`: gets its index in the context; may be NULL.
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_context_load_plugin(
    context: *mut lahar_context,
    name_or_path: *const c_char,
    plugin: *mut i64,
) -> lahar_status {
    entry("lahar_context_load_plugin", |scope| {
        // SAFETY: the host passes NULL or a live handle, a text and a writable integer.
        let (cell, name, plugin) = unsafe {
            (
                scope.context(context)?,
                text(name_or_path, "name_or_path")?,
                optional_out(plugin, "plugin")?,
            )
        };
        let position = cell.context.load_plugin(name)?;
        plugin.inspect(|plugin| plugin.set(position as i64));
        Ok(())
    })
}

/// Registers a plugin that is linked into the program. If its entry is registered already, its
/// index is returned again.
///
/// `plugin`: its entry (see lahar_plugin.h), which is called unless it is known already. The tables
/// that it returns must not change until the process ends.
/// `index`: gets its index in the context; may be NULL. `path` of lahar_plugin_info is its id in
/// brackets.
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_context_register_plugin(
    context: *mut lahar_context,
    plugin: lahar_plugin_entry_callback,
    index: *mut i64,
) -> lahar_status {
    entry("lahar_context_register_plugin", |scope| {
        // SAFETY: the host passes NULL or a live handle, an entry that follows the plugin ABI, and
        // a writable integer.
        let (cell, entry, index) = unsafe {
            let plugin = plugin.ok_or_else(|| null("plugin"))?;
            (scope.context(context)?, StaticEntry::c(plugin), optional_out(index, "index")?)
        };
        let position = cell.context.register(entry)?;
        index.inspect(|index| index.set(position as i64));
        Ok(())
    })
}

/// Sets the folder for capsules. If a model fails at a point in a step, the step writes a capsule:
/// a small JSON file with the model, its parameters, and the input and output of the model at the
/// first such point, named `lahar-capsule-<model>-<body>-<particle>-<step>.json`. Existing files
/// are not overwritten. The error message of the step gives the path of the capsule.
///
/// `folder`: an existing folder; NULL or "": no capsules. A new context has the folder of the
/// environment variable LAHAR_CAPSULES.
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_context_set_capsule_folder(
    context: *mut lahar_context,
    folder: *const c_char,
) -> lahar_status {
    entry("lahar_context_set_capsule_folder", |scope| {
        // SAFETY: the host passes NULL or a live handle.
        let cell = unsafe { scope.context(context) }?;
        // SAFETY: the host passes NULL or a text.
        let folder = if folder.is_null() { "" } else { unsafe { text(folder, "folder") }? };
        cell.context.set_capsule_folder((!folder.is_empty()).then(|| Path::new(folder)))
    })
}

/// Number of plugins that are loaded into the context.
///
/// `plugins`: gets the number.
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_context_plugin_count(
    context: *const lahar_context,
    plugins: *mut i64,
) -> lahar_status {
    entry("lahar_context_plugin_count", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a writable integer.
        let (cell, plugins) = unsafe { (scope.context(context)?, out(plugins, "plugins")?) };
        plugins.set(cell.context.plugins().len() as i64);
        Ok(())
    })
}

/// Describes a plugin.
///
/// `plugin`: 0 to lahar_context_plugin_count - 1.
/// `info`: written; the host has set `struct_size`.
/// Thread: any
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lahar_context_plugin_info(
    context: *const lahar_context,
    plugin: i64,
    info: *mut lahar_plugin_info,
) -> lahar_status {
    entry("lahar_context_plugin_info", |scope| {
        // SAFETY: the host passes NULL or a live handle, and NULL or a writable struct.
        let (cell, info) = unsafe { (scope.context(context)?, struct_out(info, "info")?) };
        info.set(plugin_info(&cell.context, plugin)?);
        Ok(())
    })
}

fn plugin_info(context: &Context, plugin: i64) -> Result<lahar_plugin_info> {
    let plugins = context.plugins();
    let plugin = plugins[index(plugin, plugins.len(), "plugin")?];
    Ok(lahar_plugin_info {
        struct_size: 0,
        reserved: 0,
        model_count: plugin.models.len() as i64,
        id: plugin.id_c.as_ptr(),
        version: plugin.version_c.as_ptr(),
        author: plugin.author_c.as_ptr(),
        licence: plugin.licence_c.as_ptr(),
        url: plugin.url_c.as_ptr(),
        path: plugin.path_c.as_ptr(),
    })
}
