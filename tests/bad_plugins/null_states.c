/* A count of state variables without the array. */
#include "minimal.h"

static void spoil(void) { model.states = NULL; }
