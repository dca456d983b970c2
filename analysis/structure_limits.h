// The one call: see analysis/limits/structure_limits.h.
#pragma once

#include "analysis/limits/structure_limits.h"  // IWYU pragma: export
