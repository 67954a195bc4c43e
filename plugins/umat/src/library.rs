//! Opens the user's library and finds its routines; one copy of it per thread where the sidecar asks for that.

use crate::build::private_folder;
use crate::host;
use crate::sidecar::{Routine, Threads};
use libloading::os::unix::{Library, RTLD_LOCAL, RTLD_NOW};
use std::cell::RefCell;
use std::error::Error;
use std::ffi::{c_char, c_int, c_void};
use std::mem::ManuallyDrop;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Names under which compilers export the routines.
pub const UMAT: [&str; 3] = ["umat_", "umat", "UMAT"];
pub const VUMAT: [&str; 3] = ["vumat_", "vumat", "VUMAT"];
const SDVINI: [&str; 3] = ["sdvini_", "sdvini", "SDVINI"];

/// Runs `body(data)`; 1 if a utility routine ended it before its end.
pub type Guard =
    unsafe extern "C" fn(body: unsafe extern "C" fn(*mut c_void), data: *mut c_void) -> c_int;
type Log = unsafe extern "C" fn(level: i32, message: *const c_char);

/// The functions of one opened copy. They stay valid: no library is ever closed.
#[derive(Clone, Copy)]
pub struct Functions {
    /// The UMAT or VUMAT.
    pub routine: *const c_void,
    pub sdvini: Option<*const c_void>,
    /// Of our utility routines, if they are linked in.
    pub guard: Option<Guard>,
}

// SAFETY: addresses of functions in libraries that are never closed; `Threads` says from which threads they are called.
unsafe impl Send for Functions {}
// SAFETY: as above.
unsafe impl Sync for Functions {}

/// A user's library.
pub struct UserLibrary {
    path: PathBuf,
    pub routine: Routine,
    threads: Threads,
    first: Functions,
    /// Its place among all libraries of the process.
    number: usize,
    /// Copies whose threads have ended.
    spare: &'static Mutex<Vec<Functions>>,
}

struct Lent {
    number: usize,
    functions: Functions,
    home: &'static Mutex<Vec<Functions>>,
}

impl Drop for Lent {
    fn drop(&mut self) {
        self.home.lock().unwrap_or_else(PoisonError::into_inner).push(self.functions);
    }
}

thread_local! {
    /// The copies of this thread.
    static LENT: RefCell<Vec<Lent>> = const { RefCell::new(Vec::new()) };
}

impl UserLibrary {
    /// Opens the library at `path` and finds `wanted`, or a UMAT, or a VUMAT.
    pub fn open(path: &Path, wanted: Option<Routine>, threads: Threads) -> Result<Self, String> {
        static NUMBER: AtomicUsize = AtomicUsize::new(0);
        let (routine, first) = open(path, wanted)?;
        Ok(Self {
            path: path.into(),
            routine,
            threads,
            first,
            number: NUMBER.fetch_add(1, Ordering::Relaxed),
            spare: Box::leak(Box::default()),
        })
    }

    /// Where it stands.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether it derives first states itself.
    pub fn has_sdvini(&self) -> bool {
        self.first.sdvini.is_some()
    }

    /// The functions that this thread may call.
    pub fn functions(&self) -> Result<Functions, String> {
        if self.threads != Threads::Copies {
            return Ok(self.first);
        }
        LENT.with_borrow_mut(|lent| {
            if let Some(mine) = lent.iter().find(|l| l.number == self.number) {
                return Ok(mine.functions);
            }
            let spare = self.spare.lock().unwrap_or_else(PoisonError::into_inner).pop();
            let functions = spare.map_or_else(|| self.open_copy(), Ok)?;
            lent.push(Lent { number: self.number, functions, home: self.spare });
            Ok(functions)
        })
    }

    /// A copy of the file is another library to the loader, with data of its own. The file is removed when it is open.
    fn open_copy(&self) -> Result<Functions, String> {
        let folder = private_folder()?;
        let copy = folder.path().join("copy.so");
        let opened = std::fs::copy(&self.path, &copy)
            .map_err(|e| format!("cannot write it: {e}"))
            .and_then(|_| open(&copy, Some(self.routine)));
        drop(folder);
        opened.map(|(_, functions)| functions).map_err(|e| {
            format!(
                "the copy {} of {} for another thread: {e}; set TMPDIR to a folder with room from which programs may run, \
                 or `threads` to `serial` in the sidecar",
                copy.display(),
                self.path.display()
            )
        })
    }
}

fn open(path: &Path, wanted: Option<Routine>) -> Result<(Routine, Functions), String> {
    // SAFETY: the host asked for this library to be loaded, whose initialisers then run.
    let library = unsafe { Library::open(Some(path), RTLD_NOW | RTLD_LOCAL) }.map_err(|e| {
        let text = e.source().map_or_else(|| e.to_string(), |cause| cause.to_string());
        let advice = match text.contains("undefined symbol") {
            true => "; build it with `lahar plugin umat-build`, which links the utility routines of Abaqus",
            false => "",
        };
        format!("the library {} cannot be opened: {text}{advice}", path.display())
    })?;
    let library = ManuallyDrop::new(library);
    let umat = find(&library, &UMAT).map(|f| (Routine::Umat, f));
    let vumat = find(&library, &VUMAT).map(|f| (Routine::Vumat, f));
    let found = match wanted {
        Some(Routine::Umat) => umat,
        Some(Routine::Vumat) => vumat,
        None => umat.or(vumat),
    };
    let (kind, routine) = found.ok_or_else(|| missing(path, wanted))?;
    // SAFETY: the symbols belong to our utility routines, which define them with these types.
    let (guard, set_log) = unsafe {
        (
            find(&library, &["lahar_umat_guard"]).map(|f| std::mem::transmute::<_, Guard>(f)),
            find(&library, &["lahar_umat_set_log"])
                .map(|f| std::mem::transmute::<_, unsafe extern "C" fn(Log)>(f)),
        )
    };
    if let Some(set_log) = set_log {
        // SAFETY: the function keeps the address, which is valid as long as this library, which is never closed.
        unsafe { set_log(host::log_text) };
    }
    Ok((kind, Functions { routine, sdvini: find(&library, &SDVINI), guard }))
}

/// The address of the first of `names` that the library exports.
fn find(library: &Library, names: &[&str]) -> Option<*const c_void> {
    names.iter().find_map(|name| {
        // SAFETY: only the address is taken.
        let symbol = unsafe { library.get::<*const c_void>(name.as_bytes()) }.ok()?;
        Some(symbol.as_raw_ptr().cast_const()).filter(|address| !address.is_null())
    })
}

fn missing(path: &Path, wanted: Option<Routine>) -> String {
    let list = |names: [&str; 3]| names.map(|n| format!("`{n}`")).join(", ");
    let names = match wanted {
        Some(Routine::Umat) => list(UMAT),
        Some(Routine::Vumat) => list(VUMAT),
        None => format!("{}, {}", list(UMAT), list(VUMAT)),
    };
    format!(
        "the library {} is neither a plugin of lahar nor one with a UMAT: looked for {names}; check with `nm -D` that the routine \
         is called UMAT or VUMAT and is exported, and build it with `lahar plugin umat-build`",
        path.display()
    )
}
