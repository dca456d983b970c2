// The step up to which x hD' + y h²K' < bound holds for matrices (StabilityRegion::exact_condition): found,
// and proved.
#pragma once

#include <optional>

#include "analysis/proofs/certified_step.h"
#include "analysis/regions/stability_region.h"
#include "analysis/spectra/numerical_range.h"

namespace springstab {

/// The h at which λ_max(x hD' + y h²K') = bound; ∞ where there is none; nothing when an eigenvalue did not
/// converge. y > 0, bound > 0; D', K' are those of `range`, stiffened. What D' or K' has below 0 is taken for
/// rounding, unless D' is `signed_damping`.
std::optional<double> exact_limit(const ExtremePoints& range, const HalfPlane& condition,
                                  const Stiffening& stiffening = {}, bool signed_damping = false);

/// The largest step found below `h` at which x hD' + y h²K' < bound is proved, from h (1 - gap) on; nothing
/// where none was.
std::optional<double> proved_limit(const DefinitenessTest& proof, const HalfPlane& condition, double h,
                                   double gap = 1e-10);

/// Below what it returns a method with that exact condition is stable for these matrices, K and D positive
/// semidefinite: proved. Nothing where no proof was found.
std::optional<double> proved_limit(const StructuralMatrices& s, const HalfPlane& condition,
                                   ArpackOptions options = {});

/// How far below h a proof begins, relative to h: half the residual that h was found to.
double proof_gap(const ArpackOptions& options);

}  // namespace springstab
