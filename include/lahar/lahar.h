/* lahar.h: the host interface of lahar, a material point method engine.
 *
 * Generated from src/ffi by `cargo xtask headers`; do not edit.
 *
 * Statuses. Functions return a lahar_status: 0 done; positive: refused, nothing has changed; negative: the object is
 * poisoned, it answers queries and can be freed. lahar_last_error_message tells what was expected, what was received and
 * what to do. Nothing prints, exits or aborts.
 *
 * Handles. lahar_context, lahar_material, lahar_world and lahar_view are opaque. `create` sets its output to NULL first,
 * and to the object only if it succeeds. `free` ignores NULL; freeing in any order is safe, children keep their parents
 * alive. A handle must not be used after it was freed. Bodies and walls are int64_t ids, never used again.
 *
 * Pointers must not be NULL unless it is said. Arrays of the host are read or written during the call only. Texts are
 * NUL-terminated UTF-8. Texts that lahar returns by pointer are static: they live as long as the process.
 *
 * Structs begin with `struct_size`, their sizeof, so that they can grow at the end. Structs with an init function are
 * filled by it; in the others, which lahar fills, the host sets `struct_size` and lahar zeroes what it does not know.
 *
 * Units are SI in this text; any consistent ones may be used. Tension is positive. Symmetric tensors have the components
 * xx, yy, zz, xy, yz, zx, in two dimensions too.
 *
 * Threads. Each function has a tag.
 *   Thread: any          from any thread at any time, and from callbacks
 *   Thread: callback-ok  a query: from any thread and from callbacks; LAHAR_ERROR_BUSY while another thread changes the
 *                        object
 *   Thread: owner        changes or frees the object: by one thread at a time (another gets LAHAR_ERROR_BUSY, except from
 *                        a free, before which the host must have ended all other use), not from callbacks
 *
 * Floating point. Every function saves the host's environment (rounding, traps), works in the default one, and restores
 * the host's; callbacks run in the host's.
 */

#ifndef LAHAR_H
#define LAHAR_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// The tables of plugins and of the engine, defined in lahar_plugin.h.
struct lahar_plugin_desc;
struct lahar_host_api;

/* ---- status ------------------------------------------------------------------------------------
 *
 * Statuses: what every function answers.
 */

// Done.
#define LAHAR_OK 0

// A pointer that must not be NULL is NULL.
#define LAHAR_ERROR_NULL_ARGUMENT 1

// `struct_size` is not one that this library knows, or the unknown tail is not zero.
#define LAHAR_ERROR_STRUCT_SIZE 2

// A value is not finite, of the wrong sign, or not one of those allowed.
#define LAHAR_ERROR_INVALID_ARGUMENT 3

// No model, parameter or field has this name; the message names the closest one.
#define LAHAR_ERROR_UNKNOWN_NAME 4

// A required parameter of a model is missing.
#define LAHAR_ERROR_MISSING_PARAMETER 5

// A parameter lies outside its hard bounds, or the model refuses the combination.
#define LAHAR_ERROR_OUT_OF_BOUNDS 6

// No body, wall or plugin has this id.
#define LAHAR_ERROR_NOT_FOUND 7

// A view is open that forbids the call.
#define LAHAR_ERROR_VIEW_OPEN 8

// The view's data belong to an earlier step.
#define LAHAR_ERROR_VIEW_STALE 9

// Another thread is using the object.
#define LAHAR_ERROR_BUSY 10

// The field can be read but not written.
#define LAHAR_ERROR_READ_ONLY 11

// This combination of options is not supported; the message names the nearest that is.
#define LAHAR_ERROR_UNSUPPORTED 12

// An array is shorter than the result; the needed size is given.
#define LAHAR_ERROR_BUFFER_TOO_SMALL 13

// The time step exceeds the stable one; nothing was done.
#define LAHAR_ERROR_STEP_TOO_LARGE 100

// The host left a value in a particle field that is not finite, not positive where it must
// be, or a position outside the grid; nothing was done.
#define LAHAR_ERROR_NON_FINITE_INPUT 101

// A particle stands outside the box of a static grid, or beyond the range of block
// coordinates; nothing was done.
#define LAHAR_ERROR_OUTSIDE_GRID 102

// A material failed or asked for a smaller time step; nothing was done. Only with the
// option `retries`.
#define LAHAR_ERROR_SMALLER_STEP 103

// A material gave no wave speed or no first state; nothing was done.
#define LAHAR_ERROR_MATERIAL_REFUSED 104

// A file could not be read or written.
#define LAHAR_ERROR_FILE 200

// The plugin file is missing.
#define LAHAR_ERROR_PLUGIN_NOT_FOUND 201

// The file is not a plugin, or its tables break the rules.
#define LAHAR_ERROR_PLUGIN_INVALID 202

// The plugin speaks another major version of the plugin ABI.
#define LAHAR_ERROR_PLUGIN_ABI 203

// The plugin refused to load.
#define LAHAR_ERROR_PLUGIN_REFUSED 204

// Threads could not be started, or the process was forked after they were.
#define LAHAR_ERROR_THREADS 205

// The memory for particles or grid is not to be had; nothing has changed.
#define LAHAR_ERROR_OUT_OF_MEMORY 206

// A defect of lahar was caught; the object is poisoned.
#define LAHAR_ERROR_PANIC -1

// A material failed at a point in the middle of a step; the world is poisoned.
#define LAHAR_ERROR_MATERIAL_FAILED -2

// A particle's state became infinite or not a number in a step; the world is poisoned.
#define LAHAR_ERROR_NON_FINITE -3

// The object was poisoned by an earlier call; it can only be queried and freed.
#define LAHAR_ERROR_POISONED -4

// A plugin broke its contract, which LAHAR_CHECK_PLUGINS=1 found; in a step the world is
// poisoned.
#define LAHAR_ERROR_PLUGIN_BROKEN -5

// What a function answers: 0 done; positive: refused, nothing has changed; negative: the object is poisoned, it
// answers queries and can be freed. 1 to 99: a mistake of the caller; 100 to 199: numerics; 200 to 299: files,
// plugins and threads.
typedef int32_t lahar_status;

// Name of a status, such as "LAHAR_ERROR_BUSY"; "unknown status" if there is none of this number.
// The text is static: do not free it. Cannot fail.
// Thread: any
const char *lahar_status_name(lahar_status status);

/* ---- version -----------------------------------------------------------------------------------
 *
 * Version of the library: constants of the header and their run-time twins.
 */

// Major version of this header.
#define LAHAR_VERSION_MAJOR 0

// Minor version of this header.
#define LAHAR_VERSION_MINOR 1

// Patch version of this header.
#define LAHAR_VERSION_PATCH 0

// Number of the binary interface of this header. A library is usable if `lahar_abi_version()` answers the same.
#define LAHAR_ABI_VERSION 1

// Version of the library that is running.
//
// `major`, `minor`, `patch`: written; must not be NULL.
// Errors: LAHAR_ERROR_NULL_ARGUMENT.
// Thread: any
lahar_status lahar_version(int32_t *major, int32_t *minor, int32_t *patch);

// Number of the binary interface of the library that is running; compare with LAHAR_ABI_VERSION. Cannot fail.
// Thread: any
int32_t lahar_abi_version(void);

/* ---- context -----------------------------------------------------------------------------------
 *
 * Context: threads, log, and the plugins that have been loaded. Everything else is made from a context.
 */

// Log level: something failed.
#define LAHAR_LOG_ERROR 0

// Log level: something is unusual, such as a parameter outside its advised bounds.
#define LAHAR_LOG_WARNING 1

// Log level: milestones, such as a loaded plugin.
#define LAHAR_LOG_INFORMATION 2

// Log level: details for finding a fault.
#define LAHAR_LOG_DETAIL 3

// Threads, log and loaded plugins. Freed by lahar_context_free; worlds, materials and views keep it alive.
typedef struct lahar_context lahar_context;

// Receives a line of the log: a LAHAR_LOG_ level, a text in UTF-8 without a newline that is valid during the call, and
// the pointer given to lahar_context_set_log. Called on the thread that called lahar, in the host's floating-point
// environment, with no lock held, just before the function returns. It may call functions tagged `callback-ok` or
// `any`. It must not unwind, throw or longjmp.
typedef void (*lahar_log_callback)(int32_t level, const char *message, void *user);

// Entry of a plugin that is linked into the program: its `lahar_plugin_entry_v1`, see lahar_plugin.h.
typedef const struct lahar_plugin_desc *(*lahar_plugin_entry_callback)(const struct lahar_host_api *host);

// A loaded plugin. The texts are static: they live as long as the process.
typedef struct lahar_plugin_info {
    // sizeof(lahar_plugin_info); set by the host.
    uint32_t struct_size;
    // 0.
    int32_t reserved;
    // Number of models.
    int64_t model_count;
    // Identifier, such as "org.lahar.linear_elastic".
    const char *id;
    // Version of the plugin.
    const char *version;
    // Who wrote it.
    const char *author;
    // Licence, an SPDX expression.
    const char *licence;
    // Where to find it; may be empty.
    const char *url;
    // The file that was loaded; of a registered plugin the id in brackets.
    const char *path;
} lahar_plugin_info;

