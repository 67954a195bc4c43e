/* lahar.h: the host interface of lahar, a material point method engine.
 *
 * Generated from src/ffi by `cargo xtask headers`; do not edit.
 *
 * Statuses. Functions return a lahar_status: 0: done; positive: refused, nothing has changed;
 * negative: the object is poisoned, it answers queries and can be freed. lahar_last_error_message gives
 * a text that says what was expected, what was received and what to do. Each function lists the statuses
 * that it returns; any may return LAHAR_ERROR_PANIC besides, for a defect of lahar, and
 * LAHAR_ERROR_OUT_OF_MEMORY if not even 64 kB can be had. No function prints, exits or aborts.
 *
 * Handles. lahar_context, lahar_material, lahar_world and lahar_view are opaque. Functions that make an
 * object first set the handle to NULL, and to the object only if they succeed. Functions that free
 * ignore NULL. Objects may be freed in any order: a context lives as long as its worlds and materials, a
 * world as long as its views. A handle must not be used after it was freed. Bodies, walls, prescribed
 * velocities and tractions have int64_t ids, which are never used again.
 *
 * Pointers must not be NULL unless the text says so. Arrays of the host are read or written only during
 * the call, except through views. Texts are NUL-terminated UTF-8, of 4096 bytes at most. Texts that lahar
 * returns by pointer are static: they are valid until the process ends.
 *
 * Structs begin with `struct_size`, their sizeof, so that fields can be added at the end. Structs that
 * have an init function are filled by it. In the others, which lahar fills, the host sets
 * `struct_size`, and lahar sets fields that it does not know to zero.
 *
 * Units are SI in this text; any consistent units may be used. Tension is positive. Symmetric tensors
 * have the components xx, yy, zz, xy, yz, zx, in two dimensions too.
 *
 * Threads. Each function has a tag.
 *   Thread: any          from any thread at any time, and from callbacks
 *   Thread: callback-ok  a query: from any thread and from callbacks; LAHAR_ERROR_BUSY while another
 *                        thread changes the object
 *   Thread: owner        changes or frees the object: by one thread at a time, not from callbacks. A
 *                        second thread gets LAHAR_ERROR_BUSY; but before an object is freed the host
 *                        must have ended all other use of its handle.
 *
 * Floating point. Every function saves the host's floating-point environment (rounding, traps), works in
 * the default one, and restores the host's. Callbacks run in the host's environment.
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
 * Statuses: the return values of functions.
 */

// Done.
#define LAHAR_OK 0

// A pointer that must not be NULL is NULL, or a pointer is not aligned for its type.
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

// No object has this id, or no item of a list has this index.
#define LAHAR_ERROR_NOT_FOUND 7

// A view is open that forbids the call; free it first.
#define LAHAR_ERROR_VIEW_OPEN 8

// Particles may have been reordered since the view was opened: by a step, or by a query
// that mapped the grid anew.
#define LAHAR_ERROR_VIEW_STALE 9

// Another thread is using the object.
#define LAHAR_ERROR_BUSY 10

// The field can be read but not written.
#define LAHAR_ERROR_READ_ONLY 11

// This combination of options is not supported; the message names the nearest one that is.
#define LAHAR_ERROR_UNSUPPORTED 12

// An array is shorter than the result; the needed size is given.
#define LAHAR_ERROR_BUFFER_TOO_SMALL 13

// The time step exceeds the stable one; nothing was done.
#define LAHAR_ERROR_STEP_TOO_LARGE 100

// A value that the host wrote to a particle field is not finite, or not positive where it
// must be, or is a position outside the grid; nothing was done.
#define LAHAR_ERROR_NON_FINITE_INPUT 101

// A particle is outside the box of a static grid, beyond the range of block coordinates,
// or beyond the axis of symmetry; nothing was done.
#define LAHAR_ERROR_OUTSIDE_GRID 102

// A material failed or asked for a smaller time step; nothing was done. Only with the
// option `retries`.
#define LAHAR_ERROR_SMALLER_STEP 103

// A material gave no wave speed or no first state; nothing was done.
#define LAHAR_ERROR_MATERIAL_REFUSED 104

// The host's progress callback asked to stop; the steps before are committed, and the world
// can go on.
#define LAHAR_ERROR_CANCELLED 105

// A file could not be read or written.
#define LAHAR_ERROR_FILE 200

// The plugin file is missing.
#define LAHAR_ERROR_PLUGIN_NOT_FOUND 201

// The file is not a plugin, or its tables break the rules.
#define LAHAR_ERROR_PLUGIN_INVALID 202

// The plugin was built for another major version of the plugin ABI.
#define LAHAR_ERROR_PLUGIN_ABI 203

// The plugin refused to load.
#define LAHAR_ERROR_PLUGIN_REFUSED 204

// Threads could not be started, or the process was forked after they were.
#define LAHAR_ERROR_THREADS 205

// There is not enough memory for particles or grid; nothing has changed.
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

// Return value of a function: 0 done; positive: refused, nothing has changed; negative: the object
// is poisoned, it answers queries and can be freed. 1 to 99: a mistake of the caller; 100 to 199:
// numerics; 200 to 299: files, plugins and threads.
typedef int32_t lahar_status;

// Name of a status, such as "LAHAR_ERROR_BUSY"; "unknown status" if no status has this number.
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

// Number of the binary interface of this header. A library is usable if `lahar_abi_version()`
// returns the same number.
#define LAHAR_ABI_VERSION 1

// Version of the library that is running.
//
// `major`, `minor`, `patch`: written; must not be NULL.
// Errors: LAHAR_ERROR_NULL_ARGUMENT.
// Thread: any
lahar_status lahar_version(int32_t *major, int32_t *minor, int32_t *patch);

// Number of the binary interface of the library that is running; compare with LAHAR_ABI_VERSION.
// Cannot fail.
// Thread: any
int32_t lahar_abi_version(void);

/* ---- context -----------------------------------------------------------------------------------
 *
 * Context: threads, log, and the plugins that have been loaded. Everything else is made from a
 * context.
 */

// Log level: something failed.
#define LAHAR_LOG_ERROR 0

// Log level: something is unusual, such as a parameter outside its advised bounds.
#define LAHAR_LOG_WARNING 1

// Log level: milestones, such as a loaded plugin.
#define LAHAR_LOG_INFORMATION 2

// Log level: details for finding a fault.
#define LAHAR_LOG_DETAIL 3

// Threads, log and loaded plugins. Freed by lahar_context_free; it lives as long as one of its
// worlds, materials or views.
typedef struct lahar_context lahar_context;

// Receives a line of the log: a level (LAHAR_LOG_*), a text in UTF-8 without a newline, valid only
// during the call, and the pointer given to lahar_context_set_log. Called on the thread that
// called lahar, in the host's floating-point environment, with no lock held, just before the
// function returns. It may call functions tagged `callback-ok` or `any`. It must not unwind, throw
// or longjmp.
typedef void (*lahar_log_callback)(int32_t level, const char *message, void *user);

// Entry of a plugin that is linked into the program: its `lahar_plugin_entry_v1`, see
// lahar_plugin.h.
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
    // Its address in the web; may be empty.
    const char *url;
    // The file that was loaded; for a registered plugin its id in brackets.
    const char *path;
} lahar_plugin_info;

