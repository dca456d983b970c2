// Which method blew up: a pattern that grows in a run, seen by the structure. Its Rayleigh quotients
//     k = φ*Kφ/φ*Mφ,   d = φ*Dφ/φ*Mφ
// are those of a mode, and a method's own step has the eigenvalues λ of A(hd, h²k) on it: one of them is the
// factor of the run, if the run was made by this method.
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "analysis/method.h"
#include "analysis/structure_limits.h"

namespace springstab::diagnosis {

struct RunFactor {
  std::complex<double> factor;  // Λ, from one frame to the next
  double h;                     // the step [s]
  int every;                    // steps from one frame to the next
};

struct MethodOfGrowth {
  Method method;
  std::complex<double> factor;  // λ of a step, the one nearest to the run's
  double distance;              // |log(Λ/λ^every)|/every: about the relative one of a step's factor
  double stiffness;             // times k, where the method's factor is nearest to the run's
  double off;                   // both together, in units of what they may be off
  bool fits;
  std::optional<double> step_over_limit;  // h/h_max of the structure; of methods that fit and have a limit
};

struct PatternInStructure {
  double stiffness, damping;      // k [1/s²], d [1/s]
  double of_stiffest;             // k/k0
  std::optional<double> overlap;  // cosine with the stiffest mode, all within 0.1 % of k0; not of masses
                                  // that are coupled
  std::vector<MethodOfGrowth> methods;  // best first
};

/// `pattern` is over the unknowns of the structure in the pose in which it grows; limits are those of
/// `answer`, at rest. Throws std::invalid_argument for a pattern of another size, std::runtime_error where k0
/// in the pose does not converge.
PatternInStructure explain_growth(const Structure& pose, StructureLimits& answer,
                                  const Eigen::VectorXcd& pattern, const RunFactor& run,
                                  const std::vector<Method>& methods);

}  // namespace springstab::diagnosis
