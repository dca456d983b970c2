#include "solvers/contact/surface_penalty.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "solvers/contact/friction.h"
#include "solvers/contact/penalty.h"
#include "solvers/linear/dense_solvers.h"

namespace springstab {
namespace {

using TwelveVector = Eigen::Vector<double, 12>;
using TwelveMatrix = Eigen::Matrix<double, 12, 12>;

FourPlaces places_in(const CornerVectors<4>& at, int lane) {
  FourPlaces x;
  for (int c = 0; c < 4; ++c) {
    const Vec3 p = at.get(c, lane);
    x[c] = {p.x, p.y, p.z};
  }
  return x;
}

TwelveVector vector_in(const CornerVectors<4>& u, int lane) {
  TwelveVector all;
  for (int k = 0; k < 12; ++k) all[k] = u.component[k][lane];
  return all;
}

void put(const TwelveVector& from, int lane, CornerVectors<4>& vectors) {
  for (int k = 0; k < 12; ++k) vectors.component[k][lane] = from[k];
}

void put(const TwelveMatrix& from, int lane, CornerBlocks<4>& blocks) {
  for (int c = 0; c < 4; ++c)
    for (int d = c; d < 4; ++d)
      for (int r = 0; r < 9; ++r)
        blocks.entry[9 * upper<4>(c, d) + r][lane] = from(3 * c + r / 3, 3 * d + r % 3);
}

// w ⊗ n.
TwelveVector rate_of(const TouchPlaces& at) {
  TwelveVector rate;
  for (int c = 0; c < 4; ++c) rate.segment<3>(3 * c) = at.weights[c] * at.normal;
  return rate;
}

// What touches as elements, and what couples them.
class OfTouches {
 public:
  explicit OfTouches(std::shared_ptr<SurfaceTouches> touches) : touches_(std::move(touches)) {}

  int size() const { return static_cast<int>(touches_->touches().size()); }
  Couplings couplings() const { return touches_->elements().couplings(); }
  bool couple_at(const ParticleField& x) {
    touches_->find(x);
    Couplings now = couplings();
    for (auto& [i, j] : now)
      if (i > j) std::swap(i, j);
    std::sort(now.begin(), now.end());
    now.erase(std::unique(now.begin(), now.end()), now.end());
    const bool changed = now != coupled_;
    coupled_ = std::move(now);
    return changed;
  }

  // of(touch, places) is a number, a vector or a matrix of each touch at x, and of(touch, places, u) a
  // vector.
  template <class Of>
  double sum(const ParticleField& x, const Of& of) const {
    return at(x).elements().sum(touches_->field(), [&](int batch) {
      return [&, batch](const auto& places, int lane) {
        return of(touch(batch, lane), places_in(places, lane));
      };
    });
  }
  template <class Of>
  void add_vectors(const ParticleField& x, double* out, const Of& of) const {
    at(x).elements().add_vectors(touches_->field(), out, [&](int batch) {
      return [&, batch](const auto& places, int lane, auto& vectors) {
        put(of(touch(batch, lane), places_in(places, lane)), lane, vectors);
      };
    });
  }
  template <class Of>
  void add_vectors(const ParticleField& x, const double* field, double* out, const Of& of) const {
    at(x).elements().add_vectors(touches_->field(), field, out, [&](int batch) {
      return [&, batch](const auto& places, const auto& u, int lane, auto& vectors) {
        put(of(touch(batch, lane), places_in(places, lane), vector_in(u, lane)), lane, vectors);
      };
    });
  }
  // Where blocks are is looked up each time: what touches changes more often than what it couples.
  template <class Of>
  void add_blocks(const ParticleField& x, BlockSparseMatrix& matrix, const Of& of) const {
    at(x).elements().add_blocks(touches_->field(), BlockPlaces<4>(), matrix, [&](int batch) {
      return [&, batch](const auto& places, int lane, auto& blocks) {
        put(of(touch(batch, lane), places_in(places, lane)), lane, blocks);
      };
    });
  }

