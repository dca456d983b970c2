// Extreme points of the numerical range by SLEPc's Krylov-Schur solver: k0, and what exact limits and
// polygons ask for.
#pragma once

#include <cstdint>

#include "analysis/spectra/numerical_range.h"
#include "analysis/spectra/spectrum.h"
#include "experiments/mpi/system.h"

namespace springstab::mpi {

/// All ranks ask the same; a point's vector holds this rank's entries.
class SlepcRange final : public ExtremePoints {
 public:
  /// `system` must outlive it. `tolerance` is of residuals, relative. SLEPc's options are those of its
  /// database.
  SlepcRange(const System& system, double tolerance, std::uint64_t seed);

  double tolerance() const override { return tolerance_; }
  std::optional<ExtremePoint> farthest(double a, double b, double tolerance = 0,
                                       const Eigen::VectorXd& near = {}) const override;

  /// k0, bounded by Gershgorin where the mass is diagonal.
  StiffestMode stiffest_mode() const;
  /// The smallest eigenvalue of K'; nothing where it did not converge.
  std::optional<double> lowest() const;

 private:
  struct Found {
    bool converged = false;
    double value = 0, residual = 0;
    OwnedVec vector{};
  };
  Found search(double a, double b, double tolerance, EPSWhich which, const Eigen::VectorXd& near) const;

  const System& system_;
  double tolerance_;
  std::uint64_t seed_;
  mutable long products_ = 0;
};

}  // namespace springstab::mpi
