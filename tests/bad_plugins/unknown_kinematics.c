/* A kind of kinematics that does not exist. */
#include "minimal.h"

static void spoil(void) { model.kinematics = 7; }
