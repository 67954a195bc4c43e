/* Two models of the same name. */
#include "minimal.h"

static void spoil(void) { plugin.model_count = 2; }
