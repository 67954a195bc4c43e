/* A model whose points depend on each other: it smooths its state over the batch. */
#include "minimal.h"

static int32_t bad_update(const void *instance, const lahar_stress_batch *b) {
  int64_t k;
  double mean = 0.0;
  update(instance, b);
  for (k = 0; k < b->n; ++k) mean += (b->state0[k] + b->strain_increment[k]) / (double)b->n;
  for (k = 0; k < b->n; ++k) b->state1[k] = mean;
  return LAHAR_PLUGIN_OK;
}

static void spoil(void) {
  model.update = bad_update;
  model.capabilities |= LAHAR_CAPABILITY_DETERMINISTIC | LAHAR_CAPABILITY_POINTWISE;
}
