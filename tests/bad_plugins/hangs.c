/* A model whose iteration does not end. */
#include "minimal.h"

static int32_t bad_update(const void *instance, const lahar_stress_batch *b) {
  volatile int converged = 0;
  while (!converged) {}
  return update(instance, b);
}

static void spoil(void) {
  model.update = bad_update;
}
