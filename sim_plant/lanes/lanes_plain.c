/* what every machine of this kind has: SSE2, NEON */
#define LANES 2
#include "kernel_lanes.h"

bool line_works(void) { return true; }
