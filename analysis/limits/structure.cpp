#include "analysis/limits/structure.h"

#include <Eigen/LU>
#include <cmath>

#include "analysis/proofs/definiteness.h"
#include "solvers/scene/scene.h"
#include "solvers/spring_chain.h"

namespace springstab {
namespace {

double frobenius_product(const SparseMatrix& a, const SparseMatrix& b) { return a.cwiseProduct(b).sum(); }

// S A S with S = 1/√D_ii, or 1/√M_ii where nothing damps: unknowns weigh alike, however light or soft.
StructuralMatrices unit_damping(const StructuralMatrices& s) {
  const Eigen::VectorXd damping = s.damping.diagonal(), mass = s.mass.diagonal();
  const Eigen::VectorXd root = (damping.array() > 0).select(damping, mass).cwiseSqrt().cwiseInverse();
  StructuralMatrices unit;
  unit.stiffness = scaled(s.stiffness, root);
  unit.mass = scaled(s.mass, root);
  unit.damping = scaled(s.damping, root);
  return unit;
}

// Whether no entry is larger than `tolerance` times √(size_i size_j).
bool is_negligible(const SparseMatrix& a, double tolerance, const Eigen::VectorXd& size) {
  for (Eigen::Index j = 0; j < a.outerSize(); ++j)
    for (SparseMatrix::InnerIterator it(a, j); it; ++it)
      if (!(std::abs(it.value()) <= tolerance * std::sqrt(size[it.row()]) * std::sqrt(size[j]))) return false;
  return true;
}

DampingProducts products_of(const StructuralMatrices& s) {
  return {s.mass.norm(),
          s.stiffness.norm(),
          s.damping.norm(),
          frobenius_product(s.mass, s.stiffness),
          frobenius_product(s.damping, s.mass),
          frobenius_product(s.damping, s.stiffness)};
}

DampingModel model_of(const RayleighDamping& damping) {
  const bool none = damping.d0 == 0 && damping.alpha == 0;
  return {none ? DampingModel::Kind::none : DampingModel::Kind::rayleigh, damping.d0, damping.alpha};
}

}  // namespace

// In units in which M and K have size 1.
std::optional<DampingModel> rayleigh_fit(const DampingProducts& of) {
  const double m = of.m, k = of.k;
  const double mk = k > 0 ? of.mk / (m * k) : 0;
  const Eigen::Matrix2d normal{{1, mk}, {mk, k > 0 ? 1.0 : 0.0}};
  const Eigen::Vector2d right{of.dm / m, k > 0 ? of.dk / k : 0};
  const Eigen::Vector2d c = normal.fullPivLu().solve(right);
  DampingModel fit{DampingModel::Kind::rayleigh, c[0] / m, k > 0 ? c[1] / k : 0};
  if (fit.d0 < 0 && -fit.d0 * m <= rayleigh_tolerance * of.d) fit.d0 = 0;
  if (fit.alpha < 0 && -fit.alpha * k <= rayleigh_tolerance * of.d) fit.alpha = 0;
  return fit.d0 >= 0 && fit.alpha >= 0 ? std::optional(fit) : std::nullopt;
}

DampingModel classify_damping(const StructuralMatrices& s) {
  if (!s.has_damping()) return {};
  if (!s.symmetric) return {DampingModel::Kind::general, 0, 0, false};
  const StructuralMatrices unit = unit_damping(s);
  if (const auto fit = rayleigh_fit(products_of(unit))) {
    const SparseMatrix rest = unit.damping - fit->d0 * unit.mass - fit->alpha * unit.stiffness;
    const Eigen::VectorXd sizes = Eigen::VectorXd(unit.damping.diagonal()).cwiseAbs() +
                                  fit->d0 * Eigen::VectorXd(unit.mass.diagonal()) +
                                  fit->alpha * Eigen::VectorXd(unit.stiffness.diagonal()).cwiseAbs();
    if (is_negligible(rest, rayleigh_tolerance, sizes)) return *fit;
  }
  return {DampingModel::Kind::general, 0, 0, is_semidefinite(s.damping, s.mass)};
}

DampingModel damping_of(const Scene& scene) {
  DampingModel damping = model_of(scene.damping());
  if (scene.has_own_damping()) damping.kind = DampingModel::Kind::general;
  return damping;
}

DampingModel damping_of(const SpringChain& chain) { return model_of(chain.damping()); }

Structure structure_of(StructuralMatrices matrices) {
  const DampingModel damping = classify_damping(matrices);
  return {std::move(matrices), damping};
}

Structure structure_of(Scene& scene, const State<Vector>& state) {
  const auto linear = scene.linearization(state);
  Structure structure{{}, damping_of(scene)};
  StructuralMatrices& s = structure.matrices;
  linear->stiffness().to_sparse().swap(s.stiffness);  // Eigen would copy it
  s.mass = lumped_mass(linear->mass());
  if (const BlockSparseMatrix* own = linear->own_damping())
    s.damping = linear->damping().d0 * s.mass + linear->damping().alpha * s.stiffness + own->to_sparse();
  return structure;
}

Structure structure_of(const SpringChain& chain) { return {chain.matrices(), damping_of(chain)}; }

}  // namespace springstab
