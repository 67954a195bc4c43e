/* A model that takes the velocity gradient, and with it the duty to rotate the stress, and does not do it. */
#include "minimal.h"

static int32_t still_update(const void *instance, const lahar_stress_batch *b) {
  static const int row[6] = {0, 1, 2, 0, 1, 0}, column[6] = {0, 1, 2, 1, 2, 2};
  int64_t c, k;
  (void)instance;
  for (k = 0; k < b->n; ++k) {
    for (c = 0; c < 6; ++c) {
      const double *l = b->velocity_gradient + k;
      const double rate = 0.5 * (l[(3 * row[c] + column[c]) * b->stride] + l[(3 * column[c] + row[c]) * b->stride]);
      b->stress1[c * b->stride + k] = b->stress0[c * b->stride + k] + MODULUS * b->dt * rate;
    }
    b->state1[k] = b->state0[k];
    b->wave_speed[k] = WAVE_SPEED;
  }
  return LAHAR_PLUGIN_OK;
}

static void spoil(void) {
  plugin.id = "org.lahar.test.no_rotation";
  model.name = "no_rotation";
  model.kinematics = LAHAR_KINEMATICS_VELOCITY_GRADIENT;
  model.update = still_update;
}
