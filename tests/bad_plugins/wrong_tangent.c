/* A model whose tangent takes shear strains for twice what they are. */
#include "minimal.h"

#include <string.h>

static int32_t tangent(const void *instance, const lahar_stress_batch *b, double *t) {
  int64_t i, j, k;
  (void)instance;
  for (i = 0; i < 6; ++i)
    for (j = 0; j < 6; ++j)
      for (k = 0; k < b->n; ++k) t[(6 * i + j) * b->stride + k] = i == j ? (i < 3 ? MODULUS : 0.5 * MODULUS) : 0.0;
  return LAHAR_PLUGIN_OK;
}

static const void *extension(const lahar_model_desc *of, const char *id) {
  static lahar_tangent_extension table;
  table.struct_size = sizeof table;
  table.tangent = tangent;
  (void)of;
  return strcmp(id, "lahar.tangent") == 0 ? &table : NULL;
}

static void spoil(void) {
  model.get_extension = extension;
  model.capabilities |= LAHAR_CAPABILITY_TANGENT;
}
