/* A model that ends the process, as legacy code does where an iteration does not converge. */
#include "minimal.h"

#include <stdlib.h>

static int32_t bad_update(const void *instance, const lahar_stress_batch *b) {
  (void)instance;
  (void)b;
  exit(3);
}

static void spoil(void) {
  model.update = bad_update;
}
