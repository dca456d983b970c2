#include "solvers/methods/tableau.h"

#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace springstab {
namespace {

constexpr double rounding_of_coefficients = 1e-9;
constexpr int highest_order = 8;

void expect_one(double sum, const char* name) {
  if (std::abs(sum - 1) <= rounding_of_coefficients) return;
  std::ostringstream message;
  message.precision(12);
  message << "inconsistent: the sum of " << name << " is " << sum << ", expected 1";
  throw std::invalid_argument(message.str());
}

// What may hang on a force in a tree of derivatives: γ and, stage by stage, how far it moves X or V.
struct Branch {
  double gamma;
  Eigen::ArrayXd moves;
};

struct Tree {
  double gamma;
  Eigen::ArrayXd weight;  // Φ_i
};

using Branches = std::vector<std::vector<Branch>>;  // by order

// Appends every product of branches (of `order`, from number `from` on, or of a lower order) with `left` to
// go.
void grow(const Branches& branches, int left, int order, std::size_t from, const Tree& so_far,
          std::vector<Tree>& all) {
  if (left == 0) all.push_back(so_far);
  for (int o = std::min(order, left); o >= 1; --o) {
    const std::vector<Branch>& level = branches[static_cast<std::size_t>(o)];
    for (std::size_t i = o == order ? from : 0; i < level.size(); ++i)
      grow(branches, left - o, o, i, {so_far.gamma * level[i].gamma, so_far.weight * level[i].moves}, all);
  }
}

}  // namespace

StageTableau runge_kutta(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return partitioned(a, b, a, b);
}

StageTableau partitioned(const Eigen::MatrixXd& a, const Eigen::VectorXd& b,
                         const Eigen::MatrixXd& a_velocity, const Eigen::VectorXd& b_velocity) {
  expect_one(b.sum(), "b");
  StageTableau t{.position = a * a_velocity,
                 .velocity = a_velocity,
                 .c = a.rowwise().sum(),
                 .position_weights = a_velocity.transpose() * b,
                 .velocity_weights = b_velocity};
  check_consistent(t);
  return t;
}

void check_consistent(const StageTableau& tableau) { expect_one(tableau.velocity_weights.sum(), "b"); }

StageTableau without_idle_stages(const StageTableau& t) {
  const Eigen::Index s = t.c.size();
  Eigen::Array<bool, Eigen::Dynamic, 1> used =
      t.position_weights.array() != 0 || t.velocity_weights.array() != 0;
  for (Eigen::Index round = 0; round < s; ++round)
    for (Eigen::Index i = 0; i < s; ++i)
      if (used[i])
        used =
            used || t.position.row(i).transpose().array() != 0 || t.velocity.row(i).transpose().array() != 0;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < s; ++i)
    if (used[i]) kept.push_back(i);
  return {t.position(kept, kept), t.velocity(kept, kept), t.c(kept), t.position_weights(kept),
          t.velocity_weights(kept)};
}

StageKind kind_of(const StageTableau& t) {
  const Eigen::MatrixXd size = t.position.cwiseAbs() + t.velocity.cwiseAbs();
  if (!size.triangularView<Eigen::StrictlyUpper>().toDenseMatrix().isZero(0))
    return StageKind::fully_implicit;
  return size.diagonal().isZero(0) ? StageKind::explicit_stages : StageKind::diagonally_implicit;
}

// A tree of n forces' worth of h moves v⁺ by h^n b̂Φ, where the motion has h^n/γ, and x⁺ by h^(n+1) b̄Φ, where
// it has h^(n+1)/((n+1)γ). On a force hang: h c_i v of order 1; another tree's hâΦ; its h²āΦ, one order more.
int order_of(const StageTableau& t) {
  const auto off = [](double sum, double expected) {
    return std::abs(sum - expected) > rounding_of_coefficients;
  };
  Branches branches(highest_order + 2);
  branches[1].push_back({1, t.c.array()});
  std::vector<Tree> before;
  for (int n = 1; n <= highest_order; ++n) {
    for (const Tree& tree : before)
      if (off(t.position_weights.dot(tree.weight.matrix()), 1 / (n * tree.gamma))) return n - 1;
    std::vector<Tree> trees;
    grow(branches, n - 1, n - 1, 0, {1.0 * n, Eigen::ArrayXd::Ones(t.c.size())}, trees);
    for (const Tree& tree : trees) {
      if (off(t.velocity_weights.dot(tree.weight.matrix()), 1 / tree.gamma)) return n - 1;
      const auto of_order = static_cast<std::size_t>(n);
      branches[of_order].push_back({tree.gamma, (t.velocity * tree.weight.matrix()).array()});
      branches[of_order + 1].push_back({(n + 1) * tree.gamma, (t.position * tree.weight.matrix()).array()});
    }
    before = std::move(trees);
  }
  return highest_order;
}

}  // namespace springstab