// Makes a context.
//
// `threads`: number of threads that steps run on; 0: the environment variable LAHAR_NUM_THREADS,
// or 1 if it is not set. With more than 1 the context starts that many threads of its own, which
// end with the context.
// `context`: set to the new handle, or to NULL on failure; the host frees it with
// lahar_context_free.
//
// The environment variable LAHAR_SIMD (scalar, avx2 or avx512) selects an instruction set, see
// lahar_context_simd. With LAHAR_CHECK_PLUGINS=1, read once in a process, every call of a model
// works on guarded copies, which is many times slower. If a model breaks its contract, for
// instance by a write past its points, LAHAR_ERROR_PLUGIN_BROKEN is returned and the message says
// how.
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (threads or one of the
// variables), LAHAR_ERROR_FILE (LAHAR_CAPSULES, see lahar_context_set_capsule_folder),
// LAHAR_ERROR_THREADS, LAHAR_ERROR_OUT_OF_MEMORY.
// Thread: any
lahar_status lahar_context_create(int32_t threads, lahar_context **context);

// Frees the handle. The context ends, and its threads are joined, when its worlds, materials and
// views are freed too. NULL is ignored.
// Thread: owner
void lahar_context_free(lahar_context *context);

// Number of threads of the context.
//
// `threads`: gets the number.
// Errors: LAHAR_ERROR_NULL_ARGUMENT.
// Thread: any
lahar_status lahar_context_thread_count(const lahar_context *context, int32_t *threads);

// Name of the instruction set that the context's kernels use: "scalar", "avx2" or "avx512".
//
// It is the best one of the processor, or the one that the environment variable LAHAR_SIMD named
// when the context was made. Models written with lahar's SDK select theirs in the same way, once
// in a process. Results are the same to the last bit for any number of threads; between
// instruction sets they differ by round-off.
//
// The text is static: do not free it. NULL for a NULL context. Cannot fail.
// Thread: any
const char *lahar_context_simd(const lahar_context *context);

// Number of different threads that have run work of the context's worlds so far; small worlds run
// on one thread.
//
// `threads`: gets the number.
// Errors: LAHAR_ERROR_NULL_ARGUMENT.
// Thread: any
lahar_status lahar_context_threads_used(const lahar_context *context, int32_t *threads);

// Sets where log lines go. Without this call lahar is silent.
//
// Callback and `user` must stay valid until others are set and the calls that other threads made
// before have returned, or until the context has ended, which may be long after
// lahar_context_free: its worlds, materials and views keep it, and log.
//
// `callback`: see lahar_log_callback; lahar_log_stderr is a ready one; NULL: no log.
// `user`: passed to the callback on every thread that calls functions of this context; lahar does
// not follow it.
// `max_level`: the most detailed level to be passed on, one of LAHAR_LOG_*.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (the level).
// Thread: any
lahar_status lahar_context_set_log(lahar_context *context,
                                   lahar_log_callback callback,
                                   void *user,
                                   int32_t max_level);

// A ready log callback: writes one line to standard error. `user` is not used.
// Thread: any
void lahar_log_stderr(int32_t level, const char *message, void *user);

// Loads a plugin into the context. If it is loaded already, its index is returned again. A plugin
// stays in memory until the process ends.
//
// `name_or_path`: a path (with a '/') or a bare name such as "lahar_drucker_prager". For a bare
// name lib<name>.so is searched in the folders of the environment variable LAHAR_PLUGIN_PATH,
// separated by ':', then in lahar/plugins-1 beside this library. A library that is not a plugin
// but contains an Abaqus UMAT or VUMAT is accepted too if the plugin lahar_umat is found by its
// name.
// `plugin`: gets its index in the context; may be NULL.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (a text that is too long or not
// UTF-8), LAHAR_ERROR_PLUGIN_NOT_FOUND, LAHAR_ERROR_PLUGIN_INVALID, LAHAR_ERROR_PLUGIN_ABI,
// LAHAR_ERROR_PLUGIN_REFUSED.
// Thread: any
lahar_status lahar_context_load_plugin(lahar_context *context,
                                       const char *name_or_path,
                                       int64_t *plugin);

// Registers a plugin that is linked into the program. If its entry is registered already, its
// index is returned again.
//
// `plugin`: its entry (see lahar_plugin.h), which is called unless it is known already. The tables
// that it returns must not change until the process ends.
// `index`: gets its index in the context; may be NULL. `path` of lahar_plugin_info is its id in
// brackets.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_PLUGIN_INVALID, LAHAR_ERROR_PLUGIN_ABI,
// LAHAR_ERROR_PLUGIN_REFUSED.
// Thread: any
lahar_status lahar_context_register_plugin(lahar_context *context,
                                           lahar_plugin_entry_callback plugin,
                                           int64_t *index);

// Sets the folder for capsules. If a model fails at a point in a step, the step writes a capsule:
// a small JSON file with the model, its parameters, and the input and output of the model at the
// first such point, named `lahar-capsule-<model>-<body>-<particle>-<step>.json`. Existing files
// are not overwritten. The error message of the step gives the path of the capsule.
//
// `folder`: an existing folder; NULL or "": no capsules. A new context has the folder of the
// environment variable LAHAR_CAPSULES.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (a text that is too long or not
// UTF-8), LAHAR_ERROR_FILE (the folder does not exist; nothing has changed).
// Thread: any
lahar_status lahar_context_set_capsule_folder(lahar_context *context, const char *folder);

// Number of plugins that are loaded into the context.
//
// `plugins`: gets the number.
// Errors: LAHAR_ERROR_NULL_ARGUMENT.
// Thread: any
lahar_status lahar_context_plugin_count(const lahar_context *context, int64_t *plugins);

// Describes a plugin.
//
// `plugin`: 0 to lahar_context_plugin_count - 1.
// `info`: written; the host has set `struct_size`.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_NOT_FOUND (the index).
// Thread: any
lahar_status lahar_context_plugin_info(const lahar_context *context,
                                       int64_t plugin,
                                       lahar_plugin_info *info);

/* ---- error -------------------------------------------------------------------------------------
 *
 * The last error: a text for people and a struct for programs. A call that fails records its error
 * for the calling thread and for the context; a call that succeeds does not clear it.
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

// Text of the last error of the calling thread: which function, what was expected, what was
// received, what to do.
//
// `buffer`: `capacity` bytes, gets the text in UTF-8 with a NUL; may be NULL if `capacity` is 0,
// to ask for the size.
// `needed`: gets the size of the text with its NUL; may be NULL.
//
// Errors of this function do not change the last error.
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (a negative capacity),
// LAHAR_ERROR_BUFFER_TOO_SMALL (the text is truncated).
// Thread: any
lahar_status lahar_last_error_message(char *buffer, int64_t capacity, int64_t *needed);

// The last error of the calling thread, for programs.
//
// `info`: written; the host has set `struct_size`.
//
// Errors of this function do not change the last error.
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE.
// Thread: any
lahar_status lahar_last_error_info(lahar_error_info *info);

// Text of the last error of any call on this context, its worlds, materials and views, from any
// thread.
//
// `buffer`, `capacity`, `needed`: as in lahar_last_error_message.
//
// Errors of this function do not change the last error.
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (a negative capacity),
// LAHAR_ERROR_BUFFER_TOO_SMALL (the text is truncated).
// Thread: any
lahar_status lahar_context_error_message(const lahar_context *context,
                                         char *buffer,
                                         int64_t capacity,
                                         int64_t *needed);

/* ---- model -------------------------------------------------------------------------------------
 *
 * Models: the constitutive models of the loaded plugins. Numbers such as `kinematics` are the
 * constants of lahar_plugin.h.
 */

// A constitutive model. The texts are static.
typedef struct lahar_model_info {
    // sizeof(lahar_model_info); set by the host.
    uint32_t struct_size;
    // Measure of deformation that the model takes: one of LAHAR_KINEMATICS_* of lahar_plugin.h.
    int32_t kinematics;
    // Name, for lahar_material_create.
    const char *name;
    // One sentence.
    const char *summary;
    // Publication of the model.
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
    // One of LAHAR_PARAMETER_* of lahar_plugin.h: a real, a whole number, or a choice given by its
    // position 0, 1, ...
    int32_t kind;
    // 1: must be given; 0: `default_value` is used.
    int32_t required;
    // 0.
    int32_t reserved;
    // Name, for lahar_material_create.
    const char *name;
    // Symbol used in the literature.
    const char *symbol;
    // SI unit; values are in the units of the host.
    const char *unit;
    // One sentence.
    const char *description;
    // Labels of a choice, separated by '|'; empty for other kinds.
    const char *choices;
    // Value if none is given; of a required parameter a typical value in SI units, or 0.
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

// A state variable of a model. Bodies of such a material have a particle field with this name. The
// texts are static.
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
// `models`: gets the number.
// Errors: LAHAR_ERROR_NULL_ARGUMENT.
// Thread: any
lahar_status lahar_context_model_count(const lahar_context *context, int64_t *models);

// Describes a model.
//
// `model`: 0 to lahar_context_model_count - 1, in the order of loading.
// `info`: written; the host has set `struct_size`.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_NOT_FOUND (the index).
// Thread: any
lahar_status lahar_context_model_info(const lahar_context *context,
                                      int64_t model,
                                      lahar_model_info *info);

// Index of the model of this name.
//
// `name`: NUL-terminated, UTF-8.
// `model`: gets the index.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (a text that is too long or not
// UTF-8), LAHAR_ERROR_UNKNOWN_NAME (the message names the closest one).
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
 * Materials: a model with values of its parameters. A material may be used by many bodies and
 * worlds.
 */

// A model with values of its parameters. Freed by lahar_material_free; existing
// bodies do not need it.
typedef struct lahar_material lahar_material;

// Makes a material from named values. Parameters that are not named have their defaults.
//
// `model`: name of a model of a loaded plugin.
// `count`, `names`, `values`: the parameters that are given, `count` of each, in the host's
// units; NULL is allowed if `count` is 0.
// `material`: set to the new handle, or to NULL on failure; the host frees it with
// lahar_material_free.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (a text that is too long or not
// UTF-8; `count`; a parameter that is given twice or not finite), LAHAR_ERROR_UNKNOWN_NAME (the
// message names the closest one), LAHAR_ERROR_MISSING_PARAMETER, LAHAR_ERROR_OUT_OF_BOUNDS,
// LAHAR_ERROR_OUT_OF_MEMORY.
// Thread: any
lahar_status lahar_material_create(lahar_context *context,
                                   const char *model,
                                   int64_t count,
                                   const char *const *names,
                                   const double *values,
                                   lahar_material **material);

// Frees the handle; bodies of the material remain valid. NULL is ignored.
// Thread: owner
void lahar_material_free(lahar_material *material);

// Value of a parameter, given or default.
//
// `value`: gets the value, in the unit of lahar_parameter_info.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (a text that is too long or not
// UTF-8), LAHAR_ERROR_UNKNOWN_NAME (the message names the closest one).
// Thread: any
lahar_status lahar_material_value(const lahar_material *material,
                                  const char *parameter,
                                  double *value);

/* ---- world -------------------------------------------------------------------------------------
 *
 * Worlds: a background grid with its bodies and walls, and time.
 *
 * Vectors of fixed size have three components; in two dimensions the third is ignored, or 0 in a
 * result. Any consistent units may be used; those named are SI. In two dimensions a world is plane
 * strain and 1 m thick.
 *
 * All bodies share the one velocity field of the grid: bodies that come within a cell or two of
 * each other are welded, and neither slide nor part freely. There is no contact between them yet.
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

// Next to walls shape functions are as everywhere; all nodes in reach of a wall feel it.
// With B-splines a layer of up to a cell moves with the wall: fluids drain into it.
#define LAHAR_WALLS_PLAIN 0

// Next to walls shape functions are modified: linear fields are reproduced up to the wall,
// which acts where it stands, on a node plane or not (default). Of several walls on a side
// of an axis the innermost counts; facing ones must be half a cell apart.
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

// A background grid with its bodies and walls. Freed by lahar_world_free; it lives as
// long as one of its views.
typedef struct lahar_world lahar_world;

// What a world is made from. Fill it with lahar_world_options_init, then set `spacing` and what
// differs from the defaults.
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
    // Distance of the grid's nodes [m], > 0; has no default. Positions further than 1e8 spacings
    // from `origin` or from x = 0 are refused.
    double spacing;
    // Position of the node with index (0, 0, 0) [m], shape [3]; default 0.
    double origin[3];
    // Rate at which PIC replaces FLIP in LAHAR_TRANSFER_PIC_FLIP [1/s], >= 0: 0 is FLIP (default),
    // infinity is PIC.
    double pic_rate;
    // Courant number of the stable time step [-], in (0, 1]; default 0.4.
    double cfl;
    // Gravity [m/s^2], shape [3]; default 0.
    double gravity[3];
    // Local non-viscous damping alpha [-], in [0, 1); default 0. For statics only: it takes the
    // part alpha of every acceleration along the velocity, so that a body in free fall falls with
    // (1 - alpha) g.
    double damping;
    // Lower corner of the box of LAHAR_GRID_STATIC [m], shape [3].
    double box_min[3];
    // Upper corner of the box of LAHAR_GRID_STATIC [m], shape [3]. Particles on the faces are inside,
    // and so are those that round-off, 1e-9 of the spacing, put beside them.
    double box_max[3];
    // One of LAHAR_WALLS_*.
    int32_t wall_treatment;
    // 1: axial symmetry about the y axis, in two dimensions only: x is the radius, and volumes,
    // masses and forces are per radian; default 0. Gravity must act along y. The axis needs a slip
    // wall at x = 0: if a particle crosses the axis, the next step is refused.
    int32_t axisymmetric;
    // Terms of the filter of LAHAR_TRANSFER_XPIC and LAHAR_TRANSFER_FMPM, 1 (as PIC) to 20, or 0
    // for the default, 2. Each term costs one more transfer to the grid and back.
    int32_t filter_order;
    // 1: particles carry a field `body_force` [N/kg], added to gravity; default 0.
    int32_t body_force;
    // How often a step is repeated with a smaller length when a material fails or asks for a
    // smaller step, 0 (default) to 20. If the host gave the length of the step, or if the
    // repetitions do not help, nothing is changed and LAHAR_ERROR_SMALLER_STEP is returned. Above
    // 0 the particles are copied in each step, which costs time and memory. With 0 a failure
    // poisons the world, and a material that asks for a smaller step shortens the next one.
    int32_t retries;
    // Must be 0.
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
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_INVALID_ARGUMENT (the
// message names the option), LAHAR_ERROR_UNSUPPORTED (options that cannot be combined; the message
// names the nearest ones that can), LAHAR_ERROR_OUT_OF_MEMORY.
// Thread: any
lahar_status lahar_world_create(lahar_context *context,
                                const lahar_world_options *options,
                                lahar_world **world);

// Frees the handle. The memory is freed together with the last view. NULL is ignored.
// Thread: owner
void lahar_world_free(lahar_world *world);

// Sets constant gravity from the next step on. It also replaces gravity by a table, see
// lahar_world_set_gravity_table.
//
// `gravity`: [m/s^2], shape [3], finite.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (not finite), LAHAR_ERROR_BUSY,
// LAHAR_ERROR_UNSUPPORTED (radial, in axial symmetry), LAHAR_ERROR_POISONED.
// Thread: owner
lahar_status lahar_world_set_gravity(lahar_world *world, const double gravity[3]);

// Sets the local non-viscous damping from the next step on. It slows all motion, free fall too:
// set it back to 0 before dynamics.
//
// `damping`: [-], in [0, 1).
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT, LAHAR_ERROR_BUSY,
// LAHAR_ERROR_POISONED.
// Thread: owner
lahar_status lahar_world_set_damping(lahar_world *world, double damping);

// One step of the given length.
//
// `dt`: [s], > 0 and not above lahar_world_stable_dt.
//
// If an error poisons the world, lahar_last_error_info gives the body, the particle, the step and
// the time.
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (dt, also if it is so small that
// time + dt equals time), LAHAR_ERROR_VIEW_OPEN (a write view is open), LAHAR_ERROR_BUSY,
// LAHAR_ERROR_STEP_TOO_LARGE (the stable step is in `suggested_dt` of lahar_last_error_info),
// LAHAR_ERROR_NON_FINITE_INPUT (the host wrote an invalid value), LAHAR_ERROR_OUTSIDE_GRID (a
// particle is outside the box of a static grid, too far away, or beyond the axis of symmetry; the
// world cannot step until the host writes other positions or removes the body),
// LAHAR_ERROR_SMALLER_STEP (only with the option `retries`: a material failed or asks for a smaller
// step; its length is in `suggested_dt` of lahar_last_error_info), LAHAR_ERROR_MATERIAL_REFUSED (a
// material gives no wave speed, or would forget the stress that was given, see lahar_body_write),
// LAHAR_ERROR_THREADS (the process was forked after the threads of the context had been started),
// LAHAR_ERROR_OUT_OF_MEMORY, LAHAR_ERROR_MATERIAL_FAILED (the world is poisoned; with `retries`
// only if a model fails as a whole), LAHAR_ERROR_NON_FINITE (the world is poisoned; not with
// `retries`), LAHAR_ERROR_POISONED, LAHAR_ERROR_PLUGIN_BROKEN (the world is poisoned if that is
// found in the middle of a step).
// Thread: owner
lahar_status lahar_world_step(lahar_world *world, double dt);

// One step of the stable length.
//
// `dt`: gets the length of the step [s]; may be NULL.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (the stable step is infinite, or
// so small that time + dt equals time), LAHAR_ERROR_VIEW_OPEN (a write view is open),
// LAHAR_ERROR_BUSY, LAHAR_ERROR_NON_FINITE_INPUT (the host wrote an invalid value),
// LAHAR_ERROR_OUTSIDE_GRID (a particle is outside the box of a static grid, too far away, or beyond
// the axis of symmetry; the world cannot step until the host writes other positions or removes the
// body), LAHAR_ERROR_SMALLER_STEP (only with the option `retries`: a material failed or asks for a
// smaller step; its length is in `suggested_dt` of lahar_last_error_info),
// LAHAR_ERROR_MATERIAL_REFUSED (a material gives no wave speed, or would forget the stress that was
// given, see lahar_body_write), LAHAR_ERROR_THREADS (the process was forked after the threads of
// the context had been started), LAHAR_ERROR_OUT_OF_MEMORY, LAHAR_ERROR_MATERIAL_FAILED (the world
// is poisoned; with `retries` only if a model fails as a whole), LAHAR_ERROR_NON_FINITE (the world
// is poisoned; not with `retries`), LAHAR_ERROR_POISONED, LAHAR_ERROR_PLUGIN_BROKEN (the world is
// poisoned if that is found in the middle of a step).
// Thread: owner
lahar_status lahar_world_step_auto(lahar_world *world, double *dt);

// Makes steps of the stable length until a time is reached; the last two are shortened to reach it
// exactly.
//
// `until`: time to reach [s], not before the present one.
// `max_steps`: largest number of steps, >= 0; INT64_MAX for no limit. To stop early for this
// reason is no error.
// `steps_done`: gets the number of committed steps, also if a step fails; may be NULL.
// `time`: gets the time that was reached [s], also if a step fails; may be NULL.
//
// A positive status means that no partial step was committed.
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (`until` is not finite or in the
// past; `max_steps` is negative; the stable step becomes so small that time + dt equals time),
// LAHAR_ERROR_VIEW_OPEN (a write view is open), LAHAR_ERROR_BUSY, LAHAR_ERROR_NON_FINITE_INPUT (the
// host wrote an invalid value), LAHAR_ERROR_OUTSIDE_GRID (a particle is outside the box of a static
// grid, too far away, or beyond the axis of symmetry; the world cannot step until the host writes
// other positions or removes the body), LAHAR_ERROR_SMALLER_STEP (only with the option `retries`: a
// material failed or asks for a smaller step; its length is in `suggested_dt` of
// lahar_last_error_info), LAHAR_ERROR_MATERIAL_REFUSED (a material gives no wave speed, or would
// forget the stress that was given, see lahar_body_write), LAHAR_ERROR_CANCELLED (see
// lahar_world_set_progress), LAHAR_ERROR_THREADS (the process was forked after the threads of the
// context had been started), LAHAR_ERROR_OUT_OF_MEMORY, LAHAR_ERROR_MATERIAL_FAILED (the world is
// poisoned; with `retries` only if a model fails as a whole), LAHAR_ERROR_NON_FINITE (the world is
// poisoned; not with `retries`), LAHAR_ERROR_POISONED, LAHAR_ERROR_PLUGIN_BROKEN (the world is
// poisoned if that is found in the middle of a step).
// Thread: owner
lahar_status lahar_world_advance(lahar_world *world,
                                 double until,
                                 int64_t max_steps,
                                 int64_t *steps_done,
                                 double *time);

// Longest step that is stable now.
//
// `dt`: gets the length [s]; infinity without particles. It is the largest dt, over all particles,
// with (c + |v| + |g| dt) dt <= cfl h and dt <= cfl h^2 / (2 D nu), and not longer than the step
// that the materials ask for; c is the wave speed, v the velocity of the particle, g gravity, h
// the spacing, D the dimension, nu the kinematic viscosity. Of gravity by a table the largest
// value in the step is used. A prescribed velocity V adds the condition |V| dt <= cfl h.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_BUSY, LAHAR_ERROR_MATERIAL_REFUSED (a material
// gives no wave speed), LAHAR_ERROR_OUT_OF_MEMORY.
// Thread: callback-ok
lahar_status lahar_world_stable_dt(const lahar_world *world, double *dt);

// Time of the world.
//
// `time`: gets the time [s].
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_world_time(const lahar_world *world, double *time);

// Number of committed steps.
//
// `steps`: gets the number.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_world_step_count(const lahar_world *world, int64_t *steps);

// Length of the last committed step.
//
// `dt`: gets the length [s]; 0 before the first step.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_world_last_dt(const lahar_world *world, double *dt);

/* ---- body --------------------------------------------------------------------------------------
 *
 * Bodies: particles of one material. They are made from the host's arrays or from shapes, and
 * named by ids that are counted from 0 and never used again.
 */

// An array of the host with any layout: component c of point k is
// data[c * component_stride + k * point_stride].
typedef struct lahar_array {
    // First value; NULL: not given. Read during the call only.
    const double *data;
    // Distance between two components of a point, in doubles. If both strides are 0, the array is
    // interleaved: point after point.
    int64_t component_stride;
    // Distance between two points, in doubles.
    int64_t point_stride;
} lahar_array;

// Particles from the host's arrays. Fill it with lahar_particles_init, then set `count`,
// `position`, `volume`, and either `mass` or `density`.
typedef struct lahar_particles {
    // sizeof(lahar_particles); set by lahar_particles_init.
    uint32_t struct_size;
    // Must be 0.
    int32_t reserved;
    // Number of particles.
    int64_t count;
    // Positions [m], shape [count, dimension]; at most 1e8 spacings from the grid's origin and
    // from x = 0.
    lahar_array position;
    // Volumes [m^3], shape [count], > 0; in two dimensions areas times 1 m.
    lahar_array volume;
    // Masses [kg], shape [count], > 0; not given: `density` times volume.
    lahar_array mass;
    // Velocities [m/s], shape [count, dimension]; not given: 0.
    lahar_array velocity;
    // Cauchy stresses xx, yy, zz, xy, yz, zx [Pa], tension positive, shape [count, 6]; not given:
    // 0. Those that the model would forget are refused by the next step, see lahar_body_write.
    lahar_array stress;
    // Mass density [kg/m^3], > 0; used if `mass` is not given.
    double density;
    // Edge lengths of the particles' domains [m], shape [count, dimension], > 0; not given:
    // unknown. The GIMP shape functions and tractions on the body need them.
    lahar_array size;
} lahar_particles;

// How a shape is filled with particles. Fill it with lahar_fill_init, then set either `density` or
// `mass`.
typedef struct lahar_fill {
    // sizeof(lahar_fill); set by lahar_fill_init.
    uint32_t struct_size;
    // Particles per cell of the grid along each axis, >= 1; default 2.
    int32_t particles_per_cell;
    // Mass density [kg/m^3], > 0; 0: not given. Each lattice point inside the shape is a particle
    // with the volume of its lattice cell. The mass of the body is then exact for a box; for a
    // sphere with a radius of one spacing it may be 10 % off.
    double density;
    // Mass of the whole body [kg], > 0; 0: not given. Divided evenly among the particles, so that
    // it is exact.
    double mass;
    // Velocity of all particles [m/s], shape [3]; default 0.
    double velocity[3];
    // Cauchy stress of all particles xx, yy, zz, xy, yz, zx [Pa], tension positive, shape [6];
    // default 0. One that the model would forget is refused by the next step, see
    // lahar_body_write.
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
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_INVALID_ARGUMENT (a value
// that is not finite, not positive or too far away; counts and strides), LAHAR_ERROR_VIEW_OPEN (any
// view is open), LAHAR_ERROR_BUSY, LAHAR_ERROR_MATERIAL_REFUSED (the model refuses the stress),
// LAHAR_ERROR_OUT_OF_MEMORY, LAHAR_ERROR_POISONED, LAHAR_ERROR_PLUGIN_BROKEN (nothing has changed).
// Thread: owner
lahar_status lahar_body_add_particles(lahar_world *world,
                                      const lahar_material *material,
                                      const lahar_particles *particles,
                                      int64_t *body);

// Adds a body that fills a box.
//
// `min`, `max`: corners [m], shape [3]. Particles are placed on a regular lattice,
// `particles_per_cell` along each axis.
// `fill`: density or mass, velocity, stress. `body`: gets the id of the new body; must not be
// NULL.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_INVALID_ARGUMENT (a value
// that is not finite, not positive or too far away), LAHAR_ERROR_VIEW_OPEN (any view is open),
// LAHAR_ERROR_BUSY, LAHAR_ERROR_MATERIAL_REFUSED (the model refuses the stress),
// LAHAR_ERROR_OUT_OF_MEMORY, LAHAR_ERROR_POISONED, LAHAR_ERROR_PLUGIN_BROKEN (nothing has changed).
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
// `fill`: density or mass, velocity, stress. With `density` the mass may be 10 % off if the
// radius is one spacing (see lahar_fill); give `mass` for an exact one.
// `body`: gets the id of the new body; must not be NULL.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_INVALID_ARGUMENT (a value
// that is not finite, not positive or too far away), LAHAR_ERROR_VIEW_OPEN (any view is open),
// LAHAR_ERROR_BUSY, LAHAR_ERROR_MATERIAL_REFUSED (the model refuses the stress),
// LAHAR_ERROR_OUT_OF_MEMORY, LAHAR_ERROR_POISONED, LAHAR_ERROR_PLUGIN_BROKEN (nothing has changed).
// Thread: owner
lahar_status lahar_body_add_sphere(lahar_world *world,
                                   const lahar_material *material,
                                   const double center[3],
                                   double radius,
                                   const lahar_fill *fill,
                                   int64_t *body);

// Adds a body that fills a simple polygon; two dimensions only.
//
// `count`: number of vertices, >= 3. `vertices`: [m], shape [count, 2], point after point,
// clockwise or counter-clockwise.
// `fill`: density or mass, velocity, stress. With `density` the mass is approximate (see
// lahar_fill); give `mass` for an exact one.
// `body`: gets the id of the new body; must not be NULL.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_INVALID_ARGUMENT (a value
// that is not finite, not positive or too far away; no simple polygon), LAHAR_ERROR_VIEW_OPEN (any
// view is open), LAHAR_ERROR_BUSY, LAHAR_ERROR_UNSUPPORTED (three dimensions),
// LAHAR_ERROR_MATERIAL_REFUSED (the model refuses the stress), LAHAR_ERROR_OUT_OF_MEMORY,
// LAHAR_ERROR_POISONED, LAHAR_ERROR_PLUGIN_BROKEN (nothing has changed).
// Thread: owner
lahar_status lahar_body_add_polygon(lahar_world *world,
                                    const lahar_material *material,
                                    int64_t count,
                                    const double *vertices,
                                    const lahar_fill *fill,
                                    int64_t *body);

// Removes a body. Its id is not used again.
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_NOT_FOUND (the body), LAHAR_ERROR_VIEW_OPEN (any
// view is open), LAHAR_ERROR_BUSY, LAHAR_ERROR_POISONED.
// Thread: owner
lahar_status lahar_body_remove(lahar_world *world, int64_t body);

// Switches F-bar on or off for a body; it is off at first.
//
// With F-bar the particles in a cell of the grid have the same rate of volume change: the trace of
// the velocity gradient is averaged, weighted by volume. Nearly incompressible and plastic
// materials then do not lock. F-bar costs one more transfer from the grid to the particles in each
// step.
//
// `on`: 1 or 0.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (`on`), LAHAR_ERROR_NOT_FOUND
// (the body), LAHAR_ERROR_VIEW_OPEN (any view is open), LAHAR_ERROR_BUSY,
// LAHAR_ERROR_OUT_OF_MEMORY, LAHAR_ERROR_POISONED.
// Thread: owner
lahar_status lahar_body_set_f_bar(lahar_world *world, int64_t body, int32_t on);

// Number of bodies.
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_world_body_count(const lahar_world *world, int64_t *bodies);

// Ids of the bodies, ascending.
//
// `capacity`, `ids`: room for so many ids; NULL and 0 to get only the count.
// `count`: gets the number of bodies.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (a negative capacity),
// LAHAR_ERROR_BUSY, LAHAR_ERROR_BUFFER_TOO_SMALL (`count` is set, the array is not touched).
// Thread: callback-ok
lahar_status lahar_world_bodies(const lahar_world *world, int64_t capacity, int64_t *ids, int64_t *count);

// Number of particles of a body.
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_NOT_FOUND (the body), LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_body_particle_count(const lahar_world *world, int64_t body, int64_t *particles);

/* ---- field -------------------------------------------------------------------------------------
 *
 * Particle fields: position, velocity, stress and so on, and every state variable of the body's
 * model, by name. The functions of this section copy, in the order of particle ids; views give
 * access to the memory itself.
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
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_NOT_FOUND (the body), LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_body_field_count(const lahar_world *world, int64_t body, int64_t *fields);

// Describes a field of a body.
//
// `field`: 0 to lahar_body_field_count - 1.
// `info`: written; the host has set `struct_size`.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_NOT_FOUND (the body or
// the index), LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_body_field_info(const lahar_world *world,
                                   int64_t body,
                                   int64_t field,
                                   lahar_field_info *info);

// Index of the field of this name.
//
// `field`: gets the index.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (a text that is too long or not
// UTF-8), LAHAR_ERROR_UNKNOWN_NAME (the message names the closest one), LAHAR_ERROR_NOT_FOUND (the
// body), LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_body_find_field(const lahar_world *world, int64_t body, const char *name, int64_t *field);

// Copies a field to the host, in the order of particle ids.
//
// `count`: number of particles of the body.
// `values`: component c of particle k is written to values[c * component_stride + k *
// point_stride], in the unit of the field. If both strides are 0, the array is interleaved, shape
// [count, components].
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (a text that is too long or not
// UTF-8; `count`, strides), LAHAR_ERROR_UNKNOWN_NAME (the message names the closest one),
// LAHAR_ERROR_NOT_FOUND (the body), LAHAR_ERROR_BUSY, LAHAR_ERROR_BUFFER_TOO_SMALL (`count`).
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
// A value that is not finite is refused by this call, and nothing is written. Masses and volumes
// that are not positive and positions outside the grid are found by the next step, which returns
// LAHAR_ERROR_NON_FINITE_INPUT until the host writes valid ones.
//
// A stress that the model would forget is found by the next step too: that of a hyperelastic solid
// follows from `deformation_gradient`, that of a fluid from its state, that of a gas from
// `strain_energy`. The step returns LAHAR_ERROR_MATERIAL_REFUSED until the stress that was given
// (here, in a view, or when the body was added) is the one that follows; the message says what to
// write or call. A stress beyond the yield surface is returned to it, with a warning in the log.
// The viscous stress of a body that moves is not checked.
//
// `count`, `values`, strides: as in lahar_body_read.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (a text that is too long or not
// UTF-8; `count`, strides, a value that is not finite), LAHAR_ERROR_UNKNOWN_NAME (the message names
// the closest one), LAHAR_ERROR_NOT_FOUND (the body), LAHAR_ERROR_BUSY, LAHAR_ERROR_READ_ONLY,
// LAHAR_ERROR_BUFFER_TOO_SMALL (`count`), LAHAR_ERROR_OUT_OF_MEMORY, LAHAR_ERROR_POISONED.
// Thread: owner
lahar_status lahar_body_write(lahar_world *world,
                              int64_t body,
                              const char *field,
                              int64_t count,
                              const double *values,
                              int64_t component_stride,
                              int64_t point_stride);

// Ids of a body's particles in storage order, the order of views: the k-th value of a view belongs
// to ids[k]. If bodies were added or removed since the last step, the particles are first mapped
// to the grid and may be reordered by that.
//
// `capacity`, `ids`: room for so many ids; NULL and 0 to get only the count.
// `count`: gets the number of particles.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (a negative capacity),
// LAHAR_ERROR_NOT_FOUND (the body), LAHAR_ERROR_VIEW_OPEN (a write view is open, and particles have
// to be mapped to the grid), LAHAR_ERROR_BUSY, LAHAR_ERROR_BUFFER_TOO_SMALL (`count` is set, the
// array is not touched), LAHAR_ERROR_OUTSIDE_GRID (as in lahar_world_step, if particles have to be
// mapped), LAHAR_ERROR_THREADS (as in lahar_world_step, if particles have to be mapped),
// LAHAR_ERROR_OUT_OF_MEMORY.
// Thread: callback-ok
lahar_status lahar_body_ids(const lahar_world *world,
                            int64_t body,
                            int64_t capacity,
                            int64_t *ids,
                            int64_t *count);

/* ---- view --------------------------------------------------------------------------------------
 *
 * Views: the memory of a particle field itself, in storage order (see lahar_body_ids). The host
 * frees each view.
 */

// Access of a view: read. The view becomes stale when particles may have been reordered: by a
// step, or by a query that maps the grid anew.
#define LAHAR_ACCESS_READ 0

// Access of a view: read and write. No step is possible while it is open.
#define LAHAR_ACCESS_WRITE 1

// A view of a field. Freed by lahar_view_free; the world lives at least as long.
typedef struct lahar_view lahar_view;

// The data of a view.
typedef struct lahar_view_info {
    // sizeof(lahar_view_info); set by the host.
    uint32_t struct_size;
    // Number of components per particle.
    int32_t components;
    // Component c of particle k, in storage order, is data[c * stride + k], in the unit of the
    // field (lahar_field_info). Must not be written through a view with LAHAR_ACCESS_READ. The
    // memory stays valid until the view is freed.
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
// While any view is open, bodies cannot be added or removed; while a write view is open, the world
// cannot step, and a query of the grid is refused if it would have to map the grid anew. What is
// written through a view counts once all write views of the world are freed; it is checked before
// the next step. If bodies were added or removed since the last step, opening a view first maps
// the particles to the grid; they may be reordered by that.
//
// `access`: LAHAR_ACCESS_READ or LAHAR_ACCESS_WRITE.
// `view`: set to the new handle, or to NULL on failure; the host frees it with lahar_view_free.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (a text that is too long or not
// UTF-8; `access`), LAHAR_ERROR_UNKNOWN_NAME (the message names the closest one),
// LAHAR_ERROR_NOT_FOUND (the body), LAHAR_ERROR_VIEW_OPEN (a write view is open, and particles have
// to be mapped to the grid), LAHAR_ERROR_BUSY, LAHAR_ERROR_READ_ONLY, LAHAR_ERROR_OUTSIDE_GRID (as
// in lahar_world_step, if particles have to be mapped), LAHAR_ERROR_THREADS (as in
// lahar_world_step, if particles have to be mapped), LAHAR_ERROR_OUT_OF_MEMORY,
// LAHAR_ERROR_POISONED (write access).
// Thread: owner
lahar_status lahar_body_view(lahar_world *world,
                             int64_t body,
                             const char *field,
                             int32_t access,
                             lahar_view **view);

// Address and layout of the data of a view.
//
// `info`: written; the host has set `struct_size`.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_VIEW_STALE (a read view:
// particles may have been reordered since it was opened), LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_view_data(const lahar_view *view, lahar_view_info *info);

// Closes the view and frees the handle. Its data must not be used any more. NULL is ignored.
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

// A plane wall. Fill it with lahar_wall_init, then set what differs from the defaults.
//
// A wall acts where it stands, at any position on the grid, and the material should be in front of
// it; the whole half-space behind is held. Of several walls on a side of an axis the innermost
// counts; two that face each other must be half a cell apart. The order in which walls are added
// does not matter. (With LAHAR_WALLS_PLAIN a wall acts on every node whose signed distance from
// it, positive on the side of the material, is at most 0 for linear shapes and GIMP, h/2 for
// quadratic and h for cubic splines, with the spacing h: right on node planes for linear shapes
// and between two for quadratic ones, up to h too late elsewhere.)
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
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_INVALID_ARGUMENT,
// LAHAR_ERROR_BUSY, LAHAR_ERROR_UNSUPPORTED (LAHAR_WALLS_MODIFIED: less than half a cell from a
// wall that faces it), LAHAR_ERROR_OUT_OF_MEMORY, LAHAR_ERROR_POISONED.
// Thread: owner
lahar_status lahar_wall_add(lahar_world *world, const lahar_wall *wall, int64_t *id);

// Removes a wall. Its id is not used again.
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_NOT_FOUND (no condition of this kind has the id),
// LAHAR_ERROR_BUSY, LAHAR_ERROR_POISONED.
// Thread: owner
lahar_status lahar_wall_remove(lahar_world *world, int64_t id);

// Force of a wall on the material in the last step; 0 before the first step with the wall.
//
// `force`: written [N], shape [3].
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_NOT_FOUND (no condition of this kind has the id),
// LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_wall_reaction(const lahar_world *world, int64_t id, double force[3]);

/* ---- table -------------------------------------------------------------------------------------
 *
 * Tables of the host: values over time, piecewise linear between the rows. The first row also
 * holds before its time, the last row also after its time.
 */

// A table over time. Times must increase, and all numbers must be finite.
typedef struct lahar_table {
    // Number of rows; 0: no table, the condition is constant.
    int64_t count;
    // Times [s], shape [count]. Read during the call only.
    const double *times;
    // Values; unit and shape are given where the table is used. Read during the call only.
    const double *values;
} lahar_table;

/* ---- prescribed_velocity -----------------------------------------------------------------------
 *
 * Velocities prescribed on regions of the grid, constant or by a table over time, named by ids
 * that are never used again.
 */

// Component of a vector: x.
#define LAHAR_COMPONENT_X 1

// Component of a vector: y.
#define LAHAR_COMPONENT_Y 2

// Component of a vector: z.
#define LAHAR_COMPONENT_Z 4

// A velocity that the nodes in a box have at the end of every step, whatever pulls at them. Fill
// it with lahar_prescribed_velocity_init, then set `components`, the box, and `velocity` or
// `table`.
//
// The box is fixed in space and selects nodes, not particles: the velocity is prescribed to
// whatever moves through the box. It is applied after the walls. Where boxes overlap, the one that
// was added last counts.
typedef struct lahar_prescribed_velocity {
    // sizeof(lahar_prescribed_velocity); set by lahar_prescribed_velocity_init.
    uint32_t struct_size;
    // The components that are prescribed, a sum of LAHAR_COMPONENT_*; has no default. The others
    // stay free.
    int32_t components;
    // Lower corner of the box [m], shape [3]; may be -infinity; has no default. Nodes on its
    // faces, within 1e-9 spacings, are inside.
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

// Adds a prescribed velocity. It limits the stable time step: a node moves at most `cfl` spacings
// in a step.
//
// `condition`: copied, with its table. `id`: gets the id; may be NULL.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_INVALID_ARGUMENT
// (components; a box that is not set or inverted; a velocity that is not finite; a row of the
// table), LAHAR_ERROR_BUSY, LAHAR_ERROR_OUT_OF_MEMORY, LAHAR_ERROR_POISONED.
// Thread: owner
lahar_status lahar_prescribed_velocity_add(lahar_world *world,
                                           const lahar_prescribed_velocity *condition,
                                           int64_t *id);

// Removes a prescribed velocity. Its id is not used again.
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_NOT_FOUND (no condition of this kind has the id),
// LAHAR_ERROR_BUSY, LAHAR_ERROR_POISONED.
// Thread: owner
lahar_status lahar_prescribed_velocity_remove(lahar_world *world, int64_t id);

// Force of a prescribed velocity on the material in the last step: the momentum that it added,
// divided by the time step; 0 before the first step with it.
//
// `force`: written [N], shape [3].
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_NOT_FOUND (no condition of this kind has the id),
// LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_prescribed_velocity_reaction(const lahar_world *world, int64_t id, double force[3]);

/* ---- traction ----------------------------------------------------------------------------------
 *
 * Tractions on the surfaces of bodies, constant or by a table over time, named by ids that are
 * never used again.
 */

// A traction on a plane surface of a body. Fill it with lahar_traction_init, then set `body`, the
// normal, the box and the traction.
//
// It is a dead load: a force per area of the surface as it was when the body was added, in a fixed
// direction. The particles whose centres are in the box when the traction is added carry it from
// then on, wherever they move. The box must contain only the outermost layer of particles, whose
// centres are half a particle's edge below the surface. Each particle passes its share to the grid
// at its outer face and not at its centre, so that the stress is right up to the last cell. In two
// dimensions the surface is 1 m wide, or one radian with axial symmetry. The edge lengths of the
// particles must be known: of a body that was added as a shape they are, for arrays give them in
// `size` of lahar_particles.
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
    // The traction vector [Pa], shape [3], finite; default 0. A pressure p on a surface whose
    // normal points to larger y is (0, -p, 0).
    double traction[3];
    // Factors of the traction over time: values [-], shape [count]. Default: no table, the factor
    // is 1.
    lahar_table factors;
} lahar_traction;

// Fills the struct with its defaults.
//
// `size`: sizeof(lahar_traction).
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE.
// Thread: any
lahar_status lahar_traction_init(lahar_traction *traction, int64_t size);

// Adds a traction. It is removed together with its body.
//
// `traction`: copied, with its table. `id`: gets the id; may be NULL.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_INVALID_ARGUMENT (the
// normal; a box that is not set, inverted, without a particle, or with particles behind one another
// along the normal; particles whose edge lengths are not known; a traction that is not finite; a
// row of the table), LAHAR_ERROR_NOT_FOUND (the body), LAHAR_ERROR_BUSY, LAHAR_ERROR_OUT_OF_MEMORY,
// LAHAR_ERROR_POISONED.
// Thread: owner
lahar_status lahar_traction_add(lahar_world *world, const lahar_traction *traction, int64_t *id);

// Removes a traction. Its id is not used again.
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_NOT_FOUND (no condition of this kind has the id),
// LAHAR_ERROR_BUSY, LAHAR_ERROR_POISONED.
// Thread: owner
lahar_status lahar_traction_remove(lahar_world *world, int64_t id);

// What a traction loads, and with which force.
//
// `particles`: gets the number of particles that carry it; may be NULL.
// `area`: gets the area of the loaded surface [m^2]; may be NULL.
// `force`: written, the force on the body in the last step [N], shape [3]; 0 before the first step
// with the traction. Queries of the grid do not change it.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_NOT_FOUND (no condition of this kind has the id),
// LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_traction_force(const lahar_world *world,
                                  int64_t id,
                                  int64_t *particles,
                                  double *area,
                                  double force[3]);

/* ---- progress ----------------------------------------------------------------------------------
 *
 * Progress: the host is called between steps, and may cancel what is left of them.
 */

// Is told how far lahar_world_advance or lahar_world_settle is: the number of steps that the call
// has committed, the time of the world [s], and the pointer given to lahar_world_set_progress.
// Returns 0 to go on; anything else cancels the call with LAHAR_ERROR_CANCELLED. Called on the
// thread that called lahar, in the host's floating-point environment, between two steps. It may call
// functions tagged `callback-ok` or `any`, on this world too, for instance lahar_world_write_vtp;
// functions that change the world return LAHAR_ERROR_BUSY. It must not unwind, throw or longjmp.
typedef int32_t (*lahar_progress_callback)(int64_t steps_done, double time, void *user);

// Sets who is called between the steps of lahar_world_advance and lahar_world_settle, and may cancel
// them. Results do not depend on it. A host with an interpreter lets it look for signals there.
//
// `callback`: see lahar_progress_callback; NULL: nobody is called.
// `user`: passed to the callback; lahar does not follow it. Both must stay valid until they are
// replaced by another call or the world is freed, and until calls that run meanwhile have returned.
// `interval`: shortest time between two calls [s of the clock on the wall], >= 0, finite; 0: after
// every step. A step is never interrupted, so that the callback comes late by up to a step.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (`interval`).
// Thread: any
lahar_status lahar_world_set_progress(lahar_world *world,
                                      lahar_progress_callback callback,
                                      void *user,
                                      double interval);

/* ---- statics -----------------------------------------------------------------------------------
 *
 * Statics by dynamics: gravity by a table, the distance of a world from equilibrium, steps until
 * equilibrium is reached, initial stresses.
 */

// Steps between two checks of the equilibrium in lahar_world_settle.
#define LAHAR_STEPS_BETWEEN_CHECKS 50

// How far a world is from equilibrium.
typedef struct lahar_equilibrium {
    // sizeof(lahar_equilibrium); set by the host.
    uint32_t struct_size;
    // 0.
    int32_t reserved;
    // Sum of m v^2 / 2 of the particles [J].
    double kinetic_energy;
    // Strain energy of the particles [J], as in lahar_totals.
    double strain_energy;
    // kinetic_energy divided by the energy of the stresses [-]. The latter is the larger of
    // |strain_energy| and the sum of V s:s / (2 rho c^2) over the particles, with the volume V, the
    // stress s, the density rho and the largest wave speed c; the sum includes initial stresses. 0
    // at rest.
    double kinetic_ratio;
    // Sum of |F| over the nodes [N]: F is the force of stresses, tractions and gravity that
    // neither walls nor prescribed velocities take up. Damping is not included: it is 0 in
    // equilibrium.
    double unbalanced_force;
    // Load on the world [N]: the sum over the nodes of m |g|, plus the forces of the tractions,
    // plus the sum over the nodes of the reactions of prescribed velocities. If all these are 0,
    // the sum of the reactions of walls.
    double external_force;
    // unbalanced_force divided by external_force [-]; 0 if unbalanced_force is 0.
    double unbalanced_ratio;
} lahar_equilibrium;

// Criteria for a world to be settled. Fill it with lahar_settle_criteria_init.
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
    // Time of the world at which to stop without equilibrium [s], later than now; default
    // infinity.
    double until;
} lahar_settle_criteria;

// What lahar_world_settle did.
typedef struct lahar_settle_result {
    // sizeof(lahar_settle_result); set by the host.
    uint32_t struct_size;
    // 1: both criteria are met; 0: `max_steps` or `until` was reached before.
    int32_t converged;
    // Number of committed steps.
    int64_t steps;
    // Time that was reached [s].
    double time;
    // `kinetic_ratio` of lahar_equilibrium at the last check [-].
    double kinetic_ratio;
    // `unbalanced_ratio` of lahar_equilibrium at the last check [-].
    double unbalanced_ratio;
} lahar_settle_result;

// Sets gravity by a table over time, piecewise linear, from the next step on: for a ramp or an
// earthquake. A step uses the value at the middle of the step; lahar_world_stable_dt uses the
// largest value that may occur in the step. lahar_world_set_gravity replaces the table by constant
// gravity.
//
// `count`: number of rows, at least 1. `times`: [s], shape [count], increasing. `values`: [m/s^2],
// shape [count, 3]. The first row also holds before its time, the last row also after its time. In
// two dimensions values[3 * row + 2] is ignored.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (no rows, times that do not
// increase, a value that is not finite; the message names the row), LAHAR_ERROR_BUSY,
// LAHAR_ERROR_UNSUPPORTED (radial, in axial symmetry), LAHAR_ERROR_OUT_OF_MEMORY,
// LAHAR_ERROR_POISONED.
// Thread: owner
lahar_status lahar_world_set_gravity_table(lahar_world *world,
                                           int64_t count,
                                           const double *times,
                                           const double *values);

// Reports how far a world is from equilibrium. The forces are those on the grid, which shows the
// particles and loads as they are: of the last step, or, if particle fields, tractions or bodies
// were changed since, mapped anew. Particles may be reordered by that, so that read views opened
// before become stale (LAHAR_ERROR_VIEW_STALE). What is written through a view counts once all
// write views of the world are freed. Costs less than a step.
//
// `equilibrium`: written; the host has set `struct_size`.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_VIEW_OPEN (a write view
// is open, and particles have to be mapped to the grid), LAHAR_ERROR_BUSY (also while another
// thread runs a query, if particles have to be mapped), LAHAR_ERROR_OUTSIDE_GRID (as in
// lahar_world_step, if particles have to be mapped), LAHAR_ERROR_MATERIAL_REFUSED (a material gives
// no wave speed), LAHAR_ERROR_THREADS (as in lahar_world_step, if particles have to be mapped),
// LAHAR_ERROR_OUT_OF_MEMORY.
// Thread: callback-ok
lahar_status lahar_world_equilibrium(const lahar_world *world, lahar_equilibrium *equilibrium);

// Fills the criteria with their defaults.
//
// `size`: sizeof(lahar_settle_criteria).
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE.
// Thread: any
lahar_status lahar_settle_criteria_init(lahar_settle_criteria *criteria, int64_t size);

// Makes steps of the stable length until the world is in equilibrium, or until `max_steps` or
// `until` is reached. The latter is no error: `converged` is then 0. Equilibrium is checked every
// LAHAR_STEPS_BETWEEN_CHECKS steps, and not accepted before the time of the last row of every
// table in use. Set damping with lahar_world_set_damping before, for instance 0.3 to 0.7: without
// damping the world does not come to rest.
//
// `criteria`: copied; NULL: the defaults.
// `result`: written, also if a step fails; the host has set `struct_size`; may be NULL.
//
// A positive status means that no partial step was committed.
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_INVALID_ARGUMENT
// (criteria that are not positive; both the stable step and `until` are infinite; the stable step
// becomes so small that time + dt equals time), LAHAR_ERROR_VIEW_OPEN (a write view is open),
// LAHAR_ERROR_BUSY, LAHAR_ERROR_NON_FINITE_INPUT (the host wrote an invalid value),
// LAHAR_ERROR_OUTSIDE_GRID (a particle is outside the box of a static grid, too far away, or beyond
// the axis of symmetry; the world cannot step until the host writes other positions or removes the
// body), LAHAR_ERROR_SMALLER_STEP (only with the option `retries`: a material failed or asks for a
// smaller step; its length is in `suggested_dt` of lahar_last_error_info),
// LAHAR_ERROR_MATERIAL_REFUSED (a material gives no wave speed, or would forget the stress that was
// given, see lahar_body_write), LAHAR_ERROR_CANCELLED (see lahar_world_set_progress),
// LAHAR_ERROR_THREADS (the process was forked after the threads of the context had been started),
// LAHAR_ERROR_OUT_OF_MEMORY, LAHAR_ERROR_MATERIAL_FAILED (the world is poisoned; with `retries`
// only if a model fails as a whole), LAHAR_ERROR_NON_FINITE (the world is poisoned; not with
// `retries`), LAHAR_ERROR_POISONED, LAHAR_ERROR_PLUGIN_BROKEN (the world is poisoned if that is
// found in the middle of a step).
// Thread: owner
lahar_status lahar_world_settle(lahar_world *world,
                                const lahar_settle_criteria *criteria,
                                lahar_settle_result *result);

// Sets the stresses of a body to those of level ground at rest: at the depth z below the surface
// the stress along gravity is -unit_weight z, and along the other two axes k0 times that. Shear
// stresses are 0, and above the surface all stresses are 0. The model derives its state variables
// from the stress, as when a body is added; their old values are lost.
//
// To set other initial stresses, give `stress` in lahar_particles, or write the field "stress" and
// call lahar_body_init_state.
//
// `surface_level`: coordinate of the surface along the axis of gravity [m].
// `unit_weight`: [N/m^3], > 0; or 0: mass divided by volume of the whole body, times gravity at
// the present time.
// `k0`: ratio of horizontal to vertical stress [-], >= 0.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (gravity is 0 at the present time
// or not along an axis; a value out of its range; the model refuses the stress),
// LAHAR_ERROR_NOT_FOUND (the body), LAHAR_ERROR_BUSY, LAHAR_ERROR_UNSUPPORTED (the stress of the
// model follows from the deformation gradient), LAHAR_ERROR_MATERIAL_REFUSED (the model would
// forget the stress: a fluid takes k0 = 1 alone, a gas what its energy gives),
// LAHAR_ERROR_OUT_OF_MEMORY, LAHAR_ERROR_POISONED, LAHAR_ERROR_PLUGIN_BROKEN (nothing has changed).
// Thread: owner
lahar_status lahar_body_set_k0_stress(lahar_world *world,
                                      int64_t body,
                                      double surface_level,
                                      double unit_weight,
                                      double k0);

// Makes the model of a body derive its state variables anew from the present stresses, as when the
// body was added: for instance the volume ratio of a fluid from its pressure. The old values of
// the state variables are lost. Call it after writing the field "stress".
//
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (the model refuses the stress;
// the old state stays), LAHAR_ERROR_NOT_FOUND (the body), LAHAR_ERROR_BUSY,
// LAHAR_ERROR_MATERIAL_REFUSED (the model would forget the stress, see lahar_body_write; the old
// state stays), LAHAR_ERROR_OUT_OF_MEMORY, LAHAR_ERROR_POISONED, LAHAR_ERROR_PLUGIN_BROKEN (nothing
// has changed).
// Thread: owner
lahar_status lahar_body_init_state(lahar_world *world, int64_t body);

/* ---- grid --------------------------------------------------------------------------------------
 *
 * The sparse background grid: blocks of nodes that follow the material.
 *
 * The grid shows the particles and loads as they are. After a step it holds the result of that
 * step. If particle fields, tractions or bodies were changed since, or before the first step, the
 * next query of blocks, nodes or node values maps mass, momentum and forces to the grid anew.
 * Particles may be reordered by that, so that read views opened before become stale
 * (LAHAR_ERROR_VIEW_STALE). What is written through a view counts once all write views of the
 * world are freed.
 *
 * A query that has to map the grid may also fail with LAHAR_ERROR_VIEW_OPEN (a write view is
 * open), LAHAR_ERROR_OUTSIDE_GRID, LAHAR_ERROR_OUT_OF_MEMORY or LAHAR_ERROR_THREADS, as a step
 * may. It needs the world for itself: LAHAR_ERROR_BUSY is returned also while another thread runs
 * a query. A poisoned world shows its grid as the failed call left it.
 */

// Size of the grid, and how the last step changed it.
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
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_VIEW_OPEN (a write view
// is open, and particles have to be mapped to the grid), LAHAR_ERROR_BUSY, LAHAR_ERROR_OUTSIDE_GRID
// (as in lahar_world_step, if particles have to be mapped), LAHAR_ERROR_THREADS (as in
// lahar_world_step, if particles have to be mapped), LAHAR_ERROR_OUT_OF_MEMORY.
// Thread: callback-ok
lahar_status lahar_grid_stats(const lahar_world *world, lahar_grid_statistics *statistics);

// Integer coordinates of the active blocks, in block order. Block b holds the nodes with the
// indices b * block_edge to b * block_edge + block_edge - 1 along each axis; coordinates may be
// negative.
//
// `capacity`, `coordinates`: room for so many blocks, shape [capacity, dimension]; NULL and 0 to
// get only the count.
// `count`: gets the number of active blocks.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (a negative capacity),
// LAHAR_ERROR_VIEW_OPEN (a write view is open, and particles have to be mapped to the grid),
// LAHAR_ERROR_BUSY, LAHAR_ERROR_BUFFER_TOO_SMALL (`count` is set, the array is not touched),
// LAHAR_ERROR_OUTSIDE_GRID (as in lahar_world_step, if particles have to be mapped),
// LAHAR_ERROR_THREADS (as in lahar_world_step, if particles have to be mapped),
// LAHAR_ERROR_OUT_OF_MEMORY.
// Thread: callback-ok
lahar_status lahar_grid_blocks(const lahar_world *world,
                               int64_t capacity,
                               int64_t *coordinates,
                               int64_t *count);

// Number of the node with an integer index. The number is the position of the node's block in
// block order times block_edge^dimension, plus the position of the node inside its block. It is
// valid until the next step, and until the grid is mapped anew.
//
// `index`: shape [3]; the node is at origin + index * spacing [m]. In two dimensions index[2] is
// ignored.
// `node`: gets the number, or -1 if the node is not active.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_VIEW_OPEN (a write view is open, and particles
// have to be mapped to the grid), LAHAR_ERROR_BUSY, LAHAR_ERROR_OUTSIDE_GRID (as in
// lahar_world_step, if particles have to be mapped), LAHAR_ERROR_THREADS (as in lahar_world_step,
// if particles have to be mapped), LAHAR_ERROR_OUT_OF_MEMORY.
// Thread: callback-ok
lahar_status lahar_grid_find_node(const lahar_world *world, const int64_t index[3], int64_t *node);

// Integer index of the node with a number: the inverse of lahar_grid_find_node.
//
// `node`: number of the node. `index`: written, shape [3]; in two dimensions index[2] is 0.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_NOT_FOUND (no such node), LAHAR_ERROR_VIEW_OPEN (a
// write view is open, and particles have to be mapped to the grid), LAHAR_ERROR_BUSY,
// LAHAR_ERROR_OUTSIDE_GRID (as in lahar_world_step, if particles have to be mapped),
// LAHAR_ERROR_THREADS (as in lahar_world_step, if particles have to be mapped),
// LAHAR_ERROR_OUT_OF_MEMORY.
// Thread: callback-ok
lahar_status lahar_grid_node_index(const lahar_world *world, int64_t node, int64_t index[3]);

// Number of node fields.
//
// `fields`: gets the number.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_grid_field_count(const lahar_world *world, int64_t *fields);

// Describes a node field. The number of components is that of this world's dimension.
//
// `field`: 0 to lahar_grid_field_count - 1.
// `info`: written; the host has set `struct_size`.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_NOT_FOUND (the index),
// LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_grid_field_info(const lahar_world *world, int64_t field, lahar_field_info *info);

// Copies a node field.
//
// `count`, `nodes`: numbers of nodes; NULL: all nodes of the active blocks, in block order, and
// `count` is `active_nodes` of lahar_grid_statistics.
// `values`: written, shape [count, components], in the unit of the field.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (a text that is too long or not
// UTF-8; `count`), LAHAR_ERROR_UNKNOWN_NAME (the message names the closest one),
// LAHAR_ERROR_NOT_FOUND (a node, before anything is written), LAHAR_ERROR_VIEW_OPEN (a write view
// is open, and particles have to be mapped to the grid), LAHAR_ERROR_BUSY, LAHAR_ERROR_OUTSIDE_GRID
// (as in lahar_world_step, if particles have to be mapped), LAHAR_ERROR_THREADS (as in
// lahar_world_step, if particles have to be mapped), LAHAR_ERROR_OUT_OF_MEMORY.
// Thread: callback-ok
lahar_status lahar_grid_read(const lahar_world *world,
                             const char *field,
                             int64_t count,
                             const int64_t *nodes,
                             double *values);

// Samples a node field q at points: sum of w m q over the nodes divided by the sum of w m, with
// the shape function w and the mass m of a node.
//
// `count`, `points`: [m], shape [count, dimension].
// `values`: written, shape [count, components], in the unit of the field; zeros where there is no
// material.
// `inside`: written, shape [count]: 1 where there is material, else 0; may be NULL.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (a text that is too long or not
// UTF-8; `count`; a coordinate that is not finite), LAHAR_ERROR_UNKNOWN_NAME (the message names the
// closest one), LAHAR_ERROR_VIEW_OPEN (a write view is open, and particles have to be mapped to the
// grid), LAHAR_ERROR_BUSY, LAHAR_ERROR_OUTSIDE_GRID (as in lahar_world_step, if particles have to
// be mapped), LAHAR_ERROR_THREADS (as in lahar_world_step, if particles have to be mapped),
// LAHAR_ERROR_OUT_OF_MEMORY.
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

// Stands for all bodies where the id of a body is expected.
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
    // Angular momentum about the point x = 0 [kg m^2/s], shape [3].
    double angular_momentum[3];
    // Kinetic energy [J].
    double kinetic_energy;
    // Strain energy [J]: the work of the stresses, or the stored energy if the model gives it.
    double strain_energy;
    // Potential energy, the sum of - m g . x [J], with gravity g at the present time.
    double potential_energy;
    // Centre of mass [m], shape [3]; 0 without particles.
    double center_of_mass[3];
} lahar_totals;

// Mass, momenta and energies of a body or of all.
//
// `body`: an id, or LAHAR_ALL_BODIES.
// `totals`: written; the host has set `struct_size`.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_STRUCT_SIZE, LAHAR_ERROR_NOT_FOUND (the body),
// LAHAR_ERROR_BUSY.
// Thread: callback-ok
lahar_status lahar_world_totals(const lahar_world *world, int64_t body, lahar_totals *totals);

// Writes all particles with all their fields to a VTP file (XML, compressed) for ParaView.
//
// Points are in the order of bodies and ids, whatever order they are stored in: point k of two
// files is the same particle as long as no body came or went. The time [s] is the field data
// `TimeValue`.
//
// `path`: NUL-terminated, UTF-8, ends in `.vtp`. The file is written under a temporary name and
// then renamed, so that an existing file is replaced as a whole or not at all.
// Errors: LAHAR_ERROR_NULL_ARGUMENT, LAHAR_ERROR_INVALID_ARGUMENT (a text that is too long or not
// UTF-8; it is empty or does not end in `.vtp`), LAHAR_ERROR_BUSY, LAHAR_ERROR_FILE,
// LAHAR_ERROR_OUT_OF_MEMORY.
// Thread: callback-ok
lahar_status lahar_world_write_vtp(const lahar_world *world, const char *path);

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