// Makes a context.
//
// `threads`: number of threads that steps run on; 0: the environment variable LAHAR_NUM_THREADS, or 1 if it is not
// set. With more than 1 the context starts that many threads of its own; they end with it.
// `context`: set to the new handle, or to NULL on failure; the host frees it with lahar_context_free.
// The environment variable LAHAR_SIMD (scalar, avx2 or avx512) asks for an instruction set, see lahar_context_simd.
// LAHAR_CHECK_PLUGINS=1, read once in a process, runs every call of a model on guarded copies, many times slower, and answers a broken
// contract, such as a write past the points, with LAHAR_ERROR_PLUGIN_BROKEN and a sentence that says which.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (threads or one of the variables), LAHAR_ERROR_THREADS, LAHAR_ERROR_FILE
// (LAHAR_CAPSULES, see lahar_context_set_capsule_folder).
// Thread: any
lahar_status lahar_context_create(int32_t threads,
                                  lahar_context **context);

// Frees the handle. The context ends, and its threads are joined, when its worlds, materials and views are freed too.
// NULL is ignored.
// Thread: owner
void lahar_context_free(lahar_context *context);

// Number of threads of the context.
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT.
// Thread: any
lahar_status lahar_context_thread_count(const lahar_context *context, int32_t *threads);

// Name of the instruction set that the context's kernels use: "scalar", "avx2" or "avx512".
//
// It is the best that the processor has, or what the environment variable LAHAR_SIMD asked for when the context was made; models of
// lahar's SDK choose theirs in the same way, once in a process. Results
// are the same to the last bit for any number of threads; between instruction sets they differ by round-off.
//
// The text is static: do not free it. NULL for a NULL context. Cannot fail.
// Thread: any
const char *lahar_context_simd(const lahar_context *context);

// Number of different threads that have run work of the context's worlds so far; small worlds run on one thread.
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT.
// Thread: any
lahar_status lahar_context_threads_used(const lahar_context *context,
                                        int32_t *threads);

// Sets where log lines go. Without this call lahar is silent.
//
// `callback`: see lahar_log_callback; lahar_log_stderr is a ready one; NULL: no log.
// `user`: handed to the callback on every thread that calls functions of this context; lahar does not follow it.
// `max_level`: the most detailed level that is wanted, one of LAHAR_LOG_*.
// Errors: LAHAR_ERROR_NULL_ARGUMENT (context), LAHAR_ERROR_INVALID_ARGUMENT (level).
// Thread: any
lahar_status lahar_context_set_log(lahar_context *context,
                                   lahar_log_callback callback,
                                   void *user,
                                   int32_t max_level);

// A ready log callback: writes one line to standard error. `user` is not used.
// Thread: any
void lahar_log_stderr(int32_t level, const char *message, void *user);

// Loads a plugin into the context; a plugin that is loaded already is found again. It stays in memory until the
// process ends.
//
// `name_or_path`: a path (with a '/') or a bare name such as "lahar_drucker_prager", which is looked for as
// lib<name>.so in the folders of the environment variable LAHAR_PLUGIN_PATH, separated by ':', then in lahar/plugins-1 beside this
// library. A library that is no plugin but holds an Abaqus UMAT or VUMAT is taken too, if the plugin lahar_umat is found by its name.
// `plugin`: gets its index in the context; may be NULL.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_PLUGIN_NOT_FOUND, LAHAR_ERROR_PLUGIN_INVALID,
// LAHAR_ERROR_PLUGIN_ABI, LAHAR_ERROR_PLUGIN_REFUSED.
// Thread: any
lahar_status lahar_context_load_plugin(lahar_context *context,
                                       const char *name_or_path,
                                       int64_t *plugin);

// Takes a plugin that is linked into the program; an entry that is registered already is found again.
//
// `plugin`: its entry (see lahar_plugin.h), which is called unless it is known; the tables that it returns must stay as they are until the
// process ends.
// `index`: gets its index in the context; may be NULL. lahar_plugin_info tells its id in brackets as its path.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_PLUGIN_INVALID, LAHAR_ERROR_PLUGIN_ABI, LAHAR_ERROR_PLUGIN_REFUSED.
// Thread: any
lahar_status lahar_context_register_plugin(lahar_context *context,
                                           lahar_plugin_entry_callback plugin,
                                           int64_t *index);

// Sets the folder to which a step that fails at a point writes a capsule: a small JSON file with the model, its parameters, and all that
// the model was given and answered at the first such point, named `lahar-capsule-<model>-<body>-<particle>-<step>.json`. Files that are
// there are kept. The message of the step's error says where the capsule is.
//
// `folder`: a folder that exists; NULL or "": no capsules. At first it is that of the environment variable LAHAR_CAPSULES.
// Errors: LAHAR_ERROR_NULL_ARGUMENT (context), LAHAR_ERROR_FILE (there is no such folder; nothing has changed).
// Thread: any
lahar_status lahar_context_set_capsule_folder(lahar_context *context,
                                              const char *folder);

// Number of plugins that are loaded into the context.
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT.
// Thread: any
lahar_status lahar_context_plugin_count(const lahar_context *context, int64_t *plugins);

// Describes a plugin.
//
// `plugin`: 0 to lahar_context_plugin_count - 1.
// `info`: written; the host has set `struct_size`.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_NOT_FOUND (index).
// Thread: any
lahar_status lahar_context_plugin_info(const lahar_context *context,
                                       int64_t plugin,
                                       lahar_plugin_info *info);

/* ---- error -------------------------------------------------------------------------------------
 *
 * The last error: a text for people and a struct for programs. A failed call keeps its error for the calling thread
 * and for the context; a call that succeeds does not clear it.
 */

// Where and why a call failed, for programs.
typedef struct lahar_error_info {
    // sizeof(lahar_error_info); set by the host.
    uint32_t struct_size;
    // The status that the call returned; LAHAR_OK if no call of this thread has failed yet.
    lahar_status code;
    // Id of the body; -1 if unknown.
    int64_t body;
    // Id of the particle inside its body, counted from 0 in the order of insertion; -1 if unknown.
    int64_t particle;
    // Number of committed steps before the one that failed; -1 if unknown.
    int64_t step;
    // Time at the start of the step that failed [s]; 0 if unknown.
    double time;
    // Time step that would be accepted [s]; 0 if unknown.
    double suggested_dt;
} lahar_error_info;

// Text of the last error of the calling thread: which function, what was expected, what was received, what to do.
//
// `buffer`: `capacity` bytes, gets the text in UTF-8 with a NUL; may be NULL if `capacity` is 0, to ask for the size.
// `needed`: gets the size of the text with its NUL; may be NULL.
// Errors: LAHAR_ERROR_BUFFER_TOO_SMALL (the text is truncated), LAHAR_ERROR_NULL_ARGUMENT,
// LAHAR_ERROR_INVALID_ARGUMENT (negative capacity). None of them changes the last error.
// Thread: any
lahar_status lahar_last_error_message(char *buffer,
                                      int64_t capacity,
                                      int64_t *needed);

// The last error of the calling thread, for programs.
//
// `info`: written; the host has set `struct_size`.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE. None of them changes the last error.
// Thread: any
lahar_status lahar_last_error_info(lahar_error_info *info);

// Text of the last error of any call on this context, its worlds, materials and views, from any thread.
//
// `buffer`, `capacity`, `needed`, errors: as in lahar_last_error_message.
// Thread: any
lahar_status lahar_context_error_message(const lahar_context *context,
                                         char *buffer,
                                         int64_t capacity,
                                         int64_t *needed);

/* ---- model -------------------------------------------------------------------------------------
 *
 * Models: what the loaded plugins offer. Numbers such as `kinematics` are the constants of lahar_plugin.h.
 */

// A constitutive model. The texts are static.
typedef struct lahar_model_info {
    // sizeof(lahar_model_info); set by the host.
    uint32_t struct_size;
    // What the model takes: one of LAHAR_KINEMATICS_* of lahar_plugin.h.
    int32_t kinematics;
    // Name, for lahar_material_create.
    const char *name;
    // One sentence.
    const char *summary;
    // Where the model is published.
    const char *reference;
    // Index of the plugin that it comes from.
    int64_t plugin;
    // Number of parameters.
    int64_t parameter_count;
    // Number of state variables.
    int64_t state_count;
    // Sum of LAHAR_OUTPUT_* of lahar_plugin.h.
    uint64_t outputs;
    // Sum of LAHAR_CAPABILITY_* of lahar_plugin.h.
    uint64_t capabilities;
} lahar_model_info;

// A parameter of a model. The texts are static.
typedef struct lahar_parameter_info {
    // sizeof(lahar_parameter_info); set by the host.
    uint32_t struct_size;
    // One of LAHAR_PARAMETER_* of lahar_plugin.h: a real, a whole number, or a choice given by its position 0, 1, ...
    int32_t kind;
    // 1: must be given; 0: `default_value` is used.
    int32_t required;
    // 0.
    int32_t reserved;
    // Name, for lahar_material_create.
    const char *name;
    // Symbol of the literature.
    const char *symbol;
    // SI unit.
    const char *unit;
    // One sentence.
    const char *description;
    // Labels of a choice, separated by '|'; empty for other kinds.
    const char *choices;
    // Value if none is given.
    double default_value;
    // Smallest accepted value; -infinity for none.
    double hard_min;
    // Largest accepted value; infinity for none.
    double hard_max;
    // Below this a warning is logged; -infinity for none.
    double advised_min;
    // Above this a warning is logged; infinity for none.
    double advised_max;
} lahar_parameter_info;

// A state variable of a model; it is a field of every body of such a material, by this name. The texts are static.
typedef struct lahar_state_info {
    // sizeof(lahar_state_info); set by the host.
    uint32_t struct_size;
    // One of LAHAR_STATE_* of lahar_plugin.h.
    int32_t kind;
    // Number of components: 1, 3, 6 or 9.
    int32_t components;
    // One of LAHAR_ROTATION_* of lahar_plugin.h.
    int32_t rotation;
    // Name of the field.
    const char *name;
    // SI unit.
    const char *unit;
    // One sentence.
    const char *description;
    // Initial value of each component, before the model derives the first state.
    double initial;
} lahar_state_info;

