/* A model whose stress grows in every step, strain or not. */
#include "minimal.h"

static int32_t bad_update(const void *instance, const lahar_stress_batch *b) {
  int64_t k;
  update(instance, b);
  for (k = 0; k < b->n; ++k) b->stress1[k] += 1e-3;
  return LAHAR_PLUGIN_OK;
}

static void spoil(void) {
  model.update = bad_update;
}
