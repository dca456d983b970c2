#include "solvers/contact/penalty.h"

#include <array>
#include <stdexcept>
#include <string>

#include "solvers/contact/friction.h"
#include "solvers/scene/element_term.h"

namespace springstab {
namespace {

// Calls visit(gap) for every obstacle that a particle is in.
template <class Visit>
void for_each_touch(const Contact& contact, const Eigen::Vector3d& x, const Visit& visit) {
  for (const Obstacle& obstacle : contact.obstacles) {
    Gap at = gap_at(obstacle, x, 0);
    at.gap -= contact.thickness;
    if (at.gap < 0) visit(at);
  }
}

ElementEnergy<1> contact_energy(const Contact& contact, double stiffness, const Eigen::Vector3d& x) {
  ElementEnergy<1> sum{0, Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero()};
  for_each_touch(contact, x, [&](const Gap& at) {
    const Eigen::Matrix3d axial = at.normal * at.normal.transpose();
    sum.energy += stiffness * at.gap * at.gap / 2;
    sum.gradient += stiffness * at.gap * at.normal;
    sum.hessian += stiffness * (axial + at.gap * at.curvature * (Eigen::Matrix3d::Identity() - axial));
  });
  return sum;
}

class ContactDampers final : public DampingTerm {
 public:
  ContactDampers(const Contact& contact, double damping, int free_count)
      : contact_(contact), damping_(damping), free_count_(free_count) {}

  std::string_view name() const override { return "contact dampers"; }
  int size() const override { return free_count_; }
  void add_force(const ParticleField& x, const ParticleField& v, double* force) const override {
    for (int i = 0; i < free_count_; ++i)
      for_each_touch(contact_, Eigen::Vector3d::Map(x[i]), [&](const Gap& at) {
        Eigen::Vector3d::Map(force + 3 * static_cast<long>(i)) -=
            damping_ * at.normal.dot(Eigen::Vector3d::Map(v[i])) * at.normal;
      });
  }
  Couplings couplings() const override { return {}; }
  void add_damping(const ParticleField& x, BlockSparseMatrix& damping) const override {
    for (int i = 0; i < free_count_; ++i)
      for_each_touch(contact_, Eigen::Vector3d::Map(x[i]), [&](const Gap& at) {
        add_isotropic_and_axial(damping.block(damping.diagonal(i)), 0, damping_, at.normal.data());
      });
  }

 private:
  Contact contact_;
  double damping_;
  int free_count_;
};

}  // namespace

const Penalty& penalty_of(const Contact& contact) {
  const auto* penalty = std::get_if<Penalty>(&contact.model);
  if (!penalty) throw std::invalid_argument("the contact is by impulses, expected a penalty");
  return *penalty;
}

TermMaker penalty_terms(const Contact& contact) {
  const Penalty penalty = penalty_of(contact);
  for (const Obstacle& obstacle : contact.obstacles)
    if (!obstacle.velocity.isZero(0))
      throw std::invalid_argument("an obstacle of a penalty moves, expected one at rest");
  return [=](const std::vector<int>&, int free_count) {
    std::vector<std::array<int, 1>> particles;
    for (int i = 0; i < free_count; ++i) particles.push_back({i});
    SceneTerms terms;
    terms.elastic.push_back(std::make_unique<ElementTerm<1>>(
        "contact springs", std::move(particles), free_count,
        [=](int, const Eigen::Vector3d& x) { return contact_energy(contact, penalty.stiffness, x); }));
    if (penalty.damping > 0)
      terms.damping.push_back(std::make_unique<ContactDampers>(contact, penalty.damping, free_count));
    return terms;
  };
}

PenaltyFriction::PenaltyFriction(const Contact& contact, std::vector<double> mass)
    : contact_(contact), stiffness_(penalty_of(contact).stiffness), mass_(std::move(mass)) {}

Filtered PenaltyFriction::apply(double, double h, const State<Vector>& before, State<Vector>& after) {
  bool changed = false;
  for (std::size_t i = 0; i < mass_.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(3 * i);
    Eigen::Vector3d v = after.v.segment<3>(at);
    const Eigen::Vector3d from = before.v.segment<3>(at);
    counts_.pairs += static_cast<long>(contact_.obstacles.size());
    for_each_touch(contact_, after.x.segment<3>(at), [&](const Gap& gap) {
      const Eigen::Vector3d q = friction_impulse(-contact_.friction * h * stiffness_ * gap.gap, mass_[i],
                                                 tangential(from, gap.normal), tangential(v, gap.normal));
      v += q / mass_[i];
      ++counts_.impulses;
      counts_.friction_work += q.dot(v + from) / 2;
      changed = true;
    });
    after.v.segment<3>(at) = v;
  }
  return changed ? Filtered::changed : Filtered::unchanged;
}

}  // namespace springstab
