//! What can go wrong: one list of statuses, one error type.
//!
//! Positive statuses leave every object as it was; negative ones poison the object: it answers
//! queries and can be freed.

use crate::choice::choices;

choices! {
    /// What can go wrong. The constants of `lahar.h` and `lahar.f90`, and what `lahar_status_name`
    /// gives, come from this list.
    #[derive(Hash)]
    pub enum Status: "status" {
        /// Done.
        Ok = 0, "ok", LAHAR_OK;
        /// A pointer that must not be NULL is NULL, or a pointer is not aligned for its type.
        NullArgument = 1, "null_argument", LAHAR_ERROR_NULL_ARGUMENT;
        /// `struct_size` is not one that this library knows, or the unknown tail is not zero.
        StructSize = 2, "struct_size", LAHAR_ERROR_STRUCT_SIZE;
        /// A value is not finite, of the wrong sign, or not one of those allowed.
        InvalidArgument = 3, "invalid_argument", LAHAR_ERROR_INVALID_ARGUMENT;
        /// No model, parameter or field has this name; the message names the closest one.
        UnknownName = 4, "unknown_name", LAHAR_ERROR_UNKNOWN_NAME;
        /// A required parameter of a model is missing.
        MissingParameter = 5, "missing_parameter", LAHAR_ERROR_MISSING_PARAMETER;
        /// A parameter lies outside its hard bounds, or the model refuses the combination.
        OutOfBounds = 6, "out_of_bounds", LAHAR_ERROR_OUT_OF_BOUNDS;
        /// No object has this id, or no item of a list has this index.
        NotFound = 7, "not_found", LAHAR_ERROR_NOT_FOUND;
        /// A view is open that forbids the call; free it first.
        ViewOpen = 8, "view_open", LAHAR_ERROR_VIEW_OPEN;
        /// Particles may have been reordered since the view was opened: by a step, or by a query
        /// that mapped the grid anew.
        ViewStale = 9, "view_stale", LAHAR_ERROR_VIEW_STALE;
        /// Another thread is using the object.
        Busy = 10, "busy", LAHAR_ERROR_BUSY;
        /// The field can be read but not written.
        ReadOnly = 11, "read_only", LAHAR_ERROR_READ_ONLY;
        /// This combination of options is not supported; the message names the nearest one that is.
        Unsupported = 12, "unsupported", LAHAR_ERROR_UNSUPPORTED;
        /// An array is shorter than the result; the needed size is given.
        BufferTooSmall = 13, "buffer_too_small", LAHAR_ERROR_BUFFER_TOO_SMALL;
        /// The time step exceeds the stable one; nothing was done.
        StepTooLarge = 100, "step_too_large", LAHAR_ERROR_STEP_TOO_LARGE;
        /// A value that the host wrote to a particle field is not finite, or not positive where it
        /// must be, or is a position outside the grid; nothing was done.
        NonFiniteInput = 101, "non_finite_input", LAHAR_ERROR_NON_FINITE_INPUT;
        /// A particle is outside the box of a static grid, beyond the range of block coordinates,
        /// or beyond the axis of symmetry; nothing was done.
        OutsideGrid = 102, "outside_grid", LAHAR_ERROR_OUTSIDE_GRID;
        /// A material failed or asked for a smaller time step; nothing was done. Only with the
        /// option `retries`.
        SmallerStep = 103, "smaller_step", LAHAR_ERROR_SMALLER_STEP;
        /// A material gave no wave speed or no first state; nothing was done.
        MaterialRefused = 104, "material_refused", LAHAR_ERROR_MATERIAL_REFUSED;
        /// The host's progress callback asked to stop; the steps before are committed, and the world
        /// can go on.
        Cancelled = 105, "cancelled", LAHAR_ERROR_CANCELLED;
        /// A file could not be read or written.
        File = 200, "file", LAHAR_ERROR_FILE;
        /// The plugin file is missing.
        PluginNotFound = 201, "plugin_not_found", LAHAR_ERROR_PLUGIN_NOT_FOUND;
        /// The file is not a plugin, or its tables break the rules.
        PluginInvalid = 202, "plugin_invalid", LAHAR_ERROR_PLUGIN_INVALID;
        /// The plugin was built for another major version of the plugin ABI.
        PluginAbi = 203, "plugin_abi", LAHAR_ERROR_PLUGIN_ABI;
        /// The plugin refused to load.
        PluginRefused = 204, "plugin_refused", LAHAR_ERROR_PLUGIN_REFUSED;
        /// Threads could not be started, or the process was forked after they were.
        Threads = 205, "threads", LAHAR_ERROR_THREADS;
        /// There is not enough memory for particles or grid; nothing has changed.
        OutOfMemory = 206, "out_of_memory", LAHAR_ERROR_OUT_OF_MEMORY;
        /// A defect of lahar was caught; the object is poisoned.
        Panic = -1, "panic", LAHAR_ERROR_PANIC;
        /// A material failed at a point in the middle of a step; the world is poisoned.
        MaterialFailed = -2, "material_failed", LAHAR_ERROR_MATERIAL_FAILED;
        /// A particle's state became infinite or not a number in a step; the world is poisoned.
        NonFinite = -3, "non_finite", LAHAR_ERROR_NON_FINITE;
        /// The object was poisoned by an earlier call; it can only be queried and freed.
        Poisoned = -4, "poisoned", LAHAR_ERROR_POISONED;
        /// A plugin broke its contract, which LAHAR_CHECK_PLUGINS=1 found; in a step the world is
        /// poisoned.
        PluginBroken = -5, "plugin_broken", LAHAR_ERROR_PLUGIN_BROKEN;
    }
}

