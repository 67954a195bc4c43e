/* A model whose factor on the time step makes no sense. */
#include "minimal.h"

static int32_t zero_update(const void *instance, const lahar_stress_batch *b) {
  int64_t k;
  update(instance, b);
  for (k = 0; k < b->n; ++k) b->dt_factor[k] = 0.0;
  return LAHAR_PLUGIN_OK;
}

static void spoil(void) {
  model.outputs |= LAHAR_OUTPUT_DT_FACTOR;
  model.update = zero_update;
}
