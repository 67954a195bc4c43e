/* A default value outside the hard bounds. */
#include "minimal.h"

static void spoil(void) { parameters[1].default_value = 11.0; }