/// Names that an error lists; more are only counted.
const FEW: usize = 24;

/// Longest name for which the closest one is looked for [bytes].
const LONGEST_NAME: usize = 60;

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

/// An error: a status for programs, a text for people (expected, received, what to do), and the
/// place.
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

    /// An unknown name. The message has the name that was not found, the known name that it means
    /// or almost spells, and all known names if they are few.
    pub fn unknown_name<'a>(
        what: &str,
        name: &str,
        known: impl IntoIterator<Item = &'a str, IntoIter: Clone>,
    ) -> Self {
        let known = known.into_iter();
        let (mut count, mut few) = (0, String::new());
        for known in known.clone() {
            count += 1;
            if count <= FEW {
                few = few + if count == 1 { "" } else { ", " } + known;
            }
        }
        let meant = meant(name, known).map_or(String::new(), |k| format!("; did you mean `{k}`?"));
        let list = match count {
            0 => " (none is known yet)".to_string(),
            1..=FEW => format!(" (known: {few})"),
            n => format!(" ({n} are known)"),
        };
        Self::new(Status::UnknownName, format!("no {what} is named `{name}`{meant}{list}"))
    }

    /// The same error with its place.
    pub fn at(mut self, place: Place) -> Self {
        self.place = place;
        self
    }
}

/// Symbols and words of the field, with the names that they may stand for.
const SYNONYMS: [(&str, &[&str]); 25] = [
    ("E", &["youngs_modulus"]),
    ("young", &["youngs_modulus"]),
    ("modulus", &["youngs_modulus", "bulk_modulus", "shear_modulus"]),
    ("nu", &["poissons_ratio"]),
    ("poisson", &["poissons_ratio"]),
    ("K", &["bulk_modulus"]),
    ("G", &["shear_modulus"]),
    ("phi", &["friction_angle"]),
    ("friction", &["friction_angle", "static_friction"]),
    ("psi", &["dilation_angle"]),
    ("dilatancy_angle", &["dilation_angle"]),
    ("c", &["cohesion"]),
    ("mu", &["viscosity", "shear_modulus", "static_friction"]),
    ("eta", &["viscosity"]),
    ("gamma", &["heat_capacity_ratio", "exponent"]),
    ("M", &["critical_stress_ratio"]),
    ("lambda", &["compression_index", "critical_state_slope"]),
    ("kappa", &["swelling_index"]),
    ("OCR", &["overconsolidation_ratio"]),
    ("rho", &["density", "mass"]),
    ("density", &["mass"]),
    ("x", &["position"]),
    ("displacement", &["position"]),
    ("sigma", &["stress"]),
    ("pressure", &["stress"]),
];

