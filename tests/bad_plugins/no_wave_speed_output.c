/* The mandatory output is not declared. */
#include "minimal.h"

static void spoil(void) { model.outputs = 0; }