// Number of models of all loaded plugins.
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT.
// Thread: any
lahar_status lahar_context_model_count(const lahar_context *context, int64_t *models);

// Describes a model.
//
// `model`: 0 to lahar_context_model_count - 1, in the order of loading.
// `info`: written; the host has set `struct_size`.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_NOT_FOUND (index).
// Thread: any
lahar_status lahar_context_model_info(const lahar_context *context,
                                      int64_t model,
                                      lahar_model_info *info);

// Index of the model of this name.
//
// `name`: NUL-terminated, UTF-8.
// `model`: gets the index.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_UNKNOWN_NAME (the message tells the closest name).
// Thread: any
lahar_status lahar_context_find_model(const lahar_context *context, const char *name, int64_t *model);

// Describes a parameter of a model.
//
// `model`: index of the model. `parameter`: 0 to `parameter_count` - 1 of lahar_model_info.
// `info`: written; the host has set `struct_size`.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_NOT_FOUND (either index).
// Thread: any
lahar_status lahar_context_model_parameter(const lahar_context *context,
                                           int64_t model,
                                           int64_t parameter,
                                           lahar_parameter_info *info);

// Describes a state variable of a model.
//
// `model`: index of the model. `state`: 0 to `state_count` - 1 of lahar_model_info.
// `info`: written; the host has set `struct_size`.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_NOT_FOUND (either index).
// Thread: any
lahar_status lahar_context_model_state(const lahar_context *context,
                                       int64_t model,
                                       int64_t state,
                                       lahar_state_info *info);

/* ---- material ----------------------------------------------------------------------------------
 *
 * Materials: a model with values of its parameters. A material may be used by many bodies and worlds.
 */

// A model with values of its parameters. Freed by lahar_material_free; bodies keep what they need.
typedef struct lahar_material lahar_material;

// Makes a material from named values. Parameters that are not named have their defaults.
//
// `model`: name of a model of a loaded plugin.
// `count`, `names`, `values`: the parameters that are given, `count` of each, in the units of the model's description;
// NULL is allowed if `count` is 0.
// `material`: set to the new handle, or to NULL on failure; the host frees it with lahar_material_free.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_UNKNOWN_NAME (model or parameter; the message tells the closest),
// LAHAR_ERROR_MISSING_PARAMETER, LAHAR_ERROR_OUT_OF_BOUNDS, LAHAR_ERROR_INVALID_ARGUMENT (given twice, not finite).
// Thread: any
lahar_status lahar_material_create(lahar_context *context,
                                   const char *model,
                                   int64_t count,
                                   const char *const *names,
                                   const double *values,
                                   lahar_material **material);

// Frees the handle; bodies made of the material go on. NULL is ignored.
// Thread: owner
void lahar_material_free(lahar_material *material);

// Value of a parameter, given or default, in the unit of its description.
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_UNKNOWN_NAME (the message tells the closest name).
// Thread: any
lahar_status lahar_material_value(const lahar_material *material,
                                  const char *parameter,
                                  double *value);

/* ---- world -------------------------------------------------------------------------------------
 *
 * Worlds: a background grid with its bodies and walls, and time.
 *
 * Vectors of fixed size have three components; in two dimensions the third is ignored, or 0 in a result. Any consistent
 * units may be used; those named are SI. In two dimensions a world is plane strain and 1 m thick.
 */

// Shape functions: linear. Use them with FLIP and LAHAR_ORDER_MUSL, see LAHAR_ORDER_USL.
#define LAHAR_SHAPE_LINEAR 0

// Shape functions: quadratic B-splines (default).
#define LAHAR_SHAPE_QUADRATIC_BSPLINE 1

// Shape functions: cubic B-splines.
#define LAHAR_SHAPE_CUBIC_BSPLINE 2

// Shape functions: uniform GIMP, linear functions averaged over the particle's domain,
// which keeps its size. Bodies from arrays must give the sizes of their particles.
#define LAHAR_SHAPE_UNIFORM_GIMP 3

// Shape functions: contiguous-particle GIMP. The domain's edges follow the stretch U of
// the particle (F = R U), at most to the spacing.
#define LAHAR_SHAPE_CONTIGUOUS_GIMP 4

// Next to walls shape functions are as everywhere; all nodes in reach of a wall feel it
// (default).
#define LAHAR_WALLS_PLAIN 0

// Next to walls shape functions are modified: linear fields are reproduced up to the wall,
// where the node on it alone counts. Walls must stand on node planes, at most one on each
// side of an axis, and particles between them.
#define LAHAR_WALLS_MODIFIED 1

// Transfer between particles and grid: a blend of PIC and FLIP, see `pic_rate`.
#define LAHAR_TRANSFER_PIC_FLIP 0

// Transfer between particles and grid: affine (APIC), which keeps angular momentum
// (default).
#define LAHAR_TRANSFER_APIC 1

// Transfer between particles and grid: Taylor (TPIC), affine with the velocity gradient;
// any shape function.
#define LAHAR_TRANSFER_TPIC 2

// Transfer between particles and grid: APIC with the forces and gradients of moving least
// squares (MLS-MPM); B-splines.
#define LAHAR_TRANSFER_MLS 3

// Transfer between particles and grid: extended (XPIC) of order `filter_order`.
#define LAHAR_TRANSFER_XPIC 4

// Transfer between particles and grid: full-mass-matrix (FMPM) of order `filter_order`.
#define LAHAR_TRANSFER_FMPM 5

// Order of a step: update stress last. The particles get their new velocities, then
// velocity gradients and stresses come from the grid as it moved. With linear shapes, this
// order and APIC are prone to blow up when a stressed particle barely touches a cell: the
// nodes there are so light that force over mass grows as 1/w with the small weight w.
// Linear shapes want FLIP (`pic_rate` 0) with LAHAR_ORDER_MUSL; B-splines have no such
// trouble.
#define LAHAR_ORDER_USL 0

// Order of a step: modified update stress last (default). The new velocities of the
// particles are mapped to the grid a second time, with the same weights, and velocity
// gradients and stresses come from those.
#define LAHAR_ORDER_MUSL 1

// Order of a step: update stress first, from the velocities at the start of the step.
#define LAHAR_ORDER_USF 2

// Order of a step: half of the stress update first, half last; keeps energy best, for
// twice the calls of the material.
#define LAHAR_ORDER_USAVG 3

// Grid: blocks come and go with the particles (default).
#define LAHAR_GRID_DYNAMIC 0

// Grid: blocks come with the particles and stay.
#define LAHAR_GRID_GROW_ONLY 1

// Grid: the blocks of a fixed box; a particle that leaves it is an error.
#define LAHAR_GRID_STATIC 2

// A background grid with its bodies and walls. Freed by lahar_world_free; views keep it alive.
typedef struct lahar_world lahar_world;

// What a world is made from. Fill it with lahar_world_options_init, then set `spacing` and what else is wanted.
typedef struct lahar_world_options {
    // sizeof(lahar_world_options); set by lahar_world_options_init.
    uint32_t struct_size;
    // 2 (plane strain, or see `axisymmetric`) or 3; default 3.
    int32_t dimension;
    // One of LAHAR_SHAPE_*.
    int32_t shape;
    // One of LAHAR_TRANSFER_*.
    int32_t transfer;
    // One of LAHAR_ORDER_*.
    int32_t order;
    // One of LAHAR_GRID_*.
    int32_t grid_policy;
    // Distance of the grid's nodes [m], > 0; has no default. Positions further than 1e8 spacings from `origin` or from
    // x = 0 are refused.
    double spacing;
    // Position of the node with index (0, 0, 0) [m], shape [3]; default 0.
    double origin[3];
    // Rate at which PIC replaces FLIP in LAHAR_TRANSFER_PIC_FLIP [1/s], >= 0: 0 is FLIP (default), infinity is PIC.
    double pic_rate;
    // Courant number of the stable time step [-], in (0, 1]; default 0.4.
    double cfl;
    // Gravity [m/s^2], shape [3]; default 0.
    double gravity[3];
    // Local non-viscous damping [-], in [0, 1); default 0.
    double damping;
    // Lower corner of the box of LAHAR_GRID_STATIC [m], shape [3].
    double box_min[3];
    // Upper corner of the box of LAHAR_GRID_STATIC [m], shape [3].
    double box_max[3];
    // One of LAHAR_WALLS_*.
    int32_t wall_treatment;
    // 1: rotational symmetry about the y axis, in 2D: x is the radius, and volumes, masses and forces are per radian; default 0.
    // Gravity must act along y. Hold the axis with a slip wall at x = 0: a step of particles that crossed it is refused.
    int32_t axisymmetric;
    // Terms of the filter of LAHAR_TRANSFER_XPIC and LAHAR_TRANSFER_FMPM, 1 (as PIC) to 20; each costs a gather and a scatter more.
    // 0: the default, 2.
    int32_t filter_order;
    // 1: particles carry a field `body_force` [N/kg], added to gravity; default 0.
    int32_t body_force;
    // How often a step is repeated smaller when a material fails or asks for a smaller one, 0 (default) to 20. Then such a step changes
    // nothing: it is answered by LAHAR_ERROR_SMALLER_STEP if the host gave its length, or if the repetitions did not help. It
    // costs a copy of the particles, in memory and once in each step. With 0 a failure poisons the world, and a wish shortens the next step.
    int32_t retries;
    // 0.
    int32_t reserved;
} lahar_world_options;

