/* A plugin that wants a newer engine than the one that asks, and refuses. */
#include "lahar/lahar_plugin.h"

#include <stddef.h>

const lahar_plugin_desc *lahar_plugin_entry_v1(const lahar_host_api *host) {
  if (host->abi_minor < 7) host->set_error("needs an engine of minor 7");
  return NULL;
}
