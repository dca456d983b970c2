// A scene: particles, some of them pinned, and the sum of what acts on them. The unknowns are the free
// particles' coordinates, three per particle in the order of their numbers; pinned ones do not appear.
//
//     const SpringNet net = make_net(Grid{.rows = 8, .columns = 8}, SpringMaterial{});
//     Scene scene(net, {0, 7}, {0, -9.81, 0}, RayleighDamping{.d0 = 1});  // two corners pinned
//     State<Vector> state = scene.rest_state();
//     const auto rk4 = make_stepper(Rk4());
//     for (int i = 0; i < 100; ++i) rk4->step(scene, 1e-3, state);
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "solvers/linear/block_linear_system.h"
#include "solvers/scene/terms.h"
#include "solvers/system.h"

namespace springstab {

struct SpringNet;
struct TriangleCloth;
struct TetSolid;

/// Of the elastic energy, in a linearization.
enum class Hessian {
  exact,
  projected,  // positive semidefinite, element by element; other eigenvalues where cloth is compressed
};

/// M x'' = f_elastic(x) + M g - d0 M v - alpha K(x) v - C(x) v. Rayleigh damping uses the exact K at the
/// positions that a force is evaluated at; the change of the damping matrices with x is neglected in the
/// linearization.
class Scene final : public System {
 public:
  /// A SpringNet, a TriangleCloth or a TetSolid with the given particles pinned at their rest positions.
  /// `pinned` ascends without repeats. Throws std::invalid_argument for an index out of range and when
  /// nothing is left to move.
  template <class Cloth>
  Scene(const Cloth& cloth, const std::vector<int>& pinned, const Eigen::Vector3d& gravity,
        RayleighDamping damping);

  /// Any particles at their rest positions [m] with their masses [kg], and whatever terms act on them; none
  /// where the maker makes none. Throws likewise, and where a mass is not positive and finite or not one for
  /// each particle.
  Scene(const std::vector<Eigen::Vector3d>& rest, const std::vector<double>& mass,
        const TermMaker& make_terms, const std::vector<int>& pinned, const Eigen::Vector3d& gravity,
        RayleighDamping damping);

  /// More that acts on the particles. Throws std::invalid_argument once there are matrices (has_matrices):
  /// their pattern is that of the terms at hand when they were made.
  void add(const TermMaker& make_terms);

  int particles() const { return static_cast<int>(number_.size()); }
  int free_particles() const { return free_count_; }
  const RayleighDamping& damping() const { return damping_; }
  bool has_own_damping() const { return !terms_.damping.empty(); }
  const SceneTerms& terms() const { return terms_; }
  const std::vector<double>& free_masses() const { return mass_; }  // [kg]
  double total_free_mass() const;
  const Eigen::Vector3d& gravity() const { return gravity_; }

  /// From the next force and the next linearization on.
  void set_damping(const RayleighDamping& damping) { damping_ = damping; }
  /// Which K a linearization gets, also for Rayleigh damping in the linear system; forces always have the
  /// exact one. Exact unless set.
  void set_hessian(Hessian hessian) { hessian_ = hessian; }
  Hessian hessian() const { return hessian_; }

  /// Whether a linearization was asked for: until then there is no matrix.
  bool has_matrices() const { return stiffness_pattern_ != nullptr; }
  /// Frees what was looked up for the next one.
  void forget_matrices();

  /// The free particles at rest, not moving.
  State<Vector> rest_state() const;
  /// Moves the pinned particles; one position per pinned particle, in order.
  void place_pinned(const std::vector<Eigen::Vector3d>& positions);
  /// Where every particle is, by its original number.
  std::vector<Eigen::Vector3d> positions(const Vector& x) const;

  /// Where all particles are, for terms().
  ParticleField position_field(const Vector& x) const;

  /// How implicit methods solve their linear systems, from the next linearization on.
  SolverOptions& solver() { return solver_; }

  Eigen::Index size() const override { return 3 * static_cast<Eigen::Index>(free_count_); }
  void acceleration(const Vector& x, const Vector& v, Vector& out) override;
  void linearize(const Vector& x, const Vector& v, Linearization<Vector>& linear) override;
  void linearize(const Vector& x, const Vector& v, std::shared_ptr<BlockLinearSystem>& linear);
  /// A new one.
  std::shared_ptr<BlockLinearSystem> linearization(const State<Vector>& state);
  double kinetic_energy(const Vector& v) override;
  double elastic_energy(const Vector& x) const;
  double potential_energy(const Vector& x) override;

 private:
  void number_particles(const std::vector<Eigen::Vector3d>& rest, const std::vector<double>& mass,
                        const std::vector<int>& pinned);
  void make_patterns(const ParticleField& x);

  int free_count_ = 0;
  std::vector<int> number_;              // particle -> its place: free ones first, then pinned ones
  std::vector<double> rest_;             // positions of the free particles
  std::vector<double> pinned_;           // positions of the pinned ones
  std::vector<double> pinned_velocity_;  // zeros
  Eigen::Vector3d gravity_;
  RayleighDamping damping_;
  Hessian hessian_ = Hessian::exact;
  SolverOptions solver_;
  std::vector<double> mass_, inverse_mass_;  // of the free particles [kg, 1/kg]
  SceneTerms terms_;
  SharedPattern stiffness_pattern_, damping_pattern_;  // of the last linearization; none before
};

}  // namespace springstab
