#include "analysis/rigid_motions.h"

#include <Eigen/SparseCholesky>
#include <vector>

namespace springstab {
namespace {

constexpr double negligible = 1e-14;  // of the largest diagonal entry
constexpr double rigid_pivot = 1e-9;

// a / its largest diagonal entry, both per unit of mass.
SparseMatrix normalized(const SparseMatrix& a, const Eigen::VectorXd& mass) {
  const double largest = Eigen::VectorXd(a.diagonal()).cwiseQuotient(mass).maxCoeff();
  return largest > 0 ? SparseMatrix(a / largest) : a;
}

SparseMatrix rows_and_columns(const SparseMatrix& a, const std::vector<int>& place, Eigen::Index size) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index j = 0; j < a.outerSize(); ++j)
    for (SparseMatrix::InnerIterator it(a, j); it; ++it)
      if (place[it.row()] >= 0 && place[it.col()] >= 0)
        entries.emplace_back(place[it.row()], place[it.col()], it.value());
  SparseMatrix part(size, size);
  part.setFromTriplets(entries.begin(), entries.end());
  return part;
}

}  // namespace

StructuralMatrices without_rigid_motions(const StructuralMatrices& s) {
  const Eigen::VectorXd mass = s.mass.diagonal();
  SparseMatrix sum = normalized(s.stiffness, mass);
  if (s.has_damping()) sum = SparseMatrix(sum + normalized(s.damping, mass));
  const Eigen::VectorXd diagonal = Eigen::VectorXd(sum.diagonal()).cwiseQuotient(mass);
  std::vector<int> place(s.size(), 0);
  Eigen::VectorXd scale(s.size());
  for (Eigen::Index i = 0; i < s.size(); ++i) {
    if (!(diagonal[i] > negligible)) place[i] = -1;
    scale[i] = place[i] < 0 ? 0 : 1 / std::sqrt(diagonal[i] * mass[i]);
  }
  sum = SparseMatrix(scale.asDiagonal() * sum * scale.asDiagonal());
  SparseMatrix held(s.size(), s.size());  // unit pivots where already held, and no pivot is exactly zero
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < s.size(); ++i) entries.emplace_back(i, i, place[i] < 0 ? 1 : 1e-15);
  held.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<SparseMatrix> factor(sum + held);
  const Eigen::VectorXd pivots = factor.permutationPinv() * factor.vectorD();
  int size = 0;
  for (Eigen::Index i = 0; i < s.size(); ++i)
    if (place[i] >= 0) place[i] = pivots[i] > rigid_pivot ? size++ : -1;

  StructuralMatrices rest;
  rest.stiffness = rows_and_columns(s.stiffness, place, size);
  rest.mass = rows_and_columns(s.mass, place, size);
  if (s.has_damping()) rest.damping = rows_and_columns(s.damping, place, size);
  return rest;
}

}  // namespace springstab
