/* lahar_plugin.h: the interface between lahar and constitutive models. It has types and tables only: a
 * plugin is not linked with lahar.
 *
 * Generated from plugins/abi by `cargo xtask headers`; do not edit.
 */

#ifndef LAHAR_PLUGIN_H
#define LAHAR_PLUGIN_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- plugin ------------------------------------------------------------------------------------
 *
 * The contract between lahar and a constitutive model: types and constants only.
 *
 * `include/lahar/lahar_plugin.h` is generated from this file. A plugin is a shared library that
 * exports one function, `lahar_plugin_entry_v1`, and links nothing of lahar. The number in the
 * name is the major version of the ABI; within a major version tables only grow at their end and
 * every table begins with its size.
 *
 * Conventions: the units are the host's, SI or any other consistent ones, so that a model has no
 * constant, no default and no advised bound with a dimension but 0; what it does not require
 * follows from other parameters. Tension positive; symmetric tensors are stored as the tensor
 * components xx, yy, zz, xy, yz, zx; general 3x3 tensors are row-major xx, xy, xz, yx, ...;
 * stresses have 6 and gradients 9 components in plane strain too. Component `c` of point `k` of
 * an array stands at `base[c * stride + k]`.
 *
 * Life of a plugin: `lahar_plugin_entry_v1` once; then `create`, per instance any number of
 * `init_state`, `update`, `wave_speed` and extension calls, then `destroy`. Libraries are never
 * unloaded. Each function has a tag:
 *
 * * `[exclusive]`: one such call at a time in the whole process, on any thread;
 * * `[concurrent]`: on any thread, at the same time as other calls on the same instance and as
 *   exclusive ones. If the model does not declare `LAHAR_CAPABILITY_THREAD_SAFE`, calls of either
 *   kind come one at a time over all such models of the library.
 *
 * No function may unwind, `longjmp`, exit or print, or change the floating-point environment; it
 * is called with traps off. The engine may call `update` with the same start any number of times:
 * the end must depend only on the start, the step and the instance.
 *
 * Versions: tables grow only at their ends, and both sides give their minor version. A plugin that
 * needs a newer engine sets `required_minor` of the model, or refuses in its entry if `abi_minor`
 * of the host table is too low. An engine accepts tables that are longer than those that it knows,
 * and fills a batch up to its own `struct_size`.
 */

// Major version of the plugin ABI; it is part of the entry's name.
#define LAHAR_PLUGIN_ABI_MAJOR 1

// Minor version: tables may have grown at their ends since lower minors.
#define LAHAR_PLUGIN_ABI_MINOR 0

// The model takes the strain increment; the engine has turned the start stress (and objective
// state) by exp(W dt), W = skw L: the Jaumann rate.
#define LAHAR_KINEMATICS_STRAIN_INCREMENT 0

// The model takes the velocity gradient and does its own rotation: `stress0` arrives unrotated.
#define LAHAR_KINEMATICS_VELOCITY_GRADIENT 1

// The model takes the deformation gradient at the end of the step: `stress0` arrives unrotated.
#define LAHAR_KINEMATICS_DEFORMATION_GRADIENT 2

// The model takes the strain increment; the engine has turned the start stress (and objective
// state) by the increment of the rotation R of F = R U instead of by exp(W dt): the Green-Naghdi
// rate.
#define LAHAR_KINEMATICS_GREEN_NAGHDI 3

// A real number.
#define LAHAR_PARAMETER_REAL 0

// A whole number, given as a double.
#define LAHAR_PARAMETER_INTEGER 1

// One of the labels in `choices`, given by its position 0, 1, ...
#define LAHAR_PARAMETER_CHOICE 2

// One component.
#define LAHAR_STATE_SCALAR 0

// Three components.
#define LAHAR_STATE_VECTOR 1

// Six components: xx, yy, zz, xy, yz, zx.
#define LAHAR_STATE_SYMMETRIC 2

// Nine components, row-major.
#define LAHAR_STATE_TENSOR 3

// The state variable does not change under a rigid rotation.
#define LAHAR_ROTATION_NONE 0

// The engine rotates the state variable with the material before `update`, as it does the stress.
#define LAHAR_ROTATION_OBJECTIVE 1

// Input: mass density at the end of the step [kg/m^3].
#define LAHAR_INPUT_DENSITY 1

