/* A model that fails: the state variable `memory` counts steps down; at 1 the point answers LAHAR_POINT_FAILED. */
#include "minimal.h"

static int32_t failing_update(const void *instance, const lahar_stress_batch *b) {
  int64_t k;
  update(instance, b);
  for (k = 0; k < b->n; ++k) {
    b->state1[k] = b->state0[k] > 0.0 ? b->state0[k] - 1.0 : 0.0;
    if (b->state0[k] == 1.0) b->status[k] = LAHAR_POINT_FAILED;
  }
  return LAHAR_PLUGIN_OK;
}

static void spoil(void) {
  plugin.id = "org.lahar.test.failing_model";
  model.name = "failing_model";
  model.outputs |= LAHAR_OUTPUT_STATUS;
  model.update = failing_update;
}
