/* A plugin with one elastic model, right in everything at the density 1000. A file that includes this spoils one thing in `spoil`. */
#ifndef MINIMAL_H
#define MINIMAL_H

#include "lahar/lahar_plugin.h"

#include <math.h>
#include <stddef.h>

/* 2 G of an elastic solid without lateral contraction, and the speed of its waves at the density 1000. */
#define MODULUS 1e5
#define WAVE_SPEED 10.0

static const lahar_host_api *host;

static int32_t create(const lahar_model_desc *table, const double *values, int64_t count, void **instance) {
  (void)table;
  (void)values;
  *instance = (void *)&host; /* any address: the model keeps nothing */
  return count == 2 ? LAHAR_PLUGIN_OK : LAHAR_PLUGIN_ERROR;
}

static void destroy(void *instance) { (void)instance; }

static int32_t update(const void *instance, const lahar_stress_batch *b) {
  int64_t c, k;
  (void)instance;
  for (k = 0; k < b->n; ++k) {
    for (c = 0; c < 6; ++c)
      b->stress1[c * b->stride + k] = b->stress0[c * b->stride + k] + MODULUS * b->strain_increment[c * b->stride + k];
    b->state1[k] = b->state0[k];
    b->wave_speed[k] = WAVE_SPEED;
  }
  return LAHAR_PLUGIN_OK;
}

static int32_t wave_speed(const void *instance, const lahar_stress_batch *b) {
  int64_t k;
  (void)instance;
  for (k = 0; k < b->n; ++k) b->wave_speed[k] = WAVE_SPEED;
  return LAHAR_PLUGIN_OK;
}

static lahar_parameter_desc parameters[2];
static lahar_state_desc states[1];
static int32_t inputs[1];
static lahar_model_desc model;
static const lahar_model_desc *models[2];
static lahar_plugin_desc plugin;

/* Called last, before the table is returned. */
static void spoil(void);

static void fill_parameter(lahar_parameter_desc *p, const char *key) {
  p->key = key;
  p->symbol = key;
  p->unit = "-";
  p->description = "A number.";
  p->kind = LAHAR_PARAMETER_REAL;
  p->default_value = 1.0;
  p->hard_min = 0.0;
  p->hard_max = 10.0;
  p->advised_min = -INFINITY;
  p->advised_max = 5.0;
}

static void fill(void) {
  fill_parameter(&parameters[0], "first");
  fill_parameter(&parameters[1], "second");
  states[0].key = "memory";
  states[0].unit = "-";
  states[0].description = "A number.";
  inputs[0] = LAHAR_INPUT_DENSITY;
  model.struct_size = sizeof model;
  model.name = "minimal";
  model.summary = "A model for tests.";
  model.reference = "";
  model.parameter_count = 2;
  model.parameter_size = sizeof parameters[0];
  model.parameters = parameters;
  model.state_count = 1;
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
  models[1] = &model;
  plugin.struct_size = sizeof plugin;
  plugin.abi_major = LAHAR_PLUGIN_ABI_MAJOR;
  plugin.abi_minor = LAHAR_PLUGIN_ABI_MINOR;
  plugin.model_count = 1;
  plugin.id = "org.lahar.test.minimal";
  plugin.version = "1.0";
  plugin.author = "The lahar developers";
  plugin.licence = "MIT OR Apache-2.0";
  plugin.url = "";
  plugin.models = models;
}

const lahar_plugin_desc *lahar_plugin_entry_v1(const lahar_host_api *api) {
  host = api;
  fill();
  spoil();
  return &plugin;
}

#endif
