// The answer in one call: the largest stable step of every method for a structure.
//
//     StructureLimits answer(structure_of(prepare(read_matrix("K.mtx"), read_matrix("M.mtx"))));
//     std::cout << "k0 = " << answer.k0().value << " 1/s²\n";
//     for (const Method& method : all_methods())
//       if (const MethodLimits& limits = answer.limits(method); limits.recommended)
//         std::cout << method.name() << ": " << *limits.recommended << " s\n";
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "analysis/limits/general_damping.h"
#include "analysis/limits/method_limits.h"
#include "analysis/limits/structure.h"
#include "analysis/method.h"
#include "analysis/spectra/generator_spectrum.h"

namespace springstab {

/// Digits of h of many_unknowns, where no others are wanted.
inline constexpr int usual_digits = 4;
/// Of k0's residual, for as many digits of h; `tolerance` where digits is 0 and for many of them.
double search_tolerance(int digits, double tolerance);

struct StructureLimitsOptions {
  double safety = 1.5;  // >= 1, on the stiffness
  /// Else no bound on k0, nothing certified, no step for every pose and no transient growth, which is
  /// quicker.
  bool certify = true;
  std::uint64_t seed = 1;       // of the start vectors
  double k0_tolerance = 1e-10;  // of k0's residual, relative
  /// Digits of h that are wanted of the searches for eigenvalues; 0: all of up to many_unknowns, else 4.
  int digits = 0;
  double certify_loss = 1e-3;        // of h, about: what a proof by pieces may lose
  std::optional<double> max_step{};  // recommended where nothing limits the step [s]
  /// Whether K is indefinite is found out also without `certify`, which costs a factorization.
  bool definiteness = false;
  std::function<void()> before_product{};  // of the matrices with a vector; may throw to give up
};

/// Owns what it needs. Everything is computed when it is first asked for, and kept. Not to be shared between
/// threads.
class StructureLimits {
 public:
  /// `k0` where it is known already.
  explicit StructureLimits(Structure structure, const StructureLimitsOptions& options = {},
                           std::optional<StiffestMode> k0 = std::nullopt);

  /// Of a structure whose matrices are not at hand: what its damping is, and where that is general, what is
  /// known of it.
  StructureLimits(const DampingModel& damping, const StructureLimitsOptions& options, const StiffestMode& k0,
                  std::unique_ptr<GeneralDamping> general);

  const Structure& structure() const { return *structure_; }
  /// Digits of h that the searches are for; nothing where they are for all.
  std::optional<int> digits() const;
  /// Throws std::invalid_argument for rates of motion beyond double precision.
  const StiffestMode& k0();
  /// All unknown where k0 did not converge.
  const MethodLimits& limits(const Method& method);
  /// Before several methods are asked for: finds limits whose proofs spare others of them theirs.
  void expect(std::span<const Method> methods);
  /// How fast the motion itself grows, the largest Re μ [1/s]: 0 where none does; nothing where it was not
  /// computed, as of a definite K without damping or with Rayleigh's, or where not all eigenvalues were.
  std::optional<double> growth();
  /// Modes of a symmetric structure whose motion grows by itself: the fastest where the damping is Rayleigh's
  /// or none, else all where they were computed.
  std::vector<DampedMode> growing_modes();

 private:
  ArpackOptions search(double tolerance) const;
  GeneralDamping* general();                    // null where k0 and two numbers decide
  GeneralDamping* split(const Method& method);  // null where it takes none or all of D implicitly
  DampingModel damping_with(const Method& method) const;
  MethodLimits compute(const Method& method);
  void add_transient_growth(const Method& method, MethodLimits& limits);

  std::shared_ptr<const Structure> structure_;  // stays where it is, however this object moves
  StructureLimitsOptions options_;
  std::optional<StiffestMode> k0_;
  std::unique_ptr<GeneralDamping> general_;
  std::optional<StructuralMatrices> with_damping_;  // where two numbers say it but a method splits it
  std::unique_ptr<GeneralDamping> split_;
  std::map<Method, MethodLimits, Method::ByIdentity> known_;
};

}  // namespace springstab
