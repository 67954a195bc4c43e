/* Nothing wrong: a model that asks for steps of at most 1e-3 s by its factor. */
#include "minimal.h"

static int32_t impatient_update(const void *instance, const lahar_stress_batch *b) {
  int64_t k;
  update(instance, b);
  for (k = 0; k < b->n; ++k) b->dt_factor[k] = b->dt > 1e-3 ? 1e-3 / b->dt : 1.0;
  return LAHAR_PLUGIN_OK;
}

static void spoil(void) {
  model.outputs |= LAHAR_OUTPUT_DT_FACTOR;
  model.update = impatient_update;
}