/// The known name that an unknown one stands for, or is spelt like: one letter in three may be
/// wrong.
fn meant<'a>(name: &str, known: impl Iterator<Item = &'a str> + Clone) -> Option<&'a str> {
    if name.len() > LONGEST_NAME {
        return None;
    }
    let lower = name.to_lowercase();
    // symbols are what they are, `K` is not `k`; words are words in capitals too
    let same = |word: &str| word == name || (word.len() > 1 && word.to_lowercase() == lower);
    let synonyms = SYNONYMS.iter().filter(|(word, _)| same(word)).flat_map(|(_, names)| *names);
    let known_synonym = synonyms.flat_map(|n| known.clone().find(|k| k == n)).next();
    known_synonym.or_else(|| {
        let known = known.clone().filter(|k| k.len() <= LONGEST_NAME);
        let spelt = known.map(|k| (strsim::damerau_levenshtein(k, &lower), k)).min()?;
        (spelt.0 <= name.chars().count() / 3).then_some(spelt.1)
    })
}

/// Result of everything in lahar that can fail.
pub type Result<T> = std::result::Result<T, Error>;

/// The beginning of a text, for people, in one line: control characters are escaped, and what is
/// longer than `most` bytes is cut.
pub fn one_line(text: &str, most: usize) -> String {
    let mut line = String::new();
    for letter in text.chars() {
        if line.len() >= most {
            line.push('\u{2026}');
            break;
        }
        match letter.is_control() {
            true => line.extend(letter.escape_default()),
            false => line.push(letter),
        }
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_suggested_only_if_it_is_meant_or_near() {
        let sand = ["youngs_modulus", "poissons_ratio", "friction_angle", "cohesion", "cone"];
        let water = ["bulk_modulus", "viscosity"];
        let fields = ["position", "velocity", "stress", "mass"];
        for (name, known, expected) in [
            ("E", &sand[..], Some("youngs_modulus")),
            ("E", &water, None), // not `cone`, not anything
            ("nu", &sand, Some("poissons_ratio")),
            ("NU", &sand, Some("poissons_ratio")),
            ("phi", &sand, Some("friction_angle")),
            ("c", &sand, Some("cohesion")),
            ("C", &sand, None),
            ("K", &water, Some("bulk_modulus")),
            ("G", &water, None),
            ("mu", &water, Some("viscosity")),
            ("rho", &fields, Some("mass")),
            ("density", &fields, Some("mass")), // not `velocity`
            ("density", &sand, None),
            ("displacement", &fields, Some("position")),
            ("pressure", &fields, Some("stress")),
            ("velocty", &fields, Some("velocity")),
            ("Velocity", &fields, Some("velocity")),
            ("temperature", &fields, None),
            ("", &fields, None),
        ] {
            assert_eq!(meant(name, known.iter().copied()), expected, "`{name}` among {known:?}");
        }
        let text = Error::unknown_name("particle field", "velocty", fields).message;
        assert_eq!(
            text,
            "no particle field is named `velocty`; did you mean `velocity`? (known: position, velocity, stress, mass)"
        );
        let text = Error::unknown_name("parameter of `newtonian`", "E", water).message;
        assert_eq!(
            text,
            "no parameter of `newtonian` is named `E` (known: bulk_modulus, viscosity)"
        );
        let many = Error::unknown_name("soil", "slit", ["sand", "silt", "clay"].repeat(9)).message;
        assert!(many.ends_with("did you mean `silt`? (27 are known)"), "{many}");
        let long = Error::unknown_name("soil", &"x".repeat(5000), ["sand"]).message;
        assert!(!long.contains("did you mean"));
    }

    #[test]
    fn a_text_becomes_one_line_that_is_not_too_long() {
        let text = one_line("no `a\nb\u{1b}[31m\u{85}`: é", 100);
        assert_eq!(text, "no `a\\nb\\u{1b}[31m\\u{85}`: é");
        assert_eq!(one_line("ééé", 4), "éé\u{2026}");
    }
}
