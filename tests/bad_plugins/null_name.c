/* A name that is NULL. */
#include "minimal.h"

static void spoil(void) { model.name = NULL; }
