/* The entry returns NULL and says why. */
#include "lahar/lahar_plugin.h"

#include <stddef.h>

const lahar_plugin_desc *lahar_plugin_entry_v1(const lahar_host_api *host) {
  host->set_error("the licence server is asleep");
  return NULL;
}
