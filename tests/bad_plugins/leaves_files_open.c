/* A model that opens a file for every instance and closes none. */
#include "minimal.h"

#include <stdio.h>

static int32_t open_file(const lahar_model_desc *table, const double *values, int64_t count, void **instance) {
  static int files;
  if (files++ < 100) fopen("/dev/null", "w");
  return create(table, values, count, instance);
}

static void spoil(void) { model.create = open_file; }
