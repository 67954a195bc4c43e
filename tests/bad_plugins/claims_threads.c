/* A model that says it is thread-safe and keeps work data in a static array. */
#include "minimal.h"

static double work[64];

static int32_t bad_update(const void *instance, const lahar_stress_batch *b) {
  int64_t k, n = b->n < 64 ? b->n : 64;
  volatile int wait;
  update(instance, b);
  for (k = 0; k < n; ++k) work[k] = b->stress1[k];
  for (wait = 0; wait < 2000; ++wait) {}
  for (k = 0; k < n; ++k) b->stress1[k] = work[k];
  return LAHAR_PLUGIN_OK;
}

static void spoil(void) {
  model.update = bad_update;
}