// Fills the options with their defaults.
//
// `size`: sizeof(lahar_world_options).
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE.
// Thread: any
lahar_status lahar_world_options_init(lahar_world_options *options, int64_t size);

// Makes an empty world at time 0.
//
// `options`: copied.
// `world`: set to the new handle, or to NULL on failure; the host frees it with lahar_world_free.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_INVALID_ARGUMENT, LAHAR_ERROR_OUT_OF_MEMORY (a
// static grid), LAHAR_ERROR_UNSUPPORTED (options that do not go together; the text names the nearest that do).
// Thread: any
lahar_status lahar_world_create(lahar_context *context,
                                const lahar_world_options *options,
                                lahar_world **world);

// Frees the handle. The memory goes when the last view is freed too. NULL is ignored.
// Thread: owner
void lahar_world_free(lahar_world *world);

// Sets constant gravity from the next step on, in the place of a table (lahar_world_set_gravity_table) too.
//
// `gravity`: [m/s^2], shape [3], finite.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT, LAHAR_ERROR_BUSY, LAHAR_ERROR_POISONED.
// Thread: owner
lahar_status lahar_world_set_gravity(lahar_world *world, const double gravity[3]);

// Sets the local non-viscous damping from the next step on.
//
// `damping`: [-], in [0, 1).
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT, LAHAR_ERROR_BUSY, LAHAR_ERROR_POISONED.
// Thread: owner
lahar_status lahar_world_set_damping(lahar_world *world, double damping);

// One step of the given length.
//
// `dt`: [s], > 0 and not above lahar_world_stable_dt.
// Errors, nothing done: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (dt, or one so small that time + dt is
// time again), LAHAR_ERROR_STEP_TOO_LARGE (the stable step is in `suggested_dt` of lahar_last_error_info),
// LAHAR_ERROR_NON_FINITE_INPUT (a value that the host wrote), LAHAR_ERROR_OUTSIDE_GRID (a particle is outside the box of
// a static grid or too far away; the world cannot step until the host writes positions back or removes the body),
// LAHAR_ERROR_THREADS (the process was forked after the threads had been started), LAHAR_ERROR_OUT_OF_MEMORY (the grid),
// LAHAR_ERROR_MATERIAL_REFUSED (a material gives no wave speed), LAHAR_ERROR_SMALLER_STEP (only with the option `retries`: a material
// failed or asks for a smaller step, the length of which is in `suggested_dt`), LAHAR_ERROR_VIEW_OPEN (a write view), LAHAR_ERROR_BUSY,
// LAHAR_ERROR_POISONED.
// Errors that poison the world: LAHAR_ERROR_MATERIAL_FAILED, LAHAR_ERROR_NON_FINITE (both not with `retries`, unless a model fails as a whole),
// LAHAR_ERROR_PLUGIN_BROKEN, LAHAR_ERROR_PANIC; lahar_last_error_info tells the body, the particle, the step and the time.
// Thread: owner
lahar_status lahar_world_step(lahar_world *world,
                              double dt);

// One step of the stable length.
//
// `dt`: gets the length of the step [s]; may be NULL.
// Errors: as lahar_world_step; LAHAR_ERROR_INVALID_ARGUMENT also if the stable step is infinite, or so small that
// time + dt is time again.
// Thread: owner
lahar_status lahar_world_step_auto(lahar_world *world,
                                   double *dt);

// Steps of the stable length until a time is reached; the last two are shortened to hit it exactly.
//
// `until`: time to reach [s], not before the present one.
// `max_steps`: at most so many steps, >= 0; INT64_MAX for no limit. Stopping early for this reason is no error.
// `steps_done`: gets the number of committed steps, on failure too; may be NULL.
// `time`: gets the time that was reached [s], on failure too; may be NULL.
// Errors: as lahar_world_step; LAHAR_ERROR_INVALID_ARGUMENT also if `until` is not finite or past, if `max_steps` is
// negative, or if the stable step becomes so small that time + dt is time again. A positive status means that no partial
// step was committed.
// Thread: owner
lahar_status lahar_world_advance(lahar_world *world,
                                 double until,
                                 int64_t max_steps,
                                 int64_t *steps_done,
                                 double *time);

// Longest step that is stable now [s]: infinity without particles.
//
// It is the largest dt, over all particles, with (c + |v| + |g| dt) dt <= cfl h and dt <= cfl h^2 / (2 D nu), and not
// above what the materials ask for; c is the wave speed, v the velocity of the particle, g gravity, h the spacing, D the
// dimension, nu the kinematic viscosity. Gravity by a table counts with its largest value in the step, and a prescribed
// velocity V with |V| dt <= cfl h.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_BUSY, LAHAR_ERROR_MATERIAL_REFUSED (a material gives no wave speed).
// Thread: callback-ok
lahar_status lahar_world_stable_dt(const lahar_world *world,
                                   double *dt);

// Time of the world [s].
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_world_time(const lahar_world *world, double *time);

// Number of committed steps.
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_world_step_count(const lahar_world *world, int64_t *steps);

// Length of the last committed step [s]; 0 before the first.
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_world_last_dt(const lahar_world *world, double *dt);

/* ---- body --------------------------------------------------------------------------------------
 *
 * Bodies: particles of one material. They are made from the host's arrays or from shapes, and named by ids that are
 * counted from 0 and never used again.
 */

// An array of the host with any layout: component c of point k stands at data[c * component_stride + k * point_stride].
typedef struct lahar_array {
    // First value; NULL: not given. Read during the call only.
    const double *data;
    // Distance of two components of a point, in doubles. Both strides 0: interleaved, point after point.
    int64_t component_stride;
    // Distance of two points, in doubles.
    int64_t point_stride;
} lahar_array;

// Particles from the host's arrays. Fill it with lahar_particles_init, then set `count`, `position`, `volume`, and either
// `mass` or `density`.
typedef struct lahar_particles {
    // sizeof(lahar_particles); set by lahar_particles_init.
    uint32_t struct_size;
    // Must be 0.
    int32_t reserved;
    // Number of particles.
    int64_t count;
    // Positions [m], shape [count, dimension]; at most 1e8 spacings from the grid's origin and from x = 0.
    lahar_array position;
    // Volumes [m^3], shape [count], > 0; in two dimensions areas times 1 m.
    lahar_array volume;
    // Masses [kg], shape [count], > 0; not given: `density` times volume.
    lahar_array mass;
    // Velocities [m/s], shape [count, dimension]; not given: 0.
    lahar_array velocity;
    // Cauchy stresses xx, yy, zz, xy, yz, zx [Pa], tension positive, shape [count, 6]; not given: 0.
    lahar_array stress;
    // Mass density [kg/m^3], > 0; used if `mass` is not given.
    double density;
    // Edge lengths of the particles' domains [m], shape [count, dimension], > 0; not given: not known. The GIMP shape functions
    // and tractions on the body need them.
    lahar_array size;
} lahar_particles;

// How a shape is filled with particles. Fill it with lahar_fill_init, then set either `density` or `mass`.
typedef struct lahar_fill {
    // sizeof(lahar_fill); set by lahar_fill_init.
    uint32_t struct_size;
    // Particles per cell of the grid along each axis, >= 1; default 2.
    int32_t particles_per_cell;
    // Mass density [kg/m^3], > 0; 0: not given. The mass of the body is that of the lattice points inside the shape, each
    // with the volume of its part of the lattice: exact for a box; a sphere of radius h, the spacing, may be 10 % off.
    double density;
    // Mass of the whole body [kg], > 0; 0: not given. Shared evenly by the particles: the mass is exact.
    double mass;
    // Velocity of all particles [m/s], shape [3]; default 0.
    double velocity[3];
    // Cauchy stress of all particles xx, yy, zz, xy, yz, zx [Pa], tension positive, shape [6]; default 0.
    double stress[6];
} lahar_fill;

// Fills the struct with its defaults: no particles, no arrays.
//
// `size`: sizeof(lahar_particles).
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE.
// Thread: any
lahar_status lahar_particles_init(lahar_particles *particles, int64_t size);

// Fills the struct with its defaults.
//
// `size`: sizeof(lahar_fill).
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE.
// Thread: any
lahar_status lahar_fill_init(lahar_fill *fill, int64_t size);

// Adds a body from the host's arrays.
//
// `particles`: read during the call only. The particles get the ids 0 to count - 1 in this order.
// `body`: gets the id of the new body; must not be NULL.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_INVALID_ARGUMENT (not finite, not positive, too
// far away, strides), LAHAR_ERROR_OUT_OF_MEMORY, LAHAR_ERROR_VIEW_OPEN, LAHAR_ERROR_BUSY, LAHAR_ERROR_POISONED.
// Thread: owner
lahar_status lahar_body_add_particles(lahar_world *world,
                                      const lahar_material *material,
                                      const lahar_particles *particles,
                                      int64_t *body);

// Adds a body that fills a box.
//
// `min`, `max`: corners [m], shape [3]. Particles stand on a regular lattice, `particles_per_cell` along each axis.
// `fill`: density or mass, velocity, stress. `body`: gets the id of the new body; must not be NULL.
// Errors: as lahar_body_add_particles.
// Thread: owner
lahar_status lahar_body_add_box(lahar_world *world,
                                const lahar_material *material,
                                const double min[3],
                                const double max[3],
                                const lahar_fill *fill,
                                int64_t *body);