// Input: a length of the discretisation, the grid spacing [m].
#define LAHAR_INPUT_ELEMENT_LENGTH 2

// Input: temperature [K], the particle field `temperature` of the host.
#define LAHAR_INPUT_TEMPERATURE 3

// Input: specific internal energy at the start of the step [J/kg]: the particle field
// `strain_energy` over the mass. The field follows the work of the stress, or the output `energy`
// of a model that gives it.
#define LAHAR_INPUT_INTERNAL_ENERGY 4

// Input: pore pressure, compression positive [Pa], the particle field `pore_pressure` of the host.
#define LAHAR_INPUT_PORE_PRESSURE 5

// Input: x of the position [m].
#define LAHAR_INPUT_POSITION_X 6

// Input: y of the position [m].
#define LAHAR_INPUT_POSITION_Y 7

// Input: z of the position [m]; 0 in plane strain.
#define LAHAR_INPUT_POSITION_Z 8

// Input: id of the particle inside its body, counted from 0 [-].
#define LAHAR_INPUT_PARTICLE_ID 9

// Output: speed of the fastest wave [m/s]; every model must give it.
#define LAHAR_OUTPUT_WAVE_SPEED 1

// Output: kinematic diffusivity [m^2/s], for the viscous limit of the time step.
#define LAHAR_OUTPUT_DIFFUSIVITY 2

// Output: energy per current volume at the end of the step [J/m^3], stored or internal; replaces
// the engine's work integral.
#define LAHAR_OUTPUT_ENERGY 4

// Output: factor on the time step that the model asks for, in (0, 1] [-]. Below 1 the engine
// repeats the step with a smaller length if the host allows that, else it shortens the next step.
#define LAHAR_OUTPUT_DT_FACTOR 8

// Output: one of the `LAHAR_POINT_*` per point.
#define LAHAR_OUTPUT_STATUS 16

// `update`, `init_state` and `wave_speed` may run on one instance from several threads at once.
#define LAHAR_CAPABILITY_THREAD_SAFE 1

// A point's result depends on that point alone.
#define LAHAR_CAPABILITY_POINTWISE 2

// Equal input gives equal output, bit for bit.
#define LAHAR_CAPABILITY_DETERMINISTIC 4

// The extension `lahar.tangent` is offered.
#define LAHAR_CAPABILITY_TANGENT 8

// The model may end the process (`STOP` of legacy code); the engine warns when it loads the
// plugin.
#define LAHAR_CAPABILITY_MAY_STOP 16

// The model may print (legacy code); the engine warns when it loads the plugin.
#define LAHAR_CAPABILITY_MAY_PRINT 32

// Transfer rule of a state variable when points are merged: the mean, weighted by mass. A split
// copies.
#define LAHAR_TRANSFER_MEAN 0

// Transfer rule: the largest, component by component.
#define LAHAR_TRANSFER_MAX 1

// Transfer rule: points that differ in it are not merged.
#define LAHAR_TRANSFER_NEVER 2

// The point is updated.
#define LAHAR_POINT_OK 0

// The point is updated, but the result is less accurate than promised; the engine logs the first
// of them.
#define LAHAR_POINT_UNRELIABLE 1

// The point is updated, but the model asks for a smaller step: by the factor `dt_factor`, or by
// one half without that output.
#define LAHAR_POINT_SMALLER_STEP 2

// The point could not be updated; its end is not used.
#define LAHAR_POINT_FAILED 3

// Return value of a plugin function: done.
#define LAHAR_PLUGIN_OK 0

// Return value of a plugin function: not done; `set_error` of the host table may say why.
#define LAHAR_PLUGIN_ERROR 1

// Level of `lahar_host_api.log`: something failed.
#define LAHAR_PLUGIN_LOG_ERROR 0

// Level: something is unusual.
#define LAHAR_PLUGIN_LOG_WARNING 1

// Level: milestones.
#define LAHAR_PLUGIN_LOG_INFORMATION 2

// Level: details for finding a fault.
#define LAHAR_PLUGIN_LOG_DETAIL 3

