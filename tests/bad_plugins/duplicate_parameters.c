/* Two parameters of the same name. */
#include "minimal.h"

static void spoil(void) { parameters[1].key = "first"; }
