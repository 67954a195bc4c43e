/* A model that writes where it must not. */
#include "minimal.h"

static int32_t bad_update(const void *instance, const lahar_stress_batch *b) {
  volatile double *nowhere = (volatile double *)8;
  *nowhere = 1.0;
  return update(instance, b);
}

static void spoil(void) {
  model.update = bad_update;
}