// What the engine offers to a plugin. Valid for the life of the process. A plugin uses only
// members inside `struct_size`.
typedef struct lahar_host_api {
    // Size of this table in bytes, as the engine knows it.
    uint32_t struct_size;
    // Minor version of the ABI that the engine has.
    uint32_t abi_minor;
    // Passes a line to the host's log. `level` is one of `LAHAR_PLUGIN_LOG_*`; `message` is
    // copied. It has an effect only while a function of the plugin runs. [concurrent]
    void (*log)(int32_t level, const char *message);
    // Sets the text that explains why the function that is running returns an error; `message` is
    // copied. [concurrent]
    void (*set_error)(const char *message);
    // 1 if the host asks long work to end, else 0. [concurrent]
    int32_t (*should_stop)(void);
} lahar_host_api;

// One material parameter. Strings are UTF-8, keys ASCII.
typedef struct lahar_parameter_desc {
    // Name by which hosts give the value: `youngs_modulus`.
    const char *key;
    // Symbol used in the literature: `E`.
    const char *symbol;
    // SI unit: `Pa`, `-`.
    const char *unit;
    // One sentence.
    const char *description;
    // `LAHAR_PARAMETER_REAL`, `_INTEGER` or `_CHOICE`.
    int32_t kind;
    // 1: the host must give it; 0: `default_value` is used.
    int32_t required;
    // Value if the host gives none, inside the hard bounds. Of a required parameter a typical
    // value in SI units, with which tools try the model.
    double default_value;
    // Smallest value that is accepted; -infinity for none.
    double hard_min;
    // Largest value that is accepted; infinity for none.
    double hard_max;
    // Below this a warning is logged; -infinity for none.
    double advised_min;
    // Above this a warning is logged; infinity for none.
    double advised_max;
    // Labels of a choice, separated by `|`; NULL for other kinds.
    const char *choices;
} lahar_parameter_desc;

// One state variable: a value that a point carries from step to step.
typedef struct lahar_state_desc {
    // Name of the particle field: `equivalent_plastic_strain`.
    const char *key;
    // SI unit.
    const char *unit;
    // One sentence.
    const char *description;
    // `LAHAR_STATE_SCALAR`, `_VECTOR`, `_SYMMETRIC` or `_TENSOR`.
    int32_t kind;
    // `LAHAR_ROTATION_NONE` or `_OBJECTIVE`.
    int32_t rotation;
    // Initial value of every component, before `init_state`.
    double initial;
} lahar_state_desc;

// A batch of points. All arrays are 64-byte aligned, share `stride` (a multiple of 8, at least
// `n`) and do not alias each other.
typedef struct lahar_stress_batch {
    // Size of this struct in bytes, as the engine knows it.
    uint32_t struct_size;
    // 0; bits may get a meaning later.
    uint32_t flags;
    // Number of points.
    int64_t n;
    // Component `c` of point `k` stands at `base[c * stride + k]`.
    int64_t stride;
    // Length of the step [s].
    double dt;
    // Time at the start of the step [s].
    double time;
    // Number of steps before this one; -1 if there is no such count.
    int64_t step;
    // Strain increment dt sym L, 6 components [-]; NULL unless the kinematics ask for it.
    const double *strain_increment;
    // Velocity gradient L, 9 components [1/s]; NULL unless the kinematics ask for it.
    const double *velocity_gradient;
    // Deformation gradient F at the end of the step, 9 components [-]; NULL unless the kinematics
    // ask for it.
    const double *deformation_gradient;
    // Cauchy stress at the start, 6 components [Pa]; never written.
    const double *stress0;
    // State at the start, the components of all state variables in the descriptor's order; never
    // written.
    const double *state0;
    // Cauchy stress at the end, 6 components [Pa]; written by `update`.
    double *stress1;
    // State at the end; written whole by `update` and, over the initial values, by `init_state`.
    double *state1;
    // The wanted inputs in the descriptor's order, each a scalar array.
    const double *const *inputs;
    // Speed of the fastest wave [m/s].
    double *wave_speed;
    // Kinematic diffusivity [m^2/s]; NULL unless declared.
    double *diffusivity;
    // Energy per current volume [J/m^3]; NULL unless declared.
    double *energy;
    // Factor on the time step that the model asks for [-]; NULL unless declared.
    double *dt_factor;
    // `LAHAR_POINT_*` per point, zero on entry; NULL unless declared.
    int32_t *status;
} lahar_stress_batch;

