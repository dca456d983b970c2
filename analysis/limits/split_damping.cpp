#include "analysis/limits/split_damping.h"

#include <Eigen/LU>

#include "analysis/spectra/spectrum.h"
#include "analysis/spectra/transition_operator.h"
#include "solvers/linear/matrix_system.h"

namespace springstab {
namespace {

// (1 + p) det(1 + A), affine in damping d, of which the part p is implicit, and k; of a step of length 1.
double at_minus_one(const Method& method, double d, double p, double k) {
  const auto one = [](double value) {
    SparseMatrix a(1, 1);
    a.insert(0, 0) = value;
    return a;
  };
  StructuralMatrices s{.stiffness = one(k), .mass = one(1), .damping = one(d)};
  s.implicit_damping = one(p);
  MatrixSystem oscillator(std::move(s));
  Eigen::MatrixXd a = as_dense(transition_operator(oscillator, method, 1));
  a.diagonal().array() += 1;
  return (1 + p) * a.determinant();
}

SparseMatrix part_of(const Method& method, const StructuralMatrices& s) {
  return implicit_damping(s, *method.info().implicit_damping);
}

}  // namespace

bool takes_part(const Method& method, const StructuralMatrices& s) {
  const std::optional<DampingPart> part = method.info().implicit_damping;
  return part && (*part != DampingPart::all || s.says_implicit());
}

bool splits_damping(const Method& method, const StructuralMatrices& s) {
  return s.has_damping() && takes_part(method, s) && (s.damping - part_of(method, s)).norm() > 0;
}

HalfPlane explicit_condition(const Method& method) {
  const double c = at_minus_one(method, 0, 0, 0);
  return {c - at_minus_one(method, 1, 0, 0), c - at_minus_one(method, 0, 0, 1), c};
}

std::optional<HalfPlane> matrix_condition(const Method& method, const StructuralMatrices& s) {
  return takes_part(method, s) ? explicit_condition(method) : stability_region(method).exact_condition();
}

StructuralMatrices with_effective_damping(const Method& method, const StructuralMatrices& s) {
  const HalfPlane free = explicit_condition(method);
  const double implicit_too = free.bound - at_minus_one(method, 1, 1, 0);  // (1 + r) x
  StructuralMatrices effective = s;
  if (s.has_damping()) effective.damping = s.damping + (implicit_too / free.x - 1) * part_of(method, s);
  effective.implicit_damping = {};
  return effective;
}

}  // namespace springstab
