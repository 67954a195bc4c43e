/* A model whose stored energy is twice what it is. */
#include "minimal.h"

#include <string.h>

static int32_t stored(const void *instance, const lahar_stress_batch *b, double *energy) {
  int64_t c, k;
  (void)instance;
  for (k = 0; k < b->n; ++k) {
    energy[k] = 0.0;
    for (c = 0; c < 6; ++c) {
      const double s = b->stress0[c * b->stride + k];
      energy[k] += (c < 3 ? 1.0 : 2.0) * s * s / MODULUS; /* and not half of it */
    }
  }
  return LAHAR_PLUGIN_OK;
}

static const void *extension(const lahar_model_desc *of, const char *id) {
  static lahar_energy_extension table;
  table.struct_size = sizeof table;
  table.stored = stored;
  (void)of;
  return strcmp(id, "lahar.energy") == 0 ? &table : NULL;
}

static void spoil(void) {
  model.get_extension = extension;
}
