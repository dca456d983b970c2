#include "solvers/scene/scene.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <string>

#include "solvers/scene/springs.h"
#include "solvers/scene/tet_solid.h"
#include "solvers/scene/triangle_cloth.h"
#include "solvers/team.h"

namespace springstab {
namespace {

void append(std::vector<double>& list, const Eigen::Vector3d& p) {
  list.insert(list.end(), {p.x(), p.y(), p.z()});
}

template <class Terms>
Couplings all_couplings(const Terms& terms) {
  Couplings all;
  for (const auto& term : terms) {
    Couplings some = term->couplings();
    if (all.empty()) {
      all = std::move(some);
    } else {
      all.insert(all.end(), some.begin(), some.end());
    }
  }
  return all;
}

}  // namespace

Scene::Scene(const std::vector<Eigen::Vector3d>& rest, const std::vector<double>& mass,
             const TermMaker& make_terms, const std::vector<int>& pinned, const Eigen::Vector3d& gravity,
             RayleighDamping damping)
    : gravity_(gravity), damping_(damping) {
  if (mass.size() != rest.size())
    throw std::invalid_argument(std::to_string(mass.size()) + " masses for " + std::to_string(rest.size()) +
                                " particles");
  for (const double m : mass)
    if (!(m > 0 && std::isfinite(m)))
      throw std::invalid_argument("a particle's mass is " + std::to_string(m) +
                                  " kg, expected positive and finite");
  number_particles(rest, mass, pinned);
  terms_ = make_terms(number_, free_count_);
}

template <class Cloth>
Scene::Scene(const Cloth& cloth, const std::vector<int>& pinned, const Eigen::Vector3d& gravity,
             RayleighDamping damping)
    : Scene(
          cloth.rest, cloth.mass,
          [&](const std::vector<int>& number, int free_count) {
            return make_terms(cloth, number, free_count);
          },
          pinned, gravity, damping) {}

void Scene::add(const TermMaker& make_terms) {
  if (has_matrices())
    throw std::invalid_argument("a term was added after the scene's matrices were made, expected before");
  SceneTerms more = make_terms(number_, free_count_);
  std::move(more.elastic.begin(), more.elastic.end(), std::back_inserter(terms_.elastic));
  std::move(more.damping.begin(), more.damping.end(), std::back_inserter(terms_.damping));
}

template Scene::Scene(const SpringNet&, const std::vector<int>&, const Eigen::Vector3d&, RayleighDamping);
template Scene::Scene(const TriangleCloth&, const std::vector<int>&, const Eigen::Vector3d&, RayleighDamping);
template Scene::Scene(const TetSolid&, const std::vector<int>&, const Eigen::Vector3d&, RayleighDamping);

// Free particles first.
void Scene::number_particles(const std::vector<Eigen::Vector3d>& rest, const std::vector<double>& mass,
                             const std::vector<int>& pinned) {
  const int n = static_cast<int>(rest.size());
  std::vector<bool> is_pinned(n, false);
  for (int i : pinned) {
    if (i < 0 || i >= n)
      throw std::invalid_argument("pinned particle " + std::to_string(i) + " does not exist, expected 0 to " +
                                  std::to_string(n - 1));
    is_pinned[i] = true;
  }
  free_count_ = static_cast<int>(std::count(is_pinned.begin(), is_pinned.end(), false));
  if (free_count_ == 0)
    throw std::invalid_argument("all particles are pinned, expected at least one that can move");

  number_.resize(n);
  rest_.reserve(3 * static_cast<std::size_t>(free_count_));
  mass_.reserve(static_cast<std::size_t>(free_count_));
  inverse_mass_.reserve(mass_.capacity());
  int next_free = 0, next_pinned = free_count_;
  for (int i = 0; i < n; ++i) {
    append(is_pinned[i] ? pinned_ : rest_, rest[i]);
    if (!is_pinned[i]) mass_.push_back(mass[i]);
    number_[i] = is_pinned[i] ? next_pinned++ : next_free++;
  }
  for (const double m : mass_) inverse_mass_.push_back(1 / m);
  pinned_velocity_.assign(pinned_.size(), 0.0);
}

void Scene::make_patterns(const ParticleField& x) {
  bool changed = !has_matrices();
  for (const auto& term : terms_.elastic) changed = term->couple_at(x) || changed;
  for (const auto& term : terms_.damping) changed = term->couple_at(x) || changed;
  if (!changed) return;
  stiffness_pattern_ = std::make_shared<BlockPattern>(free_count_, all_couplings(terms_.elastic));
  for (const auto& term : terms_.elastic) term->bind(stiffness_pattern_);
  if (terms_.damping.empty()) return;
  damping_pattern_ = std::make_shared<BlockPattern>(free_count_, all_couplings(terms_.damping));
  for (const auto& term : terms_.damping) term->bind(damping_pattern_);
}

void Scene::forget_matrices() {
  stiffness_pattern_ = damping_pattern_ = nullptr;
  for (const auto& term : terms_.elastic) term->unbind();
  for (const auto& term : terms_.damping) term->unbind();
}

double Scene::total_free_mass() const {
  double sum = 0;
  for (double m : mass_) sum += m;
  return sum;
}

State<Vector> Scene::rest_state() const {
  return {Eigen::Map<const Vector>(rest_.data(), size()), Vector::Zero(size())};
}

void Scene::place_pinned(const std::vector<Eigen::Vector3d>& positions) {
  if (3 * positions.size() != pinned_.size())
    throw std::invalid_argument(std::to_string(positions.size()) + " positions for " +
                                std::to_string(pinned_.size() / 3) + " pinned particles");
  pinned_.clear();
  for (const Eigen::Vector3d& p : positions) append(pinned_, p);
}

std::vector<Eigen::Vector3d> Scene::positions(const Vector& x) const {
  const ParticleField field = position_field(x);
  std::vector<Eigen::Vector3d> all;
  for (int place : number_) all.emplace_back(field[place][0], field[place][1], field[place][2]);
  return all;
}

ParticleField Scene::position_field(const Vector& x) const { return {x.data(), pinned_.data(), free_count_}; }

void Scene::acceleration(const Vector& x, const Vector& v, Vector& out) {
  const ParticleField positions = position_field(x);
  out.resize(size());
  share_range(size(), 0.3, [&](long first, long last) { out.segment(first, last - first).setZero(); });
  for (const auto& term : terms_.elastic) {
    if (damping_.alpha == 0) {
      term->add_force(positions, out.data());
    } else {
      term->add_damped_force(positions, v.data(), damping_.alpha, out.data());
    }
  }
  for (const auto& term : terms_.damping)
    term->add_force(positions, {v.data(), pinned_velocity_.data(), free_count_}, out.data());
  const double* const w = v.data();
  double* const a = out.data();
  const double d0 = damping_.d0, g[3] = {gravity_.x(), gravity_.y(), gravity_.z()};
  share_range(free_count_, 2, [&](long first, long last) {
    for (long i = first; i < last; ++i)
      for (int r = 0; r < 3; ++r) a[3 * i + r] = inverse_mass_[i] * a[3 * i + r] + g[r] - d0 * w[3 * i + r];
  });
}

void Scene::linearize(const Vector& x, const Vector& v, Linearization<Vector>& linear) {
  auto mine = std::dynamic_pointer_cast<BlockLinearSystem>(std::move(linear));
  linearize(x, v, mine);
  linear = std::move(mine);
}

void Scene::linearize(const Vector& x, const Vector&, std::shared_ptr<BlockLinearSystem>& linear) {
  const ParticleField positions = position_field(x);
  make_patterns(positions);
  if (!linear || linear.use_count() > 1 || linear->stiffness().pattern() != stiffness_pattern_)
    linear = std::make_shared<BlockLinearSystem>(mass_, damping_, stiffness_pattern_, damping_pattern_);
  linear->set_damping(damping_);
  linear->solver = solver_;
  BlockSparseMatrix& stiffness = linear->stiffness();
  stiffness.set_zero();
  for (const auto& term : terms_.elastic) {
    if (hessian_ == Hessian::projected) {
      term->add_projected_stiffness(positions, stiffness);
    } else {
      term->add_stiffness(positions, stiffness);
    }
  }
  if (BlockSparseMatrix* damping = linear->own_damping()) {
    damping->set_zero();
    for (const auto& term : terms_.damping) term->add_damping(positions, *damping);
  }
}

std::shared_ptr<BlockLinearSystem> Scene::linearization(const State<Vector>& state) {
  std::shared_ptr<BlockLinearSystem> linear;
  linearize(state.x, state.v, linear);
  return linear;
}

double Scene::kinetic_energy(const Vector& v) {
  double sum = 0;
  for (long i = 0; i < free_count_; ++i) sum += mass_[i] * v.segment<3>(3 * i).squaredNorm();
  return sum / 2;
}

double Scene::elastic_energy(const Vector& x) const {
  double energy = 0;
  for (const auto& term : terms_.elastic) energy += term->energy(position_field(x));
  return energy;
}

double Scene::potential_energy(const Vector& x) {
  double energy = elastic_energy(x);
  for (int i = 0; i < free_count_; ++i)
    energy -= mass_[i] * gravity_.dot(x.segment<3>(3 * static_cast<long>(i)));
  return energy;
}

}  // namespace springstab
