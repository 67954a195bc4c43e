/* A model that refuses values without saying why. */
#include "minimal.h"

static int32_t refuse(const lahar_model_desc *table, const double *values, int64_t count, void **instance) {
  return values[0] == 0.0 ? LAHAR_PLUGIN_ERROR : create(table, values, count, instance);
}

static void spoil(void) { model.create = refuse; }
