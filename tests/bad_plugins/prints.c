/* A model that prints. */
#include "minimal.h"

#include <stdio.h>

static int32_t bad_update(const void *instance, const lahar_stress_batch *b) {
  printf("stress update of %d points\n", (int)b->n);
  return update(instance, b);
}

static void spoil(void) {
  model.update = bad_update;
}
