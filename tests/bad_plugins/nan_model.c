/* A model that gives a stress that is not a number: the state variable `memory` counts steps down; at 1 the point gives NaN. */
#include "minimal.h"

static int32_t nan_update(const void *instance, const lahar_stress_batch *b) {
  int64_t k;
  update(instance, b);
  for (k = 0; k < b->n; ++k) {
    b->state1[k] = b->state0[k] > 0.0 ? b->state0[k] - 1.0 : 0.0;
    if (b->state0[k] == 1.0) b->stress1[k] = NAN;
  }
  return LAHAR_PLUGIN_OK;
}

static void spoil(void) {
  plugin.id = "org.lahar.test.nan_model";
  model.name = "nan_model";
  model.update = nan_update;
}
