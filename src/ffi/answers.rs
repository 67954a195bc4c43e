//! What each function may answer beside LAHAR_OK: one list.
//!
//! `cargo xtask headers` writes the line `Errors:` of every function of `lahar.h` from it, and
//! [`entry`](super::entry::entry) holds every answer against it. Two may come from every function
//! and are listed for none: LAHAR_ERROR_PANIC, a defect, and LAHAR_ERROR_OUT_OF_MEMORY where there
//! is not even memory for messages and handles. The latter is listed where more may be missing.

use crate::error::Status::{self, *};

/// A status, and when it is returned where its own documentation does not say so.
type Answer = (Status, &'static str);

/// Answers that functions have in common.
type Set = &'static [Answer];

/// The function takes pointers.
const POINTERS: Set = &[(NullArgument, "")];
/// The function takes or fills a struct.
const STRUCT: Set = &[(NullArgument, ""), (StructSize, "")];
/// The function takes a text.
const TEXT: Set = &[(InvalidArgument, "a text that is too long or not UTF-8")];
/// The function looks for a name.
const NAME: Set = &[
    (InvalidArgument, "a text that is too long or not UTF-8"),
    (UnknownName, "the message names the closest one"),
];
/// The function copies a list into an array of the host.
const LIST: Set = &[
    (InvalidArgument, "a negative capacity"),
    (BufferTooSmall, "`count` is set, the array is not touched"),
];
/// The function copies a text into a buffer of the host.
const MESSAGE: Set =
    &[(InvalidArgument, "a negative capacity"), (BufferTooSmall, "the text is truncated")];
/// The function reads a world.
const QUERY: Set = &[(NullArgument, ""), (Busy, "")];
/// The function changes a world.
const CHANGE: Set = &[(NullArgument, ""), (Busy, ""), (Poisoned, "")];
/// The function adds or removes bodies.
const BODIES: Set = &[(ViewOpen, "any view is open")];
/// The function names a body.
const BODY: Set = &[(NotFound, "the body")];
/// The function names a condition.
const CONDITION: Set = &[(NotFound, "no condition of this kind has the id")];
/// The memory that the function needs grows with what the host gives.
const MEMORY: Set = &[(OutOfMemory, "")];
/// The particles, or the grid, may have to be mapped anew.
const MAPPED: Set = &[
    (ViewOpen, "a write view is open, and particles have to be mapped to the grid"),
    (OutsideGrid, "as in lahar_world_step, if particles have to be mapped"),
    (Threads, "as in lahar_world_step, if particles have to be mapped"),
    (OutOfMemory, ""),
];
/// The host is called between steps.
const CANCELLED: Set = &[(Cancelled, "see lahar_world_set_progress")];
/// A model is asked for the first state of particles.
const FIRST_STATE: Set = &[(PluginBroken, "nothing has changed")];
/// The function adds a body.
const ADD: Set = &[
    (StructSize, ""),
    (InvalidArgument, "a value that is not finite, not positive or too far away"),
    (MaterialRefused, "the model refuses the stress"),
    (OutOfMemory, ""),
];
/// The function makes steps of the stable length.
const ADVANCE: Set = &[
    (ViewOpen, "a write view is open"),
    (NonFiniteInput, "the host wrote an invalid value"),
    (
        OutsideGrid,
        "a particle is outside the box of a static grid, too far away, or beyond the axis of symmetry; the \
         world cannot step until the host writes other positions or removes the body",
    ),
    (
        SmallerStep,
        "only with the option `retries`: a material failed or asks for a smaller step; its length is in \
         `suggested_dt` of lahar_last_error_info",
    ),
    (
        MaterialRefused,
        "a material gives no wave speed, or would forget the stress that was given, see lahar_body_write",
    ),
    (Threads, "the process was forked after the threads of the context had been started"),
    (OutOfMemory, ""),
    (MaterialFailed, "the world is poisoned; with `retries` only if a model fails as a whole"),
    (NonFinite, "the world is poisoned; not with `retries`"),
    (PluginBroken, "the world is poisoned if that is found in the middle of a step"),
];

/// The functions that answer with a status, in the order of the header, and their answers.
pub const ANSWERS: &[(&str, &[Set])] = &[
    ("lahar_version", &[POINTERS]),
    (
        "lahar_context_create",
        &[
            POINTERS,
            &[
                (InvalidArgument, "threads or one of the variables"),
                (OutOfMemory, ""),
                (File, "LAHAR_CAPSULES, see lahar_context_set_capsule_folder"),
                (Threads, ""),
            ],
        ],
    ),
    ("lahar_context_thread_count", &[POINTERS]),
    ("lahar_context_threads_used", &[POINTERS]),
    ("lahar_context_set_log", &[POINTERS, &[(InvalidArgument, "the level")]]),
    (
        "lahar_context_load_plugin",
        &[
            POINTERS,
            TEXT,
            &[(PluginNotFound, ""), (PluginInvalid, ""), (PluginAbi, ""), (PluginRefused, "")],
        ],
    ),
    (
        "lahar_context_register_plugin",
        &[POINTERS, &[(PluginInvalid, ""), (PluginAbi, ""), (PluginRefused, "")]],
    ),
    (
        "lahar_context_set_capsule_folder",
        &[POINTERS, TEXT, &[(File, "the folder does not exist; nothing has changed")]],
    ),
    ("lahar_context_plugin_count", &[POINTERS]),
    ("lahar_context_plugin_info", &[STRUCT, &[(NotFound, "the index")]]),
    ("lahar_last_error_message", &[POINTERS, MESSAGE]),
    ("lahar_last_error_info", &[STRUCT]),
    ("lahar_context_error_message", &[POINTERS, MESSAGE]),
    ("lahar_context_model_count", &[POINTERS]),
    ("lahar_context_model_info", &[STRUCT, &[(NotFound, "the index")]]),
    ("lahar_context_find_model", &[POINTERS, NAME]),
    ("lahar_context_model_parameter", &[STRUCT, &[(NotFound, "either index")]]),
    ("lahar_context_model_state", &[STRUCT, &[(NotFound, "either index")]]),
    (
        "lahar_material_create",
        &[
            POINTERS,
            NAME,
            MEMORY,
            &[
                (InvalidArgument, "`count`; a parameter that is given twice or not finite"),
                (MissingParameter, ""),
                (OutOfBounds, ""),
            ],
        ],
    ),
    ("lahar_material_value", &[POINTERS, NAME]),
    ("lahar_world_options_init", &[STRUCT]),
    (
        "lahar_world_create",
        &[
            STRUCT,
            MEMORY,
            &[
                (InvalidArgument, "the message names the option"),
                (
                    Unsupported,
                    "options that cannot be combined; the message names the nearest ones that can",
                ),
            ],
        ],
    ),
    (
        "lahar_world_set_gravity",
        &[CHANGE, &[(InvalidArgument, "not finite"), (Unsupported, "radial, in axial symmetry")]],
    ),
    ("lahar_world_set_damping", &[CHANGE, &[(InvalidArgument, "")]]),
    (
        "lahar_world_step",
        &[
            CHANGE,
            ADVANCE,
            &[
                (InvalidArgument, "dt, also if it is so small that time + dt equals time"),
                (StepTooLarge, "the stable step is in `suggested_dt` of lahar_last_error_info"),
            ],
        ],
    ),
    (
        "lahar_world_step_auto",
        &[
            CHANGE,
            ADVANCE,
            &[(
                InvalidArgument,
                "the stable step is infinite, or so small that time + dt equals time",
            )],
        ],
    ),
    (
        "lahar_world_advance",
        &[
            CHANGE,
            ADVANCE,
            CANCELLED,
            &[(
                InvalidArgument,
                "`until` is not finite or in the past; `max_steps` is negative; the stable step becomes so \
                 small that time + dt equals time",
            )],
        ],
    ),
    (
        "lahar_world_stable_dt",
        &[QUERY, MEMORY, &[(MaterialRefused, "a material gives no wave speed")]],
    ),
    ("lahar_world_time", &[QUERY]),
    ("lahar_world_step_count", &[QUERY]),
    ("lahar_world_last_dt", &[QUERY]),
    ("lahar_particles_init", &[STRUCT]),
    ("lahar_fill_init", &[STRUCT]),
    (
        "lahar_body_add_particles",
        &[CHANGE, BODIES, ADD, FIRST_STATE, &[(InvalidArgument, "counts and strides")]],
    ),
    ("lahar_body_add_box", &[CHANGE, BODIES, ADD, FIRST_STATE]),
    ("lahar_body_add_sphere", &[CHANGE, BODIES, ADD, FIRST_STATE]),
    (
        "lahar_body_add_polygon",
        &[
            CHANGE,
            BODIES,
            ADD,
            FIRST_STATE,
            &[(InvalidArgument, "no simple polygon"), (Unsupported, "three dimensions")],
        ],
    ),
    ("lahar_body_remove", &[CHANGE, BODIES, BODY]),
    ("lahar_body_set_f_bar", &[CHANGE, BODIES, BODY, MEMORY, &[(InvalidArgument, "`on`")]]),
    ("lahar_world_body_count", &[QUERY]),
    ("lahar_world_bodies", &[QUERY, LIST]),
    ("lahar_body_particle_count", &[QUERY, BODY]),
    ("lahar_body_field_count", &[QUERY, BODY]),
    ("lahar_body_field_info", &[QUERY, STRUCT, &[(NotFound, "the body or the index")]]),
    ("lahar_body_find_field", &[QUERY, NAME, BODY]),
    (
        "lahar_body_read",
        &[QUERY, NAME, BODY, &[(InvalidArgument, "`count`, strides"), (BufferTooSmall, "`count`")]],
    ),
    (
        "lahar_body_write",
        &[
            CHANGE,
            NAME,
            BODY,
            MEMORY,
            &[
                (InvalidArgument, "`count`, strides, a value that is not finite"),
                (ReadOnly, ""),
                (BufferTooSmall, "`count`"),
            ],
        ],
    ),
    ("lahar_body_ids", &[QUERY, LIST, BODY, MAPPED]),
    (
        "lahar_body_view",
        &[
            CHANGE,
            NAME,
            BODY,
            MAPPED,
            &[(InvalidArgument, "`access`"), (ReadOnly, ""), (Poisoned, "write access")],
        ],
    ),
    (
        "lahar_view_data",
        &[
            QUERY,
            STRUCT,
            &[(ViewStale, "a read view: particles may have been reordered since it was opened")],
        ],
    ),
    ("lahar_wall_init", &[STRUCT]),
    (
        "lahar_wall_add",
        &[
            CHANGE,
            STRUCT,
            MEMORY,
            &[
                (InvalidArgument, ""),
                (
                    Unsupported,
                    "LAHAR_WALLS_MODIFIED: less than half a cell from a wall that faces it",
                ),
            ],
        ],
    ),
    ("lahar_wall_remove", &[CHANGE, CONDITION]),
    ("lahar_wall_reaction", &[QUERY, CONDITION]),
    ("lahar_prescribed_velocity_init", &[STRUCT]),
    (
        "lahar_prescribed_velocity_add",
        &[
            CHANGE,
            STRUCT,
            MEMORY,
            &[(
                InvalidArgument,
                "components; a box that is not set or inverted; a velocity that is not finite; a row of the table",
            )],
        ],
    ),
    ("lahar_prescribed_velocity_remove", &[CHANGE, CONDITION]),
    ("lahar_prescribed_velocity_reaction", &[QUERY, CONDITION]),
    ("lahar_traction_init", &[STRUCT]),
    (
        "lahar_traction_add",
        &[
            CHANGE,
            STRUCT,
            BODY,
            MEMORY,
            &[(
                InvalidArgument,
                "the normal; a box that is not set, inverted, without a particle, or with particles behind \
                 one another along the normal; particles whose edge lengths are not known; a traction that \
                 is not finite; a row of the table",
            )],
        ],
    ),
    ("lahar_traction_remove", &[CHANGE, CONDITION]),
    ("lahar_traction_force", &[QUERY, CONDITION]),
    ("lahar_world_set_progress", &[POINTERS, &[(InvalidArgument, "`interval`")]]),
    (
        "lahar_world_set_gravity_table",
        &[
            CHANGE,
            MEMORY,
            &[
                (
                    InvalidArgument,
                    "no rows, times that do not increase, a value that is not finite; the message names the row",
                ),
                (Unsupported, "radial, in axial symmetry"),
            ],
        ],
    ),
    (
        "lahar_world_equilibrium",
        &[
            QUERY,
            STRUCT,
            MAPPED,
            &[
                (Busy, "also while another thread runs a query, if particles have to be mapped"),
                (MaterialRefused, "a material gives no wave speed"),
            ],
        ],
    ),
    ("lahar_settle_criteria_init", &[STRUCT]),
    (
        "lahar_world_settle",
        &[
            CHANGE,
            STRUCT,
            ADVANCE,
            CANCELLED,
            &[(
                InvalidArgument,
                "criteria that are not positive; both the stable step and `until` are infinite; the stable \
                 step becomes so small that time + dt equals time",
            )],
        ],
    ),
    (
        "lahar_body_set_k0_stress",
        &[
            CHANGE,
            BODY,
            MEMORY,
            FIRST_STATE,
            &[
                (
                    InvalidArgument,
                    "gravity is 0 at the present time or not along an axis; a value out of its range; the model \
                     refuses the stress",
                ),
                (Unsupported, "the stress of the model follows from the deformation gradient"),
                (
                    MaterialRefused,
                    "the model would forget the stress: a fluid takes k0 = 1 alone, a gas what its energy gives",
                ),
            ],
        ],
    ),
    (
        "lahar_body_init_state",
        &[
            CHANGE,
            BODY,
            MEMORY,
            FIRST_STATE,
            &[
                (InvalidArgument, "the model refuses the stress; the old state stays"),
                (
                    MaterialRefused,
                    "the model would forget the stress, see lahar_body_write; the old state stays",
                ),
            ],
        ],
    ),
    ("lahar_grid_stats", &[QUERY, STRUCT, MAPPED]),
    ("lahar_grid_blocks", &[QUERY, LIST, MAPPED]),
    ("lahar_grid_find_node", &[QUERY, MAPPED]),
    ("lahar_grid_node_index", &[QUERY, MAPPED, &[(NotFound, "no such node")]]),
    ("lahar_grid_field_count", &[QUERY]),
    ("lahar_grid_field_info", &[QUERY, STRUCT, &[(NotFound, "the index")]]),
    (
        "lahar_grid_read",
        &[
            QUERY,
            NAME,
            MAPPED,
            &[(InvalidArgument, "`count`"), (NotFound, "a node, before anything is written")],
        ],
    ),
    (
        "lahar_grid_sample",
        &[QUERY, NAME, MAPPED, &[(InvalidArgument, "`count`; a coordinate that is not finite")]],
    ),
    ("lahar_world_totals", &[QUERY, STRUCT, BODY]),
    (
        "lahar_world_write_vtp",
        &[
            QUERY,
            TEXT,
            MEMORY,
            &[(InvalidArgument, "it is empty or does not end in `.vtp`"), (File, "")],
        ],
    ),
];

/// The statuses that a function may return beside [`Status::Ok`], and beside what every function may
/// return, each once; none of a function that is not listed.
pub fn documented(function: &str) -> Option<Vec<Status>> {
    let sets = answers(function)?;
    Some(Status::ALL.into_iter().filter(|status| holds(sets, *status)).collect())
}

/// The text after `Errors:` in the header, without line breaks.
pub fn text(function: &str) -> Option<String> {
    let sets = answers(function)?;
    let of_each = documented(function)?.into_iter().map(|status| {
        let mut notes: Vec<&str> = Vec::new();
        for (_, note) in sets.iter().copied().flatten().filter(|answer| answer.0 == status) {
            if !note.is_empty() && !notes.contains(note) {
                notes.push(note);
            }
        }
        let constant = Status::LIST.values.iter().find(|value| value.number == status.number());
        let constant = constant.map_or("", |value| value.constant);
        if notes.is_empty() {
            constant.into()
        } else {
            format!("{constant} ({})", notes.join("; "))
        }
    });
    Some(of_each.collect::<Vec<String>>().join(", "))
}

/// Whether a function that is listed is documented not to return a status.
pub(super) fn is_unexpected(function: &str, status: Status) -> bool {
    let always = matches!(status, Ok | Panic | OutOfMemory);
    !always && answers(function).is_some_and(|sets| !holds(sets, status))
}

fn answers(function: &str) -> Option<&'static [Set]> {
    ANSWERS.iter().find(|(name, _)| *name == function).map(|(_, sets)| *sets)
}

fn holds(sets: &[Set], status: Status) -> bool {
    sets.iter().copied().flatten().any(|(known, _)| *known == status)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_answer_is_documented_once_with_all_its_notes() {
        let set = documented("lahar_grid_read").expect("a function");
        assert!(set.contains(&ViewOpen) && set.contains(&OutsideGrid), "{set:?}");
        assert!(!set.contains(&Poisoned), "{set:?}");
        let text = text("lahar_grid_read").expect("a function");
        assert!(text.starts_with("LAHAR_ERROR_NULL_ARGUMENT, "), "{text}");
        assert!(
            text.contains(
                "LAHAR_ERROR_INVALID_ARGUMENT (a text that is too long or not UTF-8; `count`)"
            ),
            "{text}"
        );
        assert_eq!(text.matches("LAHAR_ERROR_NULL_ARGUMENT").count(), 1);
        assert_eq!(documented("lahar_status_name"), None);
    }
}
