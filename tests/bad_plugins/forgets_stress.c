/* A model that takes the increment of the stress for the stress. */
#include "minimal.h"

static int32_t bad_update(const void *instance, const lahar_stress_batch *b) {
  int64_t c, k;
  update(instance, b);
  for (c = 0; c < 6; ++c)
    for (k = 0; k < b->n; ++k) b->stress1[c * b->stride + k] -= b->stress0[c * b->stride + k];
  return LAHAR_PLUGIN_OK;
}

static void spoil(void) {
  model.update = bad_update;
}
