// The catalogue run, as a table.
#pragma once

#include "experiments/studies/stress/runner.h"

namespace springstab {

/// Every case whose kind or name contains `filter`, by every method. In their order.
std::vector<StressResult> run_catalogue(const std::string& filter, const CommonOptions& common);

/// One row a case and method.
void write_stress(const std::string& path, const std::vector<StressResult>& results);

}  // namespace springstab
