/* An input that this engine does not offer. */
#include "minimal.h"

static void spoil(void) { inputs[0] = 12; }
