/* An output that no engine knows. */
#include "minimal.h"

static void spoil(void) { model.outputs |= (uint64_t)1 << 40; }
