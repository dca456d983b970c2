// Stable steps of structures whose D' does not commute with K', as dampers along springs do not: exact where
// a method's condition is one for matrices (StabilityRegion::exact_condition).
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "analysis/limits/matrix_condition.h"
#include "analysis/limits/method_limits.h"
#include "analysis/proofs/certified_step.h"
#include "analysis/proofs/lyapunov_step.h"

namespace springstab {

/// All that `limits` says of one structure with damping of kind `general`.
class GeneralDamping {
 public:
  /// `s`, with its damping, must outlive it. Without `proofs` nothing is certified, which is quicker.
  GeneralDamping(const StructuralMatrices& s, const StiffestMode& k0, const DampingModel& damping,
                 double safety, bool proofs, const ArpackOptions& options = {});
  /// Of a structure that only these know (CertifiedSteps): no eigenvalues of its motion, no Lyapunov proofs.
  GeneralDamping(std::shared_ptr<const ExtremePoints> range, DefinitenessTest proof, double coupling_ratio,
                 const StiffestMode& k0, const DampingModel& damping, double safety,
                 const ArpackOptions& options);
  GeneralDamping(StructuralMatrices&&, const StiffestMode&, const DampingModel&, double, bool,
                 const ArpackOptions& = {}) = delete;

  /// Nothing is certified where K or D is indefinite or not symmetric, and that is the reason given: there
  /// the eigenvalues decide, of the motions that do not grow by themselves.
  MethodLimits limits(const Method& method);

  /// How fast the motion itself grows, the largest Re μ [1/s]: 0 where none does, nothing where not all
  /// eigenvalues were computed.
  std::optional<double> growth();

 private:
  const std::optional<std::vector<std::complex<double>>>& own_spectrum();
  void know_bound();
  MethodLimits compute(const Method& method);
  std::vector<Stiffening> stiffenings() const;  // none, then those of the safety factor
  void set_certified(std::optional<double> h, Proof proof, MethodLimits& limits);
  void add_exact(const HalfPlane& condition, MethodLimits& limits);
  void add_split(const Method& method, MethodLimits& limits);
  void add_certified(const Method& method, MethodLimits& limits);
  void add_estimate(const Method& method, MethodLimits& limits);
  void add_estimate_near_boundary(const Method& method, MethodLimits& limits);
  void add_proved_at_one_step(const Method& method, MethodLimits& limits);
  void add_lyapunov(const Method& method, MethodLimits& limits);

  StiffestMode k0_;
  DampingModel damping_;
  double safety_;
  bool proofs_;
  double first_gap_;             // of the proofs, relative to h
  const StructuralMatrices& s_;  // empty where the matrices are not known
  Eigen::Index size_;            // beyond all limits then
  ArpackOptions options_;
  std::vector<std::optional<std::vector<std::complex<double>>>> spectra_;  // of each stiffening, when needed
  CertifiedSteps certified_;
  std::optional<LyapunovSteps> lyapunov_;  // when needed
  std::vector<std::pair<const StabilityRegion*, MethodLimits>> known_;
};

}  // namespace springstab
