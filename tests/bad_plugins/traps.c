/* A model that turns traps on and divides by zero. */
#include "minimal.h"

#include <fenv.h>

int feenableexcept(int); /* of the GNU library, beyond C99 */

static int32_t bad_update(const void *instance, const lahar_stress_batch *b) {
  volatile double zero = 0.0;
  feenableexcept(FE_DIVBYZERO);
  b->wave_speed[0] = 1.0 / zero;
  return update(instance, b);
}

static void spoil(void) {
  model.update = bad_update;
}