// Adds a body that fills a sphere, or a disc in two dimensions.
//
// `center`: [m], shape [3]. `radius`: [m], > 0.
// `fill`: density or mass, velocity, stress. With `density` the mass is that of the lattice points inside, which may be
// 10 % off if the radius is the spacing; give `mass` for an exact one.
// `body`: gets the id of the new body; must not be NULL.
// Errors: as lahar_body_add_particles.
// Thread: owner
lahar_status lahar_body_add_sphere(lahar_world *world,
                                   const lahar_material *material,
                                   const double center[3],
                                   double radius,
                                   const lahar_fill *fill,
                                   int64_t *body);

// Adds a body that fills a simple polygon; two dimensions only.
//
// `count`: number of vertices, >= 3. `vertices`: [m], shape [count, 2], point after point, in either sense of rotation.
// `fill`: density or mass, velocity, stress. With `density` the mass is that of the lattice points inside; give `mass`
// for an exact one.
// `body`: gets the id of the new body; must not be NULL.
// Errors: as lahar_body_add_particles; LAHAR_ERROR_UNSUPPORTED in three dimensions.
// Thread: owner
lahar_status lahar_body_add_polygon(lahar_world *world,
                                    const lahar_material *material,
                                    int64_t count,
                                    const double *vertices,
                                    const lahar_fill *fill,
                                    int64_t *body);

// Removes a body. Its id is not used again.
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_NOT_FOUND, LAHAR_ERROR_VIEW_OPEN, LAHAR_ERROR_BUSY,
// LAHAR_ERROR_POISONED.
// Thread: owner
lahar_status lahar_body_remove(lahar_world *world, int64_t body);

// Switches F-bar on or off for a body; off at first.
//
// With F-bar the particles in a cell of the grid grow and shrink alike (the trace of the velocity gradient is averaged, weighted by
// volume), so that nearly incompressible and plastic material does not lock. It costs an additional gather per step.
// `on`: 1 or 0.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_NOT_FOUND, LAHAR_ERROR_INVALID_ARGUMENT, LAHAR_ERROR_OUT_OF_MEMORY,
// LAHAR_ERROR_VIEW_OPEN, LAHAR_ERROR_BUSY, LAHAR_ERROR_POISONED.
// Thread: owner
lahar_status lahar_body_set_f_bar(lahar_world *world,
                                  int64_t body,
                                  int32_t on);

// Number of bodies.
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_world_body_count(const lahar_world *world, int64_t *bodies);

// Ids of the bodies, ascending.
//
// `capacity`, `ids`: room for so many ids; NULL and 0 ask for the count alone.
// `count`: gets the number of bodies.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (negative capacity), LAHAR_ERROR_BUFFER_TOO_SMALL
// (`count` is set, `ids` is not touched), LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_world_bodies(const lahar_world *world,
                                int64_t capacity,
                                int64_t *ids,
                                int64_t *count);

// Number of particles of a body.
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_NOT_FOUND, LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_body_particle_count(const lahar_world *world, int64_t body, int64_t *particles);

/* ---- field -------------------------------------------------------------------------------------
 *
 * Particle fields: position, velocity, stress and so on, and every state variable of the body's model, by name. The
 * functions here copy, in the order of insertion (by particle id); views show the memory itself.
 */

// A field of particles or of nodes. The texts are static.
typedef struct lahar_field_info {
    // sizeof(lahar_field_info); set by the host.
    uint32_t struct_size;
    // Number of components per point.
    int32_t components;
    // 1: the host may write it; 0: it is read-only.
    int32_t writable;
    // 0.
    int32_t reserved;
    // Name.
    const char *name;
    // SI unit.
    const char *unit;
    // One sentence.
    const char *description;
} lahar_field_info;

// Number of fields of a body.
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_NOT_FOUND (body), LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_body_field_count(const lahar_world *world, int64_t body, int64_t *fields);

// Describes a field of a body.
//
// `field`: 0 to lahar_body_field_count - 1.
// `info`: written; the host has set `struct_size`.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_NOT_FOUND (body or index), LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_body_field_info(const lahar_world *world,
                                   int64_t body,
                                   int64_t field,
                                   lahar_field_info *info);

// Index of the field of this name.
//
// `field`: gets the index.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_NOT_FOUND (body), LAHAR_ERROR_UNKNOWN_NAME (the message tells the
// closest name), LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_body_find_field(const lahar_world *world,
                                   int64_t body,
                                   const char *name,
                                   int64_t *field);

// Copies a field to the host, in the order of particle ids.
//
// `count`: number of particles of the body.
// `values`: component c of particle k is written to values[c * component_stride + k * point_stride]; both strides 0:
// interleaved, shape [count, components].
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_NOT_FOUND (body), LAHAR_ERROR_UNKNOWN_NAME (the message tells the
// closest name), LAHAR_ERROR_BUFFER_TOO_SMALL (count), LAHAR_ERROR_INVALID_ARGUMENT (count, strides), LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_body_read(const lahar_world *world,
                             int64_t body,
                             const char *field,
                             int64_t count,
                             double *values,
                             int64_t component_stride,
                             int64_t point_stride);

// Copies a field from the host, in the order of particle ids.
//
// A value that is not finite is refused by this call, with nothing written. Masses and volumes that are not positive and
// positions outside the grid are found before the next step, which answers LAHAR_ERROR_NON_FINITE_INPUT until the host
// writes good ones.
// `count`, `values`, strides: as in lahar_body_read.
// Errors: as lahar_body_read, LAHAR_ERROR_INVALID_ARGUMENT also for a value that is not finite, LAHAR_ERROR_READ_ONLY,
// LAHAR_ERROR_POISONED.
// Thread: owner
lahar_status lahar_body_write(lahar_world *world,
                              int64_t body,
                              const char *field,
                              int64_t count,
                              const double *values,
                              int64_t component_stride,
                              int64_t point_stride);

// Ids of a body's particles in storage order, the order of views: the k-th value of a view belongs to ids[k].
//
// `capacity`, `ids`: room for so many ids; NULL and 0 ask for the count alone.
// `count`: gets the number of particles.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_NOT_FOUND, LAHAR_ERROR_INVALID_ARGUMENT (negative capacity),
// LAHAR_ERROR_BUFFER_TOO_SMALL (`count` is set, `ids` is not touched), LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_body_ids(const lahar_world *world,
                            int64_t body,
                            int64_t capacity,
                            int64_t *ids,
                            int64_t *count);

/* ---- view --------------------------------------------------------------------------------------
 *
 * Views: the memory of a particle field itself, in storage order (see lahar_body_ids). The host frees each view.
 */

// Access of a view: read. A step makes the view stale.
#define LAHAR_ACCESS_READ 0

// Access of a view: read and write. No step is possible while it is open.
#define LAHAR_ACCESS_WRITE 1

// A view of a field. Freed by lahar_view_free; keeps the world alive.
typedef struct lahar_view lahar_view;

// Where the data of a view stand.
typedef struct lahar_view_info {
    // sizeof(lahar_view_info); set by the host.
    uint32_t struct_size;
    // Number of components per particle.
    int32_t components;
    // Component c of particle k, in storage order, stands at data[c * stride + k]. Not to be written through a view with
    // LAHAR_ACCESS_READ. The memory stays mapped until the view is freed.
    double *data;
    // Number of particles.
    int64_t count;
    // Distance of two components, in doubles.
    int64_t stride;
    // Grows whenever the storage order may have changed; equal numbers mean the same order.
    int64_t generation;
} lahar_view_info;

// Opens a view of a field of a body.
//
// While any view is open, bodies cannot be added or removed; while a write view is open, the world cannot step. What is
// written through a view is checked before the next step.
// `access`: LAHAR_ACCESS_READ or LAHAR_ACCESS_WRITE.
// `view`: set to the new handle, or to NULL on failure; the host frees it with lahar_view_free.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (access), LAHAR_ERROR_NOT_FOUND (body),
// LAHAR_ERROR_UNKNOWN_NAME (the message tells the closest name), LAHAR_ERROR_READ_ONLY, LAHAR_ERROR_BUSY,
// LAHAR_ERROR_POISONED (write access).
// Thread: owner
lahar_status lahar_body_view(lahar_world *world,
                             int64_t body,
                             const char *field,
                             int32_t access,
                             lahar_view **view);

// Where the data stand.
//
// `info`: written; the host has set `struct_size`.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_VIEW_STALE (a step has been made since),
// LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_view_data(const lahar_view *view,
                             lahar_view_info *info);

// Closes the view. Its memory must not be used any more. NULL is ignored.
// Thread: callback-ok
void lahar_view_free(lahar_view *view);

/* ---- wall --------------------------------------------------------------------------------------
 *
 * Walls: planes on the grid at any position along an axis, named by ids that are never used again.
 */

// Wall: nothing moves at it.
#define LAHAR_WALL_STICKY 0

// Wall: no motion across it, free motion along it.
#define LAHAR_WALL_SLIP 1

// Wall: as slip, but material may leave it.
#define LAHAR_WALL_SEPARATING 2

// Wall: as separating, with Coulomb friction.
#define LAHAR_WALL_FRICTION 3

