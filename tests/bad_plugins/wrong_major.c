/* A plugin of another major of the ABI. */
#include <stddef.h>

const void *lahar_plugin_entry_v2(const void *host);

const void *lahar_plugin_entry_v2(const void *host) {
  (void)host;
  return NULL;
}
