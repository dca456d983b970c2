#include "analysis/limits/structure_change.h"

#include "analysis/constants.h"

namespace springstab {

Structure changed(const Structure& structure, const StructureChange& change) {
  const auto& [own, damping, every_pose] = structure;
  Structure result{own, damping};
  StructuralMatrices& s = result.matrices;
  s.stiffness *= change.stiffness;
  s.mass *= change.mass;
  if (change.added_mass.size() > 0) s.mass += SparseMatrix(change.added_mass.asDiagonal());
  const double alpha = change.alpha.value_or(damping.alpha);
  if (s.has_damping() || damping.kind == DampingModel::Kind::general) {
    const SparseMatrix more_mass = damping.d0 * (s.mass - own.mass);
    s.damping += more_mass + SparseMatrix(alpha * s.stiffness - damping.alpha * own.stiffness);
  }
  result.damping.alpha = alpha;
  if (damping.kind == DampingModel::Kind::none && alpha > 0)
    result.damping.kind = DampingModel::Kind::rayleigh;
  return result;
}

StiffestMode changed(const StiffestMode& mode, const StructureChange& change) {
  const double factor = change.stiffness / change.mass;
  StiffestMode result = mode;
  for (double* rate : {&result.value, &result.residual}) *rate *= factor;
  for (double* bound : {&result.gershgorin, &result.upper_bound}) *bound *= factor * (1 + 4 * unit_roundoff);
  for (auto* rate : {&result.smallest, &result.lowest})
    if (*rate) **rate *= factor;
  return result;
}

}  // namespace springstab
