/* The capability is declared, the extension is not offered. */
#include "minimal.h"

static void spoil(void) { model.capabilities |= LAHAR_CAPABILITY_TANGENT; }