// One constitutive model: static tables and functions. All pointers must stay valid for the life
// of the process. Functions that have no instance yet are given the table, so that models may
// share them.
typedef struct lahar_model_desc {
    // Size of this table in bytes, as the plugin knows it.
    uint32_t struct_size;
    // One of `LAHAR_KINEMATICS_*`.
    int32_t kinematics;
    // Name by which hosts select the model: ASCII, unique.
    const char *name;
    // One sentence.
    const char *summary;
    // Publication of the model, with a DOI if there is one.
    const char *reference;
    // Number of parameters.
    uint32_t parameter_count;
    // `sizeof(lahar_parameter_desc)` as the plugin knows it.
    uint32_t parameter_size;
    // The parameters; NULL if there are none.
    const lahar_parameter_desc *parameters;
    // Number of state variables.
    uint32_t state_count;
    // `sizeof(lahar_state_desc)` as the plugin knows it.
    uint32_t state_size;
    // The state variables; NULL if there are none.
    const lahar_state_desc *states;
    // Number of wanted inputs.
    uint32_t input_count;
    // Smallest minor version of the engine with which the model works; 0 for any.
    uint32_t required_minor;
    // The wanted inputs, `LAHAR_INPUT_*`; NULL if there are none.
    const int32_t *inputs;
    // Sum of `LAHAR_OUTPUT_*`; `LAHAR_OUTPUT_WAVE_SPEED` is mandatory.
    uint64_t outputs;
    // Sum of `LAHAR_CAPABILITY_*`.
    uint64_t capabilities;
    // Makes an instance of `model`, this table, from one value per parameter, inside the hard
    // bounds; the model must copy what it needs of `values`. Mandatory. Returns `LAHAR_PLUGIN_OK`,
    // or `LAHAR_PLUGIN_ERROR` and no instance. [exclusive; after the entry]
    int32_t (*create)(const struct lahar_model_desc *model,
                      const double *values,
                      int64_t count,
                      void **instance);
    // Frees an instance. Mandatory. [exclusive; once per instance, after all its other calls]
    void (*destroy)(void *instance);
    // Says whether the values can be combined; if not, writes a NUL-terminated sentence of at most
    // `capacity` bytes to `message`. May be NULL. [exclusive; before create]
    int32_t (*check)(const struct lahar_model_desc *model,
                     const double *values,
                     int64_t count,
                     char *message,
                     int64_t capacity);
    // Derives the first state from `stress0` and `inputs` into `state1`, which holds the initial
    // values. May be NULL. [concurrent; between create and destroy]
    int32_t (*init_state)(const void *instance, const lahar_stress_batch *batch);
    // One step of all points of the batch: writes `stress1`, `state1` and the declared outputs of
    // every point. Mandatory. A point that fails says so in `status`; `LAHAR_PLUGIN_ERROR` is for
    // a batch that cannot be processed at all. [concurrent; between create and destroy]
    int32_t (*update)(const void *instance, const lahar_stress_batch *batch);
    // Wave speed (and diffusivity, if declared) from `stress0`, `state0`, `inputs` and, if the
    // kinematics ask for it, the deformation gradient. Mandatory. [concurrent; between create and
    // destroy]
    int32_t (*wave_speed)(const void *instance, const lahar_stress_batch *batch);
    // A static table for the extension `id`, or NULL. May be NULL. The ids: `lahar.tangent`
    // (lahar_tangent_extension), `lahar.energy` (lahar_energy_extension), `lahar.transfer`
    // (lahar_transfer_extension); others belong to whoever owns the domain name that they begin
    // with. [exclusive; after the entry]
    const void *(*get_extension)(const struct lahar_model_desc *model, const char *id);
} lahar_model_desc;

// Extension `lahar.tangent`, offered together with `LAHAR_CAPABILITY_TANGENT`.
typedef struct lahar_tangent_extension {
    // Size of this table in bytes, as the plugin knows it.
    uint32_t struct_size;
    // 0.
    uint32_t reserved;
    // The tangent of the step that `update` makes of the same batch [Pa]: component `6 i + j` of
    // point `k`, at `tangent[(6 * i + j) * stride + k]`, is the derivative of `stress1` component
    // i by strain increment component j. A shear component of the increment stands for two
    // components of the tensor, such as xy and yx, so that elasticity has 2 G there. Outputs of
    // the batch may be NULL. [concurrent; between create and destroy]
    int32_t (*tangent)(const void *instance, const lahar_stress_batch *batch, double *tangent);
} lahar_tangent_extension;