// A plane wall. Fill it with lahar_wall_init, then set what is wanted.
//
// A wall acts on every node whose signed distance to the plane, positive on the side of the material, is at most `reach`:
// 0 for linear and h/2 for quadratic shapes, with the spacing h; so it also acts on all nodes behind it, the whole
// half-space. Place walls on node planes for linear shapes, and half a cell from node planes for quadratic ones (for
// instance by an `origin` of h/2): then the function of no free node reaches behind the wall. Elsewhere the wall acts up
// to h late. Walls apply in the order in which they were added.
typedef struct lahar_wall {
    // sizeof(lahar_wall); set by lahar_wall_init.
    uint32_t struct_size;
    // Axis of the normal: 0 x, 1 y, 2 z; default 0.
    int32_t axis;
    // 1: the material is at larger coordinates (default); -1: at smaller.
    int32_t side;
    // One of LAHAR_WALL_*; default LAHAR_WALL_STICKY.
    int32_t kind;
    // Coordinate of the plane [m]; default 0.
    double position;
    // Coefficient of friction of LAHAR_WALL_FRICTION [-], >= 0; default 0.
    double friction;
} lahar_wall;

// Fills the struct with its defaults.
//
// `size`: sizeof(lahar_wall).
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE.
// Thread: any
lahar_status lahar_wall_init(lahar_wall *wall, int64_t size);

// Adds a wall.
//
// `wall`: copied. `id`: gets the id of the wall; may be NULL.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_INVALID_ARGUMENT, LAHAR_ERROR_UNSUPPORTED
// (LAHAR_WALLS_MODIFIED: not on a node plane, or a second wall on a side), LAHAR_ERROR_BUSY, LAHAR_ERROR_POISONED.
// Thread: owner
lahar_status lahar_wall_add(lahar_world *world,
                            const lahar_wall *wall,
                            int64_t *id);

// Removes a wall. Its id is not used again.
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_NOT_FOUND, LAHAR_ERROR_BUSY, LAHAR_ERROR_POISONED.
// Thread: owner
lahar_status lahar_wall_remove(lahar_world *world, int64_t id);

// Force of a wall on the material in the last step.
//
// `force`: written [N], shape [3].
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_NOT_FOUND, LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_wall_reaction(const lahar_world *world, int64_t id, double force[3]);

/* ---- table -------------------------------------------------------------------------------------
 *
 * Tables of the host: values over time, piecewise linear between the rows. Before the first row and after the last one the
 * values of that row hold.
 */

// A table over time. Times must increase, and all numbers be finite.
typedef struct lahar_table {
    // Number of rows; 0: no table, the condition is constant.
    int64_t count;
    // Times [s], shape [count]. Read during the call only.
    const double *times;
    // Values, shape as said where the table is used. Read during the call only.
    const double *values;
} lahar_table;

/* ---- prescribed_velocity -----------------------------------------------------------------------
 *
 * Velocities prescribed on regions of the grid, constant or by a table over time, named by ids that are never used again.
 */

// Component of a vector: x.
#define LAHAR_COMPONENT_X 1

// Component of a vector: y.
#define LAHAR_COMPONENT_Y 2

// Component of a vector: z.
#define LAHAR_COMPONENT_Z 4

// A velocity that the nodes in a box have at the end of every step, whatever pulls at them. Fill it with
// lahar_prescribed_velocity_init, then set `components`, the box and what else is wanted.
//
// The box stays where it is in space and holds nodes, not particles: it prescribes what moves through it. It comes after
// the walls, and where boxes overlap the one that was added last counts.
typedef struct lahar_prescribed_velocity {
    // sizeof(lahar_prescribed_velocity); set by lahar_prescribed_velocity_init.
    uint32_t struct_size;
    // The components that are prescribed, a sum of LAHAR_COMPONENT_*; has no default. The others stay free.
    int32_t components;
    // Lower corner of the box [m], shape [3]; may be -infinity; has no default. Nodes on its faces, to 1e-9 of the spacing,
    // are inside.
    double box_min[3];
    // Upper corner of the box [m], shape [3]; may be infinity; has no default.
    double box_max[3];
    // Velocity [m/s], shape [3], finite; default 0. Not used with a table.
    double velocity[3];
    // Velocity over time: values [m/s], shape [count, 3]. Default: no table.
    lahar_table table;
} lahar_prescribed_velocity;

// Fills the struct with its defaults.
//
// `size`: sizeof(lahar_prescribed_velocity).
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE.
// Thread: any
lahar_status lahar_prescribed_velocity_init(lahar_prescribed_velocity *condition, int64_t size);

// Adds a prescribed velocity. The stable time step keeps it, too, below `cfl` spacings a step.
//
// `condition`: copied, with its table. `id`: gets the id; may be NULL.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_INVALID_ARGUMENT (components; a box that is not
// set or inverted; a velocity that is not finite; a row of the table), LAHAR_ERROR_BUSY, LAHAR_ERROR_POISONED.
// Thread: owner
lahar_status lahar_prescribed_velocity_add(lahar_world *world,
                                           const lahar_prescribed_velocity *condition,
                                           int64_t *id);

// Removes a prescribed velocity. Its id is not used again.
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_NOT_FOUND, LAHAR_ERROR_BUSY, LAHAR_ERROR_POISONED.
// Thread: owner
lahar_status lahar_prescribed_velocity_remove(lahar_world *world, int64_t id);

// Force of a prescribed velocity on the material in the last step: the momentum it gave over the time step.
//
// `force`: written [N], shape [3].
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_NOT_FOUND, LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_prescribed_velocity_reaction(const lahar_world *world, int64_t id, double force[3]);

/* ---- traction ----------------------------------------------------------------------------------
 *
 * Tractions on the surfaces of bodies, constant or by a table over time, named by ids that are never used again.
 */

// A traction on a plane surface of a body. Fill it with lahar_traction_init, then set `body`, the normal, the box and the
// traction.
//
// It is a dead load: force per area of the surface as it was when the body was added, in a fixed direction. The particles
// with their centres in the box carry it, from now on and wherever they go; the box must hold the outermost layer of
// particles alone, the one half an edge of a particle inside of the surface. Each gives its share to the grid not at its
// centre but at its outer face, so that the stress is right up to the last cell. In two dimensions the surface is 1 m
// wide, or with axial symmetry a radian. The body needs the edge lengths of its particles: those added as a shape have them, arrays give them in `size`.
typedef struct lahar_traction {
    // sizeof(lahar_traction); set by lahar_traction_init.
    uint32_t struct_size;
    // Axis of the outward normal: 0 x, 1 y, 2 z; default 0.
    int32_t axis;
    // 1: the normal points to larger coordinates (default); -1: to smaller.
    int32_t side;
    // Must be 0.
    int32_t reserved;
    // Id of the body; has no default.
    int64_t body;
    // Lower corner of the box [m], shape [3]; may be -infinity; has no default.
    double box_min[3];
    // Upper corner of the box [m], shape [3]; may be infinity; has no default.
    double box_max[3];
    // The traction vector [Pa], shape [3], finite; default 0. A pressure p on a surface whose normal points to larger y
    // is (0, -p, 0).
    double traction[3];
    // Factors of the traction over time: values [-], shape [count]. Default: no table, the factor is 1.
    lahar_table factors;
} lahar_traction;

// Fills the struct with its defaults.
//
// `size`: sizeof(lahar_traction).
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE.
// Thread: any
lahar_status lahar_traction_init(lahar_traction *traction, int64_t size);

// Adds a traction. It goes when its body is removed.
//
// `traction`: copied, with its table. `id`: gets the id; may be NULL.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_NOT_FOUND (the body),
// LAHAR_ERROR_INVALID_ARGUMENT (the normal; a box that is not set, inverted, without a particle, or with particles behind
// one another along the normal; particles whose edge lengths are not known; a traction that is not finite; a row of the
// table), LAHAR_ERROR_BUSY, LAHAR_ERROR_POISONED.
// Thread: owner
lahar_status lahar_traction_add(lahar_world *world,
                                const lahar_traction *traction,
                                int64_t *id);

// Removes a traction. Its id is not used again.
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_NOT_FOUND, LAHAR_ERROR_BUSY, LAHAR_ERROR_POISONED.
// Thread: owner
lahar_status lahar_traction_remove(lahar_world *world, int64_t id);

// What a traction loads.
//
// `particles`: gets the number of particles that carry it; may be NULL.
// `area`: gets their area [m^2]; may be NULL.
// `force`: written, the force on the body in the last step, or of a query that mapped it to the grid since [N],
// shape [3]; 0 before.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_NOT_FOUND, LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_traction_force(const lahar_world *world,
                                  int64_t id,
                                  int64_t *particles,
                                  double *area,
                                  double force[3]);

/* ---- statics -----------------------------------------------------------------------------------
 *
 * Statics by dynamics: gravity by a table, how far a world is from equilibrium, steps until it is reached, initial
 * stresses.
 */

// Steps between two looks at the equilibrium in lahar_world_settle.
#define LAHAR_STEPS_BETWEEN_CHECKS 50

// How far a world is from equilibrium.
typedef struct lahar_equilibrium {
    // sizeof(lahar_equilibrium); set by the host.
    uint32_t struct_size;
    // 0.
    int32_t reserved;
    // Sum of m v^2 / 2 of the particles [J].
    double kinetic_energy;
    // Strain energy of the particles [J], as in lahar_totals: what the stresses worked since the start.
    double strain_energy;
    // Kinetic energy over the energy of the stresses [-]: the larger of |strain_energy| and the sum of
    // V s:s / (2 rho c^2), with the stress s and the largest wave speed c, which knows of initial stresses too. 0 at
    // rest.
    double kinetic_ratio;
    // Sum over the nodes of |F| [N], with the force F of stresses, tractions and gravity that neither walls nor prescribed
    // velocities take up. Damping is no part of it: it vanishes in equilibrium.
    double unbalanced_force;
    // What loads the world [N]: the sum over the nodes of m |g|, the forces of the tractions, and the sum over the
    // nodes of the reactions of prescribed velocities. If all these are 0, the sum of the reactions of walls.
    double external_force;
    // unbalanced_force over external_force [-]. 0 if nothing is unbalanced.
    double unbalanced_ratio;
} lahar_equilibrium;

