#define LANES 4
#include "kernel_lanes.h"

bool line_works(void) { return __builtin_cpu_supports("avx2"); }
