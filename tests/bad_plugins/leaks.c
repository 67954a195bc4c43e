/* A model that does not free its instances. */
#include "minimal.h"

#include <stdlib.h>

static int32_t take(const lahar_model_desc *table, const double *values, int64_t count, void **instance) {
  (void)table;
  (void)values;
  *instance = malloc(512);
  return count == 2 && *instance ? LAHAR_PLUGIN_OK : LAHAR_PLUGIN_ERROR;
}

static void spoil(void) { model.create = take; }
