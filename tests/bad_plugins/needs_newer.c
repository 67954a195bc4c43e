/* A model that needs a newer engine. */
#include "minimal.h"

static void spoil(void) { model.required_minor = 7; }
