// Asked backwards: whether a method holds at a wanted step, and what would make it hold. Every answer is a
// question to the same limits: of the structure changed (structure_change.h), found by a search.
//
//     ForStep question(answer, 1.0 / (60 * 10), 3);   // `answer` is a StructureLimits of a scene
//     const StepAnswer symplectic = question.of("symplectic-euler");
//     if (symplectic.holds == false && symplectic.mass_factor.value)
//       std::cout << "with " << *symplectic.mass_factor.value << " times the mass it holds\n";
#pragma once

#include <string_view>
#include <vector>

#include "analysis/limits/mass_scaling.h"
#include "analysis/limits/structure_change.h"
#include "analysis/limits/structure_limits.h"

namespace springstab {

/// A value, or why there is none, in lasting words.
template <class Value>
struct Found {
  std::optional<Value> value;
  std::string_view reason;  // where there is none

  Found(Value v) : value(std::move(v)) {}  // NOLINT(google-explicit-constructor): one or the other
  Found(std::string_view why) : reason(why) {}
};

struct AlphaRange {
  double low, high;  // [s]; high may be ∞
};

/// What is said of one method at the wanted step H. The changes are given where it does not hold; each alone
/// makes it hold, with d0, alpha (but for its own range) and every damper as they are.
struct StepAnswer {
  std::optional<bool> holds;     // H < h_max, or H is proved; nothing where neither is known
  std::optional<double> margin;  // h_max/H
  bool proved = false;           // a proved step covers H
  std::string_view unknown{};    // why it is not known

  Found<double> stiffness_factor{""};  // the largest below 1, on K
  Found<AlphaRange> alpha{""};         // D = d0 M + alpha K + dampers: an interval of alpha
  Found<double> mass_factor{""};       // the least above 1, on M
  Found<MassScaling> mass_scaling{""};
  Found<long> substeps{""};  // the fewest, each no longer than the proved step
};

/// All limits are those of StructureLimits to 1e-8 of H (to its digits where it searches for few), below H:
/// what is found holds. Where the structure's proof reaches h_max to 1e-3, so does that of the structure
/// changed, and what is found is proved to hold.
class ForStep {
 public:
  /// `answer` must outlive it; `width` is how many unknowns a particle has. Throws std::invalid_argument for
  /// a step that is not positive and finite, and for a width that does not divide the unknowns.
  ForStep(StructureLimits& answer, double step, int width);

  double step() const { return step_; }
  StepAnswer of(const Method& method);

 private:
  struct Limit;

  void add_changes(const Limit& limit, StepAnswer& result) const;
  Found<double> stiffness_factor(const Limit& limit) const;
  Found<double> mass_factor(const Limit& limit) const;
  Found<AlphaRange> alpha(const Limit& limit) const;
  std::vector<double> alphas(const StabilityRegion& region, double k) const;
  Found<AlphaRange> alpha_of_condition(const Limit& limit, const HalfPlane& condition) const;
  Found<MassScaling> mass_scaling(const Limit& limit) const;
  Found<long> substeps(const MethodLimits& limits) const;

  StructureLimits& answer_;
  double step_;
  int width_;
};

}  // namespace springstab
