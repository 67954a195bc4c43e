/* A model that gives a stress that is not a number for strains that are not small. */
#include "minimal.h"

static int32_t bad_update(const void *instance, const lahar_stress_batch *b) {
  int64_t k;
  update(instance, b);
  for (k = 0; k < b->n; ++k) b->stress1[k] += 0.0 * sqrt(1e-3 - b->strain_increment[k]);
  return LAHAR_PLUGIN_OK;
}

static void spoil(void) {
  model.update = bad_update;
}
