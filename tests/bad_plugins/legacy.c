/* Nothing wrong: a model that says of itself that it may print and end the process. */
#include "minimal.h"

static void spoil(void) { model.capabilities |= LAHAR_CAPABILITY_MAY_STOP | LAHAR_CAPABILITY_MAY_PRINT; }
