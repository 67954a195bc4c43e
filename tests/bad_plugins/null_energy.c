/* A stored energy whose function is NULL. */
#include "minimal.h"

#include <string.h>

static const lahar_energy_extension table = {sizeof table, 0, NULL};

static const void *get_extension(const lahar_model_desc *of, const char *id) {
  (void)of;
  return strcmp(id, LAHAR_EXTENSION_ENERGY) ? NULL : &table;
}

static void spoil(void) { model.get_extension = get_extension; }