// Extension `lahar.energy`.
typedef struct lahar_energy_extension {
    // Size of this table in bytes, as the plugin knows it.
    uint32_t struct_size;
    // 0.
    uint32_t reserved;
    // Energy per current volume [J/m^3], one value per point, that can be recovered, from
    // `stress0`, `state0` and, if the kinematics ask for it, the deformation gradient. Outputs of
    // the batch may be NULL. [concurrent; between create and destroy]
    int32_t (*stored)(const void *instance, const lahar_stress_batch *batch, double *energy);
} lahar_energy_extension;

// Extension `lahar.transfer`: how state variables are combined when points are merged. Without it
// every rule is the mean.
typedef struct lahar_transfer_extension {
    // Size of this table in bytes, as the plugin knows it.
    uint32_t struct_size;
    // Number of rules, which is the number of state variables.
    uint32_t count;
    // One `LAHAR_TRANSFER_*` per state variable.
    const int32_t *rules;
} lahar_transfer_extension;

// Description of a plugin. All pointers must stay valid for the life of the process.
typedef struct lahar_plugin_desc {
    // Size of this table in bytes, as the plugin knows it.
    uint32_t struct_size;
    // `LAHAR_PLUGIN_ABI_MAJOR` of the header that the plugin was built with.
    uint32_t abi_major;
    // `LAHAR_PLUGIN_ABI_MINOR` of the header that the plugin was built with.
    uint32_t abi_minor;
    // Number of models, at least 1.
    uint32_t model_count;
    // Reverse domain name or the like: `org.lahar.linear_elastic`.
    const char *id;
    // Version of the plugin.
    const char *version;
    // Who wrote it.
    const char *author;
    // SPDX licence expression.
    const char *licence;
    // Its address in the web; may be empty.
    const char *url;
    // The models, one pointer each.
    const lahar_model_desc *const *models;
} lahar_plugin_desc;

// Type of the function `lahar_plugin_entry_v1`, which every plugin exports. NULL refuses, after
// `set_error`. [exclusive; once in a process, again only after it has refused]
typedef const lahar_plugin_desc *(*lahar_plugin_entry)(const lahar_host_api *host);

// Type of the function `lahar_plugin_adapt_v1`, which an adapter exports instead of an entry: it
// makes a plugin of the foreign library at `path` (a canonical path), for example of one with a
// UMAT. NULL refuses, after `set_error`. [exclusive; once for each library, again only after it
// has refused]
typedef const lahar_plugin_desc *(*lahar_plugin_adapt)(const lahar_host_api *host,
                                                              const char *path);

#if defined(_WIN32)
#define LAHAR_PLUGIN_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define LAHAR_PLUGIN_EXPORT __attribute__((visibility("default")))
#else
#define LAHAR_PLUGIN_EXPORT
#endif

// Ids of extensions.
#define LAHAR_EXTENSION_TANGENT "lahar.tangent"
#define LAHAR_EXTENSION_ENERGY "lahar.energy"
#define LAHAR_EXTENSION_TRANSFER "lahar.transfer"

// The one function that a plugin defines: its tables, or NULL to refuse, after `set_error`.
// [exclusive; once in a process, again only after it has refused]
LAHAR_PLUGIN_EXPORT const lahar_plugin_desc *lahar_plugin_entry_v1(const lahar_host_api *host);

// Defined by adapters instead of the entry: the tables of a plugin made of the foreign library at
// `path`, or NULL to refuse, after `set_error`.
// [exclusive; once for each library, again only after it has refused]
LAHAR_PLUGIN_EXPORT const lahar_plugin_desc *lahar_plugin_adapt_v1(const lahar_host_api *host, const char *path);

/* ---- layout: what the library was built with, on 64-bit systems */

