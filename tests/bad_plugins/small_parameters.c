/* Parameter entries that are too small. */
#include "minimal.h"

static void spoil(void) { model.parameter_size = 8; }
