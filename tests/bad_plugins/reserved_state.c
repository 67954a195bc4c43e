/* A state variable with the name of a field that every particle has. */
#include "minimal.h"

static void spoil(void) { states[0].key = "stress"; }
