/* Loads a plugin by its name and prints where it was found. */
#include "lahar/lahar.h"

#include <stdio.h>

int main(void) {
  lahar_context *context;
  lahar_plugin_info info;
  char text[512] = "";
  info.struct_size = sizeof info;
  if (lahar_context_create(1, &context) != LAHAR_OK || lahar_context_load_plugin(context, "lahar_newtonian", NULL) != LAHAR_OK ||
      lahar_context_plugin_info(context, 0, &info) != LAHAR_OK) {
    lahar_last_error_message(text, sizeof text, NULL);
    printf("%s\n", text);
    return 1;
  }
  printf("%s\n", info.path);
  lahar_context_free(context);
  return 0;
}
