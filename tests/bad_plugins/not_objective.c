/* A model that takes the tensor shear strain xy for twice what it is: stiffer in one plane, and not objective. */
#include "minimal.h"

static int32_t bad_update(const void *instance, const lahar_stress_batch *b) {
  int64_t k;
  update(instance, b);
  for (k = 0; k < b->n; ++k) {
    b->stress1[3 * b->stride + k] += MODULUS * b->strain_increment[3 * b->stride + k];
    b->wave_speed[k] = 2.0 * WAVE_SPEED;
  }
  return LAHAR_PLUGIN_OK;
}

static void spoil(void) {
  model.update = bad_update;
}
