//! What can go wrong: one list of statuses, one error type.
//!
//! Positive statuses leave every object as it was; negative ones poison the object: it answers queries and can be freed.

/// The list of statuses. The constants of `lahar.h` and `lahar.f90`, `lahar_status_name` and the documentation agree
/// with it; a test holds them together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(i32)]
pub enum Status {
    /// Done.
    Ok = 0,
    /// A pointer that must not be NULL is NULL.
    NullArgument = 1,
    /// `struct_size` is not one that this library knows, or the unknown tail is not zero.
    StructSize = 2,
    /// A value is not finite, of the wrong sign, or not one of those allowed.
    InvalidArgument = 3,
    /// No model, parameter or field has this name; the message tells the closest one.
    UnknownName = 4,
    /// A required parameter of a model is missing.
    MissingParameter = 5,
    /// A parameter lies outside its hard bounds, or the model refuses the combination.
    OutOfBounds = 6,
    /// No body, wall or plugin has this id.
    NotFound = 7,
    /// A view is open that forbids the call.
    ViewOpen = 8,
    /// The view's data belong to an earlier step.
    ViewStale = 9,
    /// Another thread is using the object.
    Busy = 10,
    /// The field can be read but not written.
    ReadOnly = 11,
    /// This combination of options is not supported; the message tells the nearest that is.
    Unsupported = 12,
    /// An array is shorter than the result; the needed size is given.
    BufferTooSmall = 13,
    /// The time step exceeds the stable one; nothing was done.
    StepTooLarge = 100,
    /// The host left a value in a particle field that is not finite, not positive where it must be, or outside the grid; nothing was
    /// done.
    NonFiniteInput = 101,
    /// A particle stands outside the box of a static grid, or beyond the range of block coordinates; nothing was done.
    OutsideGrid = 102,
    /// A material failed or asked for a smaller time step; nothing was done. Only with the option `retries`.
    SmallerStep = 103,
    /// A material gave no wave speed or no first state; nothing was done.
    MaterialRefused = 104,
    /// A file could not be read or written.
    File = 200,
    /// The plugin file is missing.
    PluginNotFound = 201,
    /// The file is not a plugin, or its tables break the rules.
    PluginInvalid = 202,
    /// The plugin speaks another major version of the plugin ABI.
    PluginAbi = 203,
    /// The plugin refused to load.
    PluginRefused = 204,
    /// Threads could not be started, or the process was forked after they were.
    Threads = 205,
    /// The memory for particles or grid is not to be had; nothing has changed.
    OutOfMemory = 206,
    /// A defect of lahar was caught; the object is poisoned.
    Panic = -1,
    /// A material failed at a point in the middle of a step; the world is poisoned.
    MaterialFailed = -2,
    /// A particle's state became infinite or not a number in a step; the world is poisoned.
    NonFinite = -3,
    /// The object was poisoned by an earlier call; it can only be queried and freed.
    Poisoned = -4,
    /// A plugin broke its contract, which LAHAR_CHECK_PLUGINS=1 found; in a step the world is poisoned.
    PluginBroken = -5,
}

impl Status {
    /// Every status, in the order of the documentation.
    pub const ALL: [Status; 31] = [
        Status::Ok,
        Status::NullArgument,
        Status::StructSize,
        Status::InvalidArgument,
        Status::UnknownName,
        Status::MissingParameter,
        Status::OutOfBounds,
        Status::NotFound,
        Status::ViewOpen,
        Status::ViewStale,
        Status::Busy,
        Status::ReadOnly,
        Status::Unsupported,
        Status::BufferTooSmall,
        Status::StepTooLarge,
        Status::NonFiniteInput,
        Status::OutsideGrid,
        Status::SmallerStep,
        Status::MaterialRefused,
        Status::File,
        Status::PluginNotFound,
        Status::PluginInvalid,
        Status::PluginAbi,
        Status::PluginRefused,
        Status::Threads,
        Status::OutOfMemory,
        Status::Panic,
        Status::MaterialFailed,
        Status::NonFinite,
        Status::Poisoned,
        Status::PluginBroken,
    ];
}

/// Where in a run an error happened, as far as it is known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Place {
    /// Id of the body.
    pub body: Option<i64>,
    /// Id of the particle inside its body.
    pub particle: Option<i64>,
    /// Number of committed steps before the one that failed.
    pub step: Option<i64>,
    /// Time at the start of the step that failed [s].
    pub time: Option<f64>,
    /// Time step that would be accepted [s].
    pub suggested_dt: Option<f64>,
}

/// An error: a status for programs, a text for people (expected, received, what to do), and the place.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{message}")]
pub struct Error {
    /// What kind of error.
    pub status: Status,
    /// The text.
    pub message: String,
    /// Where it happened.
    pub place: Place,
}

impl Error {
    /// An error without a place.
    pub fn new(status: Status, message: impl Into<String>) -> Self {
        Self { status, message: message.into(), place: Place::default() }
    }

    /// Shorthand for [`Status::InvalidArgument`].
    pub fn invalid(message: impl Into<String>) -> Self {
        Self::new(Status::InvalidArgument, message)
    }

    /// An unknown name: says what was looked for, the closest known name, and all known names if they are few.
    pub fn unknown_name<'a>(
        what: &str,
        name: &str,
        known: impl IntoIterator<Item = &'a str>,
    ) -> Self {
        let known: Vec<&str> = known.into_iter().collect();
        let closest = known
            .iter()
            .map(|k| (strsim::damerau_levenshtein(k, name), *k))
            .min()
            .map_or(String::new(), |(_, k)| format!("; did you mean `{k}`?"));
        let list = match known.len() {
            0 => " (none is known yet)".to_string(),
            1..=24 => format!(" (known: {})", known.join(", ")),
            n => format!(" ({n} are known)"),
        };
        Self::new(Status::UnknownName, format!("no {what} is named `{name}`{closest}{list}"))
    }

    /// The same error at a place.
    pub fn at(mut self, place: Place) -> Self {
        self.place = place;
        self
    }
}

/// Result of everything in lahar that can fail.
pub type Result<T> = std::result::Result<T, Error>;
