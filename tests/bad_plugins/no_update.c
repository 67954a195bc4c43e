/* A mandatory function is missing. */
#include "minimal.h"

static void spoil(void) { model.update = NULL; }