#if UINTPTR_MAX > 0xffffffffu
#if defined(__cplusplus) && __cplusplus >= 201103L
#define LAHAR_ASSERT_LAYOUT(condition) static_assert(condition, #condition)
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L
#define LAHAR_ASSERT_LAYOUT(condition) _Static_assert(condition, #condition)
#endif
#endif
#ifdef LAHAR_ASSERT_LAYOUT
LAHAR_ASSERT_LAYOUT(sizeof(lahar_host_api) == 32);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_host_api, struct_size) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_host_api, abi_minor) == 4);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_host_api, log) == 8);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_host_api, set_error) == 16);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_host_api, should_stop) == 24);
LAHAR_ASSERT_LAYOUT(sizeof(lahar_parameter_desc) == 88);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_parameter_desc, key) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_parameter_desc, symbol) == 8);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_parameter_desc, unit) == 16);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_parameter_desc, description) == 24);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_parameter_desc, kind) == 32);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_parameter_desc, required) == 36);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_parameter_desc, default_value) == 40);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_parameter_desc, hard_min) == 48);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_parameter_desc, hard_max) == 56);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_parameter_desc, advised_min) == 64);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_parameter_desc, advised_max) == 72);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_parameter_desc, choices) == 80);
LAHAR_ASSERT_LAYOUT(sizeof(lahar_state_desc) == 40);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_state_desc, key) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_state_desc, unit) == 8);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_state_desc, description) == 16);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_state_desc, kind) == 24);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_state_desc, rotation) == 28);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_state_desc, initial) == 32);
LAHAR_ASSERT_LAYOUT(sizeof(lahar_stress_batch) == 152);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_stress_batch, struct_size) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_stress_batch, flags) == 4);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_stress_batch, n) == 8);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_stress_batch, stride) == 16);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_stress_batch, dt) == 24);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_stress_batch, time) == 32);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_stress_batch, step) == 40);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_stress_batch, strain_increment) == 48);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_stress_batch, velocity_gradient) == 56);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_stress_batch, deformation_gradient) == 64);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_stress_batch, stress0) == 72);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_stress_batch, state0) == 80);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_stress_batch, stress1) == 88);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_stress_batch, state1) == 96);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_stress_batch, inputs) == 104);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_stress_batch, wave_speed) == 112);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_stress_batch, diffusivity) == 120);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_stress_batch, energy) == 128);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_stress_batch, dt_factor) == 136);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_stress_batch, status) == 144);
LAHAR_ASSERT_LAYOUT(sizeof(lahar_model_desc) == 152);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_desc, struct_size) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_desc, kinematics) == 4);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_desc, name) == 8);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_desc, summary) == 16);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_desc, reference) == 24);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_desc, parameter_count) == 32);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_desc, parameter_size) == 36);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_desc, parameters) == 40);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_desc, state_count) == 48);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_desc, state_size) == 52);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_desc, states) == 56);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_desc, input_count) == 64);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_desc, required_minor) == 68);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_desc, inputs) == 72);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_desc, outputs) == 80);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_desc, capabilities) == 88);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_desc, create) == 96);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_desc, destroy) == 104);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_desc, check) == 112);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_desc, init_state) == 120);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_desc, update) == 128);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_desc, wave_speed) == 136);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_model_desc, get_extension) == 144);
LAHAR_ASSERT_LAYOUT(sizeof(lahar_tangent_extension) == 16);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_tangent_extension, struct_size) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_tangent_extension, reserved) == 4);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_tangent_extension, tangent) == 8);
LAHAR_ASSERT_LAYOUT(sizeof(lahar_energy_extension) == 16);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_energy_extension, struct_size) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_energy_extension, reserved) == 4);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_energy_extension, stored) == 8);
LAHAR_ASSERT_LAYOUT(sizeof(lahar_transfer_extension) == 16);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_transfer_extension, struct_size) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_transfer_extension, count) == 4);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_transfer_extension, rules) == 8);
LAHAR_ASSERT_LAYOUT(sizeof(lahar_plugin_desc) == 64);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_plugin_desc, struct_size) == 0);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_plugin_desc, abi_major) == 4);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_plugin_desc, abi_minor) == 8);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_plugin_desc, model_count) == 12);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_plugin_desc, id) == 16);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_plugin_desc, version) == 24);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_plugin_desc, author) == 32);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_plugin_desc, licence) == 40);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_plugin_desc, url) == 48);
LAHAR_ASSERT_LAYOUT(offsetof(lahar_plugin_desc, models) == 56);
#undef LAHAR_ASSERT_LAYOUT
#endif

#ifdef __cplusplus
} /* extern "C" */
#endif

#endif /* LAHAR_PLUGIN_H */
