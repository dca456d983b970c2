#include "experiments/limits_words.h"

#include <cmath>

#include "experiments/command/enum_name.h"

namespace springstab {

const char* name(LimitStatus status) {
  static constexpr std::pair<LimitStatus, const char*> names[] = {{LimitStatus::limited, "limited"},
                                                                  {LimitStatus::unlimited, "unlimited"},
                                                                  {LimitStatus::none, "none"},
                                                                  {LimitStatus::unknown, "unknown"}};
  return name_in(names, status);
}

const char* name(DampingModel::Kind kind) {
  using Kind = DampingModel::Kind;
  static constexpr std::pair<Kind, const char*> names[] = {{Kind::none, "none"},
                                                           {Kind::rayleigh, "rayleigh"},
                                                           {Kind::designed, "rayleigh"},
                                                           {Kind::general, "general"}};
  return name_in(names, kind);
}

const char* name(BoundKind kind) {
  static constexpr std::pair<BoundKind, const char*> names[] = {
      {BoundKind::inertia, "inertia"}, {BoundKind::pieces, "pieces"}, {BoundKind::gershgorin, "gershgorin"}};
  return name_in(names, kind);
}

const char* name(LimitSource source) { return source == LimitSource::exact ? "exact" : "estimate"; }

const char* name(Proof proof) {
  static constexpr std::pair<Proof, const char*> names[] = {{Proof::k0_bound, "bound on k0"},
                                                            {Proof::quadrant, "whole quadrant"},
                                                            {Proof::matrix_condition, "matrix condition"},
                                                            {Proof::polygon, "polygon"},
                                                            {Proof::lyapunov, "Lyapunov"},
                                                            {Proof::none, "none"}};
  return name_in(names, proof);
}

const char* value_kind(const StiffestMode& k0) { return k0.smallest ? "eigenvalue" : "Ritz value"; }

std::optional<double> factorized_bound(const StiffestMode& k0, BoundKind kind) {
  return k0.bound_kind == kind ? std::optional(k0.upper_bound) : std::nullopt;
}

std::optional<double> gershgorin_bound(const StiffestMode& k0) {
  return std::isfinite(k0.gershgorin) ? std::optional(k0.gershgorin) : std::nullopt;
}

}  // namespace springstab
