// What decides the step: where the stiffest mode's energy is, and the two bounds on k0 that need no
// eigenvalue of the whole, with which explicit finite-element codes run.
//     φ: K φ = k0 M φ, φᵀMφ = 1;     an element's share is φᵀK_e φ/k0, an unknown's φ_i (Kφ)_i/k0
//     nodal:   k0 <= max_i Σ_j |K_ij|/M_ii                                             (Gershgorin)
//     element: k0 <= max_e λ_max(K_e, M_e),  K = Σ K_e, M = Σ M_e: of a particle's mass each of its elements
//              has a part in proportion to the norm of its rows of K_e
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "analysis/spectra/arpack.h"
#include "solvers/linear/structural_matrices.h"
#include "solvers/scene/element_stiffness.h"

namespace springstab {

/// What carries the mode: an element, or where there are none an unknown.
struct Carrier {
  std::string_view kind;  // of the visitor (element_stiffness.h), or "unknown"
  long index;
  std::vector<int> particles;  // in the visitor's numbers
  double share;                // of the mode's energy; those of all elements add up to 1
  double stiffness;            // the largest eigenvalue of K_e (2k of a spring), or K_ii [N/m]
  double mass;                 // of the particles that can move, or M_ii [kg]
};

struct StiffestMotion {
  Eigen::VectorXd mode;                  // φ, its largest entry positive
  std::vector<Carrier> carriers;         // the ten with most of the energy, most first
  std::optional<double> nodal, element;  // bounds on k0, but for rounding [1/s²]; nodal for a diagonal M
};

/// The elements of a structure: `visit_all` visits each, `place` is where a particle's three unknowns are
/// among all, over three, -1 where it is pinned.
struct ElementsOf {
  std::function<void(const ElementVisitor&)> visit_all;
  std::vector<int> place;
};

/// Nothing where K is not symmetric, the search did not converge or k0 is not positive.
std::optional<StiffestMotion> stiffest_motion(const StructuralMatrices& s,
                                              const std::optional<ElementsOf>& elements = std::nullopt,
                                              const ArpackOptions& options = {});

}  // namespace springstab
