/* A model with a status that there is not. */
#include "minimal.h"

static int32_t bad_update(const void *instance, const lahar_stress_batch *b) {
  update(instance, b);
  b->status[b->n - 1] = 17;
  return LAHAR_PLUGIN_OK;
}

static void spoil(void) {
  model.update = bad_update;
  model.outputs |= LAHAR_OUTPUT_STATUS;
}
