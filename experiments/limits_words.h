// The words of an answer about limits, as JSON, tables and Python have them.
#pragma once

#include <optional>

#include "analysis/structure_limits.h"

namespace springstab {

const char* name(LimitStatus status);
const char* name(DampingModel::Kind kind);
const char* name(BoundKind kind);
const char* name(LimitSource source);
const char* name(Proof proof);

/// Where every eigenvalue was computed, k0 is one; else it is a Ritz value, from below.
const char* value_kind(const StiffestMode& k0);

/// The bound of a factorization, where it is of that kind; Gershgorin's, where it is finite.
std::optional<double> factorized_bound(const StiffestMode& k0, BoundKind kind);
std::optional<double> gershgorin_bound(const StiffestMode& k0);

}  // namespace springstab
