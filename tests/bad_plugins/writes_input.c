/* A model that writes its strain increment, as code does that turns it into engineering strain in place. */
#include "minimal.h"

static int32_t bad_update(const void *instance, const lahar_stress_batch *b) {
  update(instance, b);
  ((double *)b->strain_increment)[3 * b->stride] *= 2.0;
  return LAHAR_PLUGIN_OK;
}

static void spoil(void) {
  model.update = bad_update;
  model.capabilities |= LAHAR_CAPABILITY_DETERMINISTIC | LAHAR_CAPABILITY_POINTWISE;
}
