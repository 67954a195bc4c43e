//! A context owns what worlds share: the thread pool, the log and the list of loaded plugins.

use crate::error::{Error, Result, Status};
pub use crate::log::{LogLevel, LogSink};
use crate::log::{LogQueue, LogScope};
use crate::material::{Model, Plugin};
use crate::parallel::{Team, Threads};
pub use crate::plugin::RustEntry;
use crate::plugin::{self, StaticEntry};
use crate::simd::Isa;
use lahar_plugin_abi::{LAHAR_CAPABILITY_MAY_PRINT, LAHAR_CAPABILITY_MAY_STOP};
use std::path::{Path, PathBuf};
use std::sync::{Arc, PoisonError, RwLock};

/// Largest number of threads of a context.
pub const MAX_THREADS: usize = 1024;

/// The plugins that come with lahar, with their models: for errors, nothing is loaded unasked.
pub const SHIPPED: [(&str, &[&str]); 14] = [
    ("lahar_drucker_prager", &["drucker_prager"]),
    ("lahar_hencky", &["hencky"]),
    ("lahar_ideal_gas", &["ideal_gas"]),
    ("lahar_johnson_cook", &["johnson_cook"]),
    ("lahar_linear_elastic", &["linear_elastic", "linear_elastic_green_naghdi"]),
    ("lahar_matsuoka_nakai", &["matsuoka_nakai"]),
    ("lahar_modified_cam_clay", &["modified_cam_clay"]),
    ("lahar_mohr_coulomb", &["mohr_coulomb"]),
    ("lahar_mu_i", &["mu_i"]),
    ("lahar_neo_hookean", &["neo_hookean"]),
    ("lahar_newtonian", &["newtonian", "tait_water"]),
    ("lahar_nor_sand", &["nor_sand"]),
    ("lahar_viscoplastic_fluids", &["bingham", "herschel_bulkley"]),
    ("lahar_von_mises", &["von_mises"]),
];

/// Threads, log and loaded plugins. A context lives as long as one of its worlds or
/// materials.
pub struct Context {
    threads: Arc<Threads>,
    isa: Isa,
    log: Arc<LogQueue>,
    plugins: RwLock<Vec<&'static Plugin>>,
    capsules: RwLock<Option<PathBuf>>,
}

impl Context {
    /// A context with `threads` threads: `None` stands for `LAHAR_NUM_THREADS`, and for 1 where
    /// that is not set. One thread means that everything runs on the calling thread and none is
    /// started.
    ///
    /// Errors: [`Status::InvalidArgument`] for 0, more than [`MAX_THREADS`] or a
    /// `LAHAR_NUM_THREADS` that is no such number, a `LAHAR_SIMD` that is unknown or that the
    /// processor lacks, or a `LAHAR_CHECK_PLUGINS` other than 0 and 1; [`Status::Threads`] if the
    /// system gives no threads; [`Status::File`] if `LAHAR_CAPSULES` is no folder, see
    /// [`Context::set_capsule_folder`].
    pub fn new(threads: Option<usize>) -> Result<Arc<Context>> {
        Self::with_isa(threads, Isa::of_environment()?)
    }

    /// The same with a given instruction set.
    pub fn with_isa(threads: Option<usize>, isa: Isa) -> Result<Arc<Context>> {
        plugin::checks()?;
        let threads = match threads {
            Some(threads) => checked_threads(threads, "the thread count")?,
            None => threads_of_environment()?,
        };
        let log = Arc::new(LogQueue::default());
        let threads = Threads::new(threads, &log)?;
        let capsules = match std::env::var_os("LAHAR_CAPSULES") {
            Some(folder) if !folder.is_empty() => {
                Some(checked_folder(Path::new(&folder), "LAHAR_CAPSULES")?)
            }
            _ => None,
        };
        let (plugins, capsules) = (RwLock::default(), RwLock::new(capsules));
        Ok(Arc::new(Context { threads, isa, log, plugins, capsules }))
    }

    /// The instruction set that kernels use: what `LAHAR_SIMD` asks for (`scalar`, `avx2`,
    /// `avx512`), or the best that the processor has.
    pub fn isa(&self) -> Isa {
        self.isa
    }

    /// Number of threads that run a step, the calling one included if it is the only one.
    pub fn threads(&self) -> usize {
        self.threads.count()
    }

