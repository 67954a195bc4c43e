/* A model that turns traps on and leaves them so, for the host to die of. */
#include "minimal.h"

#include <fenv.h>

int feenableexcept(int); /* of the GNU library, beyond C99 */

static int32_t bad_update(const void *instance, const lahar_stress_batch *b) {
  feenableexcept(FE_DIVBYZERO);
  return update(instance, b);
}

static void spoil(void) { model.update = bad_update; }
