// `springstab-mpi limits`.
#pragma once

#include "experiments/limits_options.h"

namespace springstab::mpi {

/// What `springstab limits` does, of matrices that no rank holds alone; returns an ExitStatus. All ranks call
/// it.
int run_distributed_limits(const CommonOptions& common, const LimitsOptions& options);

}  // namespace springstab::mpi
