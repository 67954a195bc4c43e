/* A model that rounds upward and leaves it so. */
#include "minimal.h"

#include <fenv.h>

static int32_t bad_update(const void *instance, const lahar_stress_batch *b) {
  fesetround(FE_UPWARD);
  return update(instance, b);
}

static void spoil(void) {
  model.update = bad_update;
  model.capabilities |= LAHAR_CAPABILITY_DETERMINISTIC | LAHAR_CAPABILITY_POINTWISE;
}
