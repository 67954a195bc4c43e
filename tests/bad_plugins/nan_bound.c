/* A hard bound that is not a number. */
#include "minimal.h"

static void spoil(void) { parameters[0].hard_min = NAN; }
