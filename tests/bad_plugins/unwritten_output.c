/* A model that leaves a component of the end stress as it is. */
#include "minimal.h"

static int32_t bad_update(const void *instance, const lahar_stress_batch *b) {
  int64_t c, k;
  (void)instance;
  for (k = 0; k < b->n; ++k) {
    for (c = 0; c < 5; ++c) b->stress1[c * b->stride + k] = b->stress0[c * b->stride + k];
    b->state1[k] = b->state0[k];
    b->wave_speed[k] = 10.0;
  }
  return LAHAR_PLUGIN_OK;
}

static void spoil(void) {
  model.update = bad_update;
  model.capabilities |= LAHAR_CAPABILITY_DETERMINISTIC | LAHAR_CAPABILITY_POINTWISE;
}
