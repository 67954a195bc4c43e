/* The plugin as it should be: the control of the other files. */
#include "minimal.h"

static void spoil(void) {}
