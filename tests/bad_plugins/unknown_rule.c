/* A transfer rule that nobody knows. */
#include "minimal.h"

#include <string.h>

static const int32_t rules[] = {3};
static const lahar_transfer_extension table = {sizeof table, 1, rules};

static const void *get_extension(const lahar_model_desc *of, const char *id) {
  (void)of;
  return strcmp(id, LAHAR_EXTENSION_TRANSFER) ? NULL : &table;
}

static void spoil(void) { model.get_extension = get_extension; }
