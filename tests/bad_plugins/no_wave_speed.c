/* A model that gives no wave speed: it says that the point failed. */
#include "minimal.h"

static int32_t refuse(const void *instance, const lahar_stress_batch *b) {
  int64_t k;
  wave_speed(instance, b);
  for (k = 0; k < b->n; ++k) b->status[k] = LAHAR_POINT_FAILED;
  return LAHAR_PLUGIN_OK;
}

static void spoil(void) {
  model.outputs |= LAHAR_OUTPUT_STATUS;
  model.wave_speed = refuse;
}
