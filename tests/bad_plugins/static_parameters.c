/* A model that keeps its parameters in a static variable, so that the last instance rules them all. */
#include "minimal.h"

static double factor;

static int32_t keep(const lahar_model_desc *table, const double *values, int64_t count, void **instance) {
  factor = values[0];
  return create(table, values, count, instance);
}

static int32_t bad_update(const void *instance, const lahar_stress_batch *b) {
  int64_t c, k;
  update(instance, b);
  for (c = 0; c < 6; ++c)
    for (k = 0; k < b->n; ++k) {
      const double start = b->stress0[c * b->stride + k];
      b->stress1[c * b->stride + k] = start + factor * (b->stress1[c * b->stride + k] - start);
    }
  return LAHAR_PLUGIN_OK;
}

static void spoil(void) {
  model.create = keep;
  model.update = bad_update;
}
