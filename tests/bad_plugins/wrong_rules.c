/* More transfer rules than state variables. */
#include "minimal.h"

#include <string.h>

static const int32_t rules[] = {LAHAR_TRANSFER_MEAN, LAHAR_TRANSFER_MAX};
static const lahar_transfer_extension table = {sizeof table, 2, rules};

static const void *get_extension(const lahar_model_desc *of, const char *id) {
  (void)of;
  return strcmp(id, LAHAR_EXTENSION_TRANSFER) ? NULL : &table;
}

static void spoil(void) { model.get_extension = get_extension; }
