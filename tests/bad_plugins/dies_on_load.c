/* A plugin whose entry crashes. */
#include "minimal.h"

static void spoil(void) {
  volatile int *nowhere = (volatile int *)8;
  *nowhere = 1;
}
