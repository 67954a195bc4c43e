/* A model whose points cannot be updated in steps of more than 1e-3 s. */
#include "minimal.h"

static int32_t update_if_small(const void *instance, const lahar_stress_batch *b) {
  int64_t k;
  update(instance, b);
  for (k = 0; k < b->n; ++k) b->status[k] = b->dt > 1e-3 ? LAHAR_POINT_FAILED : LAHAR_POINT_OK;
  return LAHAR_PLUGIN_OK;
}

static void spoil(void) {
  model.outputs |= LAHAR_OUTPUT_STATUS;
  model.update = update_if_small;
}
