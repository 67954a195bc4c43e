/* An extension whose function is NULL. */
#include "minimal.h"

#include <string.h>

static lahar_tangent_extension table;

static const void *get_extension(const lahar_model_desc *of, const char *id) {
  (void)of;
  return strcmp(id, LAHAR_EXTENSION_TANGENT) ? NULL : &table;
}

static void spoil(void) {
  table.struct_size = sizeof table;
  model.get_extension = get_extension;
  model.capabilities |= LAHAR_CAPABILITY_TANGENT;
}
