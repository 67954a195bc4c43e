/* A model name with a space and a letter that is not ASCII. */
#include "minimal.h"

static void spoil(void) { model.name = "gr\xc3\xbcn clay"; }
