/* A model that writes its start state. */
#include "minimal.h"

static int32_t bad_update(const void *instance, const lahar_stress_batch *b) {
  update(instance, b);
  if (b->n > 2) ((double *)b->state0)[2] += 1.0;
  return LAHAR_PLUGIN_OK;
}

static void spoil(void) {
  model.update = bad_update;
  model.capabilities |= LAHAR_CAPABILITY_DETERMINISTIC | LAHAR_CAPABILITY_POINTWISE;
}
