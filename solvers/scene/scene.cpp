#include "solvers/scene/scene.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "solvers/scene/springs.h"
#include "solvers/scene/triangle_cloth.h"

namespace springstab {
namespace {

void append(std::vector<double>& list, const Eigen::Vector3d& p) {
  list.insert(list.end(), {p.x(), p.y(), p.z()});
}

template <class Terms>
Couplings all_couplings(const Terms& terms) {
  Couplings all;
  for (const auto& term : terms) {
    const Couplings some = term->couplings();
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

}  // namespace

template <class Cloth>
Scene::Scene(const Cloth& cloth, const std::vector<int>& pinned, const Eigen::Vector3d& gravity,
             RayleighDamping damping)
    : gravity_(gravity), damping_(damping) {
  std::vector<double> mass = number_particles(cloth.rest, cloth.mass, pinned);
  terms_ = make_terms(cloth, number_, free_count_);
  const Couplings stiffness = all_couplings(terms_.elastic);
  if (terms_.damping.empty()) {
    linear_ = std::make_unique<BlockLinearSystem>(std::move(mass), damping, stiffness);
  } else {
    linear_ = std::make_unique<BlockLinearSystem>(std::move(mass), damping, stiffness,
                                                  all_couplings(terms_.damping));
    for (const auto& term : terms_.damping) term->bind(*linear_->own_damping());
  }
  for (const auto& term : terms_.elastic) term->bind(linear_->stiffness());
}

template Scene::Scene(const SpringNet&, const std::vector<int>&, const Eigen::Vector3d&, RayleighDamping);
template Scene::Scene(const TriangleCloth&, const std::vector<int>&, const Eigen::Vector3d&, RayleighDamping);

// Free particles first; returns their masses.
std::vector<double> Scene::number_particles(const std::vector<Eigen::Vector3d>& rest,
                                            const std::vector<double>& mass, const std::vector<int>& pinned) {
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
  std::vector<double> free_mass;
  int next_free = 0, next_pinned = free_count_;
  for (int i = 0; i < n; ++i) {
    append(is_pinned[i] ? pinned_ : rest_, rest[i]);
    if (!is_pinned[i]) free_mass.push_back(mass[i]);
    number_[i] = is_pinned[i] ? next_pinned++ : next_free++;
  }
  pinned_velocity_.assign(pinned_.size(), 0.0);
  return free_mass;
}

void Scene::set_damping(const RayleighDamping& damping) {
  damping_ = damping;
  linear_->set_damping(damping);
}

double Scene::total_free_mass() const {
  double sum = 0;
  for (double m : linear_->mass()) sum += m;
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
  out.setZero(size());
  for (const auto& term : terms_.elastic) {
    if (damping_.alpha == 0) {
      term->add_force(positions, out.data());
    } else {
      term->add_damped_force(positions, v.data(), damping_.alpha, out.data());
    }
  }
  for (const auto& term : terms_.damping)
    term->add_force(positions, {v.data(), pinned_velocity_.data(), free_count_}, out.data());
  const std::vector<double>& inverse_mass = linear_->inverse_mass();
  for (long i = 0; i < free_count_; ++i)
    out.segment<3>(3 * i) =
        inverse_mass[i] * out.segment<3>(3 * i) + gravity_ - damping_.d0 * v.segment<3>(3 * i);
}

BlockLinearSystem& Scene::linearized(const Vector& x, const Vector&) {
  const ParticleField positions = position_field(x);
  linear_->stiffness().set_zero();
  for (const auto& term : terms_.elastic) {
    if (hessian_ == Hessian::projected) {
      term->add_projected_stiffness(positions, linear_->stiffness());
    } else {
      term->add_stiffness(positions, linear_->stiffness());
    }
  }
  if (BlockSparseMatrix* damping = linear_->own_damping()) {
    damping->set_zero();
    for (const auto& term : terms_.damping) term->add_damping(positions, *damping);
  }
  return *linear_;
}

double Scene::elastic_energy(const Vector& x) const {
  double energy = 0;
  for (const auto& term : terms_.elastic) energy += term->energy(position_field(x));
  return energy;
}

double Scene::potential_energy(const Vector& x) {
  double energy = elastic_energy(x);
  for (int i = 0; i < free_count_; ++i)
    energy -= linear_->mass()[i] * gravity_.dot(x.segment<3>(3 * static_cast<long>(i)));
  return energy;
}

}  // namespace springstab
