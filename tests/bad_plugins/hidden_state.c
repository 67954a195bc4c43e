/* A model that counts its calls and lets the stress depend on it. */
#include "minimal.h"

static int calls;

static int32_t bad_update(const void *instance, const lahar_stress_batch *b) {
  update(instance, b);
  b->stress1[0] += 1e-3 * ++calls;
  return LAHAR_PLUGIN_OK;
}

static void spoil(void) {
  model.update = bad_update;
  model.capabilities |= LAHAR_CAPABILITY_DETERMINISTIC | LAHAR_CAPABILITY_POINTWISE;
}