// When a world counts as settled. Fill it with lahar_settle_criteria_init.
typedef struct lahar_settle_criteria {
    // sizeof(lahar_settle_criteria); set by lahar_settle_criteria_init.
    uint32_t struct_size;
    // Must be 0.
    int32_t reserved;
    // Largest `kinetic_ratio` of lahar_equilibrium [-], > 0; default 1e-4.
    double kinetic_ratio;
    // Largest `unbalanced_ratio` of lahar_equilibrium [-], > 0; default 1e-3.
    double unbalanced_ratio;
    // Most steps, >= 1; default 1000000.
    int64_t max_steps;
    // Time of the world at which to give up [s], after the present one; default infinity.
    double until;
} lahar_settle_criteria;

// What lahar_world_settle did.
typedef struct lahar_settle_result {
    // sizeof(lahar_settle_result); set by the host.
    uint32_t struct_size;
    // 1: both criteria hold; 0: steps or time ran out before.
    int32_t converged;
    // Number of committed steps.
    int64_t steps;
    // Time that was reached [s].
    double time;
    // `kinetic_ratio` of lahar_equilibrium at the last look [-].
    double kinetic_ratio;
    // `unbalanced_ratio` of lahar_equilibrium at the last look [-].
    double unbalanced_ratio;
} lahar_settle_result;

// Sets gravity by a table over time, piecewise linear, from the next step on: a ramp, a shaking. A step takes it at its
// middle, and stable_dt counts with the largest that can come in it. lahar_world_set_gravity brings constant gravity back.
//
// `count`: number of rows, at least 1. `times`: [s], shape [count], increasing. `values`: [m/s^2], shape [count, 3].
// Before the first row and after the last one the values of that row hold.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (no rows, times that do not increase, a value that is not
// finite; the text names the row), LAHAR_ERROR_BUSY, LAHAR_ERROR_POISONED.
// Thread: owner
lahar_status lahar_world_set_gravity_table(lahar_world *world,
                                           int64_t count,
                                           const double *times,
                                           const double *values);

// Tells how far a world is from equilibrium, by the forces of the last step; before the first step, and after an initial
// stress was set, by those of the particles as they are. Costs about as much as a part of a step.
//
// `equilibrium`: written; the host has set `struct_size`.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_INVALID_ARGUMENT (a model has no wave speed for the
// present state), LAHAR_ERROR_OUTSIDE_GRID, LAHAR_ERROR_OUT_OF_MEMORY, LAHAR_ERROR_VIEW_OPEN (an open write view while particles
// have to be sorted), LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_world_equilibrium(const lahar_world *world,
                                     lahar_equilibrium *equilibrium);

// Fills the criteria with their defaults.
//
// `size`: sizeof(lahar_settle_criteria).
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE.
// Thread: any
lahar_status lahar_settle_criteria_init(lahar_settle_criteria *criteria, int64_t size);

// Steps of the stable length until the world is in equilibrium, or until steps or time have run out, which is no error:
// `converged` tells. It looks every LAHAR_STEPS_BETWEEN_CHECKS steps, and does not stop before the last row of every table in
// use has passed. Set lahar_world_set_damping before, for instance to 0.3 to 0.7, or nothing comes to rest.
//
// `criteria`: copied; NULL: the defaults. `result`: written, on failure too; the host has set `struct_size`; may be NULL.
// Errors: as lahar_world_step; LAHAR_ERROR_INVALID_ARGUMENT also for criteria that are not positive, and if the stable step
// is infinite and `until` too. A positive status means that no partial step was committed.
// Thread: owner
lahar_status lahar_world_settle(lahar_world *world,
                                const lahar_settle_criteria *criteria,
                                lahar_settle_result *result);

// Gives the particles of a body the stress of level ground at rest: at the depth z below the surface the stress along
// gravity is -unit_weight z, along the other two axes k0 times that; shear is 0, and so is all stress above the surface.
// The model derives its state from the stress, as when a body is added, so that what it remembered is lost.
//
// A field of the host's own: give `stress` in lahar_particles, or write the field "stress" and call
// lahar_body_init_state.
//
// `surface_level`: coordinate of the surface along the axis of gravity [m].
// `unit_weight`: [N/m^3], > 0; or 0: mass over volume of the whole body, times gravity at the present time.
// `k0`: ratio of horizontal to vertical stress [-], >= 0.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_NOT_FOUND, LAHAR_ERROR_INVALID_ARGUMENT (gravity is 0 at the present time or
// not along an axis; a value out of its range; the model refuses the stress), LAHAR_ERROR_UNSUPPORTED (the stress of the
// model follows from the deformation gradient), LAHAR_ERROR_BUSY, LAHAR_ERROR_POISONED.
// Thread: owner
lahar_status lahar_body_set_k0_stress(lahar_world *world,
                                      int64_t body,
                                      double surface_level,
                                      double unit_weight,
                                      double k0);

// Lets the model of a body derive its state variables anew from the present stresses, as when the body was added: for
// instance the volume ratio of a fluid from its pressure. What it remembered is lost. To be called after the host wrote
// the field "stress".
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_NOT_FOUND, LAHAR_ERROR_INVALID_ARGUMENT (the model refuses the stress; the old
// state stays), LAHAR_ERROR_BUSY, LAHAR_ERROR_POISONED.
// Thread: owner
lahar_status lahar_body_init_state(lahar_world *world,
                                   int64_t body);

/* ---- grid --------------------------------------------------------------------------------------
 *
 * The sparse background grid: blocks of nodes that follow the material. It shows the last committed step; before the
 * first step, or after bodies came or went, mass and momentum as the particles map them.
 */

// Size of the grid, and what the last step changed.
typedef struct lahar_grid_statistics {
    // sizeof(lahar_grid_statistics); set by the host.
    uint32_t struct_size;
    // 2 or 3.
    int32_t dimension;
    // Nodes of a block along each axis.
    int64_t block_edge;
    // Number of active blocks.
    int64_t active_blocks;
    // Number of nodes of the active blocks.
    int64_t active_nodes;
    // Memory of the grid [bytes].
    int64_t bytes;
    // Blocks created in the last step.
    int64_t blocks_created;
    // Blocks removed in the last step.
    int64_t blocks_removed;
} lahar_grid_statistics;

// Statistics of the grid.
//
// `statistics`: written; the host has set `struct_size`.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_grid_stats(const lahar_world *world, lahar_grid_statistics *statistics);

// Integer coordinates of the active blocks, in block order. Block b holds the nodes with the indices
// b * block_edge to b * block_edge + block_edge - 1 along each axis; coordinates may be negative.
//
// `capacity`, `coordinates`: room for so many blocks, shape [capacity, dimension]; NULL and 0 ask for the count alone.
// `count`: gets the number of active blocks.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (negative capacity), LAHAR_ERROR_BUFFER_TOO_SMALL
// (`count` is set, `coordinates` is not touched), LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_grid_blocks(const lahar_world *world,
                               int64_t capacity,
                               int64_t *coordinates,
                               int64_t *count);

// Number of the node with an integer index. Numbers hold until the next step: the position of the node's block in block
// order times block_edge^dimension, plus the node's place inside the block.
//
// `index`: shape [3]; the node stands at origin + index * spacing.
// `node`: gets the number, or -1 if the node is not active.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_grid_find_node(const lahar_world *world,
                                  const int64_t index[3],
                                  int64_t *node);

// Integer index of the node with a number: the inverse of lahar_grid_find_node.
//
// `index`: written, shape [3].
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_NOT_FOUND (no such node), LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_grid_node_index(const lahar_world *world, int64_t node, int64_t index[3]);

// Number of node fields.
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_grid_field_count(const lahar_world *world, int64_t *fields);

// Describes a node field. The number of components is that of this world's dimension.
//
// `field`: 0 to lahar_grid_field_count - 1.
// `info`: written; the host has set `struct_size`.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_NOT_FOUND (index), LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_grid_field_info(const lahar_world *world,
                                   int64_t field,
                                   lahar_field_info *info);

// Copies a node field.
//
// `count`, `nodes`: numbers of nodes; NULL: all nodes of the active blocks, in block order, and `count` is `active_nodes`
// of lahar_grid_statistics.
// `values`: written, shape [count, components].
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_UNKNOWN_NAME (the message tells the closest name),
// LAHAR_ERROR_NOT_FOUND (a node, before anything is written), LAHAR_ERROR_INVALID_ARGUMENT (count), LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_grid_read(const lahar_world *world,
                             const char *field,
                             int64_t count,
                             const int64_t *nodes,
                             double *values);

// Samples a node field at points: sum of w m q over sum of w m, w the shape function and m the mass of a node.
//
// `count`, `points`: [m], shape [count, dimension].
// `values`: written, shape [count, components]; zeros where no material is.
// `inside`: written, shape [count]: 1 where material is, else 0; may be NULL.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_UNKNOWN_NAME (the message tells the closest name),
// LAHAR_ERROR_INVALID_ARGUMENT (count, a coordinate that is not finite), LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_grid_sample(const lahar_world *world,
                               const char *field,
                               int64_t count,
                               const double *points,
                               double *values,
                               int32_t *inside);

/* ---- output ------------------------------------------------------------------------------------
 *
 * Output: sums over the particles, and files.
 */

// In the place of a body's id: all bodies.
#define LAHAR_ALL_BODIES -1

