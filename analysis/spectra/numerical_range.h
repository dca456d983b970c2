// The joint numerical range W = {(v*D'v, v*K'v)} over unit vectors v, in the mass inner product: a convex set
// (Toeplitz-Hausdorff) that holds the damping and stiffness of every eigenpair of the damped system.
#pragma once

#include <optional>

#include "analysis/spectra/arpack.h"
#include "solvers/linear/structural_matrices.h"

namespace springstab {

/// One mode, or one point of W.
struct ModePoint {
  double d;  // v*D'v [1/s]
  double k;  // v*K'v [1/s²]
};

struct ExtremePoint : ModePoint {
  Eigen::VectorXd vector;  // v, mass-scaled
};

/// Finds points of W, by whatever means.
class ExtremePoints {
 public:
  virtual ~ExtremePoints() = default;
  /// Of its searches, at least.
  virtual double tolerance() const = 0;
  /// The point of W with the largest a·d + b·k, but for rounding and the tolerance; nothing when that did not
  /// converge. It is an estimate from within: no proof that W reaches no farther. `tolerance` may loosen the
  /// search's, and `near` is the vector of a nearby direction to start from.
  virtual std::optional<ExtremePoint> farthest(double a, double b, double tolerance = 0,
                                               const Eigen::VectorXd& near = {}) const = 0;
};

class NumericalRange final : public ExtremePoints {
 public:
  /// `s` must outlive it. Works densely up to 150 unknowns, else by ARPACK with these options.
  explicit NumericalRange(const StructuralMatrices& s, ArpackOptions options = {});
  explicit NumericalRange(StructuralMatrices&&, ArpackOptions = {}) = delete;

  double tolerance() const override { return options_.tolerance; }
  std::optional<ExtremePoint> farthest(double a, double b, double tolerance = 0,
                                       const Eigen::VectorXd& near = {}) const override;

 private:
  std::optional<ExtremePoint> search(double a, double b, double tolerance, const Eigen::VectorXd& near) const;
  LinearOperator sum(double a, double b) const;
  ExtremePoint point(const Eigen::VectorXd& v) const;

  Eigen::Index size_;
  ArpackOptions options_;
  LinearOperator damping_, stiffness_;  // mass-scaled
  Eigen::MatrixXd dense_damping_, dense_stiffness_;
  SparseMatrix sparse_damping_, sparse_stiffness_;  // of many unknowns with a diagonal mass

  // Of many unknowns, what is largest in K' alone and in D' alone: every search begins there.
  struct Axis {
    ExtremePoint point;
    double tolerance;
  };
  mutable std::optional<Axis> stiffest_, most_damped_;
};

}  // namespace springstab