 private:
  const SurfaceTouches& at(const ParticleField& x) const {
    touches_->find(x);
    return *touches_;
  }
  // The last one also fills up its batch.
  const Touch& touch(int batch, int lane) const {
    const auto touches = touches_->touches();
    return touches[std::min<std::size_t>(batch * batch_size + lane, touches.size() - 1)];
  }

  std::shared_ptr<SurfaceTouches> touches_;
  Couplings coupled_;  // in order
};

class TouchSprings final : public ElasticTerm {
 public:
  TouchSprings(std::shared_ptr<SurfaceTouches> touches, TouchSpring spring)
      : of_(std::move(touches)), spring_(spring) {}

  std::string_view name() const override { return "contact springs of surfaces"; }
  int size() const override { return of_.size(); }
  double energy(const ParticleField& x) const override {
    return of_.sum(x, [this](const Touch& touch, const FourPlaces& at) {
      return touch.count * spring_.energy(touch.kind, at);
    });
  }
  void add_force(const ParticleField& x, double* force) const override {
    of_.add_vectors(x, force, [this](const Touch& touch, const FourPlaces& at) -> TwelveVector {
      return -touch.count * spring_.gradient(touch.kind, at).reshaped();
    });
  }
  void add_stiffness_times(const ParticleField& x, const double* u, double scale,
                           double* out) const override {
    of_.add_vectors(x, u, out,
                    [=, this](const Touch& touch, const FourPlaces& at, const TwelveVector& moved) {
                      return TwelveVector(scale * hessian(touch, at) * moved);
                    });
  }
  Couplings couplings() const override { return of_.couplings(); }
  bool couple_at(const ParticleField& x) override { return of_.couple_at(x); }
  void add_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const override {
    of_.add_blocks(x, stiffness,
                   [this](const Touch& touch, const FourPlaces& at) { return hessian(touch, at); });
  }
  void add_projected_stiffness(const ParticleField& x, BlockSparseMatrix& stiffness) const override {
    of_.add_blocks(x, stiffness, [this](const Touch& touch, const FourPlaces& at) -> TwelveMatrix {
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(Eigen::MatrixXd(hessian(touch, at)));
      return modes.eigenvectors() * modes.eigenvalues().cwiseMax(0).asDiagonal() *
             modes.eigenvectors().transpose();
    });
  }

 private:
  TwelveMatrix hessian(const Touch& touch, const FourPlaces& at) const {
    return touch.count * spring_.hessian(touch.kind, at);
  }

  OfTouches of_;
  TouchSpring spring_;
};

// Where the count is positive: else C would give energy.
class TouchDampers final : public DampingTerm {
 public:
  TouchDampers(std::shared_ptr<SurfaceTouches> touches, double damping)
      : of_(std::move(touches)), damping_(damping) {}

  std::string_view name() const override { return "contact dampers of surfaces"; }
  int size() const override { return of_.size(); }
  void add_force(const ParticleField& x, const ParticleField& v, double* force) const override {
    of_.add_vectors(x, v.free, force,
                    [this](const Touch& touch, const FourPlaces& at, const TwelveVector& velocity) {
                      const TouchPlaces places = touch_places(touch.kind, at);
                      const TwelveVector rate = rate_of(places);
                      return TwelveVector(-strength(touch, places) * rate.dot(velocity) * rate);
                    });
  }
  Couplings couplings() const override { return of_.couplings(); }
  bool couple_at(const ParticleField& x) override { return of_.couple_at(x); }
  void add_damping(const ParticleField& x, BlockSparseMatrix& damping) const override {
    of_.add_blocks(x, damping, [this](const Touch& touch, const FourPlaces& at) {
      const TouchPlaces places = touch_places(touch.kind, at);
      const TwelveVector rate = rate_of(places);
      return TwelveMatrix(strength(touch, places) * rate * rate.transpose());
    });
  }

 private:
  double strength(const Touch& touch, const TouchPlaces& at) const {
    return damping_ * std::max(touch.count, 0) * at.share;
  }

