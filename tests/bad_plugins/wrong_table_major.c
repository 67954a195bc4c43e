/* The entry of this major with a table of another. */
#include "minimal.h"

static void spoil(void) { plugin.abi_major = 2; }
