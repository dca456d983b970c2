#include "solvers/linear/coupled_stages.h"

namespace springstab {

bool CoupledStages::is_factorized(const StageCoupling& coupling) const {
  return coupling_.damping.size() > 0 && coupling_.damping == coupling.damping &&
         coupling_.stiffness == coupling.stiffness;
}

// Unknown u of stage i is number us + i, so that what couples lies close together.
void CoupledStages::factorize(const StageCoupling& coupling, const StructuralMatrices& matrices) {
  const Eigen::Index n = matrices.size(), s = coupling.damping.rows();
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](const SparseMatrix& matrix, const Eigen::MatrixXd& factor) {
    for (Eigen::Index c = 0; c < matrix.outerSize(); ++c)
      for (SparseMatrix::InnerIterator at(matrix, c); at; ++at)
        for (Eigen::Index i = 0; i < s; ++i)
          for (Eigen::Index j = 0; j < s; ++j)
            if (factor(i, j) != 0)
              entries.emplace_back(static_cast<int>(at.row() * s + i), static_cast<int>(at.col() * s + j),
                                   factor(i, j) * at.value());
  };
  add(matrices.mass, Eigen::MatrixXd::Identity(s, s));
  add(matrices.stiffness, coupling.stiffness);
  if (matrices.has_damping()) add(matrices.damping, coupling.damping);
  SparseMatrix whole(n * s, n * s);
  whole.setFromTriplets(entries.begin(), entries.end());
  factors_.compute(whole);
  singular_ = factors_.info() != Eigen::Success;
  coupling_ = coupling;
}

SolveReport CoupledStages::solve(const SparseMatrix& mass, const std::vector<Vector>& rhs,
                                 std::vector<Vector>& out) {
  if (singular_) return {.status = StepStatus::not_positive_definite};
  const auto s = static_cast<Eigen::Index>(rhs.size()), n = mass.rows();
  right_.resize(n * s);
  const auto stage = [s, n](Vector& all, Eigen::Index i) {
    return Eigen::Map<Vector, 0, Eigen::InnerStride<>>(all.data() + i, n, Eigen::InnerStride<>(s));
  };
  for (Eigen::Index i = 0; i < s; ++i) stage(right_, i) = mass * rhs[static_cast<std::size_t>(i)];
  all_ = factors_.solve(right_);
  for (Eigen::Index i = 0; i < s; ++i) out[static_cast<std::size_t>(i)] = stage(all_, i);
  return {.status = all_.allFinite() ? StepStatus::done : StepStatus::diverged};
}

}  // namespace springstab
