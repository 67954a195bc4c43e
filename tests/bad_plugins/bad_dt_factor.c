/* A model that wants a time step of zero. */
#include "minimal.h"

static int32_t bad_update(const void *instance, const lahar_stress_batch *b) {
  int64_t k;
  update(instance, b);
  for (k = 0; k < b->n; ++k) b->dt_factor[k] = 0.0;
  return LAHAR_PLUGIN_OK;
}

static void spoil(void) {
  model.update = bad_update;
  model.outputs |= LAHAR_OUTPUT_DT_FACTOR;
}
