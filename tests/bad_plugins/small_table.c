/* A plugin table that is too small. */
#include "minimal.h"

static void spoil(void) { plugin.struct_size = 16; }