  OfTouches of_;
  double damping_;
};

Eigen::Vector3d rate_of_parting(const Touch& touch, const TouchPlaces& at, const Vector& v) {
  Eigen::Vector3d sum(0, 0, 0);
  for (int k = 0; k < 4; ++k)
    if (const Eigen::Index i = 3 * static_cast<Eigen::Index>(touch.particles[k]); i < v.size())
      sum += at.weights[k] * v.segment<3>(i);
  return sum;
}

}  // namespace

TermMaker surface_penalty_terms(const Contact& contact, std::shared_ptr<SurfaceTouches> touches) {
  return [touches = std::move(touches), penalty = penalty_of(contact), thickness = contact.thickness](
             const std::vector<int>&, int) {
    SceneTerms terms;
    terms.elastic.push_back(
        std::make_unique<TouchSprings>(touches, TouchSpring{penalty.stiffness, thickness}));
    if (penalty.damping > 0)
      terms.damping.push_back(std::make_unique<TouchDampers>(touches, penalty.damping));
    return terms;
  };
}

SurfacePenaltyFilter::SurfacePenaltyFilter(const Contact& contact, std::vector<double> mass,
                                           std::shared_ptr<SurfaceTouches> touches)
    : friction_(contact.friction),
      stiffness_(penalty_of(contact).stiffness),
      mass_(std::move(mass)),
      touches_(std::move(touches)) {
  if (friction_ > 0 && !contact.obstacles.empty())
    of_obstacles_ = std::make_unique<PenaltyFriction>(contact, mass_);
  counts_.springs.emplace();
}

Filtered SurfacePenaltyFilter::apply(double t, double h, const State<Vector>& before, State<Vector>& after) {
  touches_->find(after.x);
  counts_.pairs += std::ssize(touches_->touches());
  const long contacts = whole_contacts(touches_->most_contacts());
  if (SpringCounts& springs = *counts_.springs; contacts > springs.contacts) {
    springs.contacts = contacts;
    if (is_planned_for_ && !is_planned_for_(contacts)) {
      ++springs.plans;
      return Filtered::outgrown;
    }
  }
  bool changed = false;
  if (friction_ > 0)
    for (const Touch& touch : touches_->touches())
      if (rub(touch, h, before, after)) changed = true;
  if (of_obstacles_) {
    of_obstacles_->set_counts({});
    if (of_obstacles_->apply(t, h, before, after) == Filtered::changed) changed = true;
    counts_.pairs += of_obstacles_->counts().pairs;
    counts_.impulses += of_obstacles_->counts().impulses;
    counts_.friction_work += of_obstacles_->counts().friction_work;
  }
  return changed ? Filtered::changed : Filtered::unchanged;
}

// The two places weigh 1/Σ (w²/m) against each other.
bool SurfacePenaltyFilter::rub(const Touch& touch, double h, const State<Vector>& before,
                               State<Vector>& after) {
  const TouchPlaces at = touch_places(touch.kind, touches_->places(touch));
  const double overlap = touches_->thickness() - at.distance;
  if (touch.count < 0 || !(overlap > 0)) return false;
  double mobility = 0;
  for (int k = 0; k < 4; ++k)
    if (touch.particles[k] < touches_->free_count())
      mobility += at.weights[k] * at.weights[k] / mass_[touch.particles[k]];
  const Eigen::Vector3d from = tangential(rate_of_parting(touch, at, before.v), at.normal),
                        slip = tangential(rate_of_parting(touch, at, after.v), at.normal);
  if (!(mobility > 0)) return false;
  const double most = friction_ * h * stiffness_ * touch.count * at.share * overlap;
  const Eigen::Vector3d q = friction_impulse(most, 1 / mobility, from, slip);
  for (int k = 0; k < 4; ++k)
    if (const int i = touch.particles[k]; i < touches_->free_count())
      after.v.segment<3>(3 * static_cast<Eigen::Index>(i)) += at.weights[k] / mass_[i] * q;
  ++counts_.impulses;
  counts_.friction_work += q.dot(slip + mobility * q + from) / 2;
  return true;
}

long whole_contacts(double most) { return std::max(1L, std::lround(std::ceil(most * (1 - 1e-12)))); }

}  // namespace springstab
