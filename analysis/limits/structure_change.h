// A structure made otherwise, to ask what would let a step hold:
//     K ← s K,   M ← m M + diag(Δm),   D ← d0 M + alpha K + C with the new M and K,
// where C, what the damping has beside Rayleigh's part, stays as it is, and so do d0 and alpha unless a new
// alpha is given.
#pragma once

#include <optional>

#include "analysis/limits/structure.h"
#include "analysis/spectra/spectrum.h"

namespace springstab {

struct StructureChange {
  double stiffness = 1, mass = 1;  // factors
  std::optional<double> alpha{};   // in place of the structure's own [s]
  Eigen::VectorXd added_mass{};    // of each unknown [kg]; empty: none
};

/// Without every_pose.
Structure changed(const Structure& structure, const StructureChange& change);

/// Of the structure changed, where no mass is added to single unknowns.
StiffestMode changed(const StiffestMode& mode, const StructureChange& change);

}  // namespace springstab
