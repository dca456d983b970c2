// What `limits` says of the matrices and the methods, whoever found it out.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "analysis/structure_limits.h"
#include "experiments/command/output.h"
#include "experiments/limits_options.h"

namespace springstab {

struct LimitsRow {
  Method method;
  MethodLimits limits;  // all unknown if k0 is not
};

/// Of all of a structure's matrices, which need not be at hand.
struct MatricesSize {
  long unknowns, condensed = 0;  // after and by condensation
  double condensed_rate = 0;     // see StructuralMatrices
  bool symmetric = true;
};

/// The one method that was asked for, or those listed. Throws std::invalid_argument for an unknown one.
std::vector<Method> methods_of(const LimitsOptions& options);

std::vector<LimitsRow> rows_of(StructureLimits& answer, const std::vector<Method>& methods, Waiting& waiting);

/// Of the command.
int status_of(StructureLimits& answer, const std::vector<LimitsRow>& rows, const LimitsOptions& options);

/// `mesh`: what was mended in a mesh file, or null.
Json limits_json(StructureLimits& answer, const MatricesSize& size, const std::vector<LimitsRow>& rows,
                 double safety, const Json& mesh);

/// The table and what is to be said beside it; `size_text`: of a scene.
void print_limits(std::ostream& out, StructureLimits& answer, const MatricesSize& size,
                  const std::vector<LimitsRow>& rows, double safety, const std::string& size_text);

}  // namespace springstab
