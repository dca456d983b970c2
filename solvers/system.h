// What a method may ask of the thing it moves: a handful of verbs, as concepts for any vector type,
// and as abstract classes for the systems that are chosen at run time (scenes, matrices from a file).
// All verbs are mass-scaled: K' = M⁻¹K [1/s²], D' = M⁻¹D [1/s], accelerations [m/s²].
#pragma once

#include <Eigen/Core>
#include <concepts>
#include <memory>
#include <stdexcept>
#include <vector>

#include "solvers/state.h"

namespace springstab {

/// The matrix m + dD' + kK' of an implicit step, with real numbers m > 0, d [s] and k [s²], which for steps
/// forward in time are not negative: implicit Euler's is {1, h, h²}. Complex numbers, as the stages of fully
/// implicit Runge-Kutta methods lead to, are not served.
struct Shift {
  double mass, damping, stiffness;

  /// The factor of K' where D' = d0 + αK': dα + k, in implicit Euler's case as h(α + h), one rounding less.
  double of_stiffness(double alpha) const {
    return stiffness == damping * damping ? damping * (alpha + damping) : damping * alpha + stiffness;
  }
  friend bool operator==(const Shift&, const Shift&) = default;
};

/// The s x s factors of D' [s] and K' [s²] by which the accelerations of s stages depend on each other.
struct StageCoupling {
  Eigen::MatrixXd damping, stiffness;
};
/// The part D_i of the damping that a method takes implicitly, of what the system offers for that: all of D
/// unless it says otherwise.
enum class DampingPart { all, diagonal };

/// How a solve with m + dD' + kK' went.
struct SolveReport {
  StepStatus status = StepStatus::done;
  long iterations = 0;  // 0 for a direct solve
  long products = 0;    // products with K and D it took
};

/// All that an explicit method uses: a = acceleration(x, v).
template <class S, class V>
concept Accelerating = requires(S& system, const V& x, const V& v, V& a) {
  system.acceleration(x, v, a);
};

/// A linear system x'' = -K'x - D'v (+ constant): its products, and the solve that implicit methods need,
/// (m + dD' + kK') out = rhs.
template <class S, class V>
concept Linear = Accelerating<S, V> && requires(S& system, const Shift& shift, const V& u, V& out) {
  system.stiffness_times(u, out);
  system.damping_times(u, out);
  { system.solve_shifted(shift, u, out) } -> std::same_as<SolveReport>;
};

using Vector = Eigen::VectorXd;
class LinearSystem;
template <class V>
struct Oscillator;

/// A pointer to what linearizing a system over V gives. Who asks keeps it, and hands it in again to have its
/// memory used again.
template <class V>
struct LinearizationTrait {
  using type = const Oscillator<V>*;
};
template <>
struct LinearizationTrait<Vector> {
  using type = std::shared_ptr<LinearSystem>;
};
template <class V>
using Linearization = typename LinearizationTrait<V>::type;

/// A system that can be linearized at (x, v); a linear one gives itself.
template <class S, class V>
concept Linearizable = Accelerating<S, V> &&
    requires(S& system, const V& x, const V& v, Linearization<V>& linear) {
  system.linearize(x, v, linear);
};

/// A mechanical system with `size()` unknowns, chosen at run time. Not const: systems own workspace.
class System {
 public:
  virtual ~System() = default;
  virtual Eigen::Index size() const = 0;
  /// out = M⁻¹ f(x, v); resizes `out`. Overflow shows as non-finite entries, it is not an error.
  virtual void acceleration(const Vector& x, const Vector& v, Vector& out) = 0;
  /// Makes `linear` the linear system with K and D of the state (x, v). One from an earlier call, which
  /// nobody else shares, is filled anew without allocation.
  virtual void linearize(const Vector& x, const Vector& v, Linearization<Vector>& linear) = 0;
  /// ½ vᵀMv [J].
  virtual double kinetic_energy(const Vector& v) = 0;
  /// Elastic energy plus the potential of the constant forces [J].
  virtual double potential_energy(const Vector& x) = 0;
};

class StepByRows;

/// x'' = -K'x - D'v, without a constant force: the system whose step is the state transition matrix.
class LinearSystem : public System {
 public:
  virtual void stiffness_times(const Vector& u, Vector& out) = 0;  // out = K'u
  virtual void damping_times(const Vector& u, Vector& out) = 0;    // out = D'u
  /// Solves (m + dD' + kK') out = rhs, starting from zero where it iterates.
  virtual SolveReport solve_shifted(const Shift& shift, const Vector& rhs, Vector& out) = 0;
  /// Solves out_i + Σ_j (damping_ij D' + stiffness_ij K') out_j = rhs_i, as fully implicit Runge-Kutta
  /// methods need it: by a factorization of the whole, for systems that have their matrices. The others throw
  /// std::invalid_argument.
  virtual SolveReport solve_coupled(const StageCoupling&, const std::vector<Vector>&, std::vector<Vector>&) {
    throw std::invalid_argument(
        "a fully implicit method solves for all stages together, expected a system that has K and D as "
        "matrices");
  }
  /// Solves (1 + hD_i') out = rhs: of the diagonal, M and D_i being matrices, (M + h diag D_i) out = M rhs.
  /// Throws std::invalid_argument where a system does not know its diagonal.
  virtual SolveReport solve_damping(DampingPart part, double h, const Vector& rhs, Vector& out) {
    if (part == DampingPart::diagonal)
      throw std::invalid_argument("this system does not tell the diagonal of its damping, expected part=all");
    return solve_shifted({1, h, 0}, rhs, out);
  }
  /// How many steps of so many stages it does well to take in one pass over its matrices (step_by_rows.h);
  /// less than 2 where it has no such way.
  virtual long steps_at_once(int) const { return 1; }
  /// Takes as many steps, to the same bits as one by one. Whether all were accepted; else the state is lost.
  virtual bool take_steps(long, StepByRows&) { return false; }
  /// Itself, not a copy: it has to outlive its linearization.
  void linearize(const Vector&, const Vector&, Linearization<Vector>& linear) override {
    linear = Linearization<Vector>(Linearization<Vector>(), this);
  }
};

}  // namespace springstab
