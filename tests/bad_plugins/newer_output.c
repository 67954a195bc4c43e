/* A plugin for a later minor, with an output that this engine does not know. */
#include "minimal.h"

static void spoil(void) {
  plugin.abi_minor = 7;
  model.outputs |= 1024;
}
