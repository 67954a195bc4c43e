/* An update that fails with a text, after a line for the log. */
#include "minimal.h"

static int32_t fail(const void *instance, const lahar_stress_batch *b) {
  (void)instance;
  (void)b;
  host->log(LAHAR_PLUGIN_LOG_WARNING, "about to fail");
  host->set_error("the clay is not in the mood");
  return LAHAR_PLUGIN_ERROR;
}

static void spoil(void) { model.update = fail; }
