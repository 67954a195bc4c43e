//! Calls of functions that are known by their declaration only, and the memory that they get.

use std::ffi::{CStr, CString, c_char, c_void};
use std::path::Path;
use std::sync::atomic::{AtomicI64, Ordering};

use libloading::os::unix::Library;

/// The shared library.
pub struct Caller(Library);

/// Words and doubles of one call, in the order of the declaration.
#[derive(Clone, Debug, Default)]
pub struct Arguments {
    pub words: Vec<i64>,
    pub doubles: Vec<f64>,
}

/// Most words of a call: six go in registers, the rest on the stack.
const WORDS: usize = 12;
/// Doubles go in registers.
const DOUBLES: usize = 8;

#[rustfmt::skip]
type Raw = unsafe extern "C" fn(
    i64, i64, i64, i64, i64, i64, i64, i64, i64, i64, i64, i64, f64, f64, f64, f64, f64, f64, f64, f64,
) -> i64;

impl Caller {
    pub fn new(path: &Path) -> Self {
        // SAFETY: liblahar.so does nothing when it is loaded.
        Self(unsafe { Library::open(Some(path), libc::RTLD_NOW) }.expect("liblahar.so"))
    }

    /// Calls a function; the host's promises are those of its declaration, which `arguments` must
    /// keep.
    ///
    /// The calling conventions of 64-bit Linux, x86-64 and ARM, give words and doubles registers in
    /// the order of each; a function does not see what it does not take. Narrow integers are the low
    /// part of a word.
    pub fn call(&self, name: &str, arguments: &Arguments) -> i64 {
        let (mut w, mut d) = ([0; WORDS], [0.0; DOUBLES]);
        w[..arguments.words.len()].copy_from_slice(&arguments.words);
        d[..arguments.doubles.len()].copy_from_slice(&arguments.doubles);
        let name = CString::new(name).expect("a name");
        // SAFETY: the name is one of lahar.h, with the arguments that stand there; see above.
        unsafe {
            let function = self.0.get::<Raw>(name.as_bytes_with_nul()).expect("an exported name");
            #[rustfmt::skip]
            let answer = function(
                w[0], w[1], w[2], w[3], w[4], w[5], w[6], w[7], w[8], w[9], w[10], w[11],
                d[0], d[1], d[2], d[3], d[4], d[5], d[6], d[7],
            );
            answer
        }
    }

    /// The name of a status.
    pub fn status_name(&self, status: i32) -> String {
        let words = vec![i64::from(status)];
        let text = self.call("lahar_status_name", &Arguments { words, doubles: Vec::new() });
        // SAFETY: the function returns a static text.
        unsafe { CStr::from_ptr(text as *const c_char) }.to_string_lossy().into_owned()
    }

    /// The message of the last error of this thread.
    pub fn message(&self) -> String {
        let mut text = vec![0u8; 4096];
        let words = vec![text.as_mut_ptr() as i64, text.len() as i64, 0];
        self.call("lahar_last_error_message", &Arguments { words, doubles: Vec::new() });
        let text = CStr::from_bytes_until_nul(&text).unwrap_or_default();
        text.to_string_lossy().into_owned()
    }
}

static LINES: AtomicI64 = AtomicI64::new(0);
static PROGRESS: AtomicI64 = AtomicI64::new(0);

/// Counts lines of the log.
pub extern "C" fn on_log(_level: i32, _message: *const c_char, _user: *mut c_void) {
    LINES.fetch_add(1, Ordering::Relaxed);
}

/// Cancels every fifth time.
pub extern "C" fn on_progress(_steps: i64, _time: f64, _user: *mut c_void) -> i32 {
    i32::from(PROGRESS.fetch_add(1, Ordering::Relaxed) % 5 == 4)
}