    /// How many distinct threads have run tasks of this context so far; see
    /// [`Context::mark_worker`].
    pub fn threads_used(&self) -> usize {
        self.threads.used()
    }

    /// The threads, to be shared with worlds.
    pub fn team(&self) -> Team {
        Team::new(&self.threads)
    }

    /// Runs `f` inside the pool, or on the calling thread if there is one thread. Panics of `f` go
    /// through.
    pub fn install<R: Send>(&self, f: impl FnOnce() -> R + Send) -> R {
        self.threads.install(f)
    }

    /// Runs `a` and `b`, at the same time if there are threads; the calling code must be inside
    /// [`Context::install`].
    pub fn join<A: Send, B: Send>(
        &self,
        a: impl FnOnce() -> A + Send,
        b: impl FnOnce() -> B + Send,
    ) -> (A, B) {
        self.threads.join(a, b)
    }

    /// Notes that the running thread has worked for this context.
    pub fn mark_worker(&self) {
        self.threads.mark();
    }

    /// Error [`Status::Threads`] if this process was forked after the threads had been started: a
    /// fork does not copy them.
    pub fn check_process(&self) -> Result<()> {
        self.threads.check_process()
    }

    /// Loads a plugin into this context and returns its index in [`Context::plugins`].
    ///
    /// A text with a `/` is a path. Any other is a name that is looked for in the folders of
    /// `LAHAR_PLUGIN_PATH` (separated by `:`), then in `lahar/plugins-1` beside this library:
    /// `lahar_newtonian` becomes `liblahar_newtonian.so`; the current directory is not searched. Of
    /// a library that is no plugin the adapter `lahar_umat`, if it is found by its name, makes one.
    /// The same file gives the same index again. Libraries stay loaded until the process ends.
    ///
    /// Errors: [`Status::PluginNotFound`], [`Status::PluginInvalid`], [`Status::PluginAbi`],
    /// [`Status::PluginRefused`]. The list of plugins is then what it was.
    pub fn load_plugin(&self, name_or_path: &str) -> Result<usize> {
        let _scope = LogScope::enter(&self.log);
        self.add(plugin::load(name_or_path)?)
    }

    /// Registers a plugin that is linked into the program by its entry, such as
    /// `lahar_model_linear_elastic::plugin`, and returns its index in [`Context::plugins`]. The
    /// same entry gives the same index again. The plugin's path is its id in brackets.
    ///
    /// Errors: [`Status::PluginInvalid`], [`Status::PluginAbi`], [`Status::PluginRefused`]. The
    /// list of plugins is then what it was.
    pub fn register_plugin(&self, entry: RustEntry) -> Result<usize> {
        self.register(StaticEntry::rust(entry))
    }

    pub(crate) fn register(&self, entry: StaticEntry) -> Result<usize> {
        let _scope = LogScope::enter(&self.log);
        self.add(plugin::register(entry)?)
    }

    /// The index of a plugin in this context, where it is new unless it is there already.
    fn add(&self, plugin: &'static Plugin) -> Result<usize> {
        let mut plugins = self.plugins.write().unwrap_or_else(PoisonError::into_inner);
        if let Some(index) = plugins.iter().position(|p| std::ptr::eq(*p, plugin)) {
            return Ok(index);
        }
        for model in &plugin.models {
            if let Some(other) =
                plugins.iter().find(|p| p.models.iter().any(|m| m.name == model.name))
            {
                return Err(Error::new(
                    Status::PluginInvalid,
                    format!(
                        "plugin {}: its model `{}` is already offered by {}, and names must be unique in a context; \
                         load only one of the two",
                        plugin.path.display(),
                        model.name,
                        other.path.display()
                    ),
                ));
            }
        }
        for model in &plugin.models {
            for (capability, text) in [
                (LAHAR_CAPABILITY_MAY_STOP, "end the process"),
                (LAHAR_CAPABILITY_MAY_PRINT, "print"),
            ] {
                if model.capabilities & capability != 0 {
                    let path = plugin.path.display();
                    let text = format!("plugin {path}: its model `{}` may {text}", model.name);
                    self.log(LogLevel::Warning, &text);
                }
            }
        }
        let names: Vec<&str> = plugin.models.iter().map(|m| m.name).collect();
        let (id, version, path) = (plugin.id, plugin.version, plugin.path.display());
        let text = format!("loaded the plugin {id} {version} from {path}: {}", names.join(", "));
        self.log(LogLevel::Information, &text);
        plugins.push(plugin);
        Ok(plugins.len() - 1)
    }

