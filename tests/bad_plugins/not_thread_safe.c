/* A model that must not be entered twice at once, and tells if it is. */
#include "minimal.h"

static volatile int inside;

static int32_t alone(const void *instance, const lahar_stress_batch *b) {
  volatile int i;
  int before = inside;
  inside = before + 1;
  for (i = 0; i < 20000; ++i) {}
  if (inside != before + 1 || before != 0) {
    host->set_error("entered twice at once");
    return LAHAR_PLUGIN_ERROR;
  }
  inside = 0;
  return update(instance, b);
}

static void spoil(void) {
  model.update = alone;
  model.capabilities = 0;
}
