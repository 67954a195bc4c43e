/* own_material.c: a constitutive model for lahar in C99, to be copied and changed.
 *
 * Isotropic linear elasticity with a von Mises cap: perfect plasticity, radial return. From the folder that holds include/:
 *
 *   cc -std=c99 -O2 -fPIC -shared -Wl,-Bsymbolic -Wl,--version-script=include/lahar/lahar_plugin.map -Iinclude own_material.c -o libown_material.so -lm
 *
 * Change what stands under the comments CHANGE, from the top to the bottom. lahar_plugin.h is the contract; in short: units are
 * those of the host, tension is positive, stresses and strains have the tensor components xx, yy, zz, xy, yz, zx in plane strain
 * too, and a function neither prints nor exits.
 */

#include <float.h>
#include <lahar/lahar_plugin.h>
#include <math.h>
#include <stdlib.h>

static const lahar_host_api *host; /* how to tell the host what is wrong */

/* CHANGE the parameters. `default_value` of a required one is a typical value, with which tools try the model. Values outside the hard
 * bounds are refused, those outside the advised ones are warned of. Units are the host's: no default or advised bound has a dimension. */
static const lahar_parameter_desc parameters[] = {
    {.key = "youngs_modulus", .symbol = "E", .unit = "Pa", .description = "Young's modulus",
     .kind = LAHAR_PARAMETER_REAL, .required = 1, .default_value = 1e7,
     .hard_min = DBL_MIN, .hard_max = INFINITY, .advised_min = -INFINITY, .advised_max = INFINITY},
    {.key = "poissons_ratio", .symbol = "nu", .unit = "-", .description = "Poisson's ratio",
     .kind = LAHAR_PARAMETER_REAL, .required = 1, .default_value = 0.3,
     .hard_min = -0.999, .hard_max = 0.4999, .advised_min = 0.0, .advised_max = 0.495},
    {.key = "yield_stress", .symbol = "Y", .unit = "Pa", .description = "Largest von Mises stress",
     .kind = LAHAR_PARAMETER_REAL, .required = 1, .default_value = 1e4,
     .hard_min = DBL_MIN, .hard_max = INFINITY, .advised_min = -INFINITY, .advised_max = INFINITY},
};
enum { PARAMETERS = sizeof parameters / sizeof *parameters };

/* CHANGE the state variables: what a point carries from step to step beside its stress. */
static const lahar_state_desc states[] = {
    {.key = "equivalent_plastic_strain", .unit = "-", .description = "Integral of the rate of plastic strain",
     .kind = LAHAR_STATE_SCALAR, .rotation = LAHAR_ROTATION_NONE, .initial = 0.0},
};

/* CHANGE the inputs: what the model wants to know of a point. */
static const int32_t inputs[] = {LAHAR_INPUT_DENSITY};

/* CHANGE the constants of one instance, made once from the parameters. */
typedef struct own_material {
    double lambda, shear_modulus, yield_stress; /* [Pa] */
} own_material;

/* CHANGE how they are made. Values come in the order of `parameters`, inside their hard bounds. */
static int32_t create(const lahar_model_desc *model, const double *values, int64_t count, void **instance) {
    const double e = values[0], nu = values[1];
    own_material *m;
    (void)model; /* which of several models of the library */
    *instance = NULL;
    if (count != PARAMETERS) return LAHAR_PLUGIN_ERROR;
    m = malloc(sizeof *m);
    if (m == NULL) {
        host->set_error("no memory");
        return LAHAR_PLUGIN_ERROR;
    }
    m->shear_modulus = e / (2.0 * (1.0 + nu));
    m->lambda = e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
    m->yield_stress = values[2];
    if (!isfinite(m->lambda) || !isfinite(m->shear_modulus)) {
        host->set_error("youngs_modulus gives moduli that are not finite");
        free(m);
        return LAHAR_PLUGIN_ERROR;
    }
    *instance = m;
    return LAHAR_PLUGIN_OK;
}

static void destroy(void *instance) {
    free(instance);
}

