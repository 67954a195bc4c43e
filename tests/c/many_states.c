/* A plugin whose model has as many state variables as its build says (STATES): linear elasticity, and in variable c the sum of
 * (c + 1) times the growth of volume. */
#include "lahar/lahar_plugin.h"

#include <stdio.h>

#define MODULUS 1e5
#define WAVE_SPEED 10.0

static char keys[STATES][16];
static lahar_state_desc states[STATES];
static int32_t inputs[1];
static lahar_model_desc model;
static const lahar_model_desc *models[1];
static lahar_plugin_desc plugin;

static int32_t create(const lahar_model_desc *table, const double *values, int64_t count, void **instance) {
  (void)table;
  (void)values;
  (void)count;
  *instance = (void *)&model; /* any address: the model keeps nothing */
  return LAHAR_PLUGIN_OK;
}

static void destroy(void *instance) { (void)instance; }

static int32_t update(const void *instance, const lahar_stress_batch *b) {
  const double *e = b->strain_increment;
  int64_t c, k, s = b->stride;
  (void)instance;
  for (c = 0; c < 6; ++c)
    for (k = 0; k < b->n; ++k) b->stress1[c * s + k] = b->stress0[c * s + k] + MODULUS * e[c * s + k];
  for (c = 0; c < STATES; ++c)
    for (k = 0; k < b->n; ++k)
      b->state1[c * s + k] = b->state0[c * s + k] + (double)(c + 1) * (e[k] + e[s + k] + e[2 * s + k]);
  for (k = 0; k < b->n; ++k) b->wave_speed[k] = WAVE_SPEED;
  return LAHAR_PLUGIN_OK;
}

static int32_t wave_speed(const void *instance, const lahar_stress_batch *b) {
  int64_t k;
  (void)instance;
  for (k = 0; k < b->n; ++k) b->wave_speed[k] = WAVE_SPEED;
  return LAHAR_PLUGIN_OK;
}

const lahar_plugin_desc *lahar_plugin_entry_v1(const lahar_host_api *api) {
  int c;
  (void)api;
  for (c = 0; c < STATES; ++c) {
    snprintf(keys[c], sizeof keys[c], "s%d", c);
    states[c].key = keys[c];
    states[c].unit = "-";
    states[c].description = "A sum.";
  }
  inputs[0] = LAHAR_INPUT_DENSITY;
  model.struct_size = sizeof model;
  model.name = "many_states";
  model.summary = "A model with many state variables.";
  model.reference = "";
  model.parameter_size = sizeof(lahar_parameter_desc);
  model.state_count = STATES;
  model.state_size = sizeof states[0];
  model.states = states;
  model.input_count = 1;
  model.inputs = inputs;
  model.outputs = LAHAR_OUTPUT_WAVE_SPEED;
  model.capabilities = LAHAR_CAPABILITY_THREAD_SAFE;
  model.create = create;
  model.destroy = destroy;
  model.update = update;
  model.wave_speed = wave_speed;
  models[0] = &model;
  plugin.struct_size = sizeof plugin;
  plugin.abi_major = LAHAR_PLUGIN_ABI_MAJOR;
  plugin.abi_minor = LAHAR_PLUGIN_ABI_MINOR;
  plugin.model_count = 1;
  plugin.id = "org.lahar.test.many_states";
  plugin.version = "1.0";
  plugin.author = "The lahar developers";
  plugin.licence = "MIT OR Apache-2.0";
  plugin.url = "";
  plugin.models = models;
  return &plugin;
}