    /// The plugins loaded into this context, in the order of loading.
    pub fn plugins(&self) -> Vec<&'static Plugin> {
        self.plugins.read().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The models of these plugins, in order.
    pub fn models(&self) -> Vec<&'static Model> {
        self.plugins().into_iter().flat_map(|p| &p.models).collect()
    }

    /// The model of this name. Error: [`Status::UnknownName`], with the closest name.
    pub fn model(&self, name: &str) -> Result<&'static Model> {
        let models = self.models();
        models.iter().copied().find(|m| m.name == name).ok_or_else(|| {
            let mut error = Error::unknown_name("model", name, models.iter().map(|m| m.name));
            match SHIPPED.iter().find(|(_, models)| models.contains(&name)) {
                Some((plugin, _)) => {
                    let text = format!("; it comes with the plugin {plugin}: load that first");
                    error.message.push_str(&text);
                }
                None if models.is_empty() => error.message.push_str("; load a plugin first"),
                None => {}
            }
            error
        })
    }

    /// The plugin that offers a model of this context.
    pub fn plugin_of(&self, model: &Model) -> Option<&'static Plugin> {
        self.plugins().into_iter().find(|p| p.models.iter().any(|m| std::ptr::eq(m, model)))
    }

    /// Sets the folder to which a step that fails at a point writes a
    /// [capsule](crate::material::Capsule); `None` for nowhere. At first it is that of the
    /// environment variable `LAHAR_CAPSULES`. Error: [`Status::File`] if it is no folder.
    pub fn set_capsule_folder(&self, folder: Option<&Path>) -> Result<()> {
        let folder = folder.map(|folder| checked_folder(folder, "the folder of failure capsules"));
        *self.capsules.write().unwrap_or_else(PoisonError::into_inner) = folder.transpose()?;
        Ok(())
    }

    /// The folder of capsules, if there is one.
    pub fn capsule_folder(&self) -> Option<PathBuf> {
        self.capsules.read().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Queues a line for the log; [`Context::flush_log`] delivers it.
    pub fn log(&self, level: LogLevel, text: &str) {
        self.log.push(level as i32, text);
    }

    /// Sets the sink of log lines of level at most `max_level` (see [`LogLevel`]); `None`: no log.
    /// Lines that are waiting go to the new sink.
    pub fn set_log(&self, sink: Option<LogSink>, max_level: i32) {
        self.log.set_sink(sink, max_level);
    }

    /// Delivers the lines that workers and plugins have queued, on the calling thread and outside
    /// any lock.
    pub fn flush_log(&self) {
        self.log.flush();
    }

    pub(crate) fn log_queue(&self) -> &Arc<LogQueue> {
        &self.log
    }
}

/// The folder by its full path, so that it stays the same if the process changes its current
/// folder.
fn checked_folder(folder: &Path, what: &str) -> Result<PathBuf> {
    let full = folder.canonicalize().and_then(|full| match full.is_dir() {
        true => Ok(full),
        false => Err(std::io::ErrorKind::NotADirectory.into()),
    });
    full.map_err(|why| {
        let folder = folder.display();
        let text = format!("{what} must be a folder that exists, got `{folder}`: {why}");
        Error::new(Status::File, text)
    })
}

fn threads_of_environment() -> Result<usize> {
    let name = "LAHAR_NUM_THREADS";
    match std::env::var(name) {
        Err(std::env::VarError::NotPresent) => Ok(1),
        Ok(text) => match text.trim().parse() {
            Ok(threads) => checked_threads(threads, name),
            Err(_) => Err(thread_error(name, &format!("`{text}`"))),
        },
        Err(_) => Err(thread_error(name, "a text that is not UTF-8")),
    }
}

fn checked_threads(threads: usize, what: &str) -> Result<usize> {
    match threads {
        1..=MAX_THREADS => Ok(threads),
        _ => Err(thread_error(what, &threads.to_string())),
    }
}

fn thread_error(what: &str, got: &str) -> Error {
    Error::invalid(format!("{what} must be a whole number from 1 to {MAX_THREADS}, got {got}"))
}