// Sums over particles.
typedef struct lahar_totals {
    // sizeof(lahar_totals); set by the host.
    uint32_t struct_size;
    // 0.
    int32_t reserved;
    // Number of particles.
    int64_t particles;
    // Mass [kg].
    double mass;
    // Momentum [kg m/s], shape [3].
    double momentum[3];
    // Angular momentum about the origin of space x = 0 [kg m^2/s], shape [3].
    double angular_momentum[3];
    // Kinetic energy [J].
    double kinetic_energy;
    // Strain energy [J]: the work of the stresses, or what the model stores if it says so.
    double strain_energy;
    // Potential energy - m g . x [J], with the present gravity.
    double potential_energy;
    // Centre of mass [m], shape [3].
    double center_of_mass[3];
} lahar_totals;

// Mass, momenta and energies of a body or of all.
//
// `body`: an id, or LAHAR_ALL_BODIES.
// `totals`: written; the host has set `struct_size`.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_NOT_FOUND, LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_world_totals(const lahar_world *world, int64_t body, lahar_totals *totals);

// Writes all particles with all their fields to a VTP file (XML, compressed) for ParaView.
//
// `path`: NUL-terminated, UTF-8, ends in `.vtp`. The file is written aside and renamed, so that an existing one is
// replaced whole or not at all.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (`path` is empty, not UTF-8 or does not end in `.vtp`),
// LAHAR_ERROR_FILE, LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_world_write_vtp(const lahar_world *world,
                                   const char *path);

/* ---- layout: what the library was built with, on 64-bit systems */

#if UINTPTR_MAX > 0xffffffffu
#if defined(__cplusplus) && __cplusplus >= 201103L
#define LAHAR_ASSERT_LAYOUT(condition) static_assert(condition, #condition)
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L
#define LAHAR_ASSERT_LAYOUT(condition) _Static_assert(condition, #condition)
#endif
#endif
#ifdef LAHAR_ASSERT_LAYOUT
LAHAR_ASSERT_LAYOUT(sizeof(lahar_error_info) == 48);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_error_info, struct_size) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_error_info, code) == 4);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_error_info, body) == 8);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_error_info, particle) == 16);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_error_info, step) == 24);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_error_info, time) == 32);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_error_info, suggested_dt) == 40);
LAHAR_ASSERT_LAYOUT(sizeof(lahar_plugin_info) == 64);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_plugin_info, struct_size) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_plugin_info, reserved) == 4);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_plugin_info, model_count) == 8);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_plugin_info, id) == 16);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_plugin_info, version) == 24);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_plugin_info, author) == 32);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_plugin_info, licence) == 40);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_plugin_info, url) == 48);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_plugin_info, path) == 56);
LAHAR_ASSERT_LAYOUT(sizeof(lahar_model_info) == 72);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_info, struct_size) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_info, kinematics) == 4);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_info, name) == 8);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_info, summary) == 16);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_info, reference) == 24);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_info, plugin) == 32);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_info, parameter_count) == 40);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_info, state_count) == 48);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_info, outputs) == 56);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_info, capabilities) == 64);
LAHAR_ASSERT_LAYOUT(sizeof(lahar_parameter_info) == 96);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_parameter_info, struct_size) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_parameter_info, kind) == 4);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_parameter_info, required) == 8);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_parameter_info, reserved) == 12);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_parameter_info, name) == 16);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_parameter_info, symbol) == 24);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_parameter_info, unit) == 32);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_parameter_info, description) == 40);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_parameter_info, choices) == 48);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_parameter_info, default_value) == 56);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_parameter_info, hard_min) == 64);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_parameter_info, hard_max) == 72);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_parameter_info, advised_min) == 80);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_parameter_info, advised_max) == 88);
LAHAR_ASSERT_LAYOUT(sizeof(lahar_state_info) == 48);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_state_info, struct_size) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_state_info, kind) == 4);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_state_info, components) == 8);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_state_info, rotation) == 12);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_state_info, name) == 16);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_state_info, unit) == 24);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_state_info, description) == 32);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_state_info, initial) == 40);
LAHAR_ASSERT_LAYOUT(sizeof(lahar_world_options) == 176);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_world_options, struct_size) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_world_options, dimension) == 4);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_world_options, shape) == 8);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_world_options, transfer) == 12);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_world_options, order) == 16);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_world_options, grid_policy) == 20);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_world_options, spacing) == 24);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_world_options, origin) == 32);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_world_options, pic_rate) == 56);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_world_options, cfl) == 64);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_world_options, gravity) == 72);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_world_options, damping) == 96);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_world_options, box_min) == 104);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_world_options, box_max) == 128);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_world_options, wall_treatment) == 152);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_world_options, axisymmetric) == 156);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_world_options, filter_order) == 160);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_world_options, body_force) == 164);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_world_options, retries) == 168);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_world_options, reserved) == 172);
LAHAR_ASSERT_LAYOUT(sizeof(lahar_array) == 24);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_array, data) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_array, component_stride) == 8);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_array, point_stride) == 16);
LAHAR_ASSERT_LAYOUT(sizeof(lahar_particles) == 168);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_particles, struct_size) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_particles, reserved) == 4);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_particles, count) == 8);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_particles, position) == 16);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_particles, volume) == 40);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_particles, mass) == 64);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_particles, velocity) == 88);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_particles, stress) == 112);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_particles, density) == 136);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_particles, size) == 144);
LAHAR_ASSERT_LAYOUT(sizeof(lahar_fill) == 96);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_fill, struct_size) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_fill, particles_per_cell) == 4);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_fill, density) == 8);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_fill, mass) == 16);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_fill, velocity) == 24);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_fill, stress) == 48);
LAHAR_ASSERT_LAYOUT(sizeof(lahar_field_info) == 40);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_field_info, struct_size) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_field_info, components) == 4);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_field_info, writable) == 8);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_field_info, reserved) == 12);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_field_info, name) == 16);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_field_info, unit) == 24);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_field_info, description) == 32);
LAHAR_ASSERT_LAYOUT(sizeof(lahar_wall) == 32);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_wall, struct_size) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_wall, axis) == 4);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_wall, side) == 8);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_wall, kind) == 12);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_wall, position) == 16);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_wall, friction) == 24);
LAHAR_ASSERT_LAYOUT(sizeof(lahar_table) == 24);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_table, count) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_table, times) == 8);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_table, values) == 16);
LAHAR_ASSERT_LAYOUT(sizeof(lahar_prescribed_velocity) == 104);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_prescribed_velocity, struct_size) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_prescribed_velocity, components) == 4);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_prescribed_velocity, box_min) == 8);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_prescribed_velocity, box_max) == 32);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_prescribed_velocity, velocity) == 56);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_prescribed_velocity, table) == 80);
LAHAR_ASSERT_LAYOUT(sizeof(lahar_traction) == 120);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_traction, struct_size) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_traction, axis) == 4);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_traction, side) == 8);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_traction, reserved) == 12);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_traction, body) == 16);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_traction, box_min) == 24);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_traction, box_max) == 48);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_traction, traction) == 72);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_traction, factors) == 96);
LAHAR_ASSERT_LAYOUT(sizeof(lahar_equilibrium) == 56);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_equilibrium, struct_size) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_equilibrium, reserved) == 4);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_equilibrium, kinetic_energy) == 8);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_equilibrium, strain_energy) == 16);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_equilibrium, kinetic_ratio) == 24);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_equilibrium, unbalanced_force) == 32);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_equilibrium, external_force) == 40);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_equilibrium, unbalanced_ratio) == 48);
LAHAR_ASSERT_LAYOUT(sizeof(lahar_settle_criteria) == 40);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_settle_criteria, struct_size) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_settle_criteria, reserved) == 4);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_settle_criteria, kinetic_ratio) == 8);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_settle_criteria, unbalanced_ratio) == 16);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_settle_criteria, max_steps) == 24);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_settle_criteria, until) == 32);
LAHAR_ASSERT_LAYOUT(sizeof(lahar_settle_result) == 40);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_settle_result, struct_size) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_settle_result, converged) == 4);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_settle_result, steps) == 8);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_settle_result, time) == 16);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_settle_result, kinetic_ratio) == 24);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_settle_result, unbalanced_ratio) == 32);
LAHAR_ASSERT_LAYOUT(sizeof(lahar_view_info) == 40);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_view_info, struct_size) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_view_info, components) == 4);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_view_info, data) == 8);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_view_info, count) == 16);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_view_info, stride) == 24);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_view_info, generation) == 32);
LAHAR_ASSERT_LAYOUT(sizeof(lahar_grid_statistics) == 56);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_grid_statistics, struct_size) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_grid_statistics, dimension) == 4);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_grid_statistics, block_edge) == 8);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_grid_statistics, active_blocks) == 16);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_grid_statistics, active_nodes) == 24);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_grid_statistics, bytes) == 32);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_grid_statistics, blocks_created) == 40);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_grid_statistics, blocks_removed) == 48);
LAHAR_ASSERT_LAYOUT(sizeof(lahar_totals) == 120);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_totals, struct_size) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_totals, reserved) == 4);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_totals, particles) == 8);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_totals, mass) == 16);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_totals, momentum) == 24);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_totals, angular_momentum) == 48);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_totals, kinetic_energy) == 72);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_totals, strain_energy) == 80);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_totals, potential_energy) == 88);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_totals, center_of_mass) == 96);
#undef LAHAR_ASSERT_LAYOUT
#endif

#ifdef __cplusplus
} /* extern "C" */
#endif

#endif /* LAHAR_H */
