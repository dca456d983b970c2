// How large a scene is and which times it has, and whether a step and a unit of length fit them: for people
// and for programs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/spectra/spectrum.h"
#include "experiments/command/output.h"
#include "experiments/inputs/subject.h"

namespace springstab {

/// "0.775 x 0 x 0.775 m, 0.128 kg, 5826 springs"; empty for matrices.
std::string size_text(const Subject& subject);

/// Adds `extent` [m], `total_mass` [kg] and `springs` to a report; null for matrices.
void add_size(Json& report, const Subject& subject);

/// A line where a scene is so large or so small that its lengths are probably no metres; else empty.
std::string size_warning(const Subject& subject);
/// On stderr.
void print_size_warning(const Subject& subject);

/// A time that steps have to resolve.
struct TimeScale {
  double seconds;
  const char* name;
};

/// Of the slowest mode, 2π/√k_min, where all modes of K' = M⁻¹K are known and oscillate, in seconds.
std::optional<double> slowest_period(const StiffestMode& k0);
/// The same of up to `dense_limit` unknowns, in the state given.
std::optional<double> slowest_period(Subject& subject, const State<Vector>& state);

/// The time in which a particle falls by its shortest edge l, √(2l/g), and that period.
std::vector<TimeScale> time_scales(const Subject& subject, std::optional<double> slowest_period);

/// What a step [s] exceeds: "a twentieth of …"; empty where it resolves them all.
std::string exceeded(double step, const std::vector<TimeScale>& scales);

}  // namespace springstab
