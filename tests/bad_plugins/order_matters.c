/* A model whose points depend on their place in the batch. */
#include "minimal.h"

static int32_t bad_update(const void *instance, const lahar_stress_batch *b) {
  int64_t k;
  update(instance, b);
  for (k = 0; k < b->n; ++k) b->state1[k] = (double)k;
  return LAHAR_PLUGIN_OK;
}

static void spoil(void) {
  model.update = bad_update;
  model.capabilities |= LAHAR_CAPABILITY_DETERMINISTIC | LAHAR_CAPABILITY_POINTWISE;
}
