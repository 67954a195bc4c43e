/* A model whose waves are faster than it says. */
#include "minimal.h"

static int32_t bad_update(const void *instance, const lahar_stress_batch *b) {
  int64_t k;
  update(instance, b);
  for (k = 0; k < b->n; ++k) b->wave_speed[k] = 0.7 * WAVE_SPEED;
  return LAHAR_PLUGIN_OK;
}

static void spoil(void) {
  model.update = bad_update;
}
