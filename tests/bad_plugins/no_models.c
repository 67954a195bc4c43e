/* A plugin without models. */
#include "minimal.h"

static void spoil(void) { plugin.model_count = 0; }
