/* A model that aborts when strains are large. */
#include "minimal.h"

#include <stdlib.h>

static int32_t bad_update(const void *instance, const lahar_stress_batch *b) {
  if (b->strain_increment[0] > 1e-3 || b->strain_increment[0] < -1e-3) abort();
  return update(instance, b);
}

static void spoil(void) {
  model.update = bad_update;
}