/* CHANGE the law: one step of one point. The engine has turned the start stress with the material. */
static void step(const own_material *m, const double strain[6], const double stress0[6], double plastic0, double stress1[6],
                 double *plastic1) {
    const double volumetric = m->lambda * (strain[0] + strain[1] + strain[2]), two_g = 2.0 * m->shear_modulus;
    double s[6], mean, mises, share = 0.0;
    int c;
    /* the elastic trial */
    for (c = 0; c < 3; ++c) stress1[c] = stress0[c] + volumetric + two_g * strain[c];
    for (c = 3; c < 6; ++c) stress1[c] = stress0[c] + two_g * strain[c];
    /* its deviator and von Mises stress */
    mean = (stress1[0] + stress1[1] + stress1[2]) / 3.0;
    for (c = 0; c < 6; ++c) s[c] = c < 3 ? stress1[c] - mean : stress1[c];
    mises = sqrt(1.5 * (s[0] * s[0] + s[1] * s[1] + s[2] * s[2] + 2.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5])));
    /* what is beyond the cap goes back along the deviator */
    if (mises > m->yield_stress) share = (mises - m->yield_stress) / mises;
    for (c = 0; c < 6; ++c) stress1[c] -= share * s[c];
    *plastic1 = plastic0 + share * mises / (3.0 * m->shear_modulus);
}

/* CHANGE the speed of the fastest wave [m/s]: the time step follows from it, too low a speed makes the run unstable. */
static double speed(const own_material *m, double density) {
    return sqrt((m->lambda + 2.0 * m->shear_modulus) / density);
}

/* One step of all points: component c of point k stands at base[c * stride + k]. Every end and output must be written. */
static int32_t update(const void *instance, const lahar_stress_batch *b) {
    const own_material *m = instance;
    const double *density = b->inputs[0];
    int64_t k, c;
    for (k = 0; k < b->n; ++k) {
        double strain[6], stress0[6], stress1[6];
        int sane;
        for (c = 0; c < 6; ++c) {
            strain[c] = b->strain_increment[c * b->stride + k];
            stress0[c] = b->stress0[c * b->stride + k];
        }
        step(m, strain, stress0, b->state0[k], stress1, &b->state1[k]);
        b->wave_speed[k] = speed(m, density[k]);
        sane = isfinite(b->wave_speed[k]) && isfinite(b->state1[k]);
        for (c = 0; c < 6; ++c) {
            b->stress1[c * b->stride + k] = stress1[c];
            sane = sane && isfinite(stress1[c]);
        }
        b->status[k] = sane ? LAHAR_POINT_OK : LAHAR_POINT_FAILED;
    }
    return LAHAR_PLUGIN_OK;
}

/* The wave speed alone, for the first time step. */
static int32_t wave_speed(const void *instance, const lahar_stress_batch *b) {
    int64_t k;
    for (k = 0; k < b->n; ++k) b->wave_speed[k] = speed(instance, b->inputs[0][k]);
    return LAHAR_PLUGIN_OK;
}

/* CHANGE names and kinematics. The capabilities say that the functions keep nothing between calls: true as long as there are no
 * variables that they write but those of the batch. */
static const lahar_model_desc model = {
    .struct_size = sizeof model,
    .kinematics = LAHAR_KINEMATICS_STRAIN_INCREMENT,
    .name = "own_material",
    .summary = "Linear elasticity with a von Mises cap",
    .reference = "Simo, Hughes: Computational Inelasticity (1998), section 3.3, doi:10.1007/b98904",
    .parameter_count = PARAMETERS,
    .parameter_size = sizeof *parameters,
    .parameters = parameters,
    .state_count = sizeof states / sizeof *states,
    .state_size = sizeof *states,
    .states = states,
    .input_count = sizeof inputs / sizeof *inputs,
    .inputs = inputs,
    .outputs = LAHAR_OUTPUT_WAVE_SPEED | LAHAR_OUTPUT_STATUS,
    .capabilities = LAHAR_CAPABILITY_THREAD_SAFE | LAHAR_CAPABILITY_POINTWISE | LAHAR_CAPABILITY_DETERMINISTIC,
    .create = create,
    .destroy = destroy,
    .update = update,
    .wave_speed = wave_speed,
};

/* A library may offer several models. */
static const lahar_model_desc *const models[] = {&model};

static const lahar_plugin_desc plugin = {
    .struct_size = sizeof plugin,
    .abi_major = LAHAR_PLUGIN_ABI_MAJOR,
    .abi_minor = LAHAR_PLUGIN_ABI_MINOR,
    .model_count = sizeof models / sizeof *models,
    .id = "org.example.own_material",
    .version = "1.0",
    .author = "You",
    .licence = "MIT OR Apache-2.0",
    .url = "",
    .models = models,
};

LAHAR_PLUGIN_EXPORT const lahar_plugin_desc *lahar_plugin_entry_v1(const lahar_host_api *api) {
    host = api;
    return &plugin;
}
