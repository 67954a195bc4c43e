/* Nothing wrong: a model that says of the third and later steps that they are less accurate than promised. */
#include "minimal.h"

static int32_t doubtful_update(const void *instance, const lahar_stress_batch *b) {
  int64_t k;
  update(instance, b);
  for (k = 0; k < b->n; ++k) b->status[k] = b->step > 1 ? LAHAR_POINT_UNRELIABLE : LAHAR_POINT_OK;
  return LAHAR_PLUGIN_OK;
}

static void spoil(void) {
  model.outputs |= LAHAR_OUTPUT_STATUS;
  model.update = doubtful_update;
}
