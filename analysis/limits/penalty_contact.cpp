#include "analysis/limits/penalty_contact.h"

#include <stdexcept>

namespace springstab {

StructuralMatrices in_any_contact(StructuralMatrices s, const ContactBound& bound, double alpha) {
  SparseMatrix unit(s.size(), s.size());
  unit.setIdentity();
  s.stiffness += bound.stiffness * unit;
  const double damping = bound.damping + alpha * bound.stiffness;
  if (damping > 0 && s.damping.size() == 0) s.damping.resize(s.size(), s.size());
  if (damping > 0) s.damping += damping * unit;
  return s;
}

Structure in_any_contact(Structure structure, const ContactBound& bound) {
  const bool whole = structure.damping.kind == DampingModel::Kind::general;
  if (!whole && bound.damping > 0)
    throw std::invalid_argument("contact has dampers, expected a structure with all of its damping matrix");
  structure.matrices =
      in_any_contact(std::move(structure.matrices), bound, whole ? structure.damping.alpha : 0);
  return structure;
}

}  // namespace springstab
